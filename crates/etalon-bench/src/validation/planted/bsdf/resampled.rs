//! Mistakes where nobody knows the pdf: directions chosen among candidates, and values that are random numbers.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::rough::{Facets, Rough};
use super::smooth::{Lambertian, cosine};
use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, PdfKind, Properties, Spectrum};

/// A rough conductor, sampled by choosing one of two cosine-weighted candidates in proportion to what they contribute.
///
/// Source: Talbot, Cline and Egbert, "Importance Resampling for Global Illumination", EGSR 2005.
#[derive(Clone, Copy)]
pub struct Resampled(Rough);

impl Resampled {
    /// Two candidates, the contribution of each, and which is chosen.
    fn candidates(&self, wo: Direction, u: &[f64]) -> ([Direction; 2], [f64; 2], usize) {
        let wi = [cosine([u[1], u[2]]), cosine([u[3], u[4]])];
        let contributions = wi.map(|wi| self.0.eval(wo, wi, &[])[0] * std::f64::consts::PI);
        let first = contributions[0] / (contributions[0] + contributions[1]).max(f64::MIN_POSITIVE);
        (wi, contributions, usize::from(u[0] >= first))
    }
}

impl Bsdf for Resampled {
    fn properties(&self) -> Properties {
        Properties { pdf: PdfKind::None, dimension: 5, map: None, ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum {
        self.0.eval(wo, wi, u)
    }

    fn pdf(&self, _: Direction, _: Direction) -> f64 {
        0.0
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let (wi, [a, b], chosen) = self.candidates(wo, u);
        let weight = 0.5 * (a + b);
        (weight > 0.0).then(|| BsdfSample::new(wi[chosen], [weight; 3], Density::Unknown))
    }
}

/// A Lambertian surface whose values are random numbers with the right mean, as those of a random walk in layers.
#[derive(Clone, Copy)]
pub struct Walk(Lambertian);

impl Bsdf for Walk {
    fn properties(&self) -> Properties {
        Properties { pdf: PdfKind::Approximate, eval_dimension: 1, ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum {
        let f = self.0.eval(wo, wi, &[])[0];
        // f times a number of mean 1: 0 or 2.
        [if u.first().is_some_and(|&u| u < 0.5) { 2.0 * f } else { 0.0 }; 3]
    }

    fn pdf(&self, _: Direction, wi: Direction) -> f64 {
        0.05 + 0.8 * self.0.pdf(wi, wi)
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let sample = self.0.sample(wo, u)?;
        Some(BsdfSample { density: Density::Unknown, ..sample })
    }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{Sample, Value, Weight};
    let resampled = || Resampled(Rough { alpha: [0.6; 2], facets: Facets::Conductor(0.8) });
    let walk = || Walk(Lambertian { albedo: 0.7 });
    vec![
        planted(
            "whole/resampled/sum-for-mean",
            resampled,
            &[40.0],
            Weight(|_, _, s| 2.0 * s.weight[0]),
            "the sum of the candidates' contributions for their mean",
        ),
        planted(
            "whole/resampled/weight-of-the-chosen",
            resampled,
            &[40.0],
            Weight(|m, o, s| m.eval(o, s.wi, &[])[0] * std::f64::consts::PI),
            "the chosen candidate's contribution as if it had been sampled alone",
        ),
        planted(
            "whole/resampled/candidates-chosen-uniformly",
            resampled,
            &[40.0],
            Sample(|m, o, u| {
                let (wi, [a, b], _) = m.candidates(o, u);
                Some(BsdfSample::new(wi[usize::from(u[0] >= 0.5)], [0.5 * (a + b); 3], Density::Unknown))
            }),
            "candidates chosen with probability ½: right in the mean over the sphere, wrong everywhere",
        ),
        planted(
            "whole/walk/path-lost",
            walk,
            &[40.0],
            Value(|_, o, i| if o[2] > 0.0 && i[2] > 0.3 { 1.0 } else { 0.7 }),
            "random walks that leave at grazing angles are lost",
        ),
        planted(
            "whole/walk/weight-without-absorption",
            walk,
            &[40.0],
            Weight(|_, _, s| s.weight[0] / 0.7),
            "weights of samples without the absorption that values have",
        ),
    ]
}
