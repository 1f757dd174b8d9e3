//! Families of BSDFs: every BSDF of the registry over its parameters.

use super::scattering::Scattering;
use etalon_core::bsdf::{Bsdf, NormalSampling};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::scene::{Conductor, Dielectric, Distribution, Material, SMOOTH_ALPHA, ScatterModel};
use etalon_stats::bsdf::{self, Energy, Parameter};

/// One family: a name, parameters, and what material they make.
pub struct Family {
    name: &'static str,
    /// Name, default value and range.
    parameters: &'static [(&'static str, f64, [f64; 2])],
    material: fn(&[f32]) -> Material,
    model: ScatterModel,
    energy: Energy,
}

/// The microfacets of a BSDF.
pub struct Facets {
    /// The distribution of their normals.
    pub distribution: Distribution,
    /// Its widths along x and y.
    pub alpha: [f64; 2],
    /// The same surface with a Fresnel reflectance of 1, if it is a metal of single scattering.
    pub lossless: Option<Scattering>,
}

impl Family {
    fn material(&self, values: &[f64]) -> Material {
        (self.material)(&values.iter().map(|&value| value as f32).collect::<Vec<f32>>())
    }

    /// The BSDF with these values of the parameters.
    #[must_use]
    pub fn bsdf(&self, values: &[f64]) -> Bsdf {
        self.material(values).bsdf(self.model)
    }

    /// The microfacets of the BSDF with these parameters, if it is a rough metal or dielectric.
    #[must_use]
    pub fn facets(&self, values: &[f64]) -> Option<Facets> {
        let wide = |alpha: [f32; 2]| alpha.map(f64::from);
        match self.material(values) {
            Material::Conductor(metal) if metal.alpha[0].min(metal.alpha[1]) >= SMOOTH_ALPHA => {
                let lossless = Material::Conductor(Conductor { eta: Rgb::ZERO, k: Rgb::ONE, ..metal });
                let lossless =
                    (!metal.multiple_scattering).then(|| Scattering::new(&lossless, self.model, self.energy));
                Some(Facets { distribution: metal.distribution, alpha: wide(metal.alpha), lossless })
            }
            Material::Dielectric(glass) if !glass.is_smooth() => {
                Some(Facets { distribution: glass.distribution, alpha: wide(glass.alpha), lossless: None })
            }
            _ => None,
        }
    }
}

impl bsdf::Family for Family {
    fn name(&self) -> &str {
        self.name
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.parameters.iter().map(|&(name, value, range)| Parameter::new(name, value, range)).collect()
    }

    fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn bsdf::BatchBsdf + '_>> {
        let scattering = Scattering::new(&self.material(values), self.model, self.energy);
        let valued = |(parameter, &value): (Parameter, &f64)| Parameter { value, ..parameter };
        let parameters = bsdf::Family::parameters(self).into_iter().zip(values).map(valued).collect();
        Ok(Box::new(Scattering { parameters, ..scattering }))
    }
}

type Declared = (&'static str, f64, [f64; 2]);

const SHARE: [f64; 2] = [0.0, 1.0];
const ALPHA: Declared = ("alpha", 0.3, [1e-4, 1.0]);
const ALPHAS: [Declared; 2] = [("alpha_x", 0.3, [1e-4, 1.0]), ("alpha_y", 0.3, [1e-4, 1.0])];
const METAL: [Declared; 2] = [("eta", 0.5, [0.1, 4.0]), ("k", 2.5, [0.0, 10.0])];
const GLASS: Declared = ("eta", 1.5, [1.0 / 2.4, 2.4]);
const ALBEDO: Declared = ("albedo", 0.8, SHARE);

fn conductor(v: &[f32], distribution: Distribution, multiple_scattering: bool) -> Material {
    let (eta, k) = (Rgb::splat(v[2]), Rgb::splat(v[3]));
    let alpha = [v[0], v[1]];
    Material::Conductor(Conductor { eta, k, alpha, distribution, two_sided: false, multiple_scattering })
}

fn isotropic(v: &[f32]) -> [f32; 4] {
    [v[0], v[0], v[1], v[2]]
}

fn glass(v: &[f32], distribution: Distribution) -> Material {
    Material::Dielectric(Dielectric { alpha: [v[0], v[1]], distribution, ..Dielectric::clear(v[2]) })
}

/// The default values of a family's parameters, with those of `chosen` in their place.
///
/// # Errors
/// [`Error::Parameter`] for a name that is unknown and a value that is out of its range.
pub fn values(family: &dyn bsdf::Family, chosen: &[(String, f64)]) -> Result<Vec<f64>> {
    let parameters = family.parameters();
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
    for (name, value) in chosen {
        let at = position(family, "set", name)?;
        let [from, to] = parameters[at].range;
        if !(from..=to).contains(value) {
            return Err(Error::parameter("set", format!("{name} = {value} is not from {from} to {to}")));
        }
        values[at] = *value;
    }
    Ok(values)
}

/// The number of a family's parameter, which `argument` names.
///
/// # Errors
/// [`Error::Parameter`] if there is no such parameter.
pub fn position(family: &dyn bsdf::Family, argument: &'static str, name: &str) -> Result<usize> {
    let parameters = family.parameters();
    let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    names.iter().position(|known| *known == name).ok_or_else(|| {
        let hint =
            if names.is_empty() { "it has none".to_owned() } else { format!("its parameters: {}", names.join(", ")) };
        Error::parameter(argument, format!("{} has no parameter \"{name}\"", family.name())).with_hint(hint)
    })
}

/// The registry.
pub fn all() -> Vec<Family> {
    const ROUGH_METAL: &[Declared] = &[ALPHAS[0], ALPHAS[1], METAL[0], METAL[1]];
    const ISOTROPIC_METAL: &[Declared] = &[ALPHA, METAL[0], METAL[1]];
    const ROUGH_GLASS: &[Declared] = &[ALPHAS[0], ALPHAS[1], GLASS];
    let model = ScatterModel::default();
    let bounded = ScatterModel { normals: NormalSampling::Bounded, ..model };
    let ndf = ScatterModel { normals: NormalSampling::Ndf, ..model };
    let erroneous = ScatterModel::SECOND_REPORT;
    let family = |name, parameters, material| Family { name, parameters, material, model, energy: Energy::AtMostOne };
    let lossless = |family| Family { energy: Energy::Conserved(0.0), ..family };
    let mixture: fn(&[f32]) -> Material = |v| {
        let diffuse = Material::Diffuse { albedo: Rgb::splat(v[1]) };
        let metal = conductor(&[v[2], v[2], v[3], v[4]], Distribution::Ggx, false);
        Material::Mixture([(1.0 - v[0], diffuse), (v[0], metal)].into())
    };
    vec![
        family("diffuse", &[ALBEDO], |v| Material::Diffuse { albedo: Rgb::splat(v[0]) }),
        family("mirror", &[("reflectance", 0.9, SHARE)], |v| Material::Mirror { reflectance: Rgb::splat(v[0]) }),
        family("refraction", &[("transmittance", 0.8, SHARE), GLASS], |v| Material::Refraction {
            transmittance: Rgb::splat(v[0]),
            eta: v[1],
        }),
        lossless(family("dielectric", &[GLASS], |v| Material::Dielectric(Dielectric::clear(v[0])))),
        family("smooth-conductor", &METAL, |v| conductor(&[0.0, 0.0, v[0], v[1]], Distribution::Ggx, false)),
        family("beckmann", ROUGH_METAL, |v| conductor(v, Distribution::Beckmann, false)),
        family("ggx", ROUGH_METAL, |v| conductor(v, Distribution::Ggx, false)),
        Family { model: bounded, ..family("ggx-bounded", ROUGH_METAL, |v| conductor(v, Distribution::Ggx, false)) },
        Family { model: ndf, ..family("ggx-ndf", ROUGH_METAL, |v| conductor(v, Distribution::Ggx, false)) },
        family("beckmann-dielectric", ROUGH_GLASS, |v| glass(v, Distribution::Beckmann)),
        family("ggx-dielectric", ROUGH_GLASS, |v| glass(v, Distribution::Ggx)),
        family("compensated-beckmann", ISOTROPIC_METAL, |v| conductor(&isotropic(v), Distribution::Beckmann, true)),
        family("compensated-ggx", ISOTROPIC_METAL, |v| conductor(&isotropic(v), Distribution::Ggx, true)),
        family("coated-diffuse", &[ALBEDO, ("eta", 1.5, [1.0, 2.4])], |v| Material::CoatedDiffuse {
            albedo: Rgb::splat(v[0]),
            eta: v[1],
        }),
        family("mixture", &[("share", 0.5, SHARE), ALBEDO, ALPHA, METAL[0], METAL[1]], mixture),
        Family {
            model: erroneous,
            energy: Energy::MayExceedOne("the report's shadowing term does"),
            ..family("errata-conductor", ISOTROPIC_METAL, |v| conductor(&isotropic(v), Distribution::Beckmann, false))
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::bsdf::ALL;
    use etalon_stats::bsdf::Family as _;

    #[test]
    fn every_bsdf_of_the_registry_is_a_family_of_its_name() {
        let families = all();
        for (name, _) in ALL {
            assert!(families.iter().any(|family| family.name() == *name), "{name} has no family");
        }
        for family in &families {
            let values: Vec<f64> = family.parameters().iter().map(|parameter| parameter.value).collect();
            let bsdf = family.with(&values).unwrap();
            assert_eq!(bsdf.properties().parameters, family.parameters(), "{}", family.name());
        }
    }

    #[test]
    fn ranges_are_reached_at_both_ends() {
        let alpha = Parameter::new("alpha", 0.3, [1e-4, 1.0]);
        assert_eq!([alpha.at(0.0), alpha.at(1.0)], [1e-4, 1.0]);
        assert!((alpha.at(0.5) - 0.01).abs() < 1e-12, "logarithmic");
        assert_eq!(Parameter::new("albedo", 0.5, [0.0, 1.0]).at(0.25), 0.25);
    }

    #[test]
    fn values_are_chosen_by_name() {
        let all = all();
        let glass = all.iter().find(|family| family.name() == "dielectric").unwrap();
        let chosen = |name: &str, value| values(glass, &[(name.to_owned(), value)]);
        assert_eq!((values(glass, &[]).unwrap(), chosen("eta", 2.0).unwrap()), (vec![1.5], vec![2.0]));
        assert!(chosen("alpha", 2.0).unwrap_err().hint().unwrap().contains("eta"));
        assert!(chosen("eta", 4.0).unwrap_err().to_string().contains("is not from"));
        assert!(chosen("eta", f64::NAN).is_err());
    }
}
