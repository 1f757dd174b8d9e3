//! An 8-bit image and its PNG file, which figures embed.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, Rgb, RgbImage};
use std::sync::{Arc, OnceLock};

/// An 8-bit RGB image (sRGB, row 0 at the top). Copies share its pixels, and its PNG file, which takes most of the time of
/// writing a figure.
#[derive(Debug, Clone)]
pub struct Rgb8(Arc<(RgbImage, OnceLock<Vec<u8>>)>);

impl Rgb8 {
    /// Wraps `data`.
    ///
    /// # Panics
    /// When `data` is shorter than `3 * width * height`: a bug of the caller, never of an input file.
    pub fn new(width: usize, height: usize, data: Vec<u8>) -> Self {
        RgbImage::from_raw(width as u32, height as u32, data).expect("three bytes a pixel").into()
    }

    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb(f(x as usize, y as usize))).into()
    }

    pub fn width(&self) -> usize {
        self.pixels().width() as usize
    }

    pub fn height(&self) -> usize {
        self.pixels().height() as usize
    }

    pub fn pixels(&self) -> &RgbImage {
        &self.0.0
    }

    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels().get_pixel(x as u32, y as u32).0
    }

    /// The image as a PNG file, encoded at the first call.
    pub fn png(&self) -> &[u8] {
        self.0.1.get_or_init(|| {
            let mut bytes = Vec::new();
            let pixels = self.pixels();
            // The best compression takes three times as long and saves less than 1 %.
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
                .write_image(pixels, pixels.width(), pixels.height(), ExtendedColorType::Rgb8)
                .expect("a sound image, written to memory");
            bytes
        })
    }
}

impl From<RgbImage> for Rgb8 {
    fn from(pixels: RgbImage) -> Self {
        Self(Arc::new((pixels, OnceLock::new())))
    }
}

impl PartialEq for Rgb8 {
    fn eq(&self, other: &Self) -> bool {
        self.pixels() == other.pixels()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_share_one_file_that_equality_does_not_see() {
        let image = || Rgb8::from_fn(31, 17, |x, y| [x as u8, y as u8, (x * y) as u8]);
        let (first, other) = (image(), image());
        let copy = first.clone();
        assert_eq!(&image::load_from_memory(first.png()).unwrap().into_rgb8(), first.pixels());
        assert!(std::ptr::eq(first.png(), copy.png()) && !std::ptr::eq(first.png(), other.png()));
        assert!(first.png() == other.png() && copy == image());
        assert_ne!(first, Rgb8::from_fn(31, 17, |_, _| [0; 3]));
        assert_ne!(Rgb8::new(2, 1, vec![7; 6]), Rgb8::new(1, 2, vec![7; 6]));
    }
}
