//! Adaptive sampling: how many camera paths each sample of a pixel has.
//!
//! A pilot render estimates the variance σ² of every pixel. The image does not contain its paths: the number of paths in a pixel
//! does not depend on what these find, so that every pixel is unbiased.
//!
//! With n paths in a pixel, the mean squared error of the image is in proportion to the mean of σ²/n, and its time to the mean of n. The
//! product of both is smallest for n = σ/λ with λ² = mean(σ²/n) / mean(n) (Neyman's allocation with the constraint n ≥ 1). The iteration computes λ from the
//! numbers that it has, and then new numbers, rounded to powers of two. It starts from n = 1.
//!
//! Variances from few paths are noisy. Therefore each half of the pilot render tests the numbers that follow from the other half, and the iteration
//! ends with the step that does not make their product smaller by 5 %.

use super::film::{Pixel, Row};
use rayon::prelude::*;

/// The first samples of every pixel have one path each in every render: one of so few samples gains less than the pilot render takes, and a
/// render of more samples may continue it.
pub const UNIFORM: u32 = 8;
/// The samples of each half of the pilot render.
pub const PILOT: u32 = 4;
/// The largest number of paths in a sample.
pub const MOST_PATHS: u32 = 64;
/// The iteration goes on while a step reduces the product below this share of its last value.
const WORTH: f64 = 0.95;

/// The pilot render: two halves with independent random numbers, of each the variances of the pixels in the rows that are done.
#[derive(Debug, Default)]
pub struct Pilot([Vec<Option<Vec<f32>>>; 2]);

impl Pilot {
    /// Renders what is missing of an image: `samples` adds the first [`PILOT`] samples of a half to all pixels of a row, or says
    /// that it was stopped.
    pub fn render(&mut self, (width, height): (usize, usize), samples: impl Fn(u64, &mut Row) -> bool + Sync) {
        for (half, number) in self.0.iter_mut().zip(0..) {
            half.resize(height, None);
            half.par_iter_mut().enumerate().filter(|(_, variances)| variances.is_none()).for_each(|(y, variances)| {
                let mut pixels = vec![Pixel::default(); width];
                if samples(number, &mut Row::new(y, &mut pixels, &mut [])) {
                    *variances = Some(pixels.iter().map(variance).collect());
                }
            });
        }
    }

    /// The numbers of paths that follow; `None` while rows are missing.
    pub fn path_counts(&self) -> Option<PathCounts> {
        let [a, b] = &self.0;
        let whole = |half: &[Option<Vec<f32>>]| half.iter().cloned().collect::<Option<Vec<_>>>();
        Some(PathCounts::new(&whole(a)?, &whole(b)?))
    }
}

/// How many paths the samples of each pixel have.
#[derive(Debug, PartialEq, Eq)]
pub struct PathCounts(Vec<u8>);

impl PathCounts {
    /// Memory for each pixel while they are computed: variances of the halves twice, their averages, and numbers of paths.
    pub const BYTES: usize = (4 + 3) * size_of::<f32>() + 5;

    /// From the variances of the two halves of a pilot render, row by row.
    fn new(a: &[Vec<f32>], b: &[Vec<f32>]) -> Self {
        let [a, b] = [a, b].map(smooth);
        let both: Vec<f32> = a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b)).collect();
        let uniform = || vec![1; both.len()];
        let (mut accepted, mut candidate, mut halves, mut least) =
            (uniform(), uniform(), [uniform(), uniform()], f64::INFINITY);
        loop {
            let crossed = product(&a, &halves[1]) + product(&b, &halves[0]);
            if crossed == 0.0 || crossed > WORTH * least {
                return Self(accepted);
            }
            least = crossed;
            accepted = candidate;
            candidate = next(&both, &accepted);
            halves = [next(&a, &halves[0]), next(&b, &halves[1])];
        }
    }

    /// How many paths a sample of a pixel has, and the number of the first of them among the paths of the pixel.
    #[inline]
    pub fn of(&self, pixel: usize, sample: u32) -> (u32, u32) {
        let later = sample.saturating_sub(UNIFORM);
        let count = if sample < UNIFORM { 1 } else { u32::from(self.0[pixel]) };
        (count, sample + later * (count - 1))
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

/// Averages over 3 × 3 pixels: few samples may miss what is rare.
fn smooth(rows: &[Vec<f32>]) -> Vec<f32> {
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let mean = |y: usize, x: usize| {
        let (rows, columns) = (&rows[around(y, rows.len())], around(x, rows[y].len()));
        let count = rows.len() * columns.len();
        let sum: f64 = rows.iter().flat_map(|row| &row[columns.clone()]).map(|&v| f64::from(v)).sum();
        (sum / count as f64) as f32
    };
    let row = |y: usize| (0..rows[y].len()).map(|x| mean(y, x)).collect::<Vec<_>>();
    (0..rows.len()).into_par_iter().flat_map_iter(row).collect()
}

/// The variance of a pixel's mean, all channels together; the largest number where its sums have left their range.
fn variance(pixel: &Pixel) -> f32 {
    pixel.standard_error().length_squared().min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::sampling::stream::{Independent, Stream};

    /// The numbers of paths for 12 × 12 pixels with these standard deviations.
    fn counts(deviation: impl Fn(usize) -> f32 + Sync) -> Vec<u8> {
        let mut pilot = Pilot::default();
        let samples = |half: u64, row: &mut Row| {
            for (x, s) in (0..12).flat_map(|x| (0..PILOT).map(move |s| (x, s))) {
                let [u, _] = Independent::new(half, (12 * row.y() + x) as u64, s).pair(0);
                row.add(x, Rgb::splat(1.0 + deviation(x) * (u as f32 - 0.5)), &[]);
            }
            true
        };
        pilot.render((12, 12), |half, row| row.y() < 5 && samples(half, row));
        assert_eq!(pilot.path_counts(), None, "stopped");
        pilot.render((12, 12), samples);
        pilot.path_counts().unwrap().0
    }

    #[test]
    fn noisy_pixels_get_more_paths() {
        let counts = counts(|x| if x == 5 { 1.0 } else { 0.01 });
        for (x, &count) in (0..12).cycle().zip(&counts) {
            // The neighbours are averaged.
            assert!(if (4..=6).contains(&x) { count > 1 } else { count == 1 }, "column {x}: {count}");
        }
        let variances: Vec<f32> = (0..144).map(|i| if i % 12 == 5 { 1.0 } else { 1e-4 }).collect();
        assert!(product(&variances, &counts) < 0.5 * product(&variances, &[1; 144]));
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
            assert_eq!(next, UNIFORM + 32 * [1, 4, 64][pixel]);
        }
    }
}
