//! Parts of a render as OpenEXR files: an image for viewers, and the sums to continue from, as channels of unsigned integers: four words
//! of 32 bits for each number.

use super::accumulate::Film;
use super::classes::PathClasses;
use super::fixed::Fixed;
use super::part::Part;
use super::pixel::{Dropped, Pixel};
use super::ranges::Ranges;
use etalon_core::error::{Error, Result};
use etalon_core::raster::{Channel, ExrFile, Layer, Metadata, Precision, Samples, write_exr_channels};
use std::path::Path;

/// Names of the attributes that a part writes by itself.
const SAMPLES: &str = "samples";
const FINGERPRINT: &str = "fingerprint";
const PATHS: &str = "paths";
const NONFINITE: &str = "droppedNonfinite";
const NEGATIVE: &str = "droppedNegative";
const FAINT: &str = "droppedFaint";
const FIRST: &str = "droppedFirst";
/// What the layer `error` is good for: name and value of the attribute that says so.
pub const ERRORS_OF_SUMS: [&str; 2] = ["errors", "of pixels, and bounds for sums of pixels"];

impl Part {
    /// Writes the part as an OpenEXR file of 32-bit floats. Its layers:
    ///
    /// | layer | what it holds |
    /// |---|---|
    /// | (unnamed) | the mean of the samples so far: the image |
    /// | `error` | its standard error (see [`Pixel::standard_error`](super::Pixel::standard_error)) |
    /// | `LE`, `LDE` … `rest` | the light by path class, if the film has it; added up in the order of the attribute `paths` they are the image |
    /// | `sums`, `squares`, `sums.LDE` … | unless the image is complete: counts and sums, in words of 32 bits |
    /// | `splats.sums` … | the same of the contributions of light paths, if there were any |
    ///
    /// Besides the metadata there are the attributes `samples` (which of how many), `fingerprint`, `paths`, `errors`,
    /// `droppedNonfinite`, `droppedNegative`, `droppedFaint` and `droppedFirst`; metadata must not have these names.
    ///
    /// # Errors
    /// Those of [`write_exr`](etalon_core::raster::write_exr).
    pub fn write(&self, path: &Path) -> Result<()> {
        self.write_with(path, !self.is_complete())
    }

    /// [`Part::write`] with the sums even of a complete image, so that samples can be added to it.
    ///
    /// # Errors
    /// Those of [`Part::write`].
    pub fn save(&self, path: &Path) -> Result<()> {
        self.write_with(path, true)
    }

    fn write_with(&self, path: &Path, keep_sums: bool) -> Result<()> {
        let film = &self.film;
        let (image, error, paths) = (film.image(), film.standard_error(), film.path_layers());
        let named = paths.iter().map(|(name, image)| Layer { name, image });
        let layers =
            [Layer { name: "", image: &image }, Layer { name: "error", image: &error }].into_iter().chain(named);
        let mut channels: Vec<Channel<'_>> = layers.flat_map(|layer| layer.channels(Precision::Float)).collect();
        if keep_sums {
            channels.extend(slots(film.classes(), film.splats.is_some()).into_iter().map(|(name, slot)| Channel {
                name,
                samples: Samples::Unsigned(Box::new(move |i| slot.get(film, i))),
            }));
        }
        write_exr_channels(path, (film.width(), film.height()), channels, &self.attributes())
    }

    fn attributes(&self) -> Metadata {
        let dropped = self.film.dropped;
        let mut attributes = self.metadata.clone().with(SAMPLES, self.ranges()).with(FINGERPRINT, &self.fingerprint);
        if let Some(classes) = self.film.classes() {
            attributes = attributes.with(PATHS, classes.names().collect::<Vec<_>>().join(" "));
        }
        attributes = attributes
            .with(ERRORS_OF_SUMS[0], ERRORS_OF_SUMS[1])
            .with(NONFINITE, dropped.nonfinite)
            .with(NEGATIVE, dropped.negative)
            .with(FAINT, dropped.faint);
        match dropped.first_pixel {
            Some((x, y)) => attributes.with(FIRST, format!("{x} {y}")),
            None => attributes,
        }
    }

    /// Reads a part, to continue it or to merge it.
    ///
    /// # Errors
    /// [`Error::Input`] for a file without sums (a complete image that [`Part::write`] wrote has none) and for a
    /// damaged one; those of [`ExrFile`].
    pub fn read(path: &Path) -> Result<Self> {
        let file = ExrFile::open(path)?;
        let attributes = file.metadata();
        let (Some(samples), Some(fingerprint)) = (attributes.get(SAMPLES), attributes.get(FINGERPRINT)) else {
            return Err(Error::input(path, "this is no part of a render: it does not say which samples it holds")
                .with_hint("parts are written by `etalon render`, for example with `shard`"));
        };
        let wrong = |name: &str| Error::input(path, format!("the attribute {name:?} makes no sense"));
        let ranges = Ranges::parse(samples).ok_or_else(|| wrong(SAMPLES))?;
        let classes = match attributes.get(PATHS) {
            Some(names) => Some(PathClasses::parse(names).ok_or_else(|| wrong(PATHS))?),
            None => None,
        };
        let splats = file.counts("splats.sums.R0");
        let (names, slots): (Vec<String>, Vec<_>) = slots(classes, splats).into_iter().unzip();
        if ranges.is_complete() && !file.counts(&names[0]) {
            return Err(Error::input(path, format!("the render is complete: all {} samples are there", ranges.spp()))
                .with_hint("a complete image has no sums, unless it was rendered with `resume`"));
        }
        let dropped = dropped(attributes).ok_or_else(|| wrong("dropped…"))?;
        let (width, height) = file.size()?;
        let film = || {
            let film = Film::new(width, height, classes);
            if splats { film.and_then(Film::with_splats) } else { film }
        };
        let mut film =
            file.unsigned(&names, film, |film, channel, pixel, word| slots[channel].set(film, pixel, word))?;
        film.dropped = dropped;
        let counts = ranges.samples()..=ranges.target();
        if let Some(i) = film.pixels.iter().position(|p| !counts.contains(&p.n) || p.camera_paths < p.n) {
            let (x, y, Pixel { n, camera_paths, .. }) = (i % width, i / width, film.pixels[i]);
            return Err(Error::input(
                path,
                format!("pixel ({x}, {y}) has {n} samples of {camera_paths} paths, not {ranges}"),
            )
            .with_hint("the file is damaged; render the part again"));
        }
        let own = [SAMPLES, FINGERPRINT, PATHS, ERRORS_OF_SUMS[0], NONFINITE, NEGATIVE, FAINT, FIRST];
        let others = attributes.entries().iter().filter(|(name, _)| !own.contains(&name.as_str()));
        let metadata = others.fold(Metadata::default(), |all, (name, value)| all.with(name, value));
        Ok(Self { film, fingerprint: fingerprint.into(), ranges, metadata })
    }
}

fn dropped(attributes: &Metadata) -> Option<Dropped> {
    let count = |name| attributes.get(name)?.parse().ok();
    let first_pixel = match attributes.get(FIRST) {
        Some(text) => {
            let (x, y) = text.split_once(' ')?;
            Some((x.parse().ok()?, y.parse().ok()?))
        }
        None => None,
    };
    // Older files do not count faint samples.
    let faint = if attributes.get(FAINT).is_some() { count(FAINT)? } else { 0 };
    Some(Dropped { nonfinite: count(NONFINITE)?, negative: count(NEGATIVE)?, faint, first_pixel })
}

/// One word of the film's state in every pixel.
#[derive(Debug, Clone, Copy)]
enum Slot {
    Count,
    CameraPaths,
    /// A word of a channel's sum; word 0 is the lowest.
    Sum(usize, usize),
    /// A word of a channel's sum of squares.
    Square(usize, usize),
    /// A word of a path class's sum in a channel.
    Path(usize, usize, usize),
    /// The same three of the contributions of light paths.
    SplatSum(usize, usize),
    SplatSquare(usize, usize),
    SplatPath(usize, usize, usize),
}

/// All words with the names of their channels: `sums.n`, `sums.cameraPaths`, `sums.R0` … `sums.B3`, `squares.R0` …, `sums.LDE.R0` …; with
/// `splats`, also `splats.sums.R0` and so on.
fn slots(classes: Option<PathClasses>, splats: bool) -> Vec<(String, Slot)> {
    type Kinds = (fn(usize, usize) -> Slot, fn(usize, usize) -> Slot, fn(usize, usize, usize) -> Slot);
    let own: Kinds = (Slot::Sum, Slot::Square, Slot::Path);
    let others: Kinds = (Slot::SplatSum, Slot::SplatSquare, Slot::SplatPath);
    let words = || (0..3).flat_map(|c| (0..4).map(move |k| (c, k, format!("{}{k}", ["R", "G", "B"][c]))));
    let mut slots = vec![("sums.n".to_owned(), Slot::Count), ("sums.cameraPaths".to_owned(), Slot::CameraPaths)];
    for (prefix, (sum, square, path)) in [("", own), ("splats.", others)].into_iter().take(1 + usize::from(splats)) {
        slots.extend(words().map(|(c, k, word)| (format!("{prefix}sums.{word}"), sum(c, k))));
        slots.extend(words().map(|(c, k, word)| (format!("{prefix}squares.{word}"), square(c, k))));
        for (class, name) in classes.into_iter().flat_map(PathClasses::names).enumerate() {
            slots.extend(words().map(|(c, k, word)| (format!("{prefix}sums.{name}.{word}"), path(class, c, k))));
        }
    }
    slots
}

impl Slot {
    /// The word in pixel number `i`.
    fn get(self, film: &Film, i: usize) -> u32 {
        let of = |number: Option<&Fixed>, k: usize| number.map_or(0, |number| (number.bits() >> (32 * k)) as u32);
        let splats = film.splats.as_ref();
        match self {
            Slot::Count => film.pixels[i].n,
            Slot::CameraPaths => film.pixels[i].camera_paths,
            Slot::Sum(c, k) => of(Some(&film.pixels[i].sum.0[c]), k),
            Slot::Square(c, k) => of(Some(&film.pixels[i].square.0[c]), k),
            Slot::Path(class, c, k) => of(film.paths.as_ref().map(|p| &p.sums[i * p.classes.count() + class].0[c]), k),
            Slot::SplatSum(c, k) => of(splats.map(|s| &s.pixels[i].sum.0[c]), k),
            Slot::SplatSquare(c, k) => of(splats.map(|s| &s.pixels[i].square.0[c]), k),
            Slot::SplatPath(class, c, k) => {
                of(splats.map(|s| &s.classes[i * film.classes().map_or(0, PathClasses::count) + class].0[c]), k)
            }
        }
    }

    /// Puts the word into pixel number `i`, where it must have been 0.
    fn set(self, film: &mut Film, i: usize, value: u32) {
        let classes = film.classes().map_or(0, PathClasses::count);
        let put = |number: Option<&mut Fixed>, k: usize| {
            if let Some(number) = number {
                *number += Fixed::from_bits(u128::from(value) << (32 * k));
            }
        };
        let splats = film.splats.as_mut();
        match self {
            Slot::Count => film.pixels[i].n = value,
            Slot::CameraPaths => film.pixels[i].camera_paths = value,
            Slot::Sum(c, k) => put(Some(&mut film.pixels[i].sum.0[c]), k),
            Slot::Square(c, k) => put(Some(&mut film.pixels[i].square.0[c]), k),
            Slot::Path(class, c, k) => {
                put(film.paths.as_mut().map(|p| &mut p.sums[i * classes + class].0[c]), k);
            }
            Slot::SplatSum(c, k) => put(splats.map(|s| &mut s.pixels[i].sum.0[c]), k),
            Slot::SplatSquare(c, k) => put(splats.map(|s| &mut s.pixels[i].square.0[c]), k),
            Slot::SplatPath(class, c, k) => put(splats.map(|s| &mut s.classes[i * classes + class].0[c]), k),
        }
    }
}
