//! Whole-number resizing for display: every pixel repeated, or boxes of pixels averaged.

use super::Image;
use crate::math::Rgb;

impl Image {
    /// Every pixel repeated `factor` times in both directions (nearest neighbour).
    ///
    /// # Panics
    /// When `factor` is 0.
    #[must_use]
    pub fn enlarged(&self, factor: usize) -> Self {
        assert!(factor > 0, "enlarging by 0");
        Self::from_fn(self.width() * factor, self.height() * factor, |x, y| self.get(x / factor, y / factor))
    }

    /// The mean of each box of `factor` by `factor` pixels, summed in f64. Boxes at the right and bottom edge hold
    /// fewer pixels when a side is not a multiple of `factor`: sides are rounded up.
    ///
    /// # Panics
    /// When `factor` is 0.
    #[must_use]
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
