//! Families of BSDFs under the contract of the tests.

use super::scattering::{Scattering, microfacets};
use etalon_core::bsdf::{self as core, Bsdf, ConductorFresnel, ErrataConductor, RoughConductor};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::optics::microfacet::Distribution;
use etalon_stats::bsdf::{self, Parameter};

/// One family.
pub struct Family(&'static core::Family);

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
    /// The BSDF with these values of the parameters.
    #[must_use]
    pub fn bsdf(&self, values: &[f64]) -> Bsdf {
        self.0.with(values)
    }

    /// The microfacets of the BSDF with these parameters, if it is a rough metal or dielectric.
    #[must_use]
    pub fn facets(&self, values: &[f64]) -> Option<Facets> {
        let bsdf = self.bsdf(values);
        let (distribution, alpha) = microfacets(&bsdf)?;
        let fresnel = ConductorFresnel::new(Rgb::ZERO, Rgb::ONE);
        let lossless = match bsdf {
            Bsdf::Beckmann(metal) => Some(Bsdf::Beckmann(RoughConductor { fresnel, ..metal })),
            Bsdf::Ggx(metal) => Some(Bsdf::Ggx(RoughConductor { fresnel, ..metal })),
            Bsdf::ErrataConductor(metal) => Some(Bsdf::ErrataConductor(ErrataConductor { fresnel, ..metal })),
            _ => None,
        };
        let lossless = lossless.map(|bsdf| Scattering::new(bsdf, self.0.energy));
        Some(Facets { distribution, alpha: alpha.map(f64::from), lossless })
    }
}

impl bsdf::Family for Family {
    fn name(&self) -> &str {
        self.0.name
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters.iter().map(|&(name, value, range)| Parameter::new(name, value, range)).collect()
    }

    fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn bsdf::BatchBsdf + '_>> {
        let valued = |(parameter, &value): (Parameter, &f64)| Parameter { value, ..parameter };
        let parameters = self.parameters().into_iter().zip(values).map(valued).collect();
        Ok(Box::new(Scattering { parameters, ..Scattering::new(self.bsdf(values), self.0.energy) }))
    }
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

/// All families.
pub fn all() -> Vec<Family> {
    core::families().map(Family).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_stats::bsdf::Family as _;

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
