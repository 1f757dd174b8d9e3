//! The noise of an image that is declared to have none.
//!
//! What a pixel differs from the mean of its four neighbours is little in a smooth image, and all of independent noise. The
//! square of this difference between both sides, less its variance by the other side's n replicates, has the expectation 0 if
//! the image has no noise, however skewed the other side's is. Each is divided by a variance that is typical of its brightness,
//! so that the few pixels that have most of the noise do not drown what all others say. Student's t over blocks tests the mean.
//! The image is first brought to the other side's mean in each block, so that a light that is too bright is not called noise.
//! A difference in fine detail cannot be told from noise: one image does not show which it is.

use super::functionals::{Blocks, Observed, WAVES};
use super::pooled::variances;
use super::side::{PRECISION, Side};
use etalon_core::raster::Image;
use etalon_stats::Extremes;
use etalon_stats::estimate::Difference;
use etalon_stats::welch::Mean;

/// Pixels of about one brightness whose variances are averaged: enough for two replicates, and few beside an image.
const ALIKE: usize = 32;

/// The noise that an image seems to have.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// Its variance, by that of the mean of the other side; above 0.
    pub ratio: f64,
    /// Whether it is more than chance makes of an image without noise.
    pub found: bool,
    /// Number of pixels that make the noise, in effect: (Σ v)²/Σ v² of their variances v, all channels as one.
    pixels: f64,
}

/// The noise of `exact`; nothing where what is left between both sides is no more than that of the mean of `noisy`.
pub fn noise(exact: &Image, noisy: &Side, blocks: &Blocks, level: f64) -> Option<Noise> {
    let variances = noisy.error().map_or_else(
        || variances(&noisy.images),
        |error| error.pixels().iter().map(|e| e.to_array().map(|e| f64::from(e).powi(2))).collect(),
    );
    let typical = typical(exact, &variances, blocks);
    let of_block = |pixels: &Vec<usize>| {
        let mut sums = Sums::default();
        for channel in 0..3 {
            let gain = gain(exact, noisy, pixels, &typical, channel);
            for &pixel in pixels.iter().filter(|_| gain.is_finite()) {
                let Some(near) = blocks.neighbours(pixel) else { continue };
                let [square, variance] = detail(exact, noisy, (pixel, near), channel, gain);
                let around: f64 = near.iter().map(|&i| typical[i][channel]).sum();
                sums.add(square, variance, typical[pixel][channel] + around / 16.0);
            }
        }
        sums
    };
    let blocks_sums: Vec<Sums> = blocks.pixels.iter().map(of_block).collect();
    let weighted = || blocks_sums.iter().filter(|sums| sums.count > 0.0);
    let total = |of: fn(&Sums) -> f64| blocks_sums.iter().map(of).sum::<f64>();
    // In units of the other side's variance: of pixels that count alike, and of pixels as they count in means.
    let excess = Mean::of_replicates(&weighted().map(|sums| sums.weighted[0] / sums.count).collect::<Vec<f64>>())?;
    let alike = excess.value / (total(|sums| sums.weighted[1]) / total(|sums| sums.count));
    let in_means = total(|sums| sums.plain[0]) / total(|sums| sums.plain[1]);
    let found = excess.value > 0.0 && 0.5 * Difference::of(excess, Mean::exact(0.0), 0.0).p() < level;
    let of_pixels: Vec<f64> = blocks.pixels.iter().flatten().map(|&pixel| variances[pixel].iter().sum()).collect();
    let pixels = of_pixels.iter().sum::<f64>().powi(2) / of_pixels.iter().map(|v| v * v).sum::<f64>();
    let ratio = if found { alike.at_least(in_means) } else { in_means };
    (ratio > 0.0 && ratio.is_finite()).then_some(Noise { ratio, found, pixels })
}

impl Noise {
    /// What the sides say of each functional if side `k` has this noise: of the same pixels as that of the other side, so that
    /// each functional has as much more of it. The ratio is no better known than the number of pixels allows.
    pub fn allowed_for(&self, observed: &[Vec<[Observed; 3]>], k: usize) -> Vec<Vec<[Observed; 3]>> {
        let mut allowed = observed.to_vec();
        for (i, (channels, noise)) in allowed[k].iter_mut().zip(&observed[1 - k]).enumerate() {
            for (of, Observed { mean: noise, .. }) in channels.iter_mut().zip(noise) {
                let dof = if i < WAVES { noise.dof.at_most(self.pixels) } else { noise.dof };
                of.mean = Mean { variance: self.ratio * noise.variance, dof, ..of.mean };
            }
        }
        allowed
    }
}

/// Sums over a block.
#[derive(Default)]
struct Sums {
    /// What squares have above their expectations, and the expectations, each by the typical variance.
    weighted: [f64; 2],
    /// The number of these.
    count: f64,
    /// The same as they are.
    plain: [f64; 2],
}

impl Sums {
    fn add(&mut self, square: f64, variance: f64, typical: f64) {
        let of = [square - variance, variance];
        self.plain = [self.plain[0] + of[0], self.plain[1] + of[1]];
        if typical > 0.0 {
            self.weighted = [self.weighted[0] + of[0] / typical, self.weighted[1] + of[1] / typical];
            self.count += 1.0;
        }
    }
}

/// For each pixel and channel, the mean variance of pixels about as bright in other blocks: what its own noise has no part in.
fn typical(exact: &Image, variances: &[[f64; 3]], blocks: &Blocks) -> Vec<[f64; 3]> {
    let of_block = |(block, pixels): (usize, &Vec<usize>)| pixels.iter().map(move |&i| (i, block)).collect::<Vec<_>>();
    let mut pixels: Vec<(usize, usize)> = blocks.pixels.iter().enumerate().flat_map(of_block).collect();
    // Equal pixels in an order that mixes the blocks: by multiples of the golden ratio.
    pixels.sort_unstable_by_key(|(pixel, _)| pixel.wrapping_mul(0x9e37_79b9));
    let mut typical = vec![[0.0; 3]; variances.len()];
    let size = pixels.len().div_ceil((pixels.len() / ALIKE).max(1)).max(1);
    for channel in 0..3 {
        let value = |pixel: usize| exact.pixels()[pixel][channel];
        pixels.sort_by(|(a, _), (b, _)| value(*a).total_cmp(&value(*b)));
        for alike in pixels.chunks(size) {
            for &(pixel, block) in alike {
                let others = alike.iter().filter(|(_, other)| *other != block);
                let (sum, count) = others.fold((0.0, 0.0), |(sum, n), (i, _)| (sum + variances[*i][channel], n + 1.0));
                typical[pixel][channel] = if count > 0.0 { sum / count } else { 0.0 };
            }
        }
    }
    typical
}

/// What `exact` is multiplied by to be nearest to the mean of `noisy` in a block, by least squares; NaN if nothing says so.
fn gain(exact: &Image, noisy: &Side, pixels: &[usize], typical: &[[f64; 3]], channel: usize) -> f64 {
    let at = |image: &Image, pixel: usize| f64::from(image.pixels()[pixel][channel]);
    let mean =
        |pixel: usize| noisy.images.iter().map(|image| at(image, pixel)).sum::<f64>() / noisy.images.len() as f64;
    let known = pixels.iter().filter(|pixel| typical[**pixel][channel] > 0.0);
    let [products, squares] = known.fold([0.0; 2], |[products, squares], &pixel| {
        let weighted = at(exact, pixel) / typical[pixel][channel];
        [products + weighted * mean(pixel), squares + weighted * at(exact, pixel)]
    });
    products / squares
}

/// What a pixel of `noisy`, less `gain` times that of `exact`, differs from the mean of its neighbours: the square, and its
/// expectation if `exact` has no noise beyond its precision.
fn detail(exact: &Image, noisy: &Side, (pixel, near): (usize, [usize; 4]), channel: usize, gain: f64) -> [f64; 2] {
    let at = |image: &Image, pixel: usize| f64::from(image.pixels()[pixel][channel]);
    let detail = |image: &Image| at(image, pixel) - 0.25 * near.iter().map(|&i| at(image, i)).sum::<f64>();
    let values: Vec<f64> = noisy.images.iter().map(detail).collect();
    let mean = Mean::of_replicates(&values).unwrap_or(Mean::exact(values[0]));
    let variance = noisy.error().map_or(mean.variance, |error| {
        at(error, pixel).powi(2) + near.iter().map(|&i| at(error, i).powi(2)).sum::<f64>() / 16.0
    });
    // Roundings of the pixel and of the mean of four.
    let rounding = 1.25 * (PRECISION * gain * at(exact, pixel)).powi(2);
    [(mean.value - gain * detail(exact)).powi(2), variance + rounding]
}
