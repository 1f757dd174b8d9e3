//! The film: samples are added up in f64, bad ones dropped, counted and located.

use crate::raster::{Image, Rgb};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

/// Samples that did not count because their radiance was impossible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Dropped {
    pub nonfinite: u64,
    pub negative: u64,
    /// The first pixel (in reading order) that lost a sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_pixel: Option<(usize, usize)>,
}

impl Dropped {
    /// How many samples were dropped in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.nonfinite + self.negative
    }

    fn merge(self, later: Self) -> Self {
        Self {
            nonfinite: self.nonfinite + later.nonfinite,
            negative: self.negative + later.negative,
            first_pixel: self.first_pixel.or(later.first_pixel),
        }
    }
}

/// Averages `radiance(x, y, sample)` over `spp` samples of every pixel, row by row in parallel.
///
/// A dropped sample counts as black: leaving it out of the mean would make the picture depend on where the trouble is.
pub fn expose(
    width: usize,
    height: usize,
    spp: u32,
    row_done: &(dyn Fn() + Sync),
    radiance: impl Fn(usize, usize, u32) -> Rgb + Sync,
) -> (Image, Dropped) {
    let mut image = Image::new(width, height);
    let rows = image.pixels_mut().par_chunks_mut(width).enumerate().map(|(y, row)| {
        let mut dropped = Dropped::default();
        for (x, pixel) in row.iter_mut().enumerate() {
            let mut sum = DVec3::ZERO;
            for sample in 0..spp {
                let value = radiance(x, y, sample);
                if !value.is_finite() {
                    dropped.nonfinite += 1;
                } else if value.min_element() < 0.0 {
                    dropped.negative += 1;
                } else {
                    sum += value.as_dvec3();
                    continue;
                }
                dropped.first_pixel.get_or_insert((x, y));
            }
            *pixel = (sum / f64::from(spp)).as_vec3();
        }
        row_done();
        dropped
    });
    let dropped = rows.collect::<Vec<_>>().into_iter().fold(Dropped::default(), Dropped::merge);
    (image, dropped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_samples_are_dropped_counted_and_located() {
        let (image, dropped) = expose(3, 2, 4, &|| (), |x, y, sample| match (x, y, sample) {
            (1, 0, 2) => Rgb::new(f32::NAN, 1.0, 1.0),
            (0, 1, _) => Rgb::new(1.0, -1.0, 1.0),
            _ => Rgb::ONE,
        });
        assert_eq!(dropped, Dropped { nonfinite: 1, negative: 4, first_pixel: Some((1, 0)) });
        assert_eq!(image.get(0, 0), Rgb::ONE);
        assert_eq!(image.get(1, 0), Rgb::splat(0.75));
        assert_eq!(image.get(0, 1), Rgb::ZERO);
    }

    #[test]
    fn small_contributions_are_not_lost_in_large_sums() {
        let (image, _) = expose(1, 1, 1 << 20, &|| (), |_, _, s| Rgb::splat(if s == 0 { 1e6 } else { 1e-3 }));
        let exact = (1e6 + f64::from((1 << 20) - 1) * f64::from(1e-3f32)) / f64::from(1 << 20);
        assert_eq!(image.get(0, 0).x, exact as f32);
    }
}
