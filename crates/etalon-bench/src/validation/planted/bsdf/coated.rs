//! Mistakes in a smooth dielectric coating over a Lambertian base.
//!
//! f = (1 − F(θₒ)) (1 − F(θᵢ)) ρ / (π η² (1 − ρ F̄_in)) with the mean reflectance F̄_in from inside, and a mirror of share F(θₒ).

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::smooth::cosine;
use etalon_core::optics::dielectric;
use etalon_stats::bsdf::{Bsdf, BsdfSample, DeltaLobe, Density, Direction, Energy, Properties, Spectrum};
use std::f64::consts::FRAC_1_PI;

const ETA: f64 = 1.5;

fn fresnel(cos: f64, eta: f64) -> f64 {
    dielectric::fresnel(cos, eta).unpolarized()
}

/// The coating, over a base that absorbs nothing.
#[derive(Clone, Copy)]
pub struct Coated {
    /// The mean of F over diffuse light from inside.
    internal: f64,
}

impl Coated {
    fn new() -> Self {
        const POINTS: u32 = 1 << 14;
        let sum: f64 = (0..POINTS).map(|i| fresnel(((f64::from(i) + 0.5) / f64::from(POINTS)).sqrt(), 1.0 / ETA)).sum();
        Self { internal: sum / f64::from(POINTS) }
    }

    fn value(&self, wo: Direction, wi: Direction, internal: f64) -> f64 {
        let pass = |w: Direction| 1.0 - fresnel(w[2], ETA);
        let above = wo[2] > 0.0 && wi[2] > 0.0;
        if above { pass(wo) * pass(wi) * FRAC_1_PI / (ETA * ETA * (1.0 - internal)) } else { 0.0 }
    }
}

impl Bsdf for Coated {
    fn properties(&self) -> Properties {
        Properties { delta: true, energy: Energy::Conserved(1e-4), ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [self.value(wo, wi, self.internal); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        if wo[2] > 0.0 { (1.0 - fresnel(wo[2], ETA)) * wi[2].max(0.0) * FRAC_1_PI } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let coat = *self.delta_lobes(wo).first()?;
        if u[0] < coat.probability {
            return Some(
                BsdfSample::new(coat.wi, [1.0; 3], Density::Delta(coat.probability)).of_lobe(0, coat.probability),
            );
        }
        let wi = cosine([u[1], u[2]]);
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi, &[])[0] * wi[2] / pdf;
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)).of_lobe(1, 1.0 - coat.probability))
    }

    fn delta_lobes(&self, wo: Direction) -> Vec<DeltaLobe> {
        let ([x, y, z], f) = (wo, fresnel(wo[2].abs(), ETA));
        let coat = DeltaLobe { wi: [-x, -y, z], probability: f, throughput: [f; 3] };
        if z > 0.0 { vec![coat] } else { Vec::new() }
    }

    fn lobes(&self) -> usize {
        2
    }

    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        Some(if lobe == 1 { self.pdf(wo, wi) } else { 0.0 })
    }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{Pdf, ValueAndWeight};
    let fault = |name, change, mistake| planted(name, Coated::new, &[30.0, 80.0], change, mistake);
    vec![
        fault(
            "whole/coated/no-internal-reflection",
            ValueAndWeight(|m, o, i| m.value(o, i, 0.0)),
            "light reflected back to the base by the coating is lost",
        ),
        fault(
            "whole/coated/radiance-not-scaled",
            ValueAndWeight(|m, o, i| ETA * ETA * m.eval(o, i, &[])[0]),
            "1/η² left out: more light than arrives",
        ),
        fault(
            "whole/coated/entering-alone",
            ValueAndWeight(
                |m, o, i| if o[2] > 0.0 { m.value([o[0], o[1], i[2].max(0.0)], i, m.internal) } else { 0.0 },
            ),
            "the transmittance at θᵢ for both directions",
        ),
        fault(
            "whole/coated/pdf-without-the-choice",
            Pdf(|m, o, i| m.pdf(o, i) / (1.0 - fresnel(o[2], ETA))),
            "the pdf of the base without the probability of not choosing the coating",
        ),
    ]
}
