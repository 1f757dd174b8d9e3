//! Adaptive sampling: how many camera paths each sample of a pixel has.
//!
//! The first samples of all pixels have one path each and estimate the variance σ² of every pixel. Pixels are coloured like a
//! chessboard: the number of paths in a pixel follows from the variances of the other colour alone. It does not depend on what
//! the paths of the pixel find, so that every pixel is unbiased.
//!
//! With n paths in a pixel, the mean squared error of the image is in proportion to the mean of σ²/n, and its time to the mean of n. The
//! product of both is smallest for n = σ/λ with λ² = mean(σ²/n) / mean(n) (Neyman's allocation with the constraint n ≥ 1). The iteration computes λ from the
//! numbers that it has, and then new numbers, rounded to powers of two. It starts from n = 1.
//!
//! The samples after the first ones have more paths each until a pixel has n times as many paths as samples: then 16, 32, 64 … samples
//! have a power of two of paths, as many as Sobol' points are well distributed in.
//!
//! Variances from few paths are noisy. Therefore each half of the neighbours tests the numbers that follow from the other half, and the
//! iteration ends with the step that does not make their product smaller.

use super::film::Pixel;
use rayon::prelude::*;

/// The first samples of every pixel, which have one path each in every render: a render of more samples may continue one of fewer.
pub const UNIFORM: u32 = 8;
/// From this sample on each has n paths; those between have 2n − 1.
const CAUGHT_UP: u32 = 2 * UNIFORM;
/// The largest n.
pub const MOST_PATHS: u32 = 64;
/// Neighbours of the other colour, by column and row, in two halves that mirror each other: an edge through a pixel passes both.
/// The variance of a neighbour counts by the inverse of its squared distance.
const NEIGHBOURS: [[[isize; 2]; 6]; 2] =
    [[[-1, 0], [0, -1], [-1, -2], [1, -2], [-2, -1], [-2, 1]], [[1, 0], [0, 1], [1, 2], [-1, 2], [2, 1], [2, -1]]];

/// How many paths the samples of each pixel have.
#[derive(Debug, PartialEq, Eq)]
pub struct PathCounts(Vec<u8>);

impl PathCounts {
    /// Memory for each pixel while they are computed: variances, their averages over the neighbours, and numbers of paths.
    pub const BYTES: usize = 4 * size_of::<f32>() + 5;

    /// From the variances of the pixels of an image, row by row.
    pub fn new(variances: &[f32], width: usize) -> Self {
        let mut counts = vec![1; variances.len()];
        for colour in 0..2 {
            let is_of_colour = |pixel: &usize| (pixel % width + pixel / width) % 2 == colour;
            let pixels: Vec<usize> = (0..variances.len()).filter(is_of_colour).collect();
            let halves = pixels.par_iter().map(|&pixel| neighbours(variances, width, pixel));
            let (a, b): (Vec<f32>, Vec<f32>) = halves.unzip();
            pixels.iter().zip(allocate(&a, &b)).for_each(|(&pixel, count)| counts[pixel] = count);
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

/// The averages of the variances around a pixel, one for each half of the neighbours; where an image has only one half of them, twice
/// the same.
fn neighbours(variances: &[f32], width: usize, pixel: usize) -> (f32, f32) {
    let height = variances.len() / width;
    let [a, b] = NEIGHBOURS.map(|offsets| {
        let (mut sum, mut count) = (0.0, 0.0);
        for [dx, dy] in offsets {
            let (x, y) = ((pixel % width).wrapping_add_signed(dx), (pixel / width).wrapping_add_signed(dy));
            if x < width && y < height {
                let weight = 1.0 / (dx * dx + dy * dy) as f64;
                sum += weight * f64::from(variances[y * width + x]);
                count += weight;
            }
        }
        (count > 0.0).then_some((sum / count) as f32)
    });
    match (a, b) {
        (Some(a), Some(b)) => (a, b),
        (Some(only), None) | (None, Some(only)) => (only, only),
        (None, None) => (0.0, 0.0),
    }
}

/// The numbers of paths for pixels whose variances two halves estimate.
pub(super) fn allocate(a: &[f32], b: &[f32]) -> Vec<u8> {
    let both: Vec<f32> = a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
    let uniform = || vec![1; both.len()];
    let (mut accepted, mut candidate, mut halves, mut least) =
        (uniform(), uniform(), [uniform(), uniform()], f64::INFINITY);
    loop {
        let crossed = product(a, &halves[1]) + product(b, &halves[0]);
        if crossed >= least {
            return accepted;
        }
        least = crossed;
        accepted = candidate;
        candidate = next(&both, &accepted);
        halves = [next(a, &halves[0]), next(b, &halves[1])];
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

/// Numbers of paths with a smaller product of error and time than these.
fn next(variances: &[f32], counts: &[u8]) -> Vec<u8> {
    let [error, time] = sums(variances, counts);
    variances.iter().map(|&variance| best(f64::from(variance) * time / error)).collect()
}

/// The power of two n for which ratio/n + n is smallest.
fn best(ratio: f64) -> u8 {
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
    fn paths_of_a_pixel_do_not_depend_on_what_its_colour_finds() {
        let variances: Vec<f32> = (0..144).map(|i| if i % 12 == 5 { 1.0 } else { 1e-4 }).collect();
        let is_of_first = |i: &usize| (i % 12 + i / 12).is_multiple_of(2);
        let changed: Vec<f32> = (0..144).map(|i| if is_of_first(&i) { 1e6 } else { variances[i] }).collect();
        let [before, after] = [variances, changed].map(|variances| PathCounts::new(&variances, 12).0);
        assert!((0..144).filter(is_of_first).all(|i| before[i] == after[i]));
        assert_ne!(before, after);
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
    fn each_step_has_a_smaller_product() {
        let variances: Vec<f32> = (0..1000).map(|i| Independent::new(3, i, 0).pair(0)[0].powi(-2) as f32).collect();
        let (mut before, mut least) = (vec![1; 1000], f64::INFINITY);
        while product(&variances, &before) < least {
            least = product(&variances, &before);
            before = next(&variances, &before);
        }
        assert!(least < 0.2 * product(&variances, &[1; 1000]));
        // No other number of one pixel is better.
        for i in 0..1000 {
            for other in [before[i] / 2, before[i].saturating_mul(2)].into_iter().filter(|n| (1..=64).contains(n)) {
                let mut changed = before.clone();
                changed[i] = other;
                assert!(product(&variances, &changed) >= least * (1.0 - 1e-3));
            }
        }
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
