//! The result of every decoder, its limits on size and memory, and the primaries of a file's colours.

use super::Image;
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::memory;
use std::path::Path;

/// Larger images are refused: 2^28 pixels are 3 GiB in memory.
const MAX_PIXELS: u64 = 1 << 28;
/// No side may be longer than this.
const MAX_SIDE: u64 = 1 << 16;

#[derive(Debug)]
pub struct Decoded {
    /// Linear RGB, row 0 at the top.
    pub image: Image,
    /// What was guessed or passed over, without the file's name.
    pub notes: Vec<String>,
    /// Whether the file says that it is a cube map.
    pub is_cube: bool,
}

/// What the alpha of an image says, which is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// There is no alpha, or it is 1 everywhere.
    Full,
    /// It is not 1 everywhere.
    Partial,
}

impl Coverage {
    /// What is to be said of it.
    pub fn note(self) -> Option<String> {
        (self == Self::Partial).then(|| "alpha, which is not 1 everywhere, is ignored".into())
    }
}

impl Decoded {
    pub fn into_parts(self) -> (Image, Vec<String>) {
        (self.image, self.notes)
    }
}

impl From<Image> for Decoded {
    fn from(image: Image) -> Self {
        Self { image, notes: Vec::new(), is_cube: false }
    }
}

/// Refuses a size that exceeds the limits, or that `bytes` bytes at `pixels_per_byte` cannot describe.
pub fn check_size(path: &Path, width: u64, height: u64, bytes: usize, pixels_per_byte: u64) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::input(path, format!("an image of {width}x{height} pixels")));
    }
    if width > MAX_SIDE || height > MAX_SIDE || width * height > MAX_PIXELS {
        return Err(Error::limit(path, format!("{width}x{height} pixels are more than is read"))
            .with_hint("at most 65536 a side and 2^28 in all; shrink the image, or the file is damaged"));
    }
    if width * height > (bytes as u64).saturating_mul(pixels_per_byte) {
        return Err(Error::input(path, format!("{bytes} bytes cannot hold the {width}x{height} pixels announced"))
            .with_hint("the file is damaged or cut off; fetch it again"));
    }
    Ok(())
}

/// A black image whose size has passed [`check_size`], if there is memory for it.
pub fn blank(path: &Path, width: usize, height: usize) -> Result<Image> {
    let mut pixels = reserve_pixels(path, width, height)?;
    pixels.resize(width * height, Rgb::ZERO);
    Ok(Image::from_pixels(width, height, pixels))
}

/// An empty vector with the capacity for the pixels of such an image, if there is memory for it.
pub fn reserve_pixels(path: &Path, width: usize, height: usize) -> Result<Vec<Rgb>> {
    memory::reserved(width * height, || format!("{}, {width}x{height} pixels", path.display()))
}

/// An error for a file that ends before its data does.
pub fn cut_off(path: &Path, needed: u64, present: usize) -> Error {
    Error::input(path, format!("the file ends early: {present} of at least {needed} bytes are there"))
        .with_hint("the file is cut off; fetch it again")
}

/// CIE x and y of red, green, blue and white in Rec. 709 (and sRGB).
const REC_709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];

/// Files round them to three or four digits.
const TOLERANCE: f32 = 1e-3;

/// A note on an image with these primaries and white point (CIE x and y of R, G, B, W), from the field `name`, unless they
/// are those of Rec. 709: colours are not converted. Some programs (HDR Shop) write zeros for unknown primaries.
pub(super) fn primaries_note(name: &str, found: [f32; 8]) -> Option<String> {
    let is_equal = found.iter().zip(REC_709).all(|(a, b)| (a - b).abs() <= TOLERANCE);
    (!is_equal && found != [0.0; 8])
        .then(|| format!("{name} {found:?} are not those of Rec. 709; R, G and B are taken as linear Rec. 709 anyway"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_primaries_are_told_from_rec_709() {
        assert_eq!(primaries_note("chromaticities", REC_709), None);
        assert_eq!(primaries_note("PRIMARIES", [0.0; 8]), None);
        assert_eq!(primaries_note("chromaticities", [0.6401, 0.33, 0.3, 0.6, 0.15, 0.06, 0.31271, 0.32902]), None);
        // AP0 of ACES, CIE XYZ, and what is no number.
        for other in [
            [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767],
            [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0],
            [f32::NAN; 8],
        ] {
            assert!(primaries_note("chromaticities", other).unwrap().contains("Rec. 709"));
        }
    }
}
