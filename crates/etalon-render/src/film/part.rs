//! A render, or a part of one: the film, which samples are on it, and of what; and parts put together.

use super::accumulate::Film;
use super::ranges::{Ranges, list};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{BUILD_NAME, Metadata};
use std::ops::Range;
use std::path::{Path, PathBuf};

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
    pub fn left(&self, samples: u32) -> Range<u32> {
        self.range.start + samples.saturating_sub(self.before)..self.range.end
    }

    pub fn range(&self) -> Range<u32> {
        self.range.clone()
    }
}

impl Part {
    /// A part without samples, of an image that is to have `spp` for each pixel.
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

    pub fn ranges(&self) -> Ranges {
        let mut ranges = self.ranges.clone();
        let target = ranges.target();
        if ranges.begun().is_some() && self.film.pixels.iter().all(|p| p.n == target) {
            ranges.finish();
        }
        ranges
    }

    /// How many samples the film holds, all pixels together.
    pub fn count(&self) -> u64 {
        self.film.pixels.iter().map(|pixel| u64::from(pixel.samples())).sum()
    }

    /// The mean number of camera paths of a sample; above 1 by adaptive sampling, `None` without a sample.
    pub fn camera_paths_per_sample(&self) -> Option<f64> {
        let paths: u64 = self.film.pixels.iter().map(|pixel| u64::from(pixel.camera_paths())).sum();
        let samples = self.count();
        (samples > 0).then(|| paths as f64 / samples as f64)
    }

    /// Whether the image has all its samples.
    pub fn is_complete(&self) -> bool {
        self.ranges().is_complete()
    }
}

/// Reads the parts of a render from files, one after the other, and merges them. Their order does not matter.
///
/// Samples may be missing, also in between; see [`Ranges::missing`]. Of the metadata those entries are kept on which
/// all parts agree.
///
/// # Errors
/// [`Error::Input`], naming two files, when they are parts of different images, hold the same samples, or were both
/// interrupted (a pixel's count cannot say of which range it has how much). [`Error::Parameter`] without any file.
/// Those of [`Part::read`].
pub fn merge_files(paths: &[PathBuf]) -> Result<Part> {
    let Some((first, others)) = paths.split_first() else {
        return Err(Error::parameter("parts", "there is nothing to merge"));
    };
    let mut merged = Part::read(first)?;
    let mut seen: Vec<(&Path, Ranges)> = vec![(first, merged.ranges())];
    for path in others {
        interrupt::check()?;
        let part = Part::read(path)?;
        same_picture(first, &merged, path, &part)?;
        let ranges = part.ranges();
        for (other, theirs) in &seen {
            apart(other, theirs, path, &ranges)?;
        }
        merged.add(part)?;
        seen.push((path, ranges));
    }
    Ok(merged)
}

impl Part {
    /// Adds a part of the same image with other samples.
    fn add(&mut self, other: Part) -> Result<()> {
        self.ranges = self.ranges();
        self.film.merge(&other.film)?;
        self.ranges.merge(other.ranges());
        let agreed = self.metadata.entries().iter().filter(|entry| other.metadata.entries().contains(entry));
        self.metadata = agreed.fold(Metadata::default(), |all, (name, value)| all.with(name, value));
        Ok(())
    }
}

/// An error that says in what two files disagree, if they are parts of different images.
fn same_picture(path_a: &Path, a: &Part, path_b: &Path, b: &Part) -> Result<()> {
    let size = |part: &Part| format!("{}x{}", part.film.width(), part.film.height());
    let samples = |part: &Part| part.ranges.spp().to_string();
    let paths = |part: &Part| part.film.classes().map_or("no".into(), |c| c.count().to_string());
    let build = |part: &Part| part.metadata.get(BUILD_NAME).unwrap_or("unknown").to_owned();
    let differences: Vec<String> = [
        ("pixels", size(a), size(b)),
        ("samples per pixel", samples(a), samples(b)),
        ("path classes", paths(a), paths(b)),
        (BUILD_NAME, build(a), build(b)),
        ("fingerprint of scene and settings", a.fingerprint.clone(), b.fingerprint.clone()),
    ]
    .into_iter()
    .filter(|(_, a, b)| a != b)
    .map(|(what, a, b)| format!("{what}: {b} here, {a} there"))
    .collect();
    if differences.is_empty() {
        return Ok(());
    }
    let message = format!("not of the same render as {} ({})", path_a.display(), differences.join("; "));
    Err(Error::input(path_b, message).with_hint("render all parts with the same scene, flags and version"))
}

/// An error if two parts cannot be distinguished.
fn apart(path_a: &Path, a: &Ranges, path_b: &Path, b: &Ranges) -> Result<()> {
    let other = path_a.display();
    if let Some(twice) = a.overlap(b) {
        return Err(Error::input(path_b, format!("samples {} are also in {other}", list(&[twice])))
            .with_hint("give each part once, and make all parts with the same number of shards"));
    }
    if let (Some(p), Some(q)) = (a.begun(), b.begun()) {
        let message = format!("interrupted in samples {}, and {other} in {}", list(&[q]), list(&[p]));
        return Err(Error::input(path_b, message).with_hint("finish one of them first"));
    }
    Ok(())
}
