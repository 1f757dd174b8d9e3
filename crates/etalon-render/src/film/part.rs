//! A render, or a part of one: the film, which samples are on it, and of what.

use super::accumulate::Film;
use super::ranges::Ranges;
use etalon_core::error::{Error, Result};
use etalon_core::raster::Metadata;
use std::ops::Range;

/// What has been rendered so far of an image.
///
/// ```
/// use etalon_core::math::Rgb;
/// use etalon_core::raster::Metadata;
/// use etalon_render::film::{Film, Part};
///
/// // The second half of 16 samples, which could be interrupted between any two samples and written to a file.
/// let mut part = Part::new(Film::new(4, 2, None)?, 16, "scene and settings", Metadata::default());
/// while let Some(task) = part.next(8..16) {
///     part.film.accumulate(|row| {
///         for x in 0..4 {
///             for sample in task.left(row.samples(x)) {
///                 row.add(x, Rgb::splat(sample as f32), &[]);
///             }
///         }
///     });
/// }
/// assert_eq!(part.ranges().to_string(), "8..16 of 16");
/// assert_eq!(part.film.image().get(0, 0), Rgb::splat(11.5));
/// # Ok::<(), etalon_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub film: Film,
    /// Which samples the film holds.
    pub(super) ranges: Ranges,
    /// Equal for parts of the same image: a hash of the scene and of all settings that change a sample.
    pub fingerprint: String,
    /// What the file says besides; see [`Part::write`] for the names that are taken.
    pub metadata: Metadata,
}

/// A range of samples that every pixel is to have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// The samples that every pixel had had before the range was begun.
    before: u32,
    range: Range<u32>,
}

impl Task {
    /// The samples that a pixel still needs that has had `samples` in all (see [`Row::samples`](super::Row::samples)).
    #[inline]
    #[must_use]
    pub fn left(&self, samples: u32) -> Range<u32> {
        self.range.start + samples.saturating_sub(self.before)..self.range.end
    }

    /// All samples of the task.
    #[must_use]
    pub fn range(&self) -> Range<u32> {
        self.range.clone()
    }
}

impl Part {
    /// A part without samples, of an image that is to have `spp` for each pixel.
    #[must_use]
    pub fn new(film: Film, spp: u32, fingerprint: impl Into<String>, metadata: Metadata) -> Self {
        Self { film, ranges: Ranges::none(spp), fingerprint: fingerprint.into(), metadata }
    }

    /// What is to be done next: the range at which the render was interrupted, then what is missing within `within`,
    /// one range after the other; nothing once all is done.
    pub fn next(&mut self, within: Range<u32>) -> Option<Task> {
        self.ranges = self.ranges();
        let before = self.ranges.samples();
        self.ranges.begin(&within).map(|range| Task { before, range })
    }

    /// Changes how many samples each pixel is to have in the end; no sample depends on it.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the part holds samples beyond.
    pub fn set_spp(&mut self, spp: u32) -> Result<()> {
        let ranges = self.ranges();
        let held = ranges.to_string();
        self.ranges = ranges.of(spp).ok_or_else(|| {
            Error::parameter("spp", format!("{spp} samples per pixel are fewer than there are: {held}"))
                .with_hint("samples cannot be taken away; render anew")
        })?;
        Ok(())
    }

    /// Which samples are on the film.
    #[must_use]
    pub fn ranges(&self) -> Ranges {
        let mut ranges = self.ranges.clone();
        let target = ranges.target();
        if ranges.begun().is_some() && self.film.pixels.iter().all(|p| p.n == target) {
            ranges.finish();
        }
        ranges
    }

    /// How many samples the film holds, all pixels together.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.film.pixels.iter().map(|pixel| u64::from(pixel.samples())).sum()
    }

    /// The mean number of camera paths of a sample; above 1 by adaptive sampling, `None` without a sample.
    #[must_use]
    pub fn camera_paths_per_sample(&self) -> Option<f64> {
        let paths: u64 = self.film.pixels.iter().map(|pixel| u64::from(pixel.camera_paths())).sum();
        let samples = self.count();
        (samples > 0).then(|| paths as f64 / samples as f64)
    }

    /// Whether the image has all its samples.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.ranges().is_complete()
    }
}
