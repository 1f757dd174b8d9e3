//! The directional albedo of a BSDF with a bound of its error: one cell of a furnace test.

use super::contract::{BatchBsdf, Direction, Properties, Spectrum};
use super::subject::Subject;
use crate::error::Result;
use crate::examine::{Protocol, SampleCount};
use crate::extremes::Extremes;
use integral::{Weights, integral, unresolved};
use mapped::{Mapped, UNSEEN};
use sequence::by_sequence;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The probability with which the error of an albedo may exceed its bound.
pub const RISK: f64 = 0.01;
/// Rounding changes a weight by at most this multiple of the square root of the machine epsilon: near total reflection, Fresnel's
/// reflectance grows with the root of the distance from the critical angle, and each lobe has its own rounding.
const ROUNDING: f64 = 8.0;
/// The roundings of a sum of lobes, in units of the last place.
const PLACES: f64 = 64.0;

/// What the bound of an albedo's error rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// On weights that are declared to be at most this.
    Certified(f64),
    /// On nothing: a weight was negative or larger than declared.
    Exceeded {
        /// What is declared, with room for rounding.
        declared: f64,
        /// The one that was found.
        found: f64,
    },
    /// On the weights that were found, of which this is the largest: none is assumed to be much further than those from what its
    /// neighbours let expect.
    Found(f64),
    /// On the assumption that means have a normal distribution, so that theirs is Student's, and that no weight is larger than those that
    /// were found.
    Normal {
        /// Degrees of freedom.
        freedom: f64,
        /// The largest weight that was found.
        largest: f64,
    },
}

/// A directional albedo: the radiance towards `wo` over that of uniform light from everywhere, per channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Albedo {
    /// The estimate.
    pub value: Spectrum,
    /// The error of a channel exceeds this with a probability of [`RISK`] at most.
    pub error: Spectrum,
    /// What that rests on.
    pub basis: Basis,
}

impl Albedo {
    /// A bound of a channel's error that holds for all of `tests` albedos, except with the probability [`RISK`].
    #[must_use]
    pub fn error_of(&self, channel: usize, tests: usize) -> f64 {
        match self.basis {
            // The bound grows with the logarithm of the number at most.
            Basis::Certified(_) | Basis::Found(_) | Basis::Exceeded { .. } => {
                self.error[channel] * (1.0 + (tests as f64).ln() / (2.0 / RISK).ln())
            }
            Basis::Normal { freedom, .. } => {
                self.error[channel] * student(RISK / tests as f64, freedom) / student(RISK, freedom)
            }
        }
    }
}

/// The value that the absolute value of a number with Student's distribution exceeds with probability `risk`.
fn student(risk: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |student| student.inverse_cdf(1.0 - 0.5 * risk))
}

/// The directional albedo for `wo`, the mean weight of samples times η², with an error of at most `error` if 2²² points suffice (2²⁰ for a BSDF
/// that declares no largest weight), or fewer that `protocol` fixes, of which some hundreds are always taken.
///
/// Where two random numbers are mapped to directions, the weight is a function of these two, averaged over the lobes that a third may choose.
/// Polynomials on rectangles of the unit square approximate it. The mean difference between the weight and the polynomials
/// is measured at independent random points, in proportion to area and to what the polynomials miss, and added to their integral. Weights lie
/// between 0 and a bound; so an empirical Bernstein inequality bounds the error of this mean without an assumption on the distribution of the differences: a lobe
/// that hides between the nodes is found by the points as often as it is sampled.
///
/// If no bound is declared, the differences take its place: none is assumed to be larger than twice the largest that was found in its rectangle,
/// or than an eighth of the largest weight there or of the mean weight, whichever is most. Weights next to the border of the square, where the
/// precision of the BSDF does not resolve the random numbers, are part of the error. BSDFs without such a map are averaged over a
/// randomized Sobol' sequence, 16 times.
///
/// That weights are f |cos θᵢ| over the pdf of the samples is what the checks `formula`, `sampling` and `weights` test.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled); those of the BSDF.
pub fn directional_albedo(bsdf: &dyn BatchBsdf, wo: Direction, error: f64, protocol: &Protocol) -> Result<Albedo> {
    let subject = Subject::new(bsdf, wo, protocol, 0)?;
    match subject.properties {
        Properties { map: Some(map), dimension: 2 | 3, .. } => by_map(&subject, map, error),
        _ => by_sequence(&subject, error),
    }
}

/// The random numbers next to 0 and to 1 that arithmetic of this precision resolves.
fn borders(precision: f64) -> [f64; 4] {
    [0.25 * precision, precision, 1.0 - precision, 1.0 - 0.5 * precision]
}

/// The most points of an albedo: what `usual` is, or what the protocol fixes if that is less.
fn most_points(subject: &Subject, usual: f64) -> f64 {
    match subject.protocol.samples {
        SampleCount::Fixed(points) => usual.at_most(points as f64),
        SampleCount::Detect(_) => usual,
    }
}

/// The light of the delta lobes.
fn of_deltas(subject: &Subject, channel: usize) -> f64 {
    subject.deltas.iter().map(|lobe| lobe.throughput[channel] * subject.eta2(lobe.wi)).sum()
}

/// Integrates the weights over the square of the two random numbers that are mapped to directions.
fn by_map(subject: &Subject, map: [usize; 2], error: f64) -> Result<Albedo> {
    let Properties { channels, largest_weight, precision, .. } = subject.properties;
    let largest = largest_weight.map(|declared| declared * (1.0 + ROUNDING * precision.sqrt()));
    let basis = largest.map_or(Basis::Found(0.0), Basis::Certified);
    let mut albedo = Albedo { value: [0.0; 3], error: [0.0; 3], basis };
    // Rounding, and what lies between the lobes' intervals, which is not asked for, have their part of the error.
    let rest = |scale: f64| scale * (UNSEEN + PLACES * precision);
    let mapped = Mapped { subject, map };
    // Integrals, and the channels that have the same weights everywhere.
    let mut known: Vec<([f64; 2], [bool; 3])> = Vec::new();
    for channel in 0..channels {
        let same = known.iter().find(|(_, equal)| equal[channel]).map(|(integral, _)| *integral);
        let [value, bound] = match same {
            Some(integral) => integral,
            None => {
                let mut weights = Weights::new(&mapped, channel);
                let mut measure = || -> Result<[f64; 2]> {
                    let rounded = if largest.is_none() { unresolved(&mut weights)? } else { 0.0 };
                    let target = (error - rounded - rest(largest.unwrap_or(1.0))).at_least(0.5 * error);
                    let [value, bound] = integral(&mut weights, largest, target)?;
                    Ok([value, bound + rounded])
                };
                let measured = measure();
                let integral = match weights.not_finite() {
                    Some(weight) => [weight, f64::INFINITY],
                    None => measured?,
                };
                let [least, most] = weights.extremes;
                if let Basis::Found(found) = &mut albedo.basis {
                    *found = found.at_least(most);
                }
                if let Some(declared) = largest.filter(|largest| least < 0.0 || most > *largest) {
                    albedo.basis = Basis::Exceeded { declared, found: if least < 0.0 { least } else { most } };
                }
                known.push((integral, weights.equal));
                integral
            }
        };
        albedo.value[channel] = value + of_deltas(subject, channel);
        albedo.error[channel] = bound + rest(largest.unwrap_or(value));
    }
    if matches!(albedo.basis, Basis::Exceeded { .. }) {
        albedo.error = [f64::INFINITY; 3];
    }
    Ok(albedo)
}

mod control;
mod integral;
mod mapped;
mod sequence;

#[cfg(test)]
mod tests;
