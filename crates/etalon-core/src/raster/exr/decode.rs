//! Reading an OpenEXR file: the header, the blocks of the full resolution, the display window; or all its layers, text attributes,
//! and channels that hold counts instead of light.

use super::super::decoded::{self, Coverage, Decoded, blank, check_size};
use super::super::{Image, Metadata};
use super::choose::{Channel, Fit, Shown, choose, layers, named, notes};
use super::encode::is_free_name;
use super::file::{Block, Exr};
use crate::error::{Error, Result};
use crate::files::read_bounded;
use crate::math::Rgb;
use exr::math::Vec2;
use exr::meta::attribute::{Chromaticities, EnvironmentMap, IntegerBounds, SampleType};
use exr::meta::header::Header;
use half::f16;
use half::slice::HalfFloatSliceExt;
use std::path::Path;

/// More pixels than these, all layers together, are refused: 3 GiB in memory.
const MAX_PIXELS: usize = 1 << 28;

/// Reads the image of an OpenEXR file; which channels that is, see [`choose`].
///
/// The image is the display window: data outside it are dropped, pixels of it without data are black.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Decoded> {
    let file = Exr::parse(path, bytes)?;
    let choice = choose(path, file.headers())?;
    let mut notes = notes(path, file.headers(), &choice)?;
    let header = &file.headers()[choice.part];
    let (image, coverage) = read_layers(&file, choice.part, std::slice::from_ref(&choice.layer))?.swap_remove(0);
    notes.extend(coverage.note());
    if matches!(choice.layer.fit, Fit::Colour | Fit::SomeColour) {
        let found = header.shared_attributes.chromaticities;
        notes.extend(found.and_then(|Chromaticities { red, green, blue, white }| {
            decoded::primaries_note(
                "chromaticities",
                [red.0, red.1, green.0, green.1, blue.0, blue.1, white.0, white.1],
            )
        }));
    }
    let is_cube = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
    Ok(Decoded { image, notes, is_cube })
}

/// The images of some layers of a part, and what their alpha says.
fn read_layers(file: &Exr, part: usize, layers: &[Shown]) -> Result<Vec<(Image, Coverage)>> {
    let (path, header) = (&file.path, &file.headers()[part]);
    let (data, window) = (header.data_window(), header.shared_attributes.display_window);
    check_window(path, data, window, file.bytes.len())?;
    let all = (window.size.0 * window.size.1).saturating_mul(layers.len());
    if all > MAX_PIXELS {
        return Err(Error::limit(path, format!("{} layers of {all} pixels in all", layers.len()))
            .with_hint("at most 2^28 pixels are read, all layers together"));
    }
    let blocks = file.blocks(part)?;
    let mut images: Vec<(Image, Coverage)> = layers
        .iter()
        .map(|_| Ok((blank(path, window.size.0, window.size.1)?, Coverage::Full)))
        .collect::<Result<_>>()?;
    // Where the data window lies in the image, which is the display window.
    let left = i64::from(data.position.0) - i64::from(window.position.0);
    let top = i64::from(data.position.1) - i64::from(window.position.1);
    blocks.read(
        |block, bytes| {
            let of =
                |layer: &Shown| (pixels(header, &layer.rgb, block, &bytes), coverage(header, layer, block, &bytes));
            layers.iter().map(of).collect::<Vec<_>>()
        },
        |block, layers| {
            for ((image, coverage), (pixels, of_block)) in images.iter_mut().zip(layers) {
                *coverage = (*coverage).max(of_block);
                for (y, row) in (block.y as i64 + top..).zip(pixels.chunks_exact(block.width)) {
                    copy_row(image, block.x as i64 + left, y, row);
                }
            }
        },
    )?;
    Ok(images)
}

/// Refuses windows beyond the limits, and a display window that has next to nothing to do with the data.
fn check_window(path: &Path, data: IntegerBounds, window: IntegerBounds, bytes: usize) -> Result<()> {
    // What the data can hold is found out block by block; this is about the limits.
    check_size(path, data.size.0 as u64, data.size.1 as u64, bytes, u64::MAX)?;
    check_size(path, window.size.0 as u64, window.size.1 as u64, bytes, u64::MAX)?;
    let overlap = |a: i32, n: usize, b: i32, m: usize| {
        i64::from(a) < i64::from(b) + m as i64 && i64::from(b) < i64::from(a) + n as i64
    };
    let (p, q) = (data.position, window.position);
    if !overlap(p.0, data.size.0, q.0, window.size.0) || !overlap(p.1, data.size.1, q.1, window.size.1) {
        return Err(Error::input(path, "all pixels lie outside the display window")
            .with_hint("the header is damaged, or the image was cropped to nothing"));
    }
    // A small crop in a large frame is common, but not one of less than a thousandth of its area.
    let (pixels, shown) = (data.size.0 * data.size.1, window.size.0 * window.size.1);
    if shown > (1 << 22) && shown / 1024 > pixels {
        return Err(Error::input(path, format!("{pixels} pixels in a display window of {shown}"))
            .with_hint("the header is damaged, or the image was cropped to next to nothing"));
    }
    Ok(())
}

/// Copies a row of pixels to (`x`, `y`), leaving out what lies outside the image.
fn copy_row(image: &mut Image, x: i64, y: i64, row: &[Rgb]) {
    let (width, height) = (image.width() as i64, image.height() as i64);
    let (from, to) = (x.max(0), (x + row.len() as i64).min(width));
    if (0..height).contains(&y) && from < to {
        let source = &row[(from - x) as usize..(to - x) as usize];
        let start = (y * width + from) as usize;
        image.pixels_mut()[start..start + source.len()].copy_from_slice(source);
    }
}

/// The image, or a layer, in the bytes of a block.
fn pixels(header: &Header, rgb: &[Option<Channel>; 3], block: &Block<'_>, bytes: &[u8]) -> Vec<Rgb> {
    let stride = block.width * header.channels.bytes_per_pixel;
    let mut pixels = vec![Rgb::ZERO; block.width * block.height];
    let mut samples = vec![0.0; block.width];
    for (line, row) in bytes.chunks_exact(stride).zip(pixels.chunks_exact_mut(block.width)) {
        if rgb.iter().all(|c| *c == rgb[0]) {
            read_samples(line, rgb[0], &mut samples);
            row.iter_mut().zip(&samples).for_each(|(pixel, &v)| *pixel = Rgb::splat(v));
            continue;
        }
        for (i, &channel) in rgb.iter().enumerate() {
            read_samples(line, channel, &mut samples);
            row.iter_mut().zip(&samples).for_each(|(pixel, &v)| pixel[i] = v);
        }
    }
    pixels
}

/// What the alpha of a layer says in the bytes of a block.
fn coverage(header: &Header, layer: &Shown, block: &Block<'_>, bytes: &[u8]) -> Coverage {
    let mut samples = vec![1.0; block.width];
    let is_full = |line| {
        read_samples(line, layer.alpha, &mut samples);
        samples.iter().all(|alpha| *alpha == 1.0)
    };
    let mut lines = bytes.chunks_exact(block.width * header.channels.bytes_per_pixel);
    if layer.alpha.is_none() || lines.all(is_full) { Coverage::Full } else { Coverage::Partial }
}

/// Takes one channel out of a decompressed line (native byte order, one channel after the other).
fn read_samples(line: &[u8], channel: Option<Channel>, samples: &mut [f32]) {
    let Some(Channel { before, kind }) = channel else {
        return samples.fill(0.0);
    };
    let bytes = &line[before * samples.len()..][..kind.bytes_per_sample() * samples.len()];
    let words = || bytes.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
    match kind {
        SampleType::F16 => {
            let halves: Vec<f16> = bytes.chunks_exact(2).map(|b| f16::from_ne_bytes([b[0], b[1]])).collect();
            halves.convert_to_f32_slice(samples);
        }
        SampleType::F32 => samples.iter_mut().zip(words()).for_each(|(s, b)| *s = f32::from_ne_bytes(b)),
        SampleType::U32 => samples.iter_mut().zip(words()).for_each(|(s, b)| *s = u32::from_ne_bytes(b) as f32),
    }
}

/// Larger files are refused unread.
const MAX_FILE_BYTES: u64 = 1 << 33;
/// Pixels whose integers are set together.
const RUN: usize = 16;

/// An OpenEXR file whose header has been read.
#[derive(Debug, Clone)]
pub struct ExrFile {
    file: Exr<'static>,
    metadata: Metadata,
}

impl ExrFile {
    /// Reads a file and looks at its header.
    ///
    /// # Errors
    /// [`Error::Input`] for a damaged file or one that is not OpenEXR, [`Error::Unsupported`] for an unknown
    /// compression, [`Error::Limit`] for more than 8 GiB or 4096 channels, and [`Error::Io`].
    pub fn open(path: &Path) -> Result<Self> {
        if path.is_dir() {
            return Err(Error::input(path, "this is a directory, not an OpenEXR file"));
        }
        let bytes = read_bounded(path, MAX_FILE_BYTES)?;
        if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            return Err(Error::input(path, "this is not an OpenEXR file"));
        }
        let file = Exr::parse(path, bytes)?;
        let mut metadata = Metadata::default();
        for (name, value) in file.texts() {
            if is_free_name(&name) && metadata.get(&name).is_none() {
                metadata = metadata.with(name, value);
            }
        }
        Ok(Self { file, metadata })
    }

    /// The text attributes to which the format gives no meaning of its own, in their order: what
    /// [`write_exr`](super::write_exr) was given as metadata.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The layers in the part of the file that holds the image, the unnamed one first, then by name. Each is shown as
    /// [`read`](super::super::read()) shows the image. Layers of unsigned integers, which are no light, are left out, and
    /// so are those of several channels without a colour or Y.
    ///
    /// # Errors
    /// Those of [`read`](super::super::read()), and [`Error::Limit`] when the layers have more than 2^28 pixels in all.
    pub fn layers(&self) -> Result<Vec<(String, Image)>> {
        let part = choose(&self.file.path, self.file.headers())?.part;
        let is_light = |layer: &Shown| layer.rgb.iter().flatten().any(|c| c.kind != SampleType::U32);
        let layers: Vec<Shown> = layers(&self.file.headers()[part]).into_iter().filter(is_light).collect();
        let images = read_layers(&self.file, part, &layers)?;
        Ok(layers.into_iter().zip(images).map(|(layer, (image, _))| (layer.name, image)).collect())
    }

    /// The names of all layers in the part of the file that holds the image, of any channels; empty for none.
    pub fn layer_names(&self) -> Vec<String> {
        let part = choose(&self.file.path, self.file.headers()).map_or(0, |choice| choice.part);
        let names = self.file.headers()[part].channels.list.iter().map(|channel| channel.name.to_string());
        let mut layers: Vec<String> =
            names.map(|name| name.rsplit_once('.').map_or(String::new(), |(layer, _)| layer.into())).collect();
        layers.dedup();
        layers
    }

    /// The layer's channels X, Y and Z, as they stand in the file; `None` if one is missing.
    ///
    /// # Errors
    /// Those of [`ExrFile::layers`].
    pub fn tristimulus(&self, layer: &str) -> Result<Option<Image>> {
        let part = choose(&self.file.path, self.file.headers())?.part;
        let Some(shown) = named(&self.file.headers()[part], layer, ["X", "Y", "Z"]) else { return Ok(None) };
        Ok(read_layers(&self.file, part, &[shown])?.pop().map(|(image, _)| image))
    }

    /// Width and height of the first part.
    ///
    /// # Errors
    /// [`Error::Limit`] as in [`read`](super::super::read()); [`Error::Unsupported`] for a cropped, deep or subsampled
    /// image.
    pub fn size(&self) -> Result<(usize, usize)> {
        let header = &self.file.headers()[0];
        let (data, window) = (header.data_window(), header.shared_attributes.display_window);
        check_window(&self.file.path, data, window, self.file.bytes.len())?;
        let plain = header.channels.list.iter().all(|c| c.sampling == Vec2(1, 1)) && !header.deep;
        if data != window || !plain {
            return Err(Error::unsupported(
                &self.file.path,
                "cropped, deep or subsampled OpenEXR data are not read here",
            )
            .with_hint("take the file as it was written, not as another program saved it"));
        }
        Ok(window.size.into())
    }

    /// Whether the first part of the file has a channel of unsigned integers with this name.
    pub fn counts(&self, name: &str) -> bool {
        let mut channels = self.file.headers()[0].channels.list.iter();
        channels.any(|channel| channel.sample_type == SampleType::U32 && channel.name == *name)
    }

    /// Reads channels of unsigned integers from the first part of the file. When they are known to be there, `start`
    /// makes what `set` then fills: it gets the number of the channel in `names`, that of the pixel, and the value.
    ///
    /// # Errors
    /// [`Error::Input`] when a channel is missing or of another type, and for damaged data; those of [`ExrFile::size`].
    pub fn unsigned<T>(
        &self,
        names: &[String],
        start: impl FnOnce() -> Result<T>,
        mut set: impl FnMut(&mut T, usize, usize, u32),
    ) -> Result<T> {
        let (width, _) = self.size()?;
        let header = &self.file.headers()[0];
        // Bytes of a pixel before each channel.
        let mut before = std::collections::HashMap::new();
        let mut sum = 0;
        for channel in &header.channels.list {
            if channel.sample_type == SampleType::U32 {
                before.insert(channel.name.to_string(), sum);
            }
            sum += channel.sample_type.bytes_per_sample();
        }
        let find = |name: &String| before.get(name).copied().ok_or_else(|| self.missing(name));
        let places: Vec<usize> = names.iter().map(find).collect::<Result<_>>()?;
        let blocks = self.file.blocks(0)?;
        let mut result = start()?;
        blocks.read(
            |_, bytes| bytes,
            |block, bytes| {
                let lines = bytes.chunks_exact(block.width * header.channels.bytes_per_pixel);
                for (y, line) in (block.y..).zip(lines) {
                    // All channels of a few pixels, then the next pixels: those in `T` stay in the cache meanwhile.
                    for start in (0..block.width).step_by(RUN) {
                        let run = RUN.min(block.width - start);
                        for (channel, before) in places.iter().enumerate() {
                            let values = line[before * block.width + 4 * start..][..4 * run].chunks_exact(4);
                            for (pixel, b) in (y * width + block.x + start..).zip(values) {
                                set(&mut result, channel, pixel, u32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
                            }
                        }
                    }
                }
            },
        )?;
        Ok(result)
    }

    fn missing(&self, name: &str) -> Error {
        Error::input(&self.file.path, format!("there is no channel {name:?} of unsigned integers"))
    }
}
