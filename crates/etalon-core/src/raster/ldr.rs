//! Clipped images: PNG, JPEG, TGA, PPM/PGM to linear light, and 8-bit PNG and PPM back.

use super::Image;
use super::decoded::{Coverage, Decoded, blank, check_size};
use super::tone::{ToneMap, linear_from_srgb, to_rgb8};
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::memory;
use image::{DynamicImage, ImageDecoder, ImageEncoder, ImageError, ImageFormat, ImageReader};
use std::io::{self, Cursor, Write};
use std::path::Path;

/// A clipped format.
pub(super) struct Format {
    kind: ImageFormat,
    /// For messages.
    pub name: &'static str,
    /// Upper bound on the pixels per byte of a file.
    pixels_per_byte: u64,
}

/// Detects a clipped format by its first bytes; TGA, which has no mark of its own, also by the file's name.
pub(super) fn recognise(path: &Path, bytes: &[u8]) -> Option<Format> {
    let (kind, name, pixels_per_byte) = match bytes {
        // 1 bit a pixel, deflated 1032 to 1.
        [0x89, b'P', b'N', b'G', ..] => (ImageFormat::Png, "PNG", 8 * 1032),
        // Two bits for a block of 64.
        [0xff, 0xd8, 0xff, ..] => (ImageFormat::Jpeg, "JPEG", 512),
        // A bitmap.
        [b'P', b'1'..=b'6', space, ..] if space.is_ascii_whitespace() || *space == b'#' => {
            (ImageFormat::Pnm, "PPM/PGM", 8)
        }
        // Runs of 128 pixels in two bytes.
        [_, 0 | 1, 1..=3 | 9..=11, ..] if has_tga_name(path) => (ImageFormat::Tga, "TGA", 64),
        _ => return None,
    };
    Some(Format { kind, name, pixels_per_byte })
}

fn has_tga_name(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tga"))
}

/// Reads a clipped image; values are taken to be sRGB-encoded, unless they are linear, and come out linear, in [0, 1].
pub(super) fn decode(path: &Path, mut bytes: Vec<u8>, format: Format, is_linear: bool) -> Result<Decoded> {
    if format.kind == ImageFormat::Png {
        remove_chunks(&mut bytes, &UNREAD);
    }
    let damaged = |e: ImageError| match e {
        ImageError::Unsupported(e) => Error::unsupported(path, e.to_string()),
        ImageError::Limits(e) => Error::limit(path, e.to_string()),
        e => Error::input(path, e.to_string()),
    };
    let decoder = ImageReader::with_format(Cursor::new(&bytes), format.kind).into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(path, width.into(), height.into(), bytes.len(), format.pixels_per_byte)?;
    // The file's values, and its pixels twice in single precision.
    let bytes = decoder.total_bytes() as usize + 2 * width as usize * height as usize * size_of::<Rgb>();
    memory::request(bytes, || format!("{}, {width}x{height} pixels", path.display()))?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    let coverage = coverage(&decoded);
    let decoded = decoded.into_rgb32f();
    let mut image = blank(path, width as usize, height as usize)?;
    for (to, from) in image.pixels_mut().iter_mut().zip(decoded.pixels()) {
        *to = Rgb::from_array(if is_linear { from.0 } else { from.0.map(linear_from_srgb) });
    }
    Ok(Decoded { notes: coverage.note().into_iter().collect(), ..image.into() })
}

/// Chunks of PNG files that nothing here reads, and that may inflate to any size: colour profiles and texts.
const UNREAD: [&[u8; 4]; 4] = [b"iCCP", b"iTXt", b"tEXt", b"zTXt"];

/// Removes the chunks of some kinds from a PNG file.
fn remove_chunks(bytes: &mut Vec<u8>, kinds: &[&[u8; 4]]) {
    let start = SIGNATURE.min(bytes.len());
    let (mut read, mut kept) = (start, start);
    // A length, a kind, bytes of this length, and a checksum.
    while let Some(&[a, b, c, d, ref kind @ ..]) = bytes.get(read..).and_then(<[u8]>::first_chunk::<8>) {
        let next = bytes.len().min(read + 12 + u32::from_be_bytes([a, b, c, d]) as usize);
        if !kinds.contains(&kind) {
            bytes.copy_within(read..next, kept);
            kept += next - read;
        }
        read = next;
    }
    bytes.drain(kept..read);
}

/// Bytes before the first chunk.
const SIGNATURE: usize = 8;

/// What the alpha of an image says.
fn coverage(image: &DynamicImage) -> Coverage {
    let is_full = match image {
        DynamicImage::ImageLumaA8(image) => image.pixels().all(|pixel| pixel[1] == u8::MAX),
        DynamicImage::ImageRgba8(image) => image.pixels().all(|pixel| pixel[3] == u8::MAX),
        DynamicImage::ImageLumaA16(image) => image.pixels().all(|pixel| pixel[1] == u16::MAX),
        DynamicImage::ImageRgba16(image) => image.pixels().all(|pixel| pixel[3] == u16::MAX),
        _ => true,
    };
    if is_full { Coverage::Full } else { Coverage::Partial }
}

pub(super) fn encode_png(image: &Image, tone: &ToneMap, out: &mut dyn Write) -> io::Result<()> {
    let (width, height) = (image.width() as u32, image.height() as u32);
    image::codecs::png::PngEncoder::new(out)
        .write_image(&to_rgb8(image, tone), width, height, image::ExtendedColorType::Rgb8)
        .map_err(|e| match e {
            ImageError::IoError(e) => e,
            e => io::Error::other(e),
        })
}

/// Writes an 8-bit binary PPM (P6).
pub(super) fn encode_ppm(image: &Image, tone: &ToneMap, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "P6\n{} {}\n255\n", image.width(), image.height())?;
    out.write_all(&to_rgb8(image, tone))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<Image> {
        let path = Path::new("a.tga");
        let format = recognise(path, bytes).expect("a known format");
        decode(path, bytes.to_vec(), format, false).map(|decoded| decoded.image)
    }

    #[test]
    fn eight_bit_files_round_trip() {
        let image = Image::from_fn(16, 16, |x, y| {
            let value = |code: usize| linear_from_srgb(code as f32 / 255.0);
            Rgb::new(value(16 * y + x), value(255 - 16 * y - x), 0.0)
        });
        let (mut png, mut ppm) = (Vec::new(), Vec::new());
        encode_png(&image, &ToneMap::default(), &mut png).unwrap();
        encode_ppm(&image, &ToneMap::default(), &mut ppm).unwrap();
        assert_eq!(parse(&png).unwrap(), image);
        assert_eq!(parse(&ppm).unwrap(), image);
    }

    #[test]
    fn grey_ascii_and_sixteen_bit_maps_are_read() {
        let grey = parse(b"P2\n# made by hand\n2 1\n4\n0 4\n").unwrap();
        assert_eq!(grey.pixels(), [Rgb::ZERO, Rgb::ONE]);
        let deep = parse(b"P5 1 1 65535 \x80\x00").unwrap();
        assert!((deep.get(0, 0).x - linear_from_srgb(32768.0 / 65535.0)).abs() < 1e-7);
    }

    /// A TGA file of true colour: a header of 18 bytes, then pixels as blue, green, red from the lower left.
    fn tga(kind: u8, [width, height]: [u16; 2], pixels: &[u8]) -> Vec<u8> {
        let [w, h] = [width, height].map(u16::to_le_bytes);
        let mut bytes = vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, w[0], w[1], h[0], h[1], 24, 0];
        bytes.extend(pixels);
        bytes
    }

    #[test]
    fn tga_files_plain_and_in_runs() {
        let red = Rgb::new(1.0, 0.0, 0.0);
        let plain = parse(&tga(2, [1, 2], &[0, 0, 255, 255, 0, 0])).unwrap();
        assert_eq!(plain.pixels(), [Rgb::new(0.0, 0.0, 1.0), red], "the lower row comes first");
        // A run of 4 pixels.
        assert_eq!(parse(&tga(10, [4, 1], &[0x83, 0, 0, 255])).unwrap().pixels(), [red; 4]);
        assert!(recognise(Path::new("a.png"), &tga(2, [1, 1], &[0; 3])).is_none(), "by its name");
        for (kind, size, pixels, message) in [
            (2, [60000, 4000], &[0; 3][..], "cannot hold"),
            (2, [0, 1], &[0; 3], "a.tga"),
            (2, [2, 2], &[0; 3], "a.tga"),
            (10, [4, 1], &[0x83, 0], "a.tga"),
            (1, [1, 1], &[0; 3], "a.tga"),
        ] {
            let error = parse(&tga(kind, size, pixels)).unwrap_err().to_string();
            assert!(error.contains(message), "{kind} {size:?}: {error}");
        }
        let path = Path::new("a.tga");
        let linear = decode(path, tga(2, [1, 1], &[0, 51, 255]), recognise(path, &tga(2, [1, 1], &[])).unwrap(), true);
        assert_eq!(linear.unwrap().image.pixels(), [Rgb::new(1.0, 0.2, 0.0)]);
    }

    #[test]
    fn profiles_and_texts_in_png_files_are_not_read() {
        let mut png = Vec::new();
        encode_png(&Image::from_pixels(1, 1, vec![Rgb::ONE]), &ToneMap::default(), &mut png).unwrap();
        let header = SIGNATURE + 12 + 13;
        let (start, end) = png.split_at(header);
        let unread = UNREAD.iter().flat_map(|kind| [&[0, 0, 0, 3][..], *kind, b"abc", b"sum?"]).collect::<Vec<_>>();
        let mut with = [start, &unread.concat(), end].concat();
        assert_eq!(parse(&with).unwrap().pixels(), [Rgb::ONE]);
        remove_chunks(&mut with, &UNREAD);
        assert_eq!(with, png);
        // A file that is cut off stays as it is.
        for length in 0..png.len() {
            let mut cut = png[..length].to_vec();
            remove_chunks(&mut cut, &UNREAD);
            assert_eq!(cut, png[..length]);
        }
    }

    #[test]
    fn a_size_that_the_file_cannot_hold_is_refused() {
        let error = parse(b"P6\n60000 4000\n255\n\0\0\0").unwrap_err();
        assert!(error.to_string().contains("cannot hold"), "{error}");
        assert!(parse(b"P6\n2 2\n255\n\0\0\0").is_err());
        assert!(parse(b"\x89PNG\r\n\x1a\n").is_err());
        assert!(parse(b"\xff\xd8\xff\xe0").is_err());
    }
}
