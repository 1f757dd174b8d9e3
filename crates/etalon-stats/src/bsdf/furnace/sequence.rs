//! The mean weight over a randomized sequence, of BSDFs that map random numbers to directions in an unknown way.

use super::{Albedo, Basis, PLACES, RISK, borders, most_points, student};
use crate::bsdf::contract::{Properties, Spectrum};
use crate::bsdf::subject::Subject;
use crate::error::{Result, poll};
use crate::extremes::Extremes;
use crate::parallel::each;
use crate::stream::{Sobol, Stream};
use rand::RngExt;

/// Randomizations of a low-discrepancy sequence.
const REPLICATES: u64 = 16;
/// The smallest and the largest number of points of a replicate, as powers of 2.
const SEQUENCE: std::ops::RangeInclusive<u32> = 8..=18;

/// The estimated error varies by a fifth: with this margin the second one is rarely above what is asked for.
const MARGIN: f64 = 0.7;

/// The mean weight over a randomized sequence, so long that the error of the mean is likely to be at most `error`. The length is found
/// with other randomizations than the mean, which would otherwise stop where the error happens to be estimated too small.
pub fn by_sequence(subject: &Subject, error: f64) -> Result<Albedo> {
    let channels = subject.properties.channels;
    // More points make no number of a mean that is none.
    let is_enough = |Albedo { value, error: bounds, .. }: &Albedo| {
        value.iter().any(|mean| !mean.is_finite()) || bounds[..channels].iter().all(|&bound| bound <= MARGIN * error)
    };
    let (mut power, mut largest, rounded) = (*SEQUENCE.start(), [0.0; 3], unresolved(subject)?);
    // The lengths that are tried before take as many points together as the last one, and the mean as many again: 32 times its replicate in all.
    let longest = 0.5 * most_points(subject, f64::INFINITY) / REPLICATES as f64;
    let last = (longest.log2() as u32).clamp(*SEQUENCE.start(), *SEQUENCE.end());
    while power < last && !is_enough(&replicated(subject, power, 0, &mut largest, rounded)?) {
        power += 1;
    }
    replicated(subject, power, 1, &mut largest, rounded)
}

/// What the rounding of a random number next to 0 or to 1 may change, as on the square of two numbers.
fn unresolved(subject: &Subject) -> Result<Spectrum> {
    const ALONG: usize = 64;
    let Properties { dimension, precision, .. } = subject.properties;
    let mut rng = subject.random(0x12, 0);
    let axes = (0..dimension).flat_map(|axis| borders(precision).map(|at| (axis, at)));
    let mut u = Vec::new();
    for (axis, at) in axes.flat_map(|border| std::iter::repeat_n(border, ALONG)) {
        u.extend((0..dimension).map(|other| if other == axis { at } else { rng.random() }));
    }
    let mut sum: Spectrum = [0.0; 3];
    for sample in subject.sample(&u)?.into_iter().flatten() {
        let power = subject.power(&sample);
        (0..3).for_each(|channel| sum[channel] += power[channel]);
    }
    Ok(sum.map(|sum| precision * sum / ALONG as f64))
}

/// The mean over the first 2^`power` points of a sequence, randomized several times. Replaces the `largest` weights by those that are
/// larger.
fn replicated(subject: &Subject, power: u32, round: u64, largest: &mut Spectrum, rounded: Spectrum) -> Result<Albedo> {
    let (properties, protocol) = (&subject.properties, subject.protocol);
    let points = f64::from(1u32 << power);
    let mean = |replicate: u64| -> Result<[Spectrum; 2]> {
        poll(protocol.cancelled)?;
        let numbers = |i: u32| {
            let stream = Sobol::new(protocol.seed, round * REPLICATES + replicate, i);
            let pairs = (0..properties.dimension.div_ceil(2)).flat_map(move |pair| stream.pair(pair as u32));
            pairs.take(properties.dimension)
        };
        let u: Vec<f64> = (0..1 << power).flat_map(numbers).collect();
        let (mut sum, mut most) = ([0.0; 3], [0.0; 3]);
        for sample in subject.sample(&u)?.into_iter().flatten() {
            let power = subject.power(&sample);
            for channel in 0..3 {
                let weight = power[channel];
                (sum[channel], most[channel]) = (sum[channel] + weight, weight.at_least(most[channel]));
            }
        }
        Ok([sum.map(|sum| sum / points), most])
    };
    let found = each(REPLICATES, mean)?;
    let (n, freedom) = (REPLICATES as f64, (REPLICATES - 1) as f64);
    let (mut values, mut errors) = ([0.0; 3], [f64::INFINITY; 3]);
    for channel in 0..properties.channels {
        largest[channel] = found.iter().map(|[_, most]| most[channel]).fold(largest[channel], f64::at_least);
        let mean = found.iter().map(|[mean, _]| mean[channel]).sum::<f64>() / n;
        let variance = found.iter().map(|[other, _]| (other[channel] - mean).powi(2)).sum::<f64>() / freedom;
        // None of independent points would be in a part of this size with probability `RISK`; weights are as large as the largest there.
        let unseen = -RISK.ln() / (n * points);
        let rounding = PLACES * properties.precision * mean.abs() + rounded[channel];
        values[channel] = mean;
        errors[channel] = student(RISK, freedom) * (variance / n).sqrt() + unseen * largest[channel] + rounding;
    }
    let largest = largest.iter().copied().fold(0.0, f64::at_least);
    Ok(Albedo { value: values, error: errors, basis: Basis::Normal { freedom, largest } })
}
