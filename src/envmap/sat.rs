//! Summed-area tables: the sum over any texel rectangle from four look-ups.

use super::latlong::Block;

/// Prefix sums in f64. In f32 the error of an 8×8 block beyond one texel of 10⁶ would be up to 2 %.
pub struct SummedArea {
    stride: usize,
    sums: Vec<f64>,
}

impl SummedArea {
    #[must_use]
    pub fn new(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let stride = width + 1;
        let mut sums = vec![0.0; stride * (height + 1)];
        for y in 0..height {
            let mut row = 0.0;
            for x in 0..width {
                row += value(x, y);
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
            }
        }
        Self { stride, sums }
    }

    /// Sum over a rectangle. The error is that of f64 relative to the sum of everything above and left of it.
    #[inline]
    #[must_use]
    pub fn sum(&self, r: Block) -> f64 {
        let at = |x: usize, y: usize| self.sums[y * self.stride + x];
        (at(r.x1, r.y1) - at(r.x0, r.y1)) - (at(r.x1, r.y0) - at(r.x0, r.y0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_sum_their_texels() {
        let value = |x: usize, y: usize| (x * x + 3 * y) as f64;
        let table = SummedArea::new(7, 5, value);
        for r in [
            Block { x0: 0, y0: 0, x1: 7, y1: 5 },
            Block { x0: 2, y0: 1, x1: 5, y1: 4 },
            Block { x0: 3, y0: 3, x1: 4, y1: 4 },
        ] {
            let direct: f64 = (r.y0..r.y1).flat_map(|y| (r.x0..r.x1).map(move |x| value(x, y))).sum();
            assert_eq!(table.sum(r), direct);
        }
    }
}
