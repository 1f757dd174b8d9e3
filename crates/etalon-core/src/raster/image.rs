//! The image buffer: linear-light RGB, 32-bit float, row 0 at the top; its resizing by whole numbers; and what an image file says
//! about how its image was made.

use crate::math::{Rgb, hash_words};

/// A rectangle of linear RGB pixels. Row 0 is the top row.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl Image {
    /// A black image.
    ///
    /// # Panics
    /// When a side is 0.
    pub fn new(width: usize, height: usize) -> Self {
        Self::from_pixels(width, height, vec![Rgb::ZERO; width * height])
    }

    /// Wraps `pixels`, row by row from the top.
    ///
    /// # Panics
    /// When a side is 0 or `pixels.len() != width * height`: a bug of the caller, never of an input file.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<Rgb>) -> Self {
        assert!(width > 0 && height > 0 && pixels.len() == width * height, "{width}x{height}, {} pixels", pixels.len());
        Self { width, height, pixels }
    }

    /// Evaluates `f(x, y)` at every pixel.
    pub fn from_fn(width: usize, height: usize, mut f: impl FnMut(usize, usize) -> Rgb) -> Self {
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend((0..width).map(|x| f(x, y)));
        }
        Self::from_pixels(width, height, pixels)
    }

    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    #[inline]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// A hash of its size and all its values.
    pub fn hash(&self) -> u64 {
        let size = [self.width() as u32, self.height() as u32];
        hash_words(0, size.into_iter().chain(self.pixels.iter().flat_map(|p| p.to_array().map(f32::to_bits))))
    }

    pub fn pixels_mut(&mut self) -> &mut [Rgb] {
        &mut self.pixels
    }

    #[inline]
    pub fn row(&self, y: usize) -> &[Rgb] {
        &self.pixels[y * self.width..(y + 1) * self.width]
    }

    /// The pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside of the image.
    #[inline]
    pub fn get(&self, x: usize, y: usize) -> Rgb {
        self.row(y)[x]
    }

    /// Sets the pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside of the image.
    pub fn set(&mut self, x: usize, y: usize, value: Rgb) {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y * self.width + x] = value;
    }

    /// The image upside-down.
    #[must_use]
    pub fn flipped_vertically(mut self) -> Self {
        for y in 0..self.height / 2 {
            let (upper, lower) = self.pixels.split_at_mut((self.height - 1 - y) * self.width);
            upper[y * self.width..][..self.width].swap_with_slice(&mut lower[..self.width]);
        }
        self
    }

    /// The image with every pixel passed through `f`.
    pub fn map(&self, f: impl Fn(Rgb) -> Rgb) -> Self {
        Self { pixels: self.pixels.iter().map(|&p| f(p)).collect(), ..*self }
    }

    /// Every pixel repeated `factor` times in both directions (nearest neighbour).
    ///
    /// # Panics
    /// When `factor` is 0.
    pub fn enlarged(&self, factor: usize) -> Self {
        assert!(factor > 0, "enlarging by 0");
        Self::from_fn(self.width() * factor, self.height() * factor, |x, y| self.get(x / factor, y / factor))
    }

    /// The mean of each box of `factor` by `factor` pixels, summed in f64. Boxes at the right and bottom edge hold
    /// fewer pixels when a side is not a multiple of `factor`: sides are rounded up.
    ///
    /// # Panics
    /// When `factor` is 0.
    pub fn reduced(&self, factor: usize) -> Self {
        assert!(factor > 0, "reducing by 0");
        Self::from_fn(self.width().div_ceil(factor), self.height().div_ceil(factor), |x, y| {
            let columns = x * factor..((x + 1) * factor).min(self.width());
            let rows = y * factor..((y + 1) * factor).min(self.height());
            let count = (columns.len() * rows.len()) as f64;
            let sum = rows.flat_map(|row| &self.row(row)[columns.clone()]).fold([0.0; 3], |sum: [f64; 3], p| {
                [sum[0] + f64::from(p.x), sum[1] + f64::from(p.y), sum[2] + f64::from(p.z)]
            });
            Rgb::from_array(sum.map(|s| (s / count) as f32))
        })
    }
}

/// Value of the `software` attribute.
pub const SOFTWARE: &str = concat!("etalon ", env!("CARGO_PKG_VERSION"));

/// The attribute of a part with the program's [`Build`](crate::build::Build).
pub const BUILD_NAME: &str = "build";

/// What a file says about how its image was made: names and values, in order.
///
/// OpenEXR keeps them as text attributes, Radiance HDR as comment lines; the other formats cannot hold them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

impl Metadata {
    /// Adds an entry after those that are there, for example `.with("spp", 64)`.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.entries.push((name.into(), value.to_string()));
        self
    }

    /// All entries, in the order in which they were added.
    pub fn entries(&self) -> &[(String, String)] {
        &self.entries
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlarging_then_reducing_gives_the_image_back() {
        let image = Image::from_fn(3, 2, |x, y| Rgb::new(x as f32, y as f32, 0.1 * (x + y) as f32));
        let large = image.enlarged(4);
        assert_eq!((large.width(), large.height()), (12, 8));
        assert_eq!(large.get(7, 3), image.get(1, 0));
        assert_eq!(large.reduced(4), image);
    }

    #[test]
    fn boxes_at_the_edge_average_what_is_there() {
        let image = Image::from_fn(3, 1, |x, _| Rgb::splat([1.0, 3.0, 7.0][x]));
        let small = image.reduced(2);
        assert_eq!(small.pixels(), [Rgb::splat(2.0), Rgb::splat(7.0)]);
        assert_eq!((small.width(), small.height()), (2, 1));
    }
}
