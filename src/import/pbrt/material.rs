//! Materials: diffuse surfaces, plain or coated, mirrors, glass, metals and mixtures.

use super::params::Params;
use super::reader::{GREY, Reader};
use crate::error::{Error, Result};
use crate::import::place::quote;
use crate::import::rule::{ANY, DIELECTRIC_INDEX, FRACTION, Rule};
use crate::math::Rgb;
use crate::optics::metals;
use crate::scene::{Conductor, Dielectric, Distribution, Material, SMOOTH_ALPHA};
use std::sync::Arc;

impl Reader<'_> {
    pub(super) fn material(&mut self, p: &Params) -> Result<Material> {
        let reflectance = |name, missing| Ok::<_, Error>(p.rgb(name, &FRACTION)?.unwrap_or(missing));
        let material = match p.kind.as_str() {
            "matte" => {
                p.only_float("sigma", |x| x == 0.0, "0 (Lambert's law)")?;
                Material::Diffuse { albedo: reflectance("Kd", GREY)? }
            }
            "diffuse" => Material::Diffuse { albedo: reflectance("reflectance", GREY)? },
            "coateddiffuse" => coated_diffuse(p, &mut self.warnings)?,
            "mirror" => Material::Mirror { reflectance: reflectance("Kr", Rgb::splat(0.9))? },
            "glass" => {
                let (reflectance, transmittance) = (reflectance("Kr", Rgb::ONE)?, reflectance("Kt", Rgb::ONE)?);
                let index = p.float("index", &DIELECTRIC_INDEX)?;
                Material::Dielectric(Dielectric { reflectance, transmittance, ..dielectric(p, index, remapped_v3)? })
            }
            "dielectric" => Material::Dielectric(dielectric(p, None, f64::sqrt)?),
            "metal" if self.setup.v2 => {
                return Err(p
                    .at
                    .unsupported("Material \"metal\" of pbrt-v2 is not supported: its microfacets are Blinn's")
                    .with_hint("write Integrator in place of SurfaceIntegrator to have it read as pbrt-v3's"));
            }
            "metal" | "conductor" => Material::Conductor(conductor(p, &mut self.warnings)?),
            "mix" => self.mixture(p)?,
            _ => {
                let kinds = "matte, diffuse, coateddiffuse, mirror, glass, dielectric, metal, conductor, mix";
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
        Ok(Material::Mixture(Arc::new([part(first, 1.0 - amount)?, part(second, amount)?])))
    }
}

/// A Lambertian surface under a smooth coat, whose light between coat and base is summed exactly. pbrt follows it at random,
/// through a coat that may be rough and that absorbs.
fn coated_diffuse(p: &Params, warnings: &mut Vec<String>) -> Result<Material> {
    let albedo = p.rgb("reflectance", &FRACTION)?.unwrap_or(GREY);
    let eta = p.float("eta", &DIELECTRIC_INDEX)?.unwrap_or(1.5) as f32;
    if p.rgb("albedo", &FRACTION)?.is_some_and(|albedo| albedo != Rgb::ZERO) {
        let message = format!("{}: a coat that scatters light is not supported", p.owner);
        return Err(p.place("albedo").unsupported(message));
    }
    if roughness(p, 0.0, f64::sqrt)? != [0.0; 2] {
        let place = ["uroughness", "vroughness", "roughness"].into_iter().find(|&name| p.has_type(name, "float"));
        let message = format!("{}: the coat is taken as smooth", p.owner);
        warnings.push(p.place(place.unwrap_or_default()).warning(&message));
    }
    // pbrt's medium has an extinction coefficient of 1.
    let thickness = p.float("thickness", &LENGTH)?.unwrap_or(0.01);
    if thickness > 0.0 {
        let share = 100.0 * (1.0 - (-2.0 * thickness).exp());
        let message =
            format!("{}: the coat's absorption is left out: {share:.2} % straight through it and back", p.owner);
        warnings.push(p.place("thickness").warning(&message));
    }
    // Settings of pbrt's random walk, without effect on its mean but for the longest paths.
    p.float("g", &ANY)?;
    p.integer("maxdepth", 0..=u32::MAX)?;
    p.integer("nsamples", 0..=u32::MAX)?;
    Ok(Material::CoatedDiffuse { albedo, eta })
}

/// A length that may be 0.
const LENGTH: Rule = Rule(|x| x >= 0.0, "not negative");

/// pbrt's `dielectric` and pbrt-v3's `glass`, whose index may have another name.
fn dielectric(p: &Params, index: Option<f64>, remapped: fn(f64) -> f64) -> Result<Dielectric> {
    let eta = p.float("eta", &DIELECTRIC_INDEX)?.or(index).unwrap_or(1.5) as f32;
    let (alpha, distribution) = (roughness(p, 0.0, remapped)?, distribution(p)?);
    Ok(Dielectric { alpha, distribution, ..Dielectric::clear(eta) })
}

/// α along u and v. Two roughnesses of 0 are a smooth surface, but for pbrt-v3's metal. Where only one α is below
/// [`SMOOTH_ALPHA`], it is raised to that, as in pbrt.
fn roughness(p: &Params, missing: f64, remapped: fn(f64) -> f64) -> Result<[f32; 2]> {
    let both = p.float("roughness", &FRACTION)?.unwrap_or(missing);
    let u = p.float("uroughness", &FRACTION)?.unwrap_or(both);
    let v = p.float("vroughness", &FRACTION)?.unwrap_or(both);
    let is_remapped = p.flag("remaproughness")?.unwrap_or(true);
    if [u, v] == [0.0; 2] && p.kind != "metal" {
        return Ok([0.0; 2]);
    }
    let alpha = [u, v].map(|roughness| if is_remapped { remapped(roughness) } else { roughness } as f32);
    let is_rough = alpha[0].max(alpha[1]) >= SMOOTH_ALPHA;
    Ok(if is_rough { alpha.map(|alpha| alpha.max(SMOOTH_ALPHA)) } else { alpha })
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

/// pbrt-v3's `metal` and pbrt-v4's `conductor`.
fn conductor(p: &Params, warnings: &mut Vec<String>) -> Result<Conductor> {
    let (eta, k) = match p.rgb("reflectance", &FRACTION)? {
        // With a reflectance, `eta` and `k` are parameters that are not known.
        Some(reflectance) => (Rgb::ONE, extinction(reflectance)),
        None => {
            (index(p, "eta", metals::COPPER.eta_rgb(), warnings)?, index(p, "k", metals::COPPER.k_rgb(), warnings)?)
        }
    };
    let alpha = if p.kind == "metal" { roughness(p, 0.01, remapped_v3)? } else { roughness(p, 0.0, f64::sqrt)? };
    Ok(Conductor { alpha, two_sided: true, ..Conductor::new(eta, k, 0.0, distribution(p)?) })
}

/// k of a conductor with η = 1 that reflects r = k²/(4 + k²) head-on, r at most 0.9999, as in pbrt-v4.
fn extinction(reflectance: Rgb) -> Rgb {
    Rgb::from_array(reflectance.min(Rgb::splat(0.9999)).to_array().map(|r| 2.0 * (r / (1.0 - r)).sqrt()))
}

/// What pbrt-v3 makes of a roughness from 0 to 1: a polynomial in its logarithm.
fn remapped_v3(roughness: f64) -> f64 {
    let x = roughness.max(1e-3).ln();
    1.62142 + x * (0.819_955 + x * (0.1734 + x * (0.017_120_1 + x * 0.000_640_711)))
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

    #[test]
    fn a_conductor_reflects_what_its_reflectance_says() {
        let wanted = Rgb::new(0.0, 0.5, 1.0);
        let (k, expected) = (extinction(wanted).to_array(), [0.0, 0.5, 0.9999]);
        for (k, r) in k.into_iter().zip(expected) {
            assert!((crate::optics::conductor::normal_reflectance(1.0, f64::from(k)) - r).abs() < 1e-6, "{k} {r}");
        }
    }

    #[test]
    fn the_third_versions_roughness_has_its_known_values() {
        // The polynomial at 1 is its constant; below 0.001 it stays.
        assert_eq!(remapped_v3(1.0), 1.62142);
        assert_eq!(remapped_v3(0.0), remapped_v3(1e-3));
        // 1.62142 − 0.819955·2.302585 + 0.1734·5.301898 − 0.0171201·12.20807 + 0.000640711·28.11012
        assert!((remapped_v3(0.1) - 0.461_760).abs() < 1e-6, "{}", remapped_v3(0.1));
        assert!((1..1000).all(|i| remapped_v3(f64::from(i) / 1e3) < remapped_v3(f64::from(i + 1) / 1e3)));
    }
}
