//! Writing OpenEXR: scan lines, ZIP compression, one part, channels of any type, layers as prefixes of their names.
//!
//! The `exr` crate makes the header and compresses the blocks; text attributes and the table of blocks are written here. The
//! crate keeps custom attributes in a hash map, so their order, and the bytes of the file, would differ from run to run.

use super::super::image::SOFTWARE;
use crate::error::{Error, Result};
use crate::files::write_atomic;
use crate::raster::{Image, Metadata};
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{self, AttributeValue, ChannelDescription, IntegerBounds, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use half::f16;
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// How samples are stored in an OpenEXR file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Precision {
    /// 16 bits: 11 significant ones, up to 65504. Rounded to nearest; finite values beyond are clamped.
    Half,
    /// 32 bits: exact.
    #[default]
    Float,
}

/// An image in a file of several. The unnamed layer (`""`) is what viewers show.
#[derive(Debug, Clone, Copy)]
pub struct Layer<'a> {
    /// Prefix of the channels' names; empty for the unnamed layer.
    pub name: &'a str,
    pub image: &'a Image,
}

/// Lines that are compressed together: fixed by the ZIP method.
const LINES: usize = 16;

/// Attributes that the format, or this writer, gives a meaning of their own.
const RESERVED: [&str; 14] = [
    "channels",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "envmap",
    "lineOrder",
    "maxSamplesPerPixel",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "software",
    "tiles",
    "type",
];

/// Writes one or more images of the same size as an OpenEXR file, ZIP-compressed (lossless).
///
/// An unnamed layer gives the channels B, G, R (in this order: some readers count on it), a named one `name.B`,
/// `name.G`, `name.R`. The metadata become text attributes in their order, after `software`. The same input gives the
/// same bytes.
///
/// # Errors
/// [`Error::Parameter`] when there is no layer, when their sizes differ, when a layer name appears twice or a channel
/// name exceeds 31 bytes, or when a metadata name is not 1 to 31 ASCII characters, appears twice, or belongs to the
/// format. [`Error::Io`].
pub fn write_exr(path: &Path, layers: &[Layer<'_>], precision: Precision, metadata: &Metadata) -> Result<()> {
    let Some(Layer { image, .. }) = layers.first() else {
        return Err(Error::parameter("layers", "an OpenEXR file needs at least one"));
    };
    let size = (image.width(), image.height());
    let mut channels = Vec::new();
    for layer in layers {
        if (layer.image.width(), layer.image.height()) != size {
            let message = format!("the size of {:?} differs from that of {:?}", layer.name, layers[0].name);
            return Err(Error::parameter("layers", message));
        }
        channels.extend(layer.channels(precision));
    }
    write_exr_channels(path, size, channels, metadata)
}

/// [`write_exr`] for channels of any type: `size` is width and height, the order of the channels does not matter.
///
/// # Errors
/// [`Error::Parameter`] when there is no channel, when a name appears twice or is not 1 to 31 ASCII characters without
/// blanks, or for metadata as in [`write_exr`]. [`Error::Io`].
pub fn write_exr_channels(
    path: &Path,
    (width, height): (usize, usize),
    channels: Vec<Channel<'_>>,
    metadata: &Metadata,
) -> Result<()> {
    let channels = sorted(channels)?;
    check_names(metadata)?;
    let descriptions =
        channels.iter().map(|c| ChannelDescription::new(text(&c.name), c.samples.kind(), false)).collect();
    let mut header = Header::new(Text::from("image"), (width, height), descriptions).with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.own_attributes.layer_name = None;
    let foreign = |e: exr::error::Error| Error::io(path, std::io::Error::other(e.to_string()));
    let head = head(&header, metadata).map_err(foreign)?;
    // Compress the blocks in parallel.
    let starts: Vec<usize> = (0..height).step_by(LINES).collect();
    let blocks: Vec<Vec<u8>> = starts
        .par_iter()
        .map(|&y| {
            let lines = y..(y + LINES).min(height);
            let section = IntegerBounds::new((0, y as i32), (width, lines.len()));
            let mut raw = Vec::with_capacity(lines.len() * width * header.channels.bytes_per_pixel);
            for y in lines {
                channels.iter().for_each(|c| c.samples.append(y * width..(y + 1) * width, &mut raw));
            }
            header.compression.compress_image_section_to_le(&header, raw, section)
        })
        .collect::<std::result::Result<_, _>>()
        .map_err(foreign)?;

    // Write header, table of offsets and blocks.
    write_atomic(path, |out| {
        let mut offset = head.len() + 8 * blocks.len();
        let mut table = Vec::with_capacity(8 * blocks.len());
        for block in &blocks {
            table.extend((offset as u64).to_le_bytes());
            offset += 8 + block.len();
        }
        let mut save = |bytes: &[u8]| out.write_all(bytes).map_err(|e| Error::io(path, e));
        save(&head)?;
        save(&table)?;
        for (y, block) in starts.iter().zip(&blocks) {
            save(&(*y as i32).to_le_bytes())?;
            save(&(block.len() as i32).to_le_bytes())?;
            save(block)?;
        }
        Ok(())
    })
}

/// A channel of an OpenEXR file.
pub struct Channel<'a> {
    /// 1 to 31 ASCII characters, with the layer's name as prefix (`error.R`).
    pub name: String,
    pub samples: Samples<'a>,
}

/// The value of each pixel, by its number (row by row from the top), and how it is stored.
pub enum Samples<'a> {
    /// 16 bits, see [`Precision::Half`].
    Half(Box<dyn Fn(usize) -> f32 + Sync + 'a>),
    /// 32 bits, exact.
    Float(Box<dyn Fn(usize) -> f32 + Sync + 'a>),
    /// Unsigned integers of 32 bits.
    Unsigned(Box<dyn Fn(usize) -> u32 + Sync + 'a>),
}

impl<'a> Layer<'a> {
    /// The layer's three channels.
    pub fn channels(&self, precision: Precision) -> [Channel<'a>; 3] {
        let image = self.image;
        [0, 1, 2].map(|component| {
            let letter = ["R", "G", "B"][component];
            let name = if self.name.is_empty() { letter.into() } else { format!("{}.{letter}", self.name) };
            let value = Box::new(move |i: usize| image.pixels()[i][component]);
            let samples = match precision {
                Precision::Half => Samples::Half(value),
                Precision::Float => Samples::Float(value),
            };
            Channel { name, samples }
        })
    }
}

impl Samples<'_> {
    fn kind(&self) -> SampleType {
        match self {
            Samples::Half(_) => SampleType::F16,
            Samples::Float(_) => SampleType::F32,
            Samples::Unsigned(_) => SampleType::U32,
        }
    }

    /// Appends the bytes of some pixels, in native order as the compressor expects them.
    fn append(&self, pixels: Range<usize>, bytes: &mut Vec<u8>) {
        match self {
            Samples::Half(value) => bytes.extend(pixels.flat_map(|i| half(value(i)).to_ne_bytes())),
            Samples::Float(value) => bytes.extend(pixels.flat_map(|i| value(i).to_ne_bytes())),
            Samples::Unsigned(value) => bytes.extend(pixels.flat_map(|i| value(i).to_ne_bytes())),
        }
    }
}

fn half(v: f32) -> f16 {
    let largest = f16::MAX.to_f32();
    f16::from_f32(if v.is_finite() { v.clamp(-largest, largest) } else { v })
}

/// All channels, sorted by name as the format demands.
fn sorted(mut channels: Vec<Channel<'_>>) -> Result<Vec<Channel<'_>>> {
    let error = |message: String| Err(Error::parameter("layers", message));
    if channels.is_empty() {
        return error("an OpenEXR file needs at least one channel".into());
    }
    if let Some(c) = channels.iter().find(|c| !is_name(&c.name)) {
        return error(format!("channel {:?}: a name is 1 to 31 ASCII characters without blanks", c.name));
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(pair) = channels.windows(2).find(|pair| pair[0].name == pair[1].name) {
        return error(format!("there are two of channel {}", pair[0].name));
    }
    Ok(channels)
}

/// Whether the format takes this as the name of a channel or an attribute.
fn is_name(name: &str) -> bool {
    (1..=31).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic())
}

/// Whether metadata may be called this: a name of the format, not one to which it gives a meaning.
pub(super) fn is_free_name(name: &str) -> bool {
    is_name(name) && !RESERVED.contains(&name)
}

fn check_names(metadata: &Metadata) -> Result<()> {
    let names: Vec<&str> = metadata.entries().iter().map(|(name, _)| name.as_str()).collect();
    for (i, name) in names.iter().enumerate() {
        if !is_free_name(name) || names[..i].contains(name) {
            return Err(Error::parameter("metadata", format!("{name:?} cannot name an OpenEXR attribute")).with_hint(
                "a name is 1 to 31 ASCII characters without blanks, is used once, and is not the format's",
            ));
        }
    }
    Ok(())
}

fn text(name: &str) -> Text {
    Text::from_slice_unchecked(name.as_bytes())
}

/// The magic number, version 2 without any flag, and the header with the metadata.
fn head(header: &Header, metadata: &Metadata) -> exr::error::Result<Vec<u8>> {
    let mut head = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    header.write(&mut head)?;
    // Texts of our own go before the byte that ends the header.
    head.pop();
    let software = ("software".to_owned(), SOFTWARE.to_owned());
    for (name, value) in std::iter::once(&software).chain(metadata.entries()) {
        attribute::write(text(name).as_slice(), &AttributeValue::Text(text(value)), &mut head)?;
    }
    head.push(0);
    Ok(head)
}
