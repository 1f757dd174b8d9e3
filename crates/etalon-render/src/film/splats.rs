//! Contributions of light paths.
//!
//! Light paths are traced with the samples of one pixel and contribute to any pixel. They are scaled so that the mean of a
//! pixel is the sum of its contributions over the number of samples per pixel, whichever pixels the paths belong to.
//!
//! Contributions of one path to several pixels depend on each other. What stands for the variance of a pixel is a bound: for a path that contributes
//! xₖ ≥ 0 to pixel k, (Σ aₖ xₖ)² ≤ Σ aₖ² xₖ X with X = Σ xₖ, for any numbers aₖ (Cauchy's inequality). With xₖ X in place of xₖ² for each
//! path, the variance of any weighted sum of pixels is at most what it would be if pixels were independent.

use super::fixed::{Fixed, FixedRgb};
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::memory;
use etalon_core::sampling::prefetch;

/// A contribution of a light path to a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splat {
    /// The number of the light path, among those that are added together.
    pub path: usize,
    /// Column and row.
    pub pixel: [u32; 2],
    /// The number of the path's class; 0 without classes.
    pub class: usize,
    /// What is added to the pixel.
    pub value: Rgb,
    /// What it takes off the variance of the camera samples at the pixel, which would find the light alone without it.
    pub spared: f32,
}

/// The sums of the contributions to each pixel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Splats {
    /// Row by row from the top.
    pub pixels: Vec<Received>,
    /// The same by path class, all classes of a pixel side by side; empty without classes.
    pub classes: Vec<FixedRgb>,
}

/// A contribution, and the sum of all contributions of its path.
pub(super) type OfPath = (Splat, Rgb);

/// The sums of contributions to a pixel, and of their products with the contributions of their paths to all pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Received {
    /// Σ x per channel.
    pub sum: FixedRgb,
    /// Σ x X per channel: where a path contributes to one pixel only, Σ x².
    pub square: FixedRgb,
}

/// How many contributions are prefetched at a time.
const AHEAD: usize = 8;

impl Splats {
    /// Zero sums for a film of this size.
    ///
    /// # Errors
    /// [`Error::Memory`](etalon_core::Error::Memory) when they do not fit.
    pub fn new([width, height]: [usize; 2], classes: usize) -> Result<Self> {
        let (pixels, sums) = (width * height, width * height * classes);
        let what = || format!("the light paths on a film of {width}x{height} pixels");
        Ok(Self {
            pixels: memory::filled(pixels, Received::default(), what)?,
            classes: memory::filled(sums, Default::default(), what)?,
        })
    }

    /// Adds light to the pixels of a film of that width.
    pub fn add(&mut self, splats: &[OfPath], width: usize) {
        let classes = self.classes.len() / self.pixels.len();
        let place = |splat: &Splat| splat.pixel[1] as usize * width + splat.pixel[0] as usize;
        for (k, (splat, of_path)) in splats.iter().enumerate() {
            // The pixels are scattered over memory: prefetch the next ones.
            if let Some((later, _)) = splats.get(k + AHEAD) {
                let i = place(later);
                prefetch(&self.pixels, i);
                prefetch(&self.pixels[i].square.0, 2);
            }
            let i = place(splat);
            let to = &mut self.pixels[i];
            to.sum += FixedRgb::of(splat.value);
            to.square += FixedRgb::product_of(splat.value, *of_path);
            if classes > 0 {
                self.classes[i * classes + splat.class] += FixedRgb::of(splat.value);
            }
        }
    }

    pub fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.pixels.iter_mut().zip(&other.pixels) {
            mine.sum += theirs.sum;
            mine.square += theirs.square;
        }
        self.classes.iter_mut().zip(&other.classes).for_each(|(mine, theirs)| *mine += *theirs);
    }
}

impl Received {
    /// The variance of the light of a pixel after `paths` light paths for each of `pixels`, most of which contribute nothing here; added over
    /// pixels as if they were independent, a bound for their sum.
    pub fn variance(&self, paths: f64, pixels: f64) -> [f64; 3] {
        std::array::from_fn(|c| {
            if self.square.0[c] == Fixed::MAX {
                return f64::INFINITY;
            }
            let sum = self.sum.0[c].to_f64();
            (self.square.0[c].to_f64() - sum * sum / (paths * pixels)).max(0.0) / (paths * paths)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;

    #[test]
    fn the_error_of_a_sum_of_pixels_that_one_light_path_reaches_is_not_understated() {
        // One path in two brings light to two pixels of 64 at once, so that the error of their sum is twice that of one.
        let (n, value) = (1000, Rgb::splat(2.0));
        let mut film = Film::new(64, 1, None).unwrap().with_splats().unwrap();
        film.accumulate(|row| {
            for (x, s) in (0..64).flat_map(|x| (0..n).map(move |s| (x, s))) {
                row.add(x, Rgb::ZERO, &[]);
                if x == 7 && s % 2 == 0 {
                    let splat = |at| Splat { path: s as usize % 3, pixel: [at, 0], class: 0, value, spared: 0.0 };
                    row.splat(&[splat(0), splat(1)]);
                }
            }
        });
        let errors: Vec<f32> = film.estimates().take(2).map(|estimate| estimate.error.x).collect();
        let of_sum = 2.0 * 2.0 * (0.5 * n as f32).sqrt() / n as f32;
        let by_pixels = errors[0].hypot(errors[1]);
        assert!((by_pixels / of_sum - 1.0).abs() < 0.01, "{of_sum} {by_pixels}");
    }
}
