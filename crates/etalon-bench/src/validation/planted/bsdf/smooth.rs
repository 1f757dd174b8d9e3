//! Mistakes in Lambertian surfaces and smooth glass.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use etalon_core::optics::dielectric;
use etalon_stats::bsdf::{Bsdf, BsdfSample, DeltaLobe, Density, Direction, Energy, Properties, Spectrum};
use std::f64::consts::{FRAC_1_PI, TAU};

/// A Lambertian surface that is lit from above.
#[derive(Clone, Copy)]
pub struct Lambertian {
    pub albedo: f64,
}

/// A cosine-weighted direction around +z.
pub fn cosine(u: [f64; 2]) -> Direction {
    let (r, (sin, cos)) = (u[0].sqrt(), (TAU * u[1]).sin_cos());
    [r * cos, r * sin, (1.0 - u[0]).sqrt()]
}

impl Bsdf for Lambertian {
    fn properties(&self) -> Properties {
        Properties::default()
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [if wo[2] > 0.0 && wi[2] > 0.0 { self.albedo * FRAC_1_PI } else { 0.0 }; 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        if wo[2] > 0.0 { wi[2].max(0.0) * FRAC_1_PI } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let wi = cosine([u[1], u[2]]);
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, [self.albedo; 3], Density::Pdf(pdf)))
    }

    fn albedo(&self, wo: Direction) -> Option<Spectrum> {
        Some([if wo[2] > 0.0 { self.albedo } else { 0.0 }; 3])
    }
}

/// A smooth boundary of glass.
#[derive(Clone, Copy)]
pub struct Glass {
    pub index: f64,
}

impl Glass {
    pub fn eta(&self, wo: Direction) -> f64 {
        if wo[2] > 0.0 { self.index } else { 1.0 / self.index }
    }

    pub fn fresnel(&self, wo: Direction) -> f64 {
        dielectric::fresnel(wo[2].abs(), self.eta(wo)).unpolarized()
    }
}

impl Bsdf for Glass {
    fn properties(&self) -> Properties {
        let energy = Energy::Conserved(0.0);
        Properties { transmission: true, delta: true, eta: self.index, energy, ..Properties::default() }
    }

    fn eval(&self, _: Direction, _: Direction, _: &[f64]) -> Spectrum {
        [0.0; 3]
    }

    fn pdf(&self, _: Direction, _: Direction) -> f64 {
        0.0
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let lobes = self.delta_lobes(wo);
        let chosen = usize::from(u[0] >= lobes[0].probability);
        let DeltaLobe { wi, probability, throughput } = *lobes.get(chosen)?;
        let weight = throughput.map(|t| t / probability);
        Some(BsdfSample::new(wi, weight, Density::Delta(probability)).of_lobe(chosen, probability))
    }

    fn delta_lobes(&self, wo: Direction) -> Vec<DeltaLobe> {
        let ([x, y, z], eta, f) = (wo, self.eta(wo), self.fresnel(wo));
        let mut lobes = vec![DeltaLobe { wi: [-x, -y, z], probability: f, throughput: [f; 3] }];
        let sin = x.hypot(y) / eta;
        if f < 1.0 {
            let wi = [-x / eta, -y / eta, -(1.0 - sin * sin).sqrt().copysign(z)];
            lobes.push(DeltaLobe { wi, probability: 1.0 - f, throughput: [(1.0 - f) / (eta * eta); 3] });
        }
        lobes
    }

    fn lobes(&self) -> usize {
        2
    }

    fn lobe_pdf(&self, _: Direction, _: Direction, _: usize) -> Option<f64> {
        Some(0.0)
    }

    fn sample_adjoint(&self, wo: Direction, u: &[f64]) -> Option<Option<BsdfSample>> {
        let adjoint = |sample: BsdfSample| {
            let eta = if wo[2] * sample.wi[2] > 0.0 { 1.0 } else { self.eta(wo) };
            BsdfSample { weight: sample.weight.map(|w| w * eta * eta), ..sample }
        };
        Some(self.sample(wo, u).map(adjoint))
    }
}

fn refracted(wo: Direction, lobe: &DeltaLobe) -> bool {
    wo[2] * lobe.wi[2] < 0.0
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{Sample, Throughput, Value, ValueAndWeight, Weight};
    let paint = || Lambertian { albedo: 0.6 };
    let glass = || Glass { index: 1.5 };
    vec![
        planted(
            "whole/diffuse/pi-left-out",
            paint,
            &[40.0],
            ValueAndWeight(|m, o, i| m.eval(o, i, &[])[0] / FRAC_1_PI),
            "the albedo for the BSDF, without 1/π",
        ),
        planted(
            "whole/diffuse/weight-of-uniform-samples",
            paint,
            &[40.0],
            Weight(|m, _, s| 2.0 * m.albedo * s.wi[2]),
            "weights for uniform samples with cosine-weighted ones",
        ),
        planted(
            "whole/diffuse/light-from-below",
            paint,
            &[40.0],
            Value(|m, o, _| if o[2] > 0.0 { m.albedo * FRAC_1_PI } else { 0.0 }),
            "values for light from below, where nothing is sampled",
        ),
        planted(
            "whole/diffuse/samples-for-views-from-below",
            paint,
            &[120.0],
            Sample(|m, o, u| m.sample([o[0], o[1], -o[2]], u)),
            "samples that carry light to views from below, where values are 0",
        ),
        planted(
            "whole/glass/fresnel-not-in-the-choice",
            glass,
            &[60.0],
            Sample(|m, o, u| m.sample(o, &[(2.0 * (u[0] - 0.5)).max(0.0), u[1], u[2]])),
            "lobes chosen with other probabilities than their samples say",
        ),
        planted(
            "whole/glass/radiance-not-scaled",
            glass,
            &[30.0],
            Throughput(|m, o, lobe| lobe.throughput[0] * if refracted(o, lobe) { m.eta(o).powi(2) } else { 1.0 }),
            "1/η² of refracted radiance left out",
        ),
        planted(
            "whole/glass/schlick-of-the-wrong-side",
            glass,
            &[150.0],
            Throughput(|_, o, lobe| {
                let f = 0.04 + 0.96 * (1.0 - o[2].abs()).powi(5);
                if refracted(o, lobe) { lobe.throughput[0] } else { f }
            }),
            "Schlick's polynomial of the cosine inside the glass as what is reflected",
        ),
    ]
}
