//! Distributions over the cells of a grid: a table of rows, and one for each row.

use super::cdf::{Cdf, CellSample, cdf_len, fill, guide_len};
use super::line::Table1;
use rayon::prelude::*;

/// A cell of a grid and the position inside it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GridSample {
    /// The column, its probability within the row, and the position along x.
    pub x: CellSample,
    /// The row, its probability, and the position along y.
    pub y: CellSample,
}

impl GridSample {
    /// Probability of the cell: the very product that [`Table2::probability`] returns.
    #[inline]
    #[must_use]
    pub fn probability(&self) -> f64 {
        self.y.probability * self.x.probability
    }
}

/// A distribution over the cells of a grid: the row by the marginal table, then the column by the row's own table.
#[derive(Debug, Clone)]
pub struct Table2 {
    width: usize,
    rows: Table1,
    /// Tables of all rows, one after the other, with stride `cdf_len(width)`.
    cdf: Vec<f64>,
    /// Their guides, with stride `guide_len(width)`.
    guide: Vec<u16>,
}

impl Table2 {
    /// Memory that a table takes for each cell, if rows are not of a few cells only.
    pub const BYTES: usize = size_of::<f64>() + 2 * size_of::<u16>();

    /// From `width * height` weights (finite, ≥ 0) given row by row through `weight(x, y)`.
    #[must_use]
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let (stride, guide_stride) = (cdf_len(width), guide_len(width));
        let mut cdf = vec![0.0; stride * height];
        let mut guide = vec![0; guide_stride * height];
        let sums: Vec<f64> = cdf
            .par_chunks_mut(stride)
            .zip(guide.par_chunks_mut(guide_stride))
            .enumerate()
            .map_init(
                || vec![0.0; width],
                |weights, (y, (cdf, guide))| {
                    for (x, w) in weights.iter_mut().enumerate() {
                        *w = weight(x, y);
                    }
                    fill(weights, cdf, guide)
                },
            )
            .collect();
        Self { width, rows: Table1::new(&sums), cdf, guide }
    }

    /// Sum of the weights; when it is 0 nothing can be sampled.
    #[inline]
    #[must_use]
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    #[inline]
    fn row(&self, y: usize) -> Cdf<'_> {
        let (stride, guide_stride) = (cdf_len(self.width), guide_len(self.width));
        Cdf {
            cdf: &self.cdf[y * stride..(y + 1) * stride],
            guide: &self.guide[y * guide_stride..(y + 1) * guide_stride],
        }
    }

    /// Samples the row with `u[0]`, then the column with `u[1]`, both in \[0, 1); `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> Option<GridSample> {
        let y = self.rows.sample(u[0])?;
        Some(GridSample { x: self.row(y.cell).sample(u[1]), y })
    }

    /// Probability of a cell (not per area).
    #[inline]
    #[must_use]
    pub fn probability(&self, x: usize, y: usize) -> f64 {
        self.rows.probability(y) * self.row(y).probability(x)
    }

    /// The `u` that [`Table2::sample`] maps to this place in cell (x, y).
    #[must_use]
    pub fn invert(&self, (x, y): (usize, usize), (fx, fy): (f64, f64)) -> [f64; 2] {
        [self.rows.invert(y, fy), self.row(y).invert(x, fx)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_dimensions_factor() {
        let w = |x: usize, y: usize| ((x + 2 * y) % 4) as f64;
        let table = Table2::new(5, 3, w);
        let mut sum = 0.0;
        for y in 0..3 {
            for x in 0..5 {
                assert!((table.probability(x, y) - w(x, y) / table.total()).abs() < 1e-15);
                sum += table.probability(x, y);
            }
        }
        assert!((sum - 1.0).abs() < 1e-14);
        for i in 0..400 {
            let u = [(f64::from(i % 20) + 0.3) / 20.0, (f64::from(i / 20) + 0.7) / 20.0];
            let at = table.sample(u).unwrap();
            assert!(w(at.x.cell, at.y.cell) > 0.0);
            let back = table.invert((at.x.cell, at.y.cell), (at.x.offset, at.y.offset));
            assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9);
        }
    }
}
