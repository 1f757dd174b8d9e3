//! Distributions over the cells of a grid: a table of rows, and one for each row.

use super::super::batch::{BATCH, Batch};
use super::super::prefetch::prefetch;
use super::cdf::{Cdf, CellSample, PROBES, bucket, cdf_len, fill, find, guide_len, inside};
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

    /// [`Table2::sample`] for up to [`BATCH`] pairs at once, to the same bits, from weights that are not all 0. `values`
    /// has one value per cell, row by row; those of the sampled cells are prefetched.
    ///
    /// A sample takes four dependent look-ups, and in a large map each waits for memory. So each step is done for all
    /// samples before the next one, and prefetches what that needs. The remaining arithmetic runs over plain arrays.
    #[inline(always)]
    pub fn sample_batch<T>(&self, u: &[[f64; 2]], values: &[T], out: &mut Batch) {
        let n = u.len().min(BATCH);
        let u = &u[..n];
        let (stride, guide_stride) = (cdf_len(self.width), guide_len(self.width));
        let buckets = (guide_stride - 2) as f64;
        let rows = self.rows.view();
        let (cell, x, y, bracket) = (&mut out.cell[..n], &mut out.x[..n], &mut out.y[..n], &mut out.bracket[..n]);
        let (fx, fy) = (&mut out.fx[..n], &mut out.fy[..n]);
        let (px, py) = (&mut out.column[..n], &mut out.probability[..n]);
        // Find the rows, and the places in the guides of their columns.
        for i in 0..n {
            let [v, u] = u[i];
            let (row, start, probability) = rows.find(v);
            (y[i], fy[i], py[i]) = (row as u32, v - start, probability);
            cell[i] = row * guide_stride + bucket(u, buckets);
            prefetch(&self.guide, cell[i]);
        }
        // Read from the guides which columns come into question.
        for i in 0..n {
            bracket[i] = [self.guide[cell[i]], self.guide[cell[i] + 1]];
            let first = y[i] as usize * stride + usize::from(bracket[i][0]);
            prefetch(&self.cdf, first);
            prefetch(&self.cdf, first + PROBES + 1);
        }
        // Find the columns.
        for i in 0..n {
            let u = u[i][1];
            let row = y[i] as usize;
            let (column, start, probability) = find(&self.cdf, row * stride, self.width, bracket[i], u);
            (x[i], fx[i], px[i]) = (column as u32, u - start, probability);
            cell[i] = row * self.width + column;
            prefetch(values, cell[i]);
        }
        // Compute positions inside the cells and the cells' probabilities.
        for i in 0..n {
            fx[i] = inside(fx[i] / px[i]);
            fy[i] = inside(fy[i] / py[i]);
            py[i] *= px[i];
        }
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
