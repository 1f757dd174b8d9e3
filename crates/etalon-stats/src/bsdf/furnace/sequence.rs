//! The mean weight over a randomized sequence, of BSDFs that map random numbers to directions in an unknown way.

use super::{Albedo, Basis, RISK, student};
use crate::bsdf::contract::Spectrum;
use crate::bsdf::subject::Subject;
use crate::error::{Result, poll};
use crate::stream::{Sobol, Stream};
use rayon::prelude::*;

/// Randomizations of a low-discrepancy sequence.
const REPLICATES: u64 = 16;
/// The smallest and the largest number of points of a replicate, as powers of 2.
const SEQUENCE: std::ops::RangeInclusive<u32> = 8..=18;

/// The estimated error varies by a fifth: with this margin the second one is rarely above what is asked for.
const MARGIN: f64 = 0.7;

/// The mean weight over a randomized sequence, so long that the error of the mean is likely to be at most `error`. The length is found
/// with other randomizations than the mean, which would otherwise stop where the error happens to be estimated too small.
pub fn by_sequence(subject: &Subject, error: f64) -> Result<Albedo> {
    let is_enough =
        |albedo: &Albedo| albedo.error[..subject.properties.channels].iter().all(|&bound| bound <= MARGIN * error);
    let mut power = *SEQUENCE.start();
    while power < *SEQUENCE.end() && !is_enough(&replicated(subject, power, 0)?) {
        power += 1;
    }
    replicated(subject, power, 1)
}

/// The mean over the first 2^`power` points of a sequence, randomized several times.
fn replicated(subject: &Subject, power: u32, round: u64) -> Result<Albedo> {
    let (properties, protocol) = (&subject.properties, subject.protocol);
    let mean = |replicate: u64| -> Result<Spectrum> {
        poll(protocol.cancelled)?;
        let numbers = |i: u32| {
            let stream = Sobol::new(protocol.seed, round * REPLICATES + replicate, i);
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
    let (n, freedom) = (REPLICATES as f64, (REPLICATES - 1) as f64);
    let mut albedo = Albedo { value: [0.0; 3], error: [f64::INFINITY; 3], basis: Basis::Normal(freedom) };
    for channel in 0..properties.channels {
        let mean = means.iter().map(|mean| mean[channel]).sum::<f64>() / n;
        let variance = means.iter().map(|other| (other[channel] - mean).powi(2)).sum::<f64>() / freedom;
        (albedo.value[channel], albedo.error[channel]) = (mean, student(RISK, freedom) * (variance / n).sqrt());
    }
    Ok(albedo)
}
