//! The directional albedo of a BSDF with a bound of its error: one cell of a furnace test.

use super::batch::BatchBsdf;
use super::contract::{Direction, Properties, Spectrum};
use super::subject::{Subject, channel_of};
use crate::bounded::mean_interval;
use crate::cubature::{Integration, Refinement};
use crate::density::Density;
use crate::domain::Square;
use crate::error::{Result, poll};
use crate::examine::Protocol;
use crate::fixed::Share;
use crate::grid::Grid;
use crate::stream::{Sobol, Stream};
use rand::RngExt;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The probability with which the error of an albedo may exceed its bound.
pub const RISK: f64 = 0.01;
/// Cells that the cubature starts from, along each axis.
const CELLS: usize = 4;
/// Most lobes that are told apart at one point.
const PASSES: usize = 16;
/// Points at a time, so few that their samples stay in the cache.
const BATCH: u64 = 1 << 10;
/// Points that say which channels are equal.
const PILOT: u64 = 1 << 10;
/// Differences up to this share of the largest weight have a mean of their own: they are many, but small, and a bound of their
/// mean grows with their size.
const SMALL: f64 = 1.0 / 64.0;
/// Points at which the largest weight is looked for where none is declared.
const WEIGHTS: u64 = 1 << 12;
/// It may be so many times the largest that is found.
const LARGEST: f64 = 2.0;
/// Most random points that measure the error.
const POINTS: u64 = 1 << 20;
/// The shares of [`RISK`] of two attempts to reach an error: if the first shows that more points are needed, the second has them.
const ATTEMPTS: [f64; 2] = [0.9 * RISK, 0.1 * RISK];
/// Randomizations of a low-discrepancy sequence, and the quantile of Student's distribution for their mean: P(|t₁₅| > 2.947) = [`RISK`].
const REPLICATES: u64 = 16;
const STUDENT: f64 = 2.947;
/// The smallest and the largest number of points of a replicate, as powers of 2.
const SEQUENCE: std::ops::RangeInclusive<u32> = 8..=18;

/// What the bound of an albedo's error rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// On Hoeffding's inequality for weights that are declared to be at most this.
    Certified(f64),
    /// On the same, if no weight is larger than this, which is twice the largest of 4096.
    LargestWeight(f64),
    /// On the assumption that means over a randomized sequence are normally distributed.
    Normal,
}

/// A directional albedo: the share of the power of uniform light that is scattered to `wo`, per channel.
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
            // Hoeffding's bound grows with the logarithm of the number, as long as nothing is seen.
            Basis::Certified(_) | Basis::LargestWeight(_) => {
                self.error[channel] * (1.0 + (tests as f64).ln() / (4.0 / RISK).ln())
            }
            Basis::Normal => {
                let freedom = (REPLICATES - 1) as f64;
                let quantile = |risk: f64| {
                    StudentsT::new(0.0, 1.0, freedom)
                        .map_or(f64::INFINITY, |student| student.inverse_cdf(1.0 - 0.5 * risk))
                };
                self.error[channel] * quantile(RISK / tests as f64) / STUDENT
            }
        }
    }
}

/// The directional albedo for `wo`, the mean weight of samples times η², with an error of at most `error` if 2²⁰ points suffice.
///
/// Where two random numbers are mapped to directions, the weight is a function of these two, averaged over the lobes that a third may choose.
/// It is integrated over the unit square by adaptive cubature. The mean difference between the weight and the polynomials that
/// the rules integrate is measured at independent random points and added. Weights lie between 0 and a bound, so that
/// Hoeffding's inequality bounds the error of this mean without an assumption on their distribution: a lobe that hides
/// between the nodes is found by the points as often as it is sampled.
///
/// Other BSDFs are averaged over a randomized Sobol' sequence, 16 times.
///
/// That weights are f |cos θᵢ| over the pdf of the samples is what the checks `formula`, `sampling` and `weights` test.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled); those of the BSDF.
pub fn directional_albedo(bsdf: &dyn BatchBsdf, wo: Direction, error: f64, protocol: &Protocol) -> Result<Albedo> {
    let subject = Subject::new(bsdf, wo, protocol, 0)?;
    match subject.properties {
        Properties { map: Some(map), dimension: 2 | 3, .. } => by_cubature(&subject, map, error),
        _ => by_sequence(&subject, error),
    }
}

/// A BSDF as a function of the two random numbers that it maps to directions.
struct Mapped<'a> {
    subject: &'a Subject<'a>,
    map: [usize; 2],
}

/// The part \[from, to) of the third number that is not known yet, and whether its lower end has no sample.
struct Unknown {
    point: usize,
    from: f64,
    to: f64,
    none_below: bool,
}

impl Mapped<'_> {
    /// The weights at pairs of random numbers in the mean over the third, which chooses the lobe, delta lobes left out.
    ///
    /// Each lobe has an interval of the third number. From either end of \[0, 1) the intervals are passed one by one by the
    /// probabilities of their lobes. Where neither end has a sample, there is none between them.
    fn weights(&self, points: &[[f64; 2]]) -> Result<Vec<Spectrum>> {
        const STEP: f64 = 1e-6;
        let dimension = self.subject.properties.dimension;
        let choice = (0..3).find(|axis| !self.map.contains(axis)).unwrap_or(2);
        let mut sums = vec![[0.0; 3]; points.len()];
        let unknown = |point| Unknown { point, from: 0.0, to: 1.0, none_below: false };
        let mut rest: Vec<Unknown> = (0..points.len()).map(unknown).collect();
        for _ in 0..PASSES {
            if rest.is_empty() {
                break;
            }
            let mut numbers = Vec::with_capacity(rest.len() * dimension);
            for &Unknown { point, from, to, none_below } in &rest {
                let mut u = [0.0; 3];
                self.map.iter().zip(points[point]).for_each(|(&axis, at)| u[axis] = at);
                u[choice] = match none_below {
                    true => to - STEP,
                    false if from > 0.0 => from + STEP,
                    false => 0.0,
                };
                numbers.extend_from_slice(&u[..dimension]);
            }
            let samples = self.subject.sample(&numbers)?;
            let mut next = Vec::new();
            for (mut unknown, sample) in rest.into_iter().zip(samples) {
                match sample {
                    Some(sample) => {
                        if !sample.is_delta() {
                            let eta2 = self.subject.eta2(sample.wi);
                            let sum = &mut sums[unknown.point];
                            (0..3).for_each(|i| sum[i] += sample.lobe_probability * sample.weight[i] * eta2);
                        }
                        let passed = sample.lobe_probability;
                        if unknown.none_below { unknown.to -= passed } else { unknown.from += passed }
                    }
                    None if unknown.none_below => continue,
                    None => unknown.none_below = true,
                }
                if unknown.to - unknown.from > 2.0 * STEP {
                    next.push(unknown);
                }
            }
            rest = next;
        }
        Ok(sums)
    }
}

/// The mean weight of one channel as what the cubature integrates.
struct Weight<'a> {
    mapped: &'a Mapped<'a>,
    channel: usize,
}

impl Density<[f64; 2]> for Weight<'_> {
    fn pdf(&self, points: &[[f64; 2]], out: &mut Vec<f64>) -> Result<()> {
        out.extend(channel_of(&self.mapped.weights(points)?, self.channel));
        Ok(())
    }
}

/// The light of the delta lobes.
fn of_deltas(subject: &Subject, channel: usize) -> f64 {
    subject.deltas.iter().map(|lobe| lobe.throughput[channel] * subject.eta2(lobe.wi)).sum()
}

fn by_cubature(subject: &Subject, map: [usize; 2], error: f64) -> Result<Albedo> {
    let mapped = Mapped { subject, map };
    let declared = subject.properties.largest_weight;
    let mut rng = subject.random(0x10, 0);
    let count = if declared.is_some() { PILOT } else { WEIGHTS };
    let points: Vec<[f64; 2]> = (0..count).map(|_| rng.random()).collect();
    let pilot = mapped.weights(&points)?;
    let seen = pilot.iter().flatten().copied().fold(0.0, f64::max);
    let largest = declared.unwrap_or(LARGEST * seen);
    let basis = declared.map_or(Basis::LargestWeight(largest), Basis::Certified);
    let mut albedo = Albedo { value: [0.0; 3], error: [0.0; 3], basis };
    for channel in 0..subject.properties.channels {
        // Channels that are equal are integrated once.
        let same = (0..channel).find(|&other| pilot.iter().all(|weight| weight[channel] == weight[other]));
        let [value, bound] = match same {
            Some(other) => [albedo.value[other] - of_deltas(subject, other), albedo.error[other]],
            None => integral(&mapped, channel, largest, error)?,
        };
        (albedo.value[channel], albedo.error[channel]) = (value + of_deltas(subject, channel), bound);
    }
    Ok(albedo)
}

/// The integral of the weight of one channel over the unit square, and the bound of its error.
fn integral(mapped: &Mapped, channel: usize, largest: f64, error: f64) -> Result<[f64; 2]> {
    if largest == 0.0 {
        return Ok([0.0; 2]);
    }
    let subject = mapped.subject;
    let weight = Weight { mapped, channel };
    let grid = Grid::equal([CELLS; 2], None);
    let integration = Integration::new(&Square, &weight, &grid, &[], subject.protocol.cancelled)?;
    let Integration::Refined(refinement) = &integration else { return Ok([0.0, f64::INFINITY]) };
    let polynomials: f64 = refinement.integrals().values.iter().sum();
    // As many points as the bound takes if all differences are small; more if they are not.
    let (mut seen, mut points) = ([0.0; 4], BATCH);
    let mut result = [polynomials, f64::INFINITY];
    for (attempt, risk) in ATTEMPTS.into_iter().enumerate() {
        while points < POINTS && bound(seen, points, risk)[1] * largest > 0.9 * error {
            points += points / 8;
        }
        seen = differences(mapped, channel, largest, refinement, points, 0x11 + attempt as u64)?;
        let [correction, bound] = bound(seen, points, risk);
        result = [polynomials + largest * correction, largest * bound];
        if result[1] <= error {
            break;
        }
    }
    Ok(result)
}

/// The means of the differences between the weight and the polynomials of the rules at independent random points, in units of the
/// largest weight: of positive ones up to [`SMALL`], of what is above that, and the same of negative ones.
fn differences(
    mapped: &Mapped,
    channel: usize,
    largest: f64,
    refinement: &Refinement<Square>,
    points: u64,
    purpose: u64,
) -> Result<[f64; 4]> {
    let subject = mapped.subject;
    let of_batch = |batch: u64| -> Result<[Share; 4]> {
        poll(subject.protocol.cancelled)?;
        let (mut rng, mut sums) = (subject.random(purpose, batch), [Share::default(); 4]);
        let places: Vec<[f64; 2]> = (0..BATCH.min(points - batch * BATCH)).map(|_| rng.random()).collect();
        for (&at, weight) in places.iter().zip(mapped.weights(&places)?) {
            let difference = (weight[channel] - refinement.polynomial(at)) / largest;
            let (first, size) = (2 * usize::from(difference <= 0.0), difference.abs());
            // A sum has a resolution of 2⁻²⁹ of its largest number.
            sums[first].add(Share::new(size.min(SMALL) / SMALL));
            sums[first + 1].add(Share::new((size - SMALL).max(0.0)));
        }
        Ok(sums)
    };
    let sums = (0..points.div_ceil(BATCH)).into_par_iter().map(of_batch).collect::<Result<Vec<_>>>()?;
    let mean = |part: usize| Share::total(sums.iter().map(|sums| sums[part])) / points as f64;
    Ok([SMALL * mean(0), mean(1), SMALL * mean(2), mean(3)])
}

/// The mean of the positive differences minus that of the negative ones, and the bound of its error, which may fail with probability
/// `risk`. No expected value is below 0, so that only upper ends of intervals count: of two parts for either sign.
fn bound(means: [f64; 4], points: u64, risk: f64) -> [f64; 2] {
    let end = |mean: f64| mean_interval(mean.min(1.0), points, 0.5 * risk)[1];
    let most = |small: f64, large: f64| SMALL * end(small / SMALL) + end(large);
    let [above, below] = [most(means[0], means[1]), most(means[2], means[3])];
    let difference = means[0] + means[1] - means[2] - means[3];
    [difference, (above - difference).max(difference + below)]
}

/// The mean weight over a randomized sequence, replicated until the error of the mean is at most `error`.
fn by_sequence(subject: &Subject, error: f64) -> Result<Albedo> {
    let Subject { properties, protocol, .. } = subject;
    let mut albedo = Albedo { value: [0.0; 3], error: [f64::INFINITY; 3], basis: Basis::Normal };
    for power in SEQUENCE {
        let mean = |replicate: u64| -> Result<Spectrum> {
            poll(protocol.cancelled)?;
            let numbers = |i: u32| {
                let stream = Sobol::new(protocol.seed, replicate, i);
                let pairs = (0..properties.dimension.div_ceil(2)).flat_map(move |pair| stream.pair(pair as u32));
                pairs.take(properties.dimension)
            };
            let u: Vec<f64> = (0..1 << power).flat_map(numbers).collect();
            let mut sum = [0.0; 3];
            for sample in subject.sample(&u)?.into_iter().flatten() {
                let eta2 = subject.eta2(sample.wi);
                (0..3).for_each(|channel| sum[channel] += sample.weight[channel] * eta2);
            }
            Ok(sum.map(|sum| sum / f64::from(1u32 << power)))
        };
        let means = (0..REPLICATES).into_par_iter().map(mean).collect::<Result<Vec<_>>>()?;
        let n = REPLICATES as f64;
        for channel in 0..properties.channels {
            let mean = means.iter().map(|mean| mean[channel]).sum::<f64>() / n;
            let variance = means.iter().map(|other| (other[channel] - mean).powi(2)).sum::<f64>() / (n - 1.0);
            (albedo.value[channel], albedo.error[channel]) = (mean, STUDENT * (variance / n).sqrt());
        }
        if albedo.error[..properties.channels].iter().all(|&bound| bound <= error) {
            break;
        }
    }
    Ok(albedo)
}

#[cfg(test)]
mod tests;
