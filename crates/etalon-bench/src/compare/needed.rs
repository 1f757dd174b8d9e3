//! How many replicates or samples find the bias that is asked for.

use super::side::{Noise, Side};
use etalon_stats::chi_square::POWER;
use etalon_stats::estimate::Difference;
use etalon_stats::welch::Mean;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

/// What would do in nine of ten runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Needed {
    /// As many times the replicates, or the samples of sides whose errors are known by pixel.
    pub times: f64,
    /// The numbers of replicates of both sides; none of other sides.
    pub replicates: [Option<usize>; 2],
    /// Which sides have noise.
    pub noisy: [bool; 2],
}

/// Largest factor of the number of images.
const MOST: f64 = 1e6;

/// The least numbers for which tests at `level` find a uniform bias of `detect` with 90 % probability, from the means of the image
/// by side and channel. Standard errors fall with the root of the number, degrees of freedom grow with it; the numbers allow for the
/// error of today's standard errors and of those to come.
pub fn needed(
    sides: &[Side; 2],
    means: [[Mean; 3]; 2],
    allowances: [f64; 3],
    level: f64,
    detect: f64,
) -> Option<Needed> {
    // The channel with the least of three standard errors decides, and each of them may be too small.
    let z = Normal::new(0.0, 1.0).ok()?.inverse_cdf(1.0 - (1.0 - POWER) / 3.0);
    let replicates = |side: &Side, times: f64| {
        (side.noise == Noise::Replicates).then(|| (side.images.len() as f64 * times).ceil() as usize)
    };
    let suffices = |times: &f64| {
        let bias = |channel: usize| {
            let [a, b] = [0, 1].map(|k| {
                let mean = means[k][channel];
                let dof = replicates(&sides[k], *times).map_or(mean.dof, |n| sides[k].dof_of(n, mean.dof));
                Mean { variance: mean.variance / times, dof, ..mean }
            });
            let of = |a, b| Difference::of(a, b, allowances[channel]);
            let [now, then] = [of(means[0][channel], means[1][channel]), of(a, b)];
            let uncertain = z * (0.5 / now.dof + 0.5 / then.dof).sqrt();
            then.detectable(level) * uncertain.exp() / (0.5 * (a.value.abs() + b.value.abs()))
        };
        (0..3).any(|channel| bias(channel) <= detect)
    };
    // More must do, too: from 16 replicates on, functionals have their own variances.
    let steps: Vec<f64> = (0..).map(|i| 1.02_f64.powi(i)).take_while(|times| *times < MOST).collect();
    let times = steps.into_iter().rev().take_while(suffices).last()?;
    let noisy = means.map(|means| means.iter().any(|mean| mean.variance > 0.0));
    Some(Needed { times, replicates: sides.each_ref().map(|side| replicates(side, times)), noisy })
}
