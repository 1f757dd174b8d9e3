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
pub fn expose<W>(
    width: usize,
    height: usize,
    spp: u32,
    row_done: &(dyn Fn() + Sync),
    workspace: impl Fn() -> W + Sync + Send,
    trace: impl Fn(&mut W, usize, u64, usize, &mut dyn FnMut(usize, Rgb)) + Sync,
) -> (Image, Dropped) {
    let mut image = Image::new(width, height);
    let rows = image.pixels_mut().par_chunks_mut(width).enumerate().map_init(workspace, |work, (y, row)| {
        let mut dropped = Dropped::default();
        let mut sums = vec![DVec3::ZERO; width];
        let total = width as u64 * u64::from(spp);
        let mut first = 0;
        while first < total {
            let count = (total - first).min(super::lanes::LANES as u64) as usize;
            trace(work, y, first, count, &mut |x, value: Rgb| {
                if !value.is_finite() {
                    dropped.nonfinite += 1;
                } else if value.min_element() < 0.0 {
                    dropped.negative += 1;
                } else {
                    sums[x] += value.as_dvec3();
                    return;
                }
                dropped.first_pixel.get_or_insert((x, y));
            });
            first += count as u64;
        }
        for (pixel, sum) in row.iter_mut().zip(sums) {
            *pixel = (sum / f64::from(spp)).as_vec3();
        }
        row_done();
        dropped
    });
    let dropped = rows.collect::<Vec<_>>().into_iter().fold(Dropped::default(), Dropped::merge);
    (image, dropped)
}
