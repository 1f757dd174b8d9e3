//! The result of every decoder, and its limits on size and memory.

use super::Image;
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::memory;
use std::path::Path;

/// Larger images are refused: 2^28 pixels are 3 GiB in memory.
const MAX_PIXELS: u64 = 1 << 28;
/// No side may be longer than this.
const MAX_SIDE: u64 = 1 << 16;

/// A decoded file.
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
    /// The image and the notes.
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
