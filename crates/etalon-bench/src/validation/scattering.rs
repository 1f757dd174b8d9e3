//! A BSDF of the renderer under the contract of the tests.

use super::suite::inputs::short;
use etalon_core::bsdf::{Bsdf, BsdfSample, Lobe, Scatter};
use etalon_core::math::Rgb;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx, Microfacet};
use etalon_stats::bsdf::{self, DeltaLobe, Density, Direction, Energy, Parameter, Properties, Reciprocity, Spectrum};
use glam::Vec3;

/// A BSDF with what its own methods do not say.
pub struct Scattering {
    pub bsdf: Bsdf,
    /// The index of refraction below the surface over that above it.
    pub eta: f32,
    /// Whether it conserves energy.
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
