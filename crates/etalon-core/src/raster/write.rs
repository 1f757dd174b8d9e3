//! Writing an image file: the format is picked by the extension, the file is written whole or not at all.

use super::exr::{Layer, Precision, write_exr};
use super::tone::ToneMap;
use super::{Image, Metadata, ldr, pfm, rgbe};
use crate::error::{Error, Result};
use crate::files::write_atomic;
use std::io::{self, Write};
use std::path::Path;

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
    use super::*;

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
