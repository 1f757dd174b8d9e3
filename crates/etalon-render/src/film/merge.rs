//! Parts of a render put together.

use super::part::Part;
use super::ranges::{Ranges, list};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{BUILD_NAME, Metadata};
use std::path::{Path, PathBuf};

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
