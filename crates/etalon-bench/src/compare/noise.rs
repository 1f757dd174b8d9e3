//! The noise of images: of few replicates, of an image that is declared to have none, and whether the images of a side are
//! independent.
//!
//! Few replicates: the mean of the image and its low modes pool their estimates of it.
//! The variance s² of n replicates has n − 1 degrees of freedom, and Student's t with one or two of them is exceeded at small
//! levels by differences of a hundred standard errors only. The image's mean and its cosine modes are nine weighted means of the
//! same pixels, and noise whose correlations are short beside the image (filters, paths that reach neighbouring pixels) has the same
//! factor in all nine: Var f = F Σ w²σ², with F = 1 for independent pixels. The pixels' own variances give Σ w²σ² for each,
//! the replicates of all nine give F. That correlations are short is a premise: noise that a whole image shares, such as an
//! exposure of its own, has fewer degrees of freedom. Where a functional's own variance is above the pooled one, it counts.
//!
//! An image that is declared to have no noise:
//! what a pixel differs from the mean of its four neighbours is little in a smooth image, and all of independent noise. The
//! square of this difference between both sides, less its variance by the other side's n replicates, has the expectation 0 if
//! the image has no noise, however skewed the other side's is. Each is divided by a variance that is typical of its brightness,
//! so that the few pixels that have most of the noise do not drown what all others say. Student's t over blocks tests the mean.
//! The image is first brought to the other side's mean in each block, so that a light that is too bright is not called noise.
//! A difference in fine detail cannot be told from noise: one image does not show which it is.
//!
//! Independent images with one expectation:
//! random numbers that two images share, and a fault that two of them have, make their residuals x − x̄ alike. Of n independent
//! images with the variances vₖ, the product of two residuals has the expectation −(vₖ + vₗ)/n + Σv/n², and the square of one
//! vₖ (1 − 2/n) + Σv/n²; images may have different numbers of samples. What the products exceed that by is summed over blocks of the
//! image, and Student's t over the blocks tests each pair, at a level that is corrected for the number of pairs. Blocks must be
//! independent: noise that a whole image shares, such as an exposure of its own, looks like another expectation.

use super::functionals::{Blocks, Layout, Observed, WAVES};
use super::side::{PRECISION, Side};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_stats::Extremes;
use etalon_stats::estimate::Difference;
use etalon_stats::welch::Mean;
use rayon::prelude::*;

/// The variance and the degrees of freedom of the mean and the modes of a side, from replicates; by functional and channel.
///
/// The nine estimates of F would have 9 (n − 1) degrees of freedom if they were independent. Where a few pixels have nearly all
/// of the noise, all functionals see the same of it: with the correlations R of the functionals, which follow from
/// the pixels' variances, F has (n − 1) 9²/Σ R² (Satterthwaite), and n − 1 in the worst case. A pixel counts with the larger of
/// both sides' variances: a few replicates may miss that it is noisy.
pub fn pool([side, other]: [&Side; 2], layout: &Layout, own: &[[Mean; 3]]) -> Vec<[Mean; 3]> {
    let n = side.images.len() as f64;
    let mut variances = variances(&side.images);
    if other.images.len() > 1 {
        for (variance, other) in variances.iter_mut().zip(self::variances(&other.images)) {
            *variance = std::array::from_fn(|channel| variance[channel].at_least(other[channel]));
        }
    }
    let covariances = layout.covariances(&variances);
    let mut pooled = own[..WAVES].to_vec();
    for (channel, covariance) in covariances.iter().enumerate() {
        let noisy: Vec<usize> = (0..WAVES).filter(|&i| covariance[i][i] > 0.0).collect();
        let count = noisy.len() as f64;
        let factor = noisy.iter().map(|&i| own[i][channel].variance * n / covariance[i][i]).sum::<f64>() / count;
        let correlation = |i: usize, j: usize| covariance[i][j].powi(2) / (covariance[i][i] * covariance[j][j]);
        let squares: f64 = noisy.iter().flat_map(|&i| noisy.iter().map(move |&j| correlation(i, j))).sum();
        for &i in &noisy {
            let mean = &mut pooled[i][channel];
            mean.variance = mean.variance.at_least(factor * covariance[i][i] / n);
            mean.dof = (n - 1.0) * count * count / squares;
        }
    }
    pooled
}

/// The variance of each pixel over the images.
pub fn variances(images: &[Image]) -> Vec<[f64; 3]> {
    let n = images.len() as f64;
    let variance = |pixel: usize, channel: usize| {
        let values = images.iter().map(|image| f64::from(image.pixels()[pixel][channel]));
        let mean = values.clone().sum::<f64>() / n;
        values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..images[0].pixels().len()).map(|pixel| [0, 1, 2].map(|channel| variance(pixel, channel))).collect()
}

/// The standard deviation of each pixel over the images.
pub fn deviations(images: &[Image]) -> Image {
    let deviations = variances(images).into_iter().map(|of| Rgb::from_array(of.map(|variance| variance.sqrt() as f32)));
    Image::from_pixels(images[0].width(), images[0].height(), deviations.collect())
}

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

/// Two images of a side that are more alike, or less, than independent images of one expectation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Related {
    /// Their numbers, from 0.
    pub images: [usize; 2],
    /// The correlation of their noise: near 0 for independent images of one expectation.
    pub correlation: f64,
    /// Corrected for the number of pairs.
    pub p: f64,
}

/// Images of which all pairs are tested; of more, neighbours are.
const ALL_PAIRS: usize = 64;
/// The products of fewer images follow from their variances.
const FEWEST: usize = 4;
/// A correlation of neighbours that changes the standard error of the mean by a twentieth: smaller ones do not matter.
const MATTERS: f64 = 0.05;
/// Values with noise that a block needs, for each image.
const VALUES: usize = 4;

/// The pair of images that is least likely among independent ones, if its corrected p is below `level`; nothing of three images.
pub fn related(images: &[Image], blocks: &Blocks, level: f64) -> Option<Related> {
    let n = images.len();
    let farthest = if n > ALL_PAIRS { 1 } else { n };
    let pairs: Vec<[usize; 2]> = (0..n).flat_map(|k| (k + 1..n.min(k + 1 + farthest)).map(move |l| [k, l])).collect();
    if n < FEWEST {
        return None;
    }
    let of_block = |pixels: &Vec<usize>| {
        let residuals = residuals(images, pixels);
        let (count, images) = (residuals[0].len(), n as f64);
        let product = |k: usize, l: usize| residuals[k].iter().zip(&residuals[l]).map(|(a, b)| a * b).sum::<f64>();
        let squares: Vec<f64> = (0..n).map(|k| product(k, k) / count as f64).collect();
        let all = squares.iter().sum::<f64>() / (1.0 - 1.0 / images) / (images * images);
        let variance = |k: usize| (squares[k] - all) / (1.0 - 2.0 / images);
        let of_pair = |&[k, l]: &[usize; 2]| {
            let expected = all - (variance(k) + variance(l)) / images;
            product(k, l) / count as f64 - expected
        };
        (count >= VALUES * n).then(|| pairs.iter().map(of_pair).collect::<Vec<f64>>())
    };
    let by_block: Vec<Vec<f64>> = blocks.pixels.par_iter().filter_map(of_block).collect();
    let test = |(i, images): (usize, &[usize; 2])| {
        let mean = Mean::of_replicates(&by_block.iter().map(|pairs| pairs[i]).collect::<Vec<f64>>())?;
        let p = Difference::of(mean, Mean::exact(0.0), 0.0).p() * pairs.len() as f64;
        Some(Related { images: *images, correlation: mean.value, p }).filter(|_| mean.value.abs() > MATTERS)
    };
    let least = pairs.iter().enumerate().filter_map(test).min_by(|a, b| a.p.total_cmp(&b.p));
    least.filter(|related| related.p < level)
}

/// By image, what the pixels and channels with noise differ from their means, by their standard deviations.
fn residuals(images: &[Image], pixels: &[usize]) -> Vec<Vec<f64>> {
    let n = images.len() as f64;
    let mut residuals = vec![Vec::new(); images.len()];
    for (pixel, channel) in pixels.iter().flat_map(|&pixel| (0..3).map(move |channel| (pixel, channel))) {
        let values = images.iter().map(|image| f64::from(image.pixels()[pixel][channel]));
        let mean = values.clone().sum::<f64>() / n;
        let deviation = (values.clone().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        if deviation > 0.0 {
            residuals.iter_mut().zip(values).for_each(|(of, value)| of.push((value - mean) / deviation));
        }
    }
    residuals
}
