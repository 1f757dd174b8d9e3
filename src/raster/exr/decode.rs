//! Reading an OpenEXR file: the header, the blocks of the full resolution, the display window.

use super::choose::{Channel, Choice, choose};
use super::chunks::{Block, locate};
use crate::error::{Error, Place, Result};
use crate::raster::read::{blank, check_size};
use crate::raster::{Image, Rgb};
use exr::meta::MetaData;
use exr::meta::attribute::{IntegerBounds, SampleType};
use exr::meta::header::Header;
use half::f16;
use half::slice::HalfFloatSliceExt;
use rayon::prelude::*;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Blocks are decoded in groups of about this many pixels, to bound what stands in memory beside the image.
const PIXELS_AT_ONCE: usize = 1 << 20;

/// Reads the picture of an OpenEXR file; which channels that is, see [`choose`].
///
/// The image is the display window: data outside it are dropped, pixels of it without data are black.
pub(in crate::raster) fn decode(path: &Path, bytes: &[u8]) -> Result<Image> {
    let mut cursor = Cursor::new(bytes);
    // Not pedantic: damaged attributes that the picture does not need are passed over.
    let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|e| {
        let method = compression_method(bytes).filter(|m| *m > KNOWN_METHODS);
        method.map_or_else(|| foreign(path, &e), |m| unknown_method(path, m))
    })?;
    let choice = choose(path, &meta.headers)?;
    let header = &meta.headers[choice.part];
    let (data, window) = (header.data_window(), header.shared_attributes.display_window);
    check_window(path, data, window, bytes.len())?;
    let blocks = locate(path, bytes, &meta, choice.part, cursor.position() as usize)?;

    let mut image = blank(path, window.size.0, window.size.1)?;
    // Where the data window lies in the image.
    let left = i64::from(data.position.0) - i64::from(window.position.0);
    let top = i64::from(data.position.1) - i64::from(window.position.1);
    let largest = blocks.iter().map(|b| b.width * b.height).max().unwrap_or(1);
    let group = (PIXELS_AT_ONCE / largest).max(rayon::current_num_threads());
    for blocks in blocks.chunks(group) {
        let decoded: Vec<Vec<Rgb>> =
            blocks.par_iter().map(|block| pixels(path, header, &choice, block)).collect::<Result<_>>()?;
        for (block, pixels) in blocks.iter().zip(&decoded) {
            for (y, row) in (block.y as i64 + top..).zip(pixels.chunks_exact(block.width)) {
                copy_row(&mut image, block.x as i64 + left, y, row);
            }
        }
    }
    Ok(image)
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

/// Decompresses one block.
fn pixels(path: &Path, header: &Header, choice: &Choice, block: &Block<'_>) -> Result<Vec<Rgb>> {
    let section = IntegerBounds::new((block.x as i32, block.y as i32), (block.width, block.height));
    let data = block.data.to_vec();
    let place = Place::Byte(block.offset as u64);
    // The checks before leave no known way to make the codecs panic; should there be one, it ends as an error.
    let result = catch_unwind(AssertUnwindSafe(|| {
        header.compression.decompress_image_section_from_le(header, data, section, false)
    }));
    let bytes = match result {
        Ok(decoded) => decoded.map_err(|e| foreign(path, &e).at(place))?,
        Err(_) => return Err(damaged(path, "a block cannot be decompressed").at(place)),
    };
    let stride = block.width * header.channels.bytes_per_pixel;
    let mut pixels = vec![Rgb::ZERO; block.width * block.height];
    let mut samples = vec![0.0; block.width];
    for (line, row) in bytes.chunks_exact(stride).zip(pixels.chunks_exact_mut(block.width)) {
        if choice.rgb.iter().all(|c| *c == choice.rgb[0]) {
            read_samples(line, choice.rgb[0], &mut samples);
            row.iter_mut().zip(&samples).for_each(|(pixel, &v)| *pixel = Rgb::splat(v));
            continue;
        }
        for (i, &channel) in choice.rgb.iter().enumerate() {
            read_samples(line, channel, &mut samples);
            row.iter_mut().zip(&samples).for_each(|(pixel, &v)| pixel[i] = v);
        }
    }
    Ok(pixels)
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

/// An error of the `exr` crate in the words of this one.
fn foreign(path: &Path, error: &exr::error::Error) -> Error {
    match error {
        exr::error::Error::NotSupported(what) => Error::unsupported(path, format!("OpenEXR: {what}"))
            .with_hint("save the image with ZIP, PIZ or DWAA compression, not deep"),
        exr::error::Error::Invalid(what) if what == "reference to missing bytes" => {
            damaged(path, "the header runs beyond the end of the file")
        }
        exr::error::Error::Invalid(what) => damaged(path, what),
        other => damaged(path, &other.to_string()),
    }
}

/// The highest number of a compression method that the `exr` crate has a name for.
const KNOWN_METHODS: u8 = 11;

/// The number of the compression method, looked for without parsing the header (which comes first in the file).
fn compression_method(bytes: &[u8]) -> Option<u8> {
    let name = b"compression\0compression\0\x01\0\0\0";
    let at = bytes[..bytes.len().min(1 << 16)].windows(name.len()).position(|w| w == name)?;
    bytes.get(at + name.len()).copied()
}

fn unknown_method(path: &Path, method: u8) -> Error {
    Error::unsupported(path, format!("OpenEXR: compression method {method} is not known here"))
        .with_hint("save the image with ZIP, PIZ or DWAA compression")
}

fn damaged(path: &Path, what: &str) -> Error {
    Error::input(path, format!("damaged OpenEXR file: {what}")).with_hint("fetch the file again")
}
