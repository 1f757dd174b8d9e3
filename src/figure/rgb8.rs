//! An 8-bit image and its PNG file, which figures embed.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// An 8-bit RGB image (sRGB, three bytes a pixel, row 0 at the top). Copies share its pixels, and its PNG file, which
/// takes most of the time of writing a figure.
#[derive(Clone)]
pub struct Rgb8 {
    width: usize,
    height: usize,
    shared: Arc<Shared>,
}

struct Shared {
    data: Vec<u8>,
    png: OnceLock<Vec<u8>>,
}

impl Rgb8 {
    /// Wraps `data`.
    ///
    /// # Panics
    /// When a side is 0 or `data.len() != 3 * width * height`: a bug of the caller, never of an input file.
    #[must_use]
    pub fn new(width: usize, height: usize, data: Vec<u8>) -> Self {
        assert!(width > 0 && height > 0 && data.len() == 3 * width * height, "{width}x{height}, {} bytes", data.len());
        Self { width, height, shared: Arc::new(Shared { data, png: OnceLock::new() }) }
    }

    /// Evaluates `f(x, y)` at every pixel.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        let mut data = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            for x in 0..width {
                data.extend_from_slice(&f(x, y));
            }
        }
        Self::new(width, height, data)
    }

    /// In pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// In pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, row by row from the top.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.shared.data
    }

    /// The image as a PNG file, encoded at the first call.
    #[must_use]
    pub fn png(&self) -> &[u8] {
        self.shared.png.get_or_init(|| {
            let mut bytes = Vec::new();
            // The best compression takes three times as long and saves less than 1 %.
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
                .write_image(self.data(), self.width as u32, self.height as u32, ExtendedColorType::Rgb8)
                .expect("a sound image, written to memory");
            bytes
        })
    }
}

impl PartialEq for Rgb8 {
    fn eq(&self, other: &Self) -> bool {
        self.width == other.width && self.height == other.height && self.data() == other.data()
    }
}

impl Eq for Rgb8 {}

impl fmt::Debug for Rgb8 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Rgb8({}x{})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Rgb8 {
        Rgb8::from_fn(31, 17, |x, y| [x as u8, y as u8, (x * y) as u8])
    }

    #[test]
    fn the_file_holds_the_pixels() {
        let read = image::load_from_memory(image().png()).unwrap().into_rgb8();
        assert_eq!(read.dimensions(), (31, 17));
        assert_eq!(read.as_raw().as_slice(), image().data());
    }

    #[test]
    fn copies_share_one_file_that_equality_does_not_see() {
        let (first, other) = (image(), image());
        let copy = first.clone();
        assert!(std::ptr::eq(first.png(), copy.png()));
        assert!(!std::ptr::eq(first.png(), other.png()));
        assert_eq!(first.png(), other.png());
        assert_eq!(copy, image());
        assert_ne!(first, Rgb8::from_fn(31, 17, |_, _| [0; 3]));
        assert_ne!(Rgb8::new(2, 1, vec![7; 6]), Rgb8::new(1, 2, vec![7; 6]));
    }
}
