//! Reading an OpenEXR file: the header, the blocks of the full resolution, the display window.

use super::choose::{Channel, Fit, Shown, choose, notes};
use super::chunks::Block;
use super::file::Exr;
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::raster::decoded::{Coverage, Decoded, blank, check_size};
use crate::raster::{Image, primaries};
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
            primaries::note("chromaticities", [red.0, red.1, green.0, green.1, blue.0, blue.1, white.0, white.1])
        }));
    }
    let is_cube = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
    Ok(Decoded { image, notes, is_cube })
}

/// The images of some layers of a part, and what their alpha says.
pub(super) fn read_layers(file: &Exr, part: usize, layers: &[Shown]) -> Result<Vec<(Image, Coverage)>> {
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
pub(super) fn check_window(path: &Path, data: IntegerBounds, window: IntegerBounds, bytes: usize) -> Result<()> {
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
