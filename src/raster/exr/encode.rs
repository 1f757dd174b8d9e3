//! Writing OpenEXR: scan lines, ZIP compression, one part, layers as channel name prefixes.

use crate::error::{Error, Result};
use crate::files::write_atomic;
use crate::raster::write::SOFTWARE;
use crate::raster::{Image, Metadata};
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use half::f16;
use rayon::prelude::*;
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
    let channels = channels(layers)?;
    check_names(metadata)?;
    let image = layers[0].image;
    let kind = match precision {
        Precision::Half => SampleType::F16,
        Precision::Float => SampleType::F32,
    };
    let descriptions = channels.iter().map(|c| ChannelDescription::new(text(&c.name), kind, false)).collect();
    let header = Header::new(Text::from("image"), (image.width(), image.height()), descriptions).with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    let starts: Vec<usize> = (0..image.height()).step_by(LINES).collect();
    let blocks: Vec<Vec<u8>> = starts
        .par_iter()
        .map(|&y| {
            let lines = y..(y + LINES).min(image.height());
            let section = IntegerBounds::new((0, y as i32), (image.width(), lines.len()));
            let raw = lines.flat_map(|y| channels.iter().flat_map(move |c| c.samples(y, precision))).collect();
            header.compression.compress_image_section_to_le(&header, raw, section)
        })
        .collect::<std::result::Result<_, _>>()
        .map_err(|e| Error::io(path, std::io::Error::other(e.to_string())))?;

    let head = head(image, &channels, kind, metadata);
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

/// One channel of one image.
struct Channel<'a> {
    name: String,
    image: &'a Image,
    component: usize,
}

impl Channel<'_> {
    /// The bytes of row `y`, in native order as the compressor expects them.
    fn samples(&self, y: usize, precision: Precision) -> Vec<u8> {
        let values = self.image.row(y).iter().map(|p| p[self.component]);
        match precision {
            Precision::Half => values.flat_map(|v| half(v).to_ne_bytes()).collect(),
            Precision::Float => values.flat_map(f32::to_ne_bytes).collect(),
        }
    }
}

fn half(v: f32) -> f16 {
    let largest = f16::MAX.to_f32();
    f16::from_f32(if v.is_finite() { v.clamp(-largest, largest) } else { v })
}

/// All channels, sorted by name as the format demands.
fn channels<'a>(layers: &[Layer<'a>]) -> Result<Vec<Channel<'a>>> {
    let error = |message: String| Err(Error::parameter("layers", message));
    let Some(first) = layers.first() else {
        return error("an OpenEXR file needs at least one".into());
    };
    let mut channels = Vec::new();
    for layer in layers {
        if (layer.image.width(), layer.image.height()) != (first.image.width(), first.image.height()) {
            return error(format!("the size of {:?} differs from that of {:?}", layer.name, first.name));
        }
        if layer.name.len() > 29 || !layer.name.bytes().all(|b| b.is_ascii_graphic()) {
            return error(format!("{:?} is not a name of at most 29 ASCII characters without blanks", layer.name));
        }
        for (component, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let name = if layer.name.is_empty() { letter.into() } else { format!("{}.{letter}", layer.name) };
            channels.push(Channel { name, image: layer.image, component });
        }
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(pair) = channels.windows(2).find(|pair| pair[0].name == pair[1].name) {
        return error(format!("there are two of channel {}", pair[0].name));
    }
    Ok(channels)
}

fn check_names(metadata: &Metadata) -> Result<()> {
    let names: Vec<&str> = metadata.entries().iter().map(|(name, _)| name.as_str()).collect();
    for (i, name) in names.iter().enumerate() {
        let proper = (1..=31).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic());
        if !proper || RESERVED.contains(name) || names[..i].contains(name) {
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

/// Everything before the table of blocks. Written here, not by the `exr` crate, which shuffles attributes.
fn head(image: &Image, channels: &[Channel<'_>], kind: SampleType, metadata: &Metadata) -> Vec<u8> {
    let kind: i32 = if kind == SampleType::F16 { 1 } else { 2 };
    let mut list = Vec::new();
    for channel in channels {
        list.extend(channel.name.bytes());
        list.push(0);
        list.extend(kind.to_le_bytes());
        list.extend([0; 4]);
        list.extend([1_i32, 1].map(i32::to_le_bytes).as_flattened());
    }
    list.push(0);
    let window = [0, 0, image.width() as i32 - 1, image.height() as i32 - 1].map(i32::to_le_bytes);

    // The magic number, then version 2 without any flag.
    let mut head = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            head.extend(text.bytes());
            head.push(0);
        }
        head.extend((value.len() as i32).to_le_bytes());
        head.extend(value);
    };
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", window.as_flattened());
    attribute("displayWindow", "box2i", window.as_flattened());
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes());
    attribute("software", "string", SOFTWARE.as_bytes());
    for (name, value) in metadata.entries() {
        attribute(name, "string", value.as_bytes());
    }
    head.push(0);
    head
}
