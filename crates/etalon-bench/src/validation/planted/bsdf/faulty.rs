//! A right BSDF with one thing changed.

use super::super::fault::PlantedFault;
use crate::validation::case::Case;
use crate::validation::{plain, whole};
use etalon_stats::bsdf::{Bsdf, BsdfSample, DeltaLobe, Density, Direction, Hit, Properties, Spectrum};
use etalon_stats::{Protocol, SampleCount};

/// A value for two directions, in place of the right one.
pub type Value<M> = fn(&M, Direction, Direction) -> f64;
/// A weight for a sample, in place of the right one.
pub type Weight<M> = fn(&M, Direction, &BsdfSample) -> f64;

/// What is changed.
#[derive(Clone, Copy)]
pub enum Change<M> {
    /// Values, and not the weights.
    Value(Value<M>),
    /// Values, and weights with them.
    ValueAndWeight(Value<M>),
    /// The pdf, and not the weights.
    Pdf(Value<M>),
    PdfAndWeight(Value<M>),
    CarriedPdf(Value<M>),
    Weight(Weight<M>),
    /// Samples.
    Sample(fn(&M, Direction, &[f64]) -> Option<BsdfSample>),
    /// Values for importance.
    AdjointValue(Value<M>),
    /// Weights for importance, of a sample for radiance.
    AdjointWeight(Weight<M>),
    /// What delta lobes do to radiance, and weights with it.
    Throughput(fn(&M, Direction, &DeltaLobe) -> f64),
    /// The probability of a lobe times its pdf.
    LobePdf(fn(&M, Direction, Direction, usize) -> f64),
    /// Where rays meet a light.
    Hit(fn(Hit) -> Hit),
}

/// A BSDF of one channel with a change, or right.
pub struct Faulty<M> {
    pub right: M,
    pub change: Option<Change<M>>,
}

/// Both numbers over each other, 1 where there is none.
fn ratio(new: f64, old: f64) -> f64 {
    if old == 0.0 { 1.0 } else { new / old }
}

impl<M: Bsdf> Faulty<M> {
    fn changed_pdf(&self, wo: Direction, wi: Direction) -> Option<f64> {
        match self.change {
            Some(Change::Pdf(pdf) | Change::PdfAndWeight(pdf)) => Some(pdf(&self.right, wo, wi)),
            _ => None,
        }
    }
}

impl<M: Bsdf> Bsdf for Faulty<M> {
    fn properties(&self) -> Properties {
        self.right.properties()
    }

    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum {
        match self.change {
            Some(Change::Value(value) | Change::ValueAndWeight(value)) if u.is_empty() => {
                [value(&self.right, wo, wi); 3]
            }
            // A stochastic value is changed in proportion to its random number.
            Some(Change::Value(value)) => [value(&self.right, wo, wi) * self.right.eval(wo, wi, u)[0]; 3],
            _ => self.right.eval(wo, wi, u),
        }
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        self.changed_pdf(wo, wi).unwrap_or_else(|| self.right.pdf(wo, wi))
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let right = &self.right;
        let mut sample = match self.change {
            Some(Change::Sample(sample)) => sample(right, wo, u),
            _ => right.sample(wo, u),
        }?;
        let wi = sample.wi;
        let factor = match self.change {
            Some(Change::ValueAndWeight(value)) if !sample.is_delta() => {
                ratio(value(right, wo, wi), right.eval(wo, wi, &[])[0])
            }
            Some(Change::PdfAndWeight(pdf)) if !sample.is_delta() => ratio(right.pdf(wo, wi), pdf(right, wo, wi)),
            Some(Change::Throughput(throughput)) if sample.is_delta() => {
                let lobe = right.delta_lobes(wo).into_iter().find(|lobe| lobe.wi == wi)?;
                throughput(right, wo, &lobe) / lobe.throughput[0]
            }
            Some(Change::Weight(weight)) => ratio(weight(right, wo, &sample), sample.weight[0]),
            _ => 1.0,
        };
        sample.weight = sample.weight.map(|w| w * factor);
        if let Density::Pdf(pdf) = &mut sample.density {
            *pdf = self.changed_pdf(wo, wi).unwrap_or(*pdf);
            if let Some(Change::CarriedPdf(carried)) = self.change {
                *pdf = carried(right, wo, wi);
            }
        }
        Some(sample)
    }

    fn delta_lobes(&self, wo: Direction) -> Vec<DeltaLobe> {
        let lobes = self.right.delta_lobes(wo).into_iter();
        let changed = |lobe: DeltaLobe| match self.change {
            Some(Change::Throughput(throughput)) => {
                DeltaLobe { throughput: [throughput(&self.right, wo, &lobe); 3], ..lobe }
            }
            _ => lobe,
        };
        lobes.map(changed).collect()
    }

    fn lobes(&self) -> usize {
        self.right.lobes()
    }

    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        if let Some(Change::LobePdf(pdf)) = self.change {
            return Some(pdf(&self.right, wo, wi, lobe));
        }
        let pdf = self.right.lobe_pdf(wo, wi, lobe)?;
        Some(self.changed_pdf(wo, wi).map_or(pdf, |new| pdf * ratio(new, self.right.pdf(wo, wi))))
    }

    fn eval_adjoint(&self, wo: Direction, wi: Direction) -> Option<Spectrum> {
        match self.change {
            Some(Change::AdjointValue(value)) => Some([value(&self.right, wo, wi); 3]),
            Some(Change::ValueAndWeight(_) | Change::Value(_)) => None,
            _ => self.right.eval_adjoint(wo, wi),
        }
    }

    fn sample_adjoint(&self, wo: Direction, u: &[f64]) -> Option<Option<BsdfSample>> {
        match self.change {
            None => self.right.sample_adjoint(wo, u),
            Some(Change::AdjointWeight(weight)) => {
                let adjoint =
                    |sample: BsdfSample| BsdfSample { weight: [weight(&self.right, wo, &sample); 3], ..sample };
                Some(self.right.sample(wo, u).map(adjoint))
            }
            _ => None,
        }
    }

    fn albedo(&self, wo: Direction) -> Option<Spectrum> {
        self.right.albedo(wo)
    }

    fn hit(&self, wo: Direction, wi: Direction) -> Option<Hit> {
        let hit = self.right.hit(wo, wi)?;
        Some(if let Some(Change::Hit(changed)) = self.change { changed(hit) } else { hit })
    }
}

/// The unit vector at that angle in degrees with the normal, in no symmetric position to the tangents.
pub fn towards(degrees: f64) -> Direction {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [0.8 * sin, 0.6 * sin, cos]
}

/// A change of the BSDF that `right` builds, tested for `wo` at these angles in degrees.
pub fn planted<M: Bsdf + Copy + 'static>(
    name: &'static str,
    right: fn() -> M,
    degrees: &'static [f64],
    change: Change<M>,
    mistake: &'static str,
) -> PlantedFault {
    let make = move |is_faulty: bool| Faulty { right: right(), change: is_faulty.then_some(change) };
    planted_at(name, make, degrees.iter().map(|&degrees| towards(degrees)).collect(), mistake)
}

/// What `make` builds with the mistake or without it, tested for these directions `wo` or from these reference points.
pub fn planted_at<M: Bsdf>(
    name: &'static str,
    make: impl Fn(bool) -> Faulty<M> + Clone + Send + Sync + 'static,
    wos: Vec<Direction>,
    mistake: &'static str,
) -> PlantedFault {
    let case = |kind: &str, is_faulty: bool| {
        let [(make, wos), (other, same)] = [(make.clone(), wos.clone()), (make.clone(), wos.clone())];
        Case::new(format!("{kind}/{name}"), move |protocol, round| {
            // The mistakes are larger than what the tests of samplers look for.
            let samples = match protocol.samples {
                SampleCount::Detect(error) => SampleCount::Detect((3.0 * error).min(1.0)),
                fixed @ SampleCount::Fixed(_) => fixed,
            };
            whole::examine(&make(is_faulty), &wos, &Protocol { samples, ..*protocol }, round)
        })
        .with_plain(move |seed| plain::p_value_of_bsdf(&other(is_faulty), &same, seed))
    };
    PlantedFault { name, mistake, faulty: case("planted", true), sound: case("sound", false) }
}
