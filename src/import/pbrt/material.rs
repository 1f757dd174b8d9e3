//! Materials: diffuse surfaces, mirrors, smooth glass and metals.

use super::params::Params;
use super::reader::{GREY, Reader};
use crate::error::{Error, Result};
use crate::import::place::quote;
use crate::import::rule::{DIELECTRIC_INDEX, FRACTION, Rule};
use crate::math::Rgb;
use crate::optics::metals;
use crate::scene::{Conductor, Dielectric, Distribution, Material};

impl Reader<'_> {
    pub(super) fn material(&mut self, p: &Params) -> Result<Material> {
        let reflectance = |name, missing| Ok::<_, Error>(p.rgb(name, &FRACTION)?.unwrap_or(missing));
        let material = match p.kind.as_str() {
            "matte" => {
                p.only_float("sigma", |x| x == 0.0, "0 (Lambert's law)")?;
                Material::Diffuse { albedo: reflectance("Kd", GREY)? }
            }
            "diffuse" => Material::Diffuse { albedo: reflectance("reflectance", GREY)? },
            "mirror" => Material::Mirror { reflectance: reflectance("Kr", Rgb::splat(0.9))? },
            "glass" => {
                let (reflectance, transmittance) = (reflectance("Kr", Rgb::ONE)?, reflectance("Kt", Rgb::ONE)?);
                let index = p.float("index", &DIELECTRIC_INDEX)?;
                let eta = glass_index(p)?.or(index).unwrap_or(1.5) as f32;
                Material::Dielectric(Dielectric { reflectance, transmittance, ..Dielectric::clear(eta) })
            }
            "dielectric" => {
                let eta = glass_index(p)?.unwrap_or(1.5) as f32;
                Material::Dielectric(Dielectric::clear(eta))
            }
            "metal" if self.setup.v2 => {
                return Err(p
                    .at
                    .unsupported("Material \"metal\" of pbrt-v2 is not supported: its microfacets are Blinn's")
                    .with_hint("write Integrator in place of SurfaceIntegrator to have it read as pbrt-v3's"));
            }
            "metal" | "conductor" => Material::Conductor(conductor(p, &mut self.warnings)?),
            _ => return Err(p.unsupported_kind("matte, diffuse, mirror, glass, dielectric, metal, conductor")),
        };
        // Where nothing is rough, there is nothing to remap.
        p.finish(&["remaproughness"], &mut self.warnings)?;
        Ok(material)
    }
}

/// The index of refraction of a dielectric, whose surface must be smooth.
fn glass_index(p: &Params) -> Result<Option<f64>> {
    for name in ["roughness", "uroughness", "vroughness"] {
        p.only_float(name, |x| x == 0.0, "0 (smooth)")?;
    }
    p.float("eta", &DIELECTRIC_INDEX)
}

/// pbrt-v3's `metal` and pbrt-v4's `conductor`. Their microfacets are GGX's (Trowbridge and Reitz); `"string
/// distribution" "beckmann"` is this program's own addition.
fn conductor(p: &Params, warnings: &mut Vec<String>) -> Result<Conductor> {
    let eta = index_spectrum(p, "eta", metals::Metal::eta_rgb, warnings)?;
    let k = index_spectrum(p, "k", metals::Metal::k_rgb, warnings)?;
    let v3 = p.kind == "metal";
    let both = p.float("roughness", &FRACTION)?.unwrap_or(if v3 { 0.01 } else { 0.0 });
    let u = p.float("uroughness", &FRACTION)?.unwrap_or(both);
    let v = p.float("vroughness", &FRACTION)?.unwrap_or(both);
    if u != v {
        let message = format!("{}: roughnesses that differ are not supported: {u} and {v}", p.owner);
        return Err(p.place("vroughness").unsupported(message));
    }
    let alpha = match p.flag("remaproughness")? {
        Some(false) => u,
        _ if v3 => remapped_v3(u),
        _ => u.sqrt(),
    };
    let distribution = match p.text("distribution")? {
        None | Some("ggx") => Distribution::Ggx,
        Some("beckmann") => Distribution::Beckmann,
        Some(other) => {
            let message = format!("the distribution {} is not \"beckmann\" or \"ggx\"", quote(other));
            return Err(p.place("distribution").unsupported(message));
        }
    };
    Ok(Conductor { two_sided: true, ..Conductor::new(eta, k, alpha as f32, distribution) })
}

/// What pbrt-v3 makes of a roughness from 0 to 1: a polynomial in its logarithm.
fn remapped_v3(roughness: f64) -> f64 {
    let x = roughness.max(1e-3).ln();
    1.62142 + x * (0.819_955 + x * (0.1734 + x * (0.017_120_1 + x * 0.000_640_711)))
}

/// `eta` or `k`: three numbers, or a metal's spectrum by name, like `metal-Au-eta`. Without it: copper's, as in pbrt.
fn index_spectrum(
    p: &Params,
    name: &'static str,
    of: impl Fn(&metals::Metal) -> Rgb,
    warnings: &mut Vec<String>,
) -> Result<Rgb> {
    const INDEX: Rule = Rule(|x| (0.0..=1000.0).contains(&x), "from 0 to 1000");
    let (at, spectrum) = (p.place(name), p.spectrum(name)?);
    if spectrum.is_none()
        && let Some(rgb) = p.rgb(name, &INDEX)?
    {
        return Ok(rgb);
    }
    let spectrum = spectrum.map_or_else(|| format!("metal-Cu-{name}"), str::to_owned);
    let symbol = spectrum.strip_prefix("metal-").and_then(|rest| rest.strip_suffix(name)?.strip_suffix('-'));
    let metal = symbol.and_then(|symbol| metals::METALS.iter().find(|metal| metal.symbol == symbol));
    let Some(metal) = metal else {
        let known: Vec<String> = metals::METALS.iter().map(|m| format!("metal-{}-{name}", m.symbol)).collect();
        return Err(at
            .unsupported(format!("{}: the spectrum {} is not known", p.owner, quote(&spectrum)))
            .with_hint(format!("give it as rgb, or as one of {}", known.join(", "))));
    };
    let [r, g, b] = metals::WAVELENGTHS_NM;
    warnings.push(at.warning(&format!("{}: {name} is {}'s at {r}, {g} and {b} nm", p.owner, metal.name)));
    Ok(of(metal))
}

#[cfg(test)]
mod tests {
    use super::*;

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
