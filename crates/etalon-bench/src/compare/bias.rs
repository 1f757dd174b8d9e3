//! A difference in parts of the mean of B, and how many replicates or samples find the bias that is asked for.

use super::side::{Noise, Side};
use etalon_stats::Extremes;
use etalon_stats::estimate::Difference;
use etalon_stats::welch::Mean;
use serde::Serialize;

/// A difference in parts of the mean of B in its channel, with an interval. The intervals of a family hold together with
/// the probability 1 − level/3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bias {
    /// A − B.
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl Bias {
    /// A `difference` in parts of the mean of B, with an interval at `level`; nothing where that mean is not told from 0.
    ///
    /// Fieller's interval has all θ for which the difference D less θ times the mean M is no further from 0 than t standard
    /// errors. Of whatever correlation, these are at most s + |θ| s_M, so that the ends of D's interval, each by the end of M's
    /// that makes the interval wider, hold it. Source: Fieller, "Some Problems in Interval Estimation", Journal of the Royal
    /// Statistical Society B 16, 1954.
    pub(super) fn of(difference: Difference, of_b: Mean, level: f64) -> Option<Self> {
        let mean = Difference::of(Mean { value: of_b.value.abs(), ..of_b }, Mean::exact(0.0), 0.0);
        let dof = difference.dof.at_most(mean.dof);
        let [half, half_of_mean] = [difference, mean].map(|of| Difference { dof, ..of }.half_width(level));
        let [least, most] = [mean.value - half_of_mean, mean.value + half_of_mean];
        let [low, high] = [difference.value - half, difference.value + half];
        (least > 0.0).then(|| Self {
            value: difference.value / mean.value,
            low: low / if low < 0.0 { least } else { most },
            high: high / if high > 0.0 { least } else { most },
        })
    }
}

/// What finds a bias with 90 % probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Needed {
    /// As many times the replicates, or the samples of sides whose errors are known by pixel.
    pub times: f64,
    /// The numbers of replicates of both sides; none of other sides.
    pub replicates: [Option<usize>; 2],
    pub noisy: [bool; 2],
}

/// Largest factor of the number of images.
const MOST: f64 = 1e6;

/// The least numbers for which the test of the image's mean at `level`, which is that of a channel, finds a uniform bias of `detect` with
/// 90 % probability, from the means of the image by side and channel. That test decides: a uniform bias is more of its standard errors
/// than of any tile's. Standard errors fall with the root of the number, degrees of freedom grow with it.
pub fn needed(
    sides: &[Side; 2],
    means: [[Mean; 3]; 2],
    allowances: [f64; 3],
    level: f64,
    detect: f64,
) -> Option<Needed> {
    let replicates = |side: &Side, times: f64| {
        (side.noise == Noise::Replicates).then(|| (side.images.len() as f64 * times).ceil() as usize)
    };
    let suffices = |times: &f64| {
        let bias = |channel: usize| {
            let [a, b] = [0, 1].map(|k| {
                let mean = means[k][channel];
                match replicates(&sides[k], *times) {
                    Some(n) => Mean {
                        variance: mean.variance * sides[k].images.len() as f64 / n as f64,
                        dof: sides[k].dof_of(n, mean.dof),
                        ..mean
                    },
                    None => Mean { variance: mean.variance / times, ..mean },
                }
            });
            let of = |a, b| Difference::of(a, b, allowances[channel]);
            let now = of(means[0][channel], means[1][channel]);
            now.detectable_then(level, &of(a, b)) / (0.5 * (a.value.abs() + b.value.abs()))
        };
        (0..3).any(|channel| bias(channel) <= detect)
    };
    let times = (0..).map(|i| 1.02_f64.powi(i)).take_while(|times| *times < MOST).find(suffices)?;
    let noisy = means.map(|means| means.iter().any(|mean| mean.variance > 0.0));
    Some(Needed { times, replicates: sides.each_ref().map(|side| replicates(side, times)), noisy })
}

#[cfg(test)]
mod tests {
    use super::super::{Answer, Family, FamilyResult, Plan, Side, Tested, compare};
    use etalon_core::math::Rgb;
    use etalon_core::raster::Image;
    use etalon_stats::stream::CounterRng;
    use rand::RngExt;
    use rayon::prelude::*;

    /// 16 images of this expectation, 8 × 8 pixels, each the mean of `samples` exponential values.
    fn side(rng: &mut CounterRng, expectation: f32, samples: usize) -> Side {
        let mut value = || (0..samples).map(|_| -(1.0 - rng.random::<f32>()).ln()).sum::<f32>() / samples as f32;
        let mut pixel = || Rgb::from_array([value(), value(), value()]) * expectation;
        Side::replicates((0..16).map(|_| Image::from_fn(8, 8, |_, _| pixel())).collect())
    }

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn the_ratio_is_in_its_interval() {
        const PAIRS: u64 = 200;
        for factor in [0.5, 1.0, 1.5, 3.0] {
            for samples_of_b in [1, 100] {
                let is_inside = |pair: u64| {
                    let rng = &mut CounterRng::new(17, pair);
                    let [a, b] = [side(rng, factor, 400), side(rng, 1.0, samples_of_b)];
                    let compared = compare(a, b, Plan { level: 0.01, detect: 0.01 }).unwrap();
                    assert!(factor == 1.0 || compared.answer == Answer::Different);
                    let holds = |family: &FamilyResult, test: &Tested| {
                        // The modes of a uniform image have the expectation 0, and tiles that of the image.
                        let truth = if family.family == Family::LowFrequency { 0.0 } else { f64::from(factor) - 1.0 };
                        // The own mean of a tile need not be told from 0.
                        let is_tile = family.family == Family::Tiles;
                        let bias = compared.bias(family, test);
                        bias.map_or(is_tile, |bias| bias.low <= truth && truth <= bias.high)
                    };
                    let of_family = |family: &FamilyResult| family.tests.iter().all(|test| holds(family, test));
                    [of_family(&compared.families[0]), compared.families.iter().all(of_family)]
                };
                let inside: Vec<[bool; 2]> = (0..PAIRS).into_par_iter().map(is_inside).collect();
                let [of_mean, all] = [0, 1].map(|k| inside.iter().filter(|of| of[k]).count());
                println!("A = {factor} B, {samples_of_b} samples of B: mean {of_mean}, all {all} of {PAIRS}");
                // Fewer than 193 of 200 at 99 % have a probability of 0.1 %.
                assert!(all >= 193, "{factor}, {samples_of_b}: {of_mean}, {all}");
            }
        }
        // Where the mean of B is not told from 0, there is no ratio.
        let rng = &mut CounterRng::new(18, 0);
        let noise = (0..16).map(|_| Image::from_fn(8, 8, |_, _| Rgb::splat(rng.random::<f32>() - 0.5))).collect();
        let compared =
            compare(side(rng, 1.0, 400), Side::replicates(noise), Plan { level: 0.01, detect: 0.01 }).unwrap();
        let family = &compared.families[0];
        assert_eq!(compared.bias(family, &family.tests[0]), None);
    }
}
