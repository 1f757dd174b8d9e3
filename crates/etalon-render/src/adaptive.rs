//! Adaptive sampling: how many camera paths each sample of a pixel has.
//!
//! The first samples of all pixels have one path each and estimate the variance of every pixel. Pixels are coloured like a chessboard: the
//! variance σ² of a path in a pixel is taken from neighbours of the other colour alone.
//!
//! With n paths in each sample of a pixel, the mean squared error of the image is in proportion to the mean of σ²/n, and its time to the mean
//! of n. The product of both is smallest for n = σ/λ with λ² = mean(σ²/n) / mean(n) (Neyman's allocation with the constraint n ≥ 1). The
//! numbers are powers of two up to 64. The iteration computes λ from the numbers that it has, and then new numbers. It starts from n = 1.
//!
//! Averages of a few neighbours are noisy, and later steps follow the noise. Cross-validation ends the iteration: after each step the
//! product is computed with the variances of the other pixels of the colour themselves, in place of the averages. A pixel stops at the
//! first step that does not lower it, and keeps the number of the step before.
//!
//! Nowhere is the variance of the pixel itself used: its number of paths does not depend on what its paths find, so that its mean is
//! unbiased.
//!
//! The samples after the first ones have more paths each until a pixel has n times as many paths as samples: then 16, 32, 64 … samples
//! have a power of two of paths, as many as Sobol' points are well distributed in.

use super::film::Pixel;
use rayon::prelude::*;

/// The first samples of every pixel, which have one path each in every render: a render of more samples may continue one of fewer.
pub const UNIFORM: u32 = 8;
/// From this sample on each has n paths; those between have 2n − 1.
const CAUGHT_UP: u32 = 2 * UNIFORM;
/// The largest n.
pub const MOST_PATHS: u32 = 64;
/// Neighbours of the other colour, by column and row. The variance of each counts by the inverse of its squared distance.
const NEIGHBOURS: [[isize; 2]; 12] =
    [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -2], [1, -2], [-1, 2], [1, 2], [-2, -1], [2, -1], [-2, 1], [2, 1]];

/// How many paths the samples of each pixel have.
#[derive(Debug, PartialEq, Eq)]
pub struct PathCounts(Vec<u8>);

impl PathCounts {
    /// Memory for each pixel while they are computed: its variance and number of paths; and for each of one colour its index, the estimate of
    /// its variance and its own variance, the least product with the number of paths, the error of the pixel and of those after it, and the
    /// numbers of this step and the next.
    pub const BYTES: usize = size_of::<f32>()
        + 1
        + (size_of::<usize>() + 2 * size_of::<f32>() + size_of::<(f64, u8)>() + 2 * size_of::<f64>() + 2).div_ceil(2);

    /// From the variances of the pixels of an image, row by row.
    pub fn new(variances: &[f32], width: usize) -> Self {
        let mut counts = vec![1; variances.len()];
        for colour in 0..2 {
            let is_of_colour = |pixel: &usize| (pixel % width + pixel / width) % 2 == colour;
            let mut pixels = Vec::with_capacity(variances.len().div_ceil(2));
            pixels.extend((0..variances.len()).filter(is_of_colour));
            let estimated: Vec<f32> = pixels.par_iter().map(|&pixel| around(variances, width, pixel)).collect();
            let own: Vec<f32> = pixels.iter().map(|&pixel| variances[pixel]).collect();
            pixels.iter().zip(cross_validated(&estimated, &own)).for_each(|(&pixel, count)| counts[pixel] = count);
        }
        Self(counts)
    }

    /// How many paths a sample of a pixel has, and the number of the first of them among the paths of the pixel.
    #[inline]
    pub fn of(&self, pixel: usize, sample: u32) -> (u32, u32) {
        let count = u32::from(self.0[pixel]);
        match sample {
            0..UNIFORM => (1, sample),
            UNIFORM..CAUGHT_UP => (2 * count - 1, UNIFORM + (sample - UNIFORM) * (2 * count - 1)),
            _ => (count, sample * count),
        }
    }
}

fn around(variances: &[f32], width: usize, pixel: usize) -> f32 {
    let height = variances.len() / width;
    let (mut sum, mut weights) = (0.0, 0.0);
    for [dx, dy] in NEIGHBOURS {
        let (x, y) = ((pixel % width).wrapping_add_signed(dx), (pixel / width).wrapping_add_signed(dy));
        if x < width && y < height {
            let weight = 1.0 / (dx * dx + dy * dy) as f64;
            sum += weight * f64::from(variances[y * width + x]);
            weights += weight;
        }
    }
    if weights > 0.0 { (sum / weights) as f32 } else { 0.0 }
}

/// The numbers of paths for pixels with these estimates of their variances, by cross-validation with their own variances.
fn cross_validated(estimated: &[f32], own: &[f32]) -> Vec<u8> {
    // For each pixel, the least product and the number of paths at that step; −∞ once it has stopped
    let mut best = vec![(f64::INFINITY, 1); own.len()];
    let mut counts = vec![1; own.len()];
    loop {
        let mut goes_on = false;
        let time: f64 = counts.iter().map(|&count| f64::from(count)).sum();
        let errors: Vec<f64> =
            own.iter().zip(&counts).map(|(&own, &count)| f64::from(own) / f64::from(count)).collect();
        // Sums without the pixel: a difference would keep a trace of a very large variance
        let mut after: Vec<f64> = vec![0.0; errors.len()];
        for i in (1..errors.len()).rev() {
            after[i - 1] = after[i] + errors[i];
        }
        let mut before = 0.0;
        for (i, (least, kept)) in best.iter_mut().enumerate() {
            let product = (before + after[i]) * (time - f64::from(counts[i]));
            if product < *least {
                (*least, *kept, goes_on) = (product, counts[i], true);
            } else {
                *least = f64::NEG_INFINITY;
            }
            before += errors[i];
        }
        if !goes_on {
            return best.into_iter().map(|(_, count)| count).collect();
        }
        counts = next(estimated, &counts);
    }
}

/// The numbers of paths for pixels with these variances.
pub(super) fn allocate(variances: &[f32]) -> Vec<u8> {
    let mut counts = vec![1; variances.len()];
    loop {
        let better = next(variances, &counts);
        if product(variances, &better) < product(variances, &counts) {
            counts = better;
        } else {
            return counts;
        }
    }
}

/// The sums of σ²/n and of n.
fn sums(variances: &[f32], counts: &[u8]) -> [f64; 2] {
    let errors = variances.iter().zip(counts).map(|(&variance, &count)| f64::from(variance) / f64::from(count));
    [errors.sum(), counts.iter().map(|&count| f64::from(count)).sum()]
}

/// Error times time.
fn product(variances: &[f32], counts: &[u8]) -> f64 {
    let [error, time] = sums(variances, counts);
    error * time
}

/// The numbers of paths that are best for the λ of these.
fn next(variances: &[f32], counts: &[u8]) -> Vec<u8> {
    let [error, time] = sums(variances, counts);
    variances.iter().map(|&variance| power_of_two(f64::from(variance) * time / error)).collect()
}

/// The power of two n for which ratio/n + n is smallest.
fn power_of_two(ratio: f64) -> u8 {
    let mut count = 1;
    // 2n is better than n where the ratio is above 2n².
    while count < MOST_PATHS && ratio > f64::from(2 * count * count) {
        count *= 2;
    }
    count as u8
}

/// The variance of a pixel's mean, all channels together; the largest number where its sums have left their range.
pub fn variance(pixel: &Pixel) -> f32 {
    pixel.standard_error().length_squared().min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::sampling::stream::{Independent, Stream};

    /// The numbers of paths for 12 × 12 pixels with these standard deviations.
    fn counts(deviation: impl Fn(usize) -> f32) -> Vec<u8> {
        let variance = |pixel: usize| {
            let numbers = (0..UNIFORM).map(|s| Independent::new(0, pixel as u64, s).pair(0)[0] as f32);
            let values: Vec<f32> = numbers.map(|u| deviation(pixel % 12) * (u - 0.5)).collect();
            let mean = values.iter().sum::<f32>() / UNIFORM as f32;
            values.iter().map(|v| (v - mean).powi(2)).sum()
        };
        PathCounts::new(&(0..144).map(variance).collect::<Vec<_>>(), 12).0
    }

    #[test]
    fn paths_of_a_pixel_do_not_depend_on_what_it_finds() {
        let variances: Vec<f32> = (0..144).map(|i| if i % 12 == 5 { 1.0 } else { 1e-4 }).collect();
        let counts = |variances: &[f32]| PathCounts::new(variances, 12).0;
        let before = counts(&variances);
        for pixel in 0..144 {
            for variance in [0.0, 1e-2, 1e6, f32::MAX] {
                let mut changed = variances.clone();
                changed[pixel] = variance;
                assert_eq!(counts(&changed)[pixel], before[pixel]);
            }
        }
        let other: Vec<f32> = (0..144).map(|i| if i % 12 == 8 { 1.0 } else { 1e-4 }).collect();
        assert_ne!(counts(&other), before);
        for (width, height) in [(1, 1), (1, 5), (5, 1), (2, 2)] {
            assert_eq!(PathCounts::new(&vec![1.0; width * height], width).0, vec![1; width * height]);
        }
    }

    #[test]
    fn noisy_pixels_get_more_paths() {
        let counts = counts(|x| if x == 5 { 1.0 } else { 0.01 });
        for (x, &count) in (0..12).cycle().zip(&counts) {
            // The neighbours are averaged.
            let is_right = match x {
                4..=6 => count > 1,
                3 | 7 => true,
                _ => count == 1,
            };
            assert!(is_right, "column {x}: {count}");
        }
        let variances: Vec<f32> = (0..144).map(|i| if i % 12 == 5 { 1.0 } else { 1e-4 }).collect();
        let ratio = product(&variances, &counts) / product(&variances, &[1; 144]);
        assert!(ratio < 0.7, "{ratio}");
    }

    #[test]
    fn equal_noise_and_no_noise_get_one_path_for_each_sample() {
        assert_eq!(counts(|_| 1.0), [1; 144]);
        assert_eq!(counts(|_| 0.0), [1; 144]);
    }

    #[test]
    fn known_variances_have_the_best_numbers() {
        let variances: Vec<f32> = (0..1000).map(|i| Independent::new(3, i, 0).pair(0)[0].powi(-2) as f32).collect();
        let counts = allocate(&variances);
        let least = product(&variances, &counts);
        assert!(least < 0.2 * product(&variances, &[1; 1000]));
        // No other number of one pixel is better.
        for i in 0..1000 {
            for other in [counts[i] / 2, counts[i].saturating_mul(2)].into_iter().filter(|n| (1..=64).contains(n)) {
                let mut changed = counts.clone();
                changed[i] = other;
                assert!(product(&variances, &changed) >= least * (1.0 - 1e-5));
            }
        }
    }

    #[test]
    fn numbers_do_not_follow_noise() {
        // Estimates that say nothing of the pixels
        let of = |seed: u64| (0..1000).map(|i| 1e4f32.powf(Independent::new(seed, i, 0).pair(0)[0] as f32)).collect();
        let [estimated, own]: [Vec<f32>; 2] = [of(1), of(2)];
        let over_uniform = |counts: &[u8]| product(&own, counts) / product(&own, &[1; 1000]);
        let [tested, trusting] =
            [cross_validated(&estimated, &own), allocate(&estimated)].map(|counts| over_uniform(&counts));
        assert!(tested < 1.05 && trusting > 2.0, "{tested} {trusting}");
    }

    #[test]
    fn every_path_of_a_pixel_has_a_number_of_its_own() {
        let counts = PathCounts(vec![1, 4, 64]);
        for pixel in 0..3 {
            let mut next = 0;
            for sample in 0..40 {
                let (count, first) = counts.of(pixel, sample);
                assert_eq!(first, next);
                next = first + count;
            }
            assert_eq!(next, 40 * [1, 4, 64][pixel]);
        }
    }
}
