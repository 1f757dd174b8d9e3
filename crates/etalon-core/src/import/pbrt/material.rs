//! Materials: diffuse surfaces, plain, rough or coated, mirrors, glass, metals and mixtures, with or without textures.

use super::params::Params;
use super::reader::{GREY, Reader};
use super::texture::Values;
use crate::bsdf::{Bsdf, CoatedDiffuse, OrenNayar, ThinDielectric};
use crate::error::{Error, Result};
use crate::import::place::{ANY, DIELECTRIC_INDEX, FRACTION, Rule, quote};
use crate::math::Rgb;
use crate::optics::metals;
use crate::scene::{
    Conductor, Dielectric, Distribution, Material, RoughnessScale, SMOOTH_ALPHA, Texture, Textured, least_alpha,
};
use std::sync::Arc;

/// Most materials in a mixture, those of its parts included.
const MOST_MIXED: usize = 64;

impl Reader<'_> {
    pub(super) fn material(&mut self, p: &Params) -> Result<Material> {
        let material = match p.kind.as_str() {
            "matte" => self.matte(p)?,
            "diffuse" => self.diffuse(p, "reflectance")?,
            "coateddiffuse" => self.coated_diffuse(p)?,
            "mirror" => {
                let (reflectance, texture) = self.colour(p, "Kr", Rgb::splat(0.9))?;
                with_textures(Material::Mirror { reflectance }, [texture, None], None)
            }
            "glass" => {
                let index = p.float("index", &DIELECTRIC_INDEX)?;
                let (reflected, transmitted) = (self.colour(p, "Kr", Rgb::ONE)?, self.colour(p, "Kt", Rgb::ONE)?);
                self.dielectric(p, [reflected, transmitted], index, RoughnessScale::Logarithmic)?
            }
            "dielectric" => {
                self.dielectric(p, [(Rgb::ONE, None), (Rgb::ONE, None)], None, RoughnessScale::SquareRoot)?
            }
            "thindielectric" => {
                let eta = p.float("eta", &DIELECTRIC_INDEX)?.unwrap_or(1.5) as f32;
                Material::from(Bsdf::ThinDielectric(ThinDielectric { eta }))
            }
            "metal" if self.setup.v2 => {
                return Err(p
                    .at
                    .unsupported("Material \"metal\" of pbrt-v2 is not supported: its microfacets are Blinn's")
                    .with_hint("write Integrator in place of SurfaceIntegrator to have it read as pbrt-v3's"));
            }
            "metal" | "conductor" => self.conductor(p)?,
            "mix" => self.mixture(p)?,
            _ => {
                let kinds =
                    "matte, diffuse, coateddiffuse, mirror, glass, dielectric, thindielectric, metal, conductor, mix";
                return Err(p.unsupported_kind(kinds));
            }
        };
        p.finish(&[], &mut self.warnings)?;
        Ok(material)
    }

    /// pbrt-v4's `mix` of two named materials: `amount` is the share of the second.
    fn mixture(&self, p: &Params) -> Result<Material> {
        let at = p.place("materials");
        let names = p.texts("materials")?.unwrap_or_default();
        let [first, second] = names else {
            return Err(at.input(format!("{} needs \"string materials\" of two names", p.owner)));
        };
        let amount = p.float("amount", &FRACTION)?.unwrap_or(0.5) as f32;
        let part = |name: &String, weight: f32| {
            let known = self.materials.get(name).cloned();
            let material = known.ok_or_else(|| at.input(format!("no material named {}", quote(name))))?;
            Ok::<_, Error>((weight, material))
        };
        let parts = [part(first, 1.0 - amount)?, part(second, amount)?];
        // Mixtures of mixtures double with each line.
        if parts.iter().map(|(_, material)| material.parts()).sum::<usize>() > MOST_MIXED {
            return Err(at.unsupported(format!("a mixture of more than {MOST_MIXED} materials")));
        }
        Ok(Material::Mixture(Arc::new(parts)))
    }

    fn diffuse(&self, p: &Params, name: &'static str) -> Result<Material> {
        let (albedo, texture) = self.colour(p, name, GREY)?;
        Ok(with_textures(Material::Diffuse { albedo }, [texture, None], None))
    }

    /// pbrt-v3's `matte`: Oren and Nayar's model, and Lambert's law where `sigma` is 0.
    fn matte(&self, p: &Params) -> Result<Material> {
        const SIGMA: Rule = Rule(|x| (0.0..=90.0).contains(&x), "from 0 to 90 degrees");
        let sigma = p.float("sigma", &SIGMA)?.unwrap_or(0.0) as f32;
        if sigma == 0.0 {
            return self.diffuse(p, "Kd");
        }
        let (albedo, texture) = self.colour(p, "Kd", GREY)?;
        let bsdf = Bsdf::OrenNayar(OrenNayar::new(albedo, sigma.to_radians()));
        Ok(with_textures(Material::from(bsdf), [texture, None], None))
    }

    /// A Lambertian surface under a smooth coat, whose light between coat and base is summed exactly. pbrt follows it at random,
    /// through a coat that may be rough and that absorbs.
    fn coated_diffuse(&mut self, p: &Params) -> Result<Material> {
        let (albedo, texture) = self.colour(p, "reflectance", GREY)?;
        let eta = p.float("eta", &DIELECTRIC_INDEX)?.unwrap_or(1.5) as f32;
        if p.rgb("albedo", &FRACTION)?.is_some_and(|albedo| albedo != Rgb::ZERO) {
            let message = format!("{}: a coat that scatters light is not supported", p.owner);
            return Err(p.place("albedo").unsupported(message));
        }
        if self.roughness(p, 0.0, RoughnessScale::SquareRoot)? != ([0.0; 2], None) {
            let place = ROUGHNESSES.into_iter().find(|&name| p.has(name));
            let message = format!("{}: the coat is taken as smooth", p.owner);
            self.warnings.push(p.place(place.unwrap_or_default()).warning(&message));
        }
        // pbrt's medium has an extinction coefficient of 1.
        let thickness = p.float("thickness", &LENGTH)?.unwrap_or(0.01);
        if thickness > 0.0 {
            let share = 100.0 * (1.0 - (-2.0 * thickness).exp());
            let message =
                format!("{}: the coat's absorption is left out: {share:.2} % straight through it and back", p.owner);
            self.warnings.push(p.place("thickness").warning(&message));
        }
        // Settings of pbrt's random walk, without effect on its mean except for the longest paths.
        p.float("g", &ANY)?;
        p.integer("maxdepth", 0..=u32::MAX)?;
        p.integer("nsamples", 0..=u32::MAX)?;
        let coated = Bsdf::CoatedDiffuse(CoatedDiffuse::new(albedo, eta));
        Ok(with_textures(Material::from(coated), [texture, None], None))
    }

    /// pbrt's `dielectric` and pbrt-v3's `glass`, whose index may have another name; `colours` are those of reflection and
    /// transmission.
    fn dielectric(
        &self,
        p: &Params,
        colours: [(Rgb, Option<Texture>); 2],
        index: Option<f64>,
        scale: RoughnessScale,
    ) -> Result<Material> {
        let eta = p.float("eta", &DIELECTRIC_INDEX)?.or(index).unwrap_or(1.5) as f32;
        let ((alpha, alpha_texture), distribution) = (self.roughness(p, 0.0, scale)?, distribution(p)?);
        let [(reflectance, reflected), (transmittance, transmitted)] = colours;
        let dielectric = Dielectric { reflectance, transmittance, eta, alpha, distribution };
        if alpha_texture.is_some() && least_alpha(&dielectric) > ROUGH_ALPHA {
            return Err(p.at.unsupported(format!("{}: a texture of roughness needs an index apart from 1", p.owner)));
        }
        Ok(with_textures(Material::Dielectric(dielectric), [reflected, transmitted], alpha_texture))
    }

    /// pbrt-v3's `metal` and pbrt-v4's `conductor`.
    fn conductor(&mut self, p: &Params) -> Result<Material> {
        let (eta, k) = match p.rgb("reflectance", &FRACTION)? {
            // With a reflectance, `eta` and `k` are parameters that are not known.
            Some(reflectance) => (Rgb::ONE, extinction(reflectance)),
            None => (
                index(p, "eta", metals::COPPER.eta_rgb(), &mut self.warnings)?,
                index(p, "k", metals::COPPER.k_rgb(), &mut self.warnings)?,
            ),
        };
        let (missing, scale) = match p.kind.as_str() {
            "metal" => (0.01, RoughnessScale::Logarithmic),
            _ => (0.0, RoughnessScale::SquareRoot),
        };
        let (alpha, texture) = self.roughness(p, missing, scale)?;
        let conductor = Conductor { alpha, two_sided: true, ..Conductor::new(eta, k, 0.0, distribution(p)?) };
        Ok(with_textures(Material::Conductor(conductor), [None, None], texture))
    }

    /// α along u and v, or textures of it with an α that stands for them.
    fn roughness(&self, p: &Params, missing: f64, scale: RoughnessScale) -> Result<([f32; 2], Option<[Texture; 2]>)> {
        let is_remapped = p.flag("remaproughness")?.unwrap_or(true);
        let scale = if is_remapped { scale } else { RoughnessScale::Alpha };
        let [both, u, v] = ROUGHNESSES.map(|name| self.fraction(p, name, Values::Float));
        let (both, u, v) = (both?, u?, v?);
        let number = |name, texture: &Option<Texture>| match texture {
            Some(Texture::Constant(value)) => Ok(Some(f64::from(value.x))),
            Some(_) => Ok(None),
            None => p.float(name, &FRACTION),
        };
        let one = |name, own: Option<Texture>| {
            // A texture or a number of its own, or those of both.
            let number_of_both = number("roughness", &both)?.unwrap_or(missing);
            let texture = if p.has(name) { own.clone() } else { both.clone() };
            let texture = texture.filter(|texture| !matches!(texture, Texture::Constant(_)));
            Ok::<_, Error>((number(name, &own)?.unwrap_or(number_of_both), texture))
        };
        let [(u, u_texture), (v, v_texture)] = [one("uroughness", u)?, one("vroughness", v)?];
        if u_texture.is_none() && v_texture.is_none() {
            return Ok((widths([u, v], scale, p.kind != "metal"), None));
        }
        let texture = |texture: Option<Texture>, number: f64| {
            let roughness = texture.unwrap_or(Texture::Constant(Rgb::splat(number as f32)));
            Texture::Alpha(scale, Arc::new(roughness))
        };
        Ok(([ROUGH_ALPHA; 2], Some([texture(u_texture, u), texture(v_texture, v)])))
    }
}

/// The parameters of roughness: of both axes, along u, along v.
const ROUGHNESSES: [&str; 3] = ["roughness", "uroughness", "vroughness"];

/// The α that stands for textures: of a surface that is rough.
const ROUGH_ALPHA: f32 = 0.5;

/// A length that may be 0.
const LENGTH: Rule = Rule(|x| x >= 0.0, "not negative");

/// α along u and v for two roughnesses. Two of 0 are a smooth surface, except for pbrt-v3's metal. Where only one α is below
/// [`SMOOTH_ALPHA`], it is raised to that, as in pbrt.
fn widths([u, v]: [f64; 2], scale: RoughnessScale, is_smooth_at_0: bool) -> [f32; 2] {
    if [u, v] == [0.0; 2] && is_smooth_at_0 {
        return [0.0; 2];
    }
    let alpha = [u, v].map(|roughness| scale.alpha(roughness) as f32);
    let is_rough = alpha[0].max(alpha[1]) >= SMOOTH_ALPHA;
    if is_rough { alpha.map(|alpha| alpha.max(SMOOTH_ALPHA)) } else { alpha }
}

/// The material with textures of reflectance and transmittance, and of α; without any it is plain.
fn with_textures(base: Material, colours: [Option<Texture>; 2], alpha: Option<[Texture; 2]>) -> Material {
    let [reflectance, transmittance] = colours;
    if reflectance.is_none() && transmittance.is_none() && alpha.is_none() {
        return base;
    }
    Material::Textured(Arc::new(Textured { base, reflectance, transmittance, alpha }))
}

/// The microfacets are GGX's (Trowbridge and Reitz), as in pbrt; `"string distribution" "beckmann"` is this program's own
/// addition.
fn distribution(p: &Params) -> Result<Distribution> {
    match p.text("distribution")? {
        None | Some("ggx") => Ok(Distribution::Ggx),
        Some("beckmann") => Ok(Distribution::Beckmann),
        Some(other) => {
            let message = format!("the distribution {} is not \"beckmann\" or \"ggx\"", quote(other));
            Err(p.place("distribution").unsupported(message))
        }
    }
}

/// k of a conductor with η = 1 that reflects r = k²/(4 + k²) head-on, r at most 0.9999, as in pbrt-v4.
fn extinction(reflectance: Rgb) -> Rgb {
    Rgb::from_array(reflectance.min(Rgb::splat(0.9999)).to_array().map(|r| 2.0 * (r / (1.0 - r)).sqrt()))
}

/// `eta` or `k` in the three channels. Without it: copper's, as in pbrt.
fn index(p: &Params, name: &'static str, copper: Rgb, warnings: &mut Vec<String>) -> Result<Rgb> {
    const INDEX: Rule = Rule(|x| (0.0..=1000.0).contains(&x), "from 0 to 1000");
    let given = p.rgb(name, &INDEX)?;
    if given.is_none() {
        warnings.push(p.at.warning(&format!("{}: no {name}: copper's", p.owner)));
    }
    Ok(given.unwrap_or(copper))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The material of that name and these parameters in a file.
    fn imported(text: &str) -> Material {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.pbrt");
        std::fs::write(&path, format!("Camera \"perspective\" WorldBegin Material {text} Shape \"sphere\" WorldEnd"))
            .unwrap();
        crate::import::read_scene(&path, &Default::default()).unwrap().scene.objects[0].material.clone()
    }

    #[test]
    fn matte_with_sigma_is_oren_and_nayars() {
        let albedo = Rgb::new(0.2, 0.5, 0.8);
        let matte = |sigma: &str| imported(&format!("\"matte\" \"rgb Kd\" [.2 .5 .8] {sigma}"));
        let rough = Bsdf::OrenNayar(OrenNayar::new(albedo, 20f32.to_radians()));
        assert_eq!(matte("\"float sigma\" 20"), Material::from(rough));
        assert_eq!([matte(""), matte("\"float sigma\" 0")], [(); 2].map(|()| Material::Diffuse { albedo }));
    }

    #[test]
    fn a_thin_dielectric_has_an_index() {
        let thin = |eta| Material::from(Bsdf::ThinDielectric(ThinDielectric { eta }));
        let found = ["", "\"float eta\" 1.3"].map(|eta| imported(&format!("\"thindielectric\" {eta}")));
        assert_eq!(found, [thin(1.5), thin(1.3)]);
    }

    #[test]
    fn a_conductor_reflects_what_its_reflectance_says() {
        let wanted = Rgb::new(0.0, 0.5, 1.0);
        let (k, expected) = (extinction(wanted).to_array(), [0.0, 0.5, 0.9999]);
        for (k, r) in k.into_iter().zip(expected) {
            assert!((crate::optics::conductor::normal_reflectance(1.0, f64::from(k)) - r).abs() < 1e-6, "{k} {r}");
        }
    }
}
