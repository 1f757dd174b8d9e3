//! BSDFs of the renderer, and families of them, under the contract of the tests.

use super::suite::short;
use etalon_core::bsdf as core;
use etalon_core::bsdf::{Bsdf, BsdfSample, ConductorFresnel, ErrataConductor, Lobe, RoughConductor, Scatter};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx, Microfacet};
use etalon_stats::bsdf::{self, DeltaLobe, Density, Direction, Energy, Parameter, Properties, Reciprocity, Spectrum};
use glam::Vec3;

/// A BSDF with what its own methods do not say.
pub struct Scattering {
    pub bsdf: Bsdf,
    /// The index of refraction below the surface over that above it.
    pub eta: f32,
    pub energy: Energy,
    /// Whether its lobes are wide enough for derivatives of directions in single precision.
    pub is_wide: bool,
    pub parameters: Vec<Parameter>,
}

/// Lobes at least as wide have directions whose derivatives single precision resolves.
const WIDE: f32 = 0.025;

fn vec3(w: Direction) -> Vec3 {
    Vec3::from_array(w.map(|x| x as f32))
}

fn spectrum(rgb: Rgb) -> Spectrum {
    rgb.to_array().map(f64::from)
}

/// The distribution of a BSDF's microfacets, and its widths along x and y.
pub fn microfacets(bsdf: &Bsdf) -> Option<(Distribution, [f32; 2])> {
    let beckmann = |facets: &Beckmann<f32>| Some((Distribution::Beckmann, facets.widths().both()));
    let ggx = |facets: &Ggx<f32>| Some((Distribution::Ggx, facets.widths().both()));
    match bsdf {
        Bsdf::Beckmann(metal) => beckmann(&metal.distribution),
        Bsdf::Ggx(metal) => ggx(&metal.distribution),
        Bsdf::CompensatedBeckmann(metal) => beckmann(&metal.single().distribution),
        Bsdf::CompensatedGgx(metal) => ggx(&metal.single().distribution),
        Bsdf::ErrataConductor(metal) => beckmann(&metal.distribution),
        Bsdf::BeckmannDielectric(glass) => beckmann(&glass.distribution),
        Bsdf::GgxDielectric(glass) => ggx(&glass.distribution),
        _ => None,
    }
}

impl Scattering {
    /// A BSDF without named parameters.
    pub fn new(bsdf: Bsdf, energy: Energy) -> Self {
        let eta = match &bsdf {
            Bsdf::Refraction(boundary) => boundary.eta,
            Bsdf::Dielectric(boundary) => boundary.eta,
            Bsdf::BeckmannDielectric(boundary) => boundary.eta(),
            Bsdf::GgxDielectric(boundary) => boundary.eta(),
            _ => 1.0,
        };
        let is_wide = microfacets(&bsdf).is_none_or(|(_, alpha)| {
            // Refraction turns directions by the index minus 1 of what the facets are turned.
            let turned = if eta == 1.0 { 1.0 } else { (eta - 1.0).abs() };
            alpha[0].min(alpha[1]) * turned >= WIDE
        });
        Self { bsdf, eta, energy, is_wide, parameters: Vec::new() }
    }

    fn lobe_index(&self, lobe: Lobe) -> usize {
        self.bsdf.lobes().iter().position(|&other| other == lobe).unwrap_or(usize::MAX)
    }

    /// The lobes whose directions are on the same side of the surface, relative to `wo`, and are no delta distributions.
    fn spread_on_side(&self, transmission: bool) -> usize {
        let lobes = self.bsdf.lobes().iter();
        lobes.filter(|lobe| !lobe.is_delta() && lobe.is_transmission() == transmission).count()
    }

    fn sample_of(&self, sample: BsdfSample) -> bsdf::BsdfSample {
        let BsdfSample { wi, weight, pdf, lobe, probability, .. } = sample;
        let (pdf, probability) = (f64::from(pdf), f64::from(probability));
        let density = if lobe.is_delta() { Density::Delta(probability) } else { Density::Pdf(pdf) };
        bsdf::BsdfSample::new(wi.to_array().map(f64::from), spectrum(weight), density)
            .of_lobe(self.lobe_index(lobe), probability)
    }
}

impl bsdf::Bsdf for Scattering {
    fn properties(&self) -> Properties {
        let lobes = self.bsdf.lobes();
        Properties {
            channels: 3,
            reflection: lobes.iter().any(|lobe| !lobe.is_transmission()),
            transmission: lobes.iter().any(|lobe| lobe.is_transmission()),
            delta: lobes.iter().any(|lobe| lobe.is_delta()),
            eta: f64::from(self.eta),
            reciprocity: if self.bsdf.is_reciprocal() {
                Reciprocity::Reciprocal
            } else {
                Reciprocity::Not("the BSDF says so")
            },
            energy: self.energy,
            narrow: !self.is_wide,
            largest_weight: self.bsdf.largest_weight().map(f64::from),
            precision: f64::from(f32::EPSILON),
            parameters: self.parameters.clone(),
            ..Properties::default()
        }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        spectrum(self.bsdf.eval(vec3(wo), vec3(wi)))
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        f64::from(self.bsdf.pdf(vec3(wo), vec3(wi)))
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<bsdf::BsdfSample> {
        self.bsdf.sample(vec3(wo), short(u[0]), [short(u[1]), short(u[2])]).map(|sample| self.sample_of(sample))
    }

    /// Found by sampling with random numbers that choose every lobe, also one of small probability.
    fn delta_lobes(&self, wo: Direction) -> Vec<DeltaLobe> {
        let mut found: Vec<DeltaLobe> = Vec::new();
        if self.bsdf.lobes().iter().all(|lobe| !lobe.is_delta()) {
            return found;
        }
        let powers = (1..=24).map(|k| 0.5f32.powi(k)).flat_map(|x| [x, 1.0 - x]);
        for uc in [0.0].into_iter().chain(powers).chain((0..64).map(|i| i as f32 / 64.0)) {
            let Some(sample) = self.bsdf.sample(vec3(wo), uc, [0.5; 2]).filter(BsdfSample::is_delta) else { continue };
            let wi = sample.wi.to_array().map(f64::from);
            if found.iter().all(|lobe| lobe.wi != wi) {
                let probability = f64::from(sample.probability);
                let throughput = spectrum(sample.weight).map(|weight| weight * probability);
                found.push(DeltaLobe { wi, probability, throughput });
            }
        }
        found
    }

    fn lobes(&self) -> usize {
        self.bsdf.lobes().len()
    }

    /// Known where a side of the surface has one lobe.
    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        let lobe = *self.bsdf.lobes().get(lobe)?;
        let transmitted = wo[2] * wi[2] < 0.0;
        match self.spread_on_side(transmitted) {
            0 => Some(0.0),
            1 if lobe.is_delta() || lobe.is_transmission() != transmitted => Some(0.0),
            1 => Some(self.pdf(wo, wi)),
            _ => None,
        }
    }

    fn eval_adjoint(&self, wo: Direction, wi: Direction) -> Option<Spectrum> {
        Some(spectrum(self.bsdf.eval_adjoint(vec3(wo), vec3(wi))))
    }

    fn sample_adjoint(&self, wo: Direction, u: &[f64]) -> Option<Option<bsdf::BsdfSample>> {
        let sample = || self.bsdf.sample_adjoint(vec3(wo), short(u[0]), [short(u[1]), short(u[2])]);
        self.bsdf.is_reciprocal().then(|| sample().map(|sample| self.sample_of(sample)))
    }
}

pub struct Family(&'static core::Family);

pub struct Facets {
    pub distribution: Distribution,
    /// Its widths along x and y.
    pub alpha: [f64; 2],
    /// The same surface with a Fresnel reflectance of 1, if it is a metal of single scattering.
    pub lossless: Option<Scattering>,
}

impl Family {
    pub fn bsdf(&self, values: &[f64]) -> Bsdf {
        self.0.with(values)
    }

    /// The microfacets of the BSDF with these parameters, if it is a rough metal or dielectric.
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
    values_of(family.name(), &family.parameters(), chosen)
}

/// The same of parameters of what is called `whose`.
///
/// # Errors
/// As [`values`].
pub fn values_of(whose: &str, parameters: &[Parameter], chosen: &[(String, f64)]) -> Result<Vec<f64>> {
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
    for (name, value) in chosen {
        let at = position(whose, parameters, "set", name)?;
        let [from, to] = parameters[at].range;
        if !(from..=to).contains(value) {
            return Err(Error::parameter("set", format!("{name} = {value} is not from {from} to {to}")));
        }
        values[at] = *value;
    }
    Ok(values)
}

/// The number of a parameter of `whose`, which `argument` names.
///
/// # Errors
/// [`Error::Parameter`] if there is no such parameter.
pub fn position(whose: &str, parameters: &[Parameter], argument: &'static str, name: &str) -> Result<usize> {
    let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    names.iter().position(|known| *known == name).ok_or_else(|| {
        let hint =
            if names.is_empty() { "it has none".to_owned() } else { format!("its parameters: {}", names.join(", ")) };
        Error::parameter(argument, format!("{whose} has no parameter \"{name}\"")).with_hint(hint)
    })
}

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
