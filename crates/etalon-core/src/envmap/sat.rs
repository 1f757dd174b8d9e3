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
