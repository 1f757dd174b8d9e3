//! Mistakes in mixtures of lobes: a diffuse one and a rough conductor.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::rough::{Facets, Rough};
use super::smooth::Lambertian;
use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, Properties, Spectrum};

/// Two lobes, each with half of the light, chosen with probabilities of 0.3 and 0.7.
#[derive(Clone, Copy)]
pub struct Mixture {
    pub diffuse: Lambertian,
    pub glossy: Rough,
    pub probability: f64,
}

impl Mixture {
    fn lobe(&self, lobe: usize) -> (&dyn Bsdf, f64) {
        if lobe == 0 { (&self.diffuse, self.probability) } else { (&self.glossy, 1.0 - self.probability) }
    }

    fn chosen(&self, u: &[f64]) -> usize {
        usize::from(u[0] >= self.probability)
    }
}

impl Bsdf for Mixture {
    fn properties(&self) -> Properties {
        Properties::default()
    }

    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum {
        [0.5 * (self.diffuse.eval(wo, wi, u)[0] + self.glossy.eval(wo, wi, u)[0]); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        let of = |lobe: usize| self.lobe(lobe).1 * self.lobe(lobe).0.pdf(wo, wi);
        of(0) + of(1)
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let lobe = self.chosen(u);
        let wi = self.lobe(lobe).0.sample(wo, u)?.wi;
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi, &[])[0] * wi[2] / pdf;
        Some(BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)).of_lobe(lobe, self.lobe(lobe).1))
    }

    fn lobes(&self) -> usize {
        2
    }

    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        let (bsdf, probability) = self.lobe(lobe);
        Some(probability * bsdf.pdf(wo, wi))
    }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{LobePdf, PdfAndWeight, Sample, ValueAndWeight, Weight};
    let mixture = || Mixture {
        diffuse: Lambertian { albedo: 0.8 },
        glossy: Rough { alpha: [0.2; 2], facets: Facets::Conductor(0.9) },
        probability: 0.3,
    };
    let fault = |name, change, mistake| planted(name, mixture, &[50.0], change, mistake);
    vec![
        fault(
            "whole/mixture/pdf-without-probabilities",
            PdfAndWeight(|m, o, i| m.diffuse.pdf(o, i) + m.glossy.pdf(o, i)),
            "pdfs of the lobes added without the probabilities of choosing them",
        ),
        fault(
            "whole/mixture/pdf-of-equal-probabilities",
            PdfAndWeight(|m, o, i| 0.5 * (m.diffuse.pdf(o, i) + m.glossy.pdf(o, i))),
            "the pdf of lobes chosen with probability ½, which are chosen with 0.3 and 0.7",
        ),
        fault(
            "whole/mixture/weight-of-the-chosen-lobe",
            Weight(|m, o, s| {
                let (bsdf, probability) = m.lobe(s.lobe);
                m.eval(o, s.wi, &[])[0] * s.wi[2] / (probability * bsdf.pdf(o, s.wi))
            }),
            "f of all lobes over the pdf of the chosen one: light counted for every lobe",
        ),
        fault(
            "whole/mixture/lobe-probability-missing-in-weight",
            Weight(|m, o, s| 0.5 * m.lobe(s.lobe).0.eval(o, s.wi, &[])[0] * s.wi[2] / m.lobe(s.lobe).0.pdf(o, s.wi)),
            "the chosen lobe's weight, not divided by the probability of choosing it",
        ),
        fault(
            "whole/mixture/random-number-reused",
            Sample(|m, o, u| m.sample(o, &[u[0], u[0], u[2]])),
            "the random number that chooses the lobe is used again for the direction",
        ),
        fault(
            "whole/mixture/mis-weights-of-equal-lobes",
            LobePdf(|m, o, i, lobe| 0.5 * m.lobe(lobe).0.pdf(o, i)),
            "pdfs of the lobes for MIS with other probabilities than in sampling",
        ),
        fault(
            "whole/mixture/lobes-not-weighted",
            ValueAndWeight(|m, o, i| 2.0 * m.eval(o, i, &[])[0]),
            "the lobes added without their weights: more light than arrives",
        ),
    ]
}
