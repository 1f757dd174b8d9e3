//! Image files. What is read is detected by its first bytes, not by its name; what is written has the format that the extension
//! picks, and is written whole or not at all.

use super::decoded::Decoded;
use super::exr::{self, Layer, Precision, write_exr};
use super::tone::ToneMap;
use super::{Image, Metadata, ldr, pfm, rgbe};
use crate::error::{Error, Result};
use crate::files::{read_bounded, write_atomic};
use std::io::{self, Write};
use std::path::Path;

/// Larger files are refused unread: 2 GiB holds a 16384x8192 map of 32-bit floats.
const MAX_FILE_BYTES: u64 = 1 << 31;
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Accept PNG, JPEG, TGA and PPM/PGM, decoded from sRGB to linear. Off by default: such files are clipped at 1, so
    /// that the sun is as bright as a white wall, and every measurement made with them is wrong.
    pub allow_ldr: bool,
    /// Take the values of such files as linear, from 0 to 1, instead.
    pub is_linear: bool,
}

/// Reads an image file into linear RGB, row 0 at the top.
///
/// | format | accepted | how the values are taken |
/// |---|---|---|
/// | OpenEXR | half, float and unsigned channels; scan lines, tiles, mip maps (the full resolution); no, RLE, ZIP, PIZ, PXR24, B44, DWA compression | RGB, or one channel as grey, of the unnamed layer or of the only one that suits; alpha ignored; the display window, black where no data is |
/// | Radiance HDR | new and old run lengths, flat; all eight orientations | mantissa/256 · 2^(exponent-128), divided by `EXPOSURE` and `COLORCORR` |
/// | PFM | `PF` and `Pf` (not `PF4`), both byte orders | multiplied by the absolute value of the header's scale |
/// | PNG, JPEG, PPM/PGM; TGA, known by its name, too | only with [`ReadOptions::allow_ldr`] | sRGB transfer function undone, unless [`ReadOptions::is_linear`]; alpha ignored |
///
/// Negative and non-finite values are returned unchanged. Some OpenEXR maps are stored upside-down without a mark in the
/// file; they are returned upside-down. [`read_with_notes`] also returns what had to be guessed.
///
/// # Errors
/// [`Error::Input`] for a damaged file or one that is no image, [`Error::Unsupported`] for a feature not implemented
/// or for a clipped format that was not asked for, [`Error::Limit`] when a side exceeds 65536, the image 2^28 pixels
/// or the file 2 GiB, [`Error::Memory`] when it does not fit, and [`Error::Io`]. Memory is taken only in proportion to what the file can really hold.
pub fn read(path: &Path, options: ReadOptions) -> Result<Image> {
    read_with_notes(path, options).map(|(image, _)| image)
}

/// [`read`], and a sentence about each thing in the file that was guessed or passed over: which channels or part of an
/// OpenEXR file are the image, primaries other than those of Rec. 709.
///
/// # Errors
/// Those of [`read`].
pub fn read_with_notes(path: &Path, options: ReadOptions) -> Result<(Image, Vec<String>)> {
    load(path, options).map(Decoded::into_parts)
}

/// [`read_with_notes`] for an image whose layout must be lat-long.
///
/// # Errors
/// Those of [`read`], and [`Error::Unsupported`] for an OpenEXR file whose `envmap` attribute says that it is a cube map.
pub fn read_lat_long(path: &Path, options: ReadOptions) -> Result<(Image, Vec<String>)> {
    let decoded = load(path, options)?;
    if decoded.is_cube {
        return Err(Error::unsupported(path, "this is a cube map (its envmap attribute is CUBE), not a lat-long map")
            .with_hint("convert it: exrenvmap -l cube.exr latlong.exr"));
    }
    Ok(decoded.into_parts())
}

/// Decodes an OpenEXR file that is in memory; errors name it `path`.
///
/// # Errors
/// Those of [`read`], without [`Error::Io`].
pub fn decode_exr(path: &Path, bytes: &[u8]) -> Result<Image> {
    exr::decode(path, bytes).map(|decoded| decoded.image)
}

fn load(path: &Path, options: ReadOptions) -> Result<Decoded> {
    if path.is_dir() {
        return Err(
            Error::input(path, "this is a directory, not an image file").with_hint("name its files: DIRECTORY/*")
        );
    }
    let bytes = read_bounded(path, MAX_FILE_BYTES)?;
    let mut decoded = decode(path, bytes, options)?;
    decoded.notes.iter_mut().for_each(|note| *note = format!("{}: {note}", path.display()));
    Ok(decoded)
}

/// [`load`] for bytes that are at hand; `path` is only named in errors.
fn decode(path: &Path, bytes: Vec<u8>, options: ReadOptions) -> Result<Decoded> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr::decode(path, &bytes)
    } else if bytes.starts_with(b"#?") {
        rgbe::decode(path, &bytes)
    } else if pfm::recognise(&bytes) {
        pfm::decode(path, bytes).map(Decoded::from)
    } else if bytes.starts_with(b"PF4") {
        Err(Error::unsupported(path, "this is a PFM file of four channels (PF4, RGBA), a variant without a standard")
            .with_hint("save it without alpha, as PF"))
    } else if let Some(format) = ldr::recognise(path, &bytes) {
        if options.allow_ldr {
            return ldr::decode(path, bytes, format, options.is_linear);
        }
        Err(Error::unsupported(path, format!("a {} file holds no radiance: its values are clipped at 1", format.name))
            .with_hint("use an OpenEXR, Radiance HDR or PFM file; `allow_ldr` takes this one anyway"))
    } else {
        Err(no_image(path, &bytes))
    }
}

/// An error that describes a file which is no image.
fn no_image(path: &Path, bytes: &[u8]) -> Error {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(512)]);
    let text = start.trim_start_matches('\u{feff}').trim_start();
    let lower = text.to_ascii_lowercase();
    if bytes.is_empty() {
        Error::input(path, "the file is empty")
    } else if text.starts_with("version https://git-lfs") {
        Error::input(path, "this is a Git LFS pointer, not the image itself")
            .with_hint("run `git lfs pull` in the repository that it came from")
    } else if lower.starts_with("<!doctype html") || lower.starts_with("<html") {
        Error::input(path, "this is a web page, not an image").with_hint("the download went wrong; fetch it again")
    } else {
        let is_text = !start.contains(|c: char| c == '\u{fffd}' || (c.is_control() && !c.is_whitespace()));
        let what = if is_text { "this is a text file, not an image" } else { "not an image format known here" };
        Error::input(path, what)
            .with_hint("images are OpenEXR, Radiance HDR or PFM files; PNG, JPEG, TGA and PPM/PGM hold no radiance")
    }
}

/// Precision and tone mapping of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WriteOptions {
    /// For OpenEXR: the sample type.
    pub precision: Precision,
    /// For PNG and PPM: the way to 8 bits.
    pub tone: ToneMap,
}

/// [`write_with`] the default options: 32-bit floats for OpenEXR, plain sRGB for PNG and PPM.
///
/// # Errors
/// Those of [`write_with`].
pub fn write(path: &Path, image: &Image, metadata: &Metadata) -> Result<()> {
    write_with(path, image, metadata, WriteOptions::default())
}

/// Writes `image` in the format that the extension of `path` names (upper or lower case):
///
/// | extension | format | values |
/// |---|---|---|
/// | `.exr` | OpenEXR, ZIP-compressed, channels B, G, R | exact as [`Precision::Float`]; to nearest, finite ones clamped to ±65504, as [`Precision::Half`] |
/// | `.pfm` | PFM, `PF`, little-endian | exact |
/// | `.hdr` | Radiance HDR, run lengths | mantissas of 8 bits, rounded; no negative values, NaN becomes 0 |
/// | `.png` | PNG, 8 bits a channel | through [`WriteOptions::tone`] |
/// | `.ppm` | P6, 8 bits a channel | through [`WriteOptions::tone`] |
///
/// # Errors
/// [`Error::Parameter`] for another extension and for metadata that OpenEXR cannot name (see [`write_exr`]),
/// [`Error::Io`]. After an error a file that was at `path` before is unchanged.
pub fn write_with(path: &Path, image: &Image, metadata: &Metadata, options: WriteOptions) -> Result<()> {
    let save = |fill: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
        write_atomic(path, |out| fill(out).map_err(|e| Error::io(path, e)))
    };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "exr" => write_exr(path, &[Layer { name: "", image }], options.precision, metadata),
        "pfm" => save(&|out| pfm::encode(image, out)),
        "hdr" => save(&|out| rgbe::encode(image, metadata, out)),
        "png" => save(&|out| ldr::encode_png(image, &options.tone, out)),
        "ppm" => save(&|out| ldr::encode_ppm(image, &options.tone, out)),
        _ => {
            let name = path.display();
            Err(Error::parameter("output file", format!("no image format has the extension of {name}"))
                .with_hint("known extensions: .exr, .pfm, .hdr, .png, .ppm"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::decoded::check_size;
    use super::*;

    fn refusal(bytes: &[u8]) -> Error {
        decode(Path::new("x.exr"), bytes.to_vec(), ReadOptions::default()).unwrap_err()
    }

    #[test]
    fn files_that_are_no_image_are_described() {
        for (bytes, expected) in [
            (&b""[..], "empty"),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 3\n", "Git LFS pointer"),
            (b"\n <!DOCTYPE HTML><title>404</title>", "web page"),
            (b"hello, world\n", "text file"),
            (b"PFennig\n1 1\n-1\n\0\0\0\0\0\0\0\0\0\0\0\0", "not an image format"),
            (b"PF4\n1 1\n-1\n0123456789abcdef", "four channels"),
            (b"\x00\x01\x02\x03", "not an image format"),
        ] {
            let message = refusal(bytes).to_string();
            assert!(message.contains(expected) && message.starts_with("x.exr"), "{message}");
        }
    }

    #[test]
    fn clipped_formats_need_the_flag() {
        for bytes in [&b"\x89PNG\r\n\x1a\n"[..], b"\xff\xd8\xff\xe0", b"P6\n1 1\n255\n\0\0\0"] {
            let error = refusal(bytes);
            assert!(error.to_string().contains("clipped at 1"), "{error}");
            assert!(error.hint().unwrap().contains("`allow_ldr`"));
        }
    }

    #[test]
    fn a_directory_and_a_missing_file_are_errors() {
        let dir = tempfile::tempdir().unwrap();
        assert!(read(dir.path(), ReadOptions::default()).unwrap_err().to_string().contains("directory"));
        let missing = read(&dir.path().join("none.exr"), ReadOptions::default()).unwrap_err();
        assert!(matches!(missing, Error::Io { .. }));
    }

    #[test]
    fn sizes_are_bounded() {
        let path = Path::new("x");
        assert!(check_size(path, 4, 4, 16, 1).is_ok());
        assert!(matches!(check_size(path, 4, 4, 15, 1), Err(Error::Input { .. })));
        assert!(matches!(check_size(path, 0, 4, 15, 1), Err(Error::Input { .. })));
        assert!(matches!(check_size(path, 65536, 65536, usize::MAX, 1), Err(Error::Limit { .. })));
        assert!(matches!(check_size(path, u64::MAX, u64::MAX, 1, 1), Err(Error::Limit { .. })));
    }

    #[test]
    fn unknown_extensions_are_refused_before_anything_is_written() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["a.tiff", "a", "a.", ".exr"] {
            let path = dir.path().join(name);
            let error = write(&path, &Image::new(1, 1), &Metadata::default()).unwrap_err();
            assert!(matches!(error, Error::Parameter { .. }), "{error}");
            assert!(error.hint().unwrap().contains(".exr, .pfm"));
            assert!(!path.exists());
        }
    }

    #[test]
    fn metadata_keep_their_order() {
        let metadata = Metadata::default().with("spp", 64).with("seed", 1).with("command", "render x");
        let names: Vec<&str> = metadata.entries().iter().map(|(n, _)| n.as_str()).collect();
        assert_eq!(names, ["spp", "seed", "command"]);
    }
}
