//! Many distributions over as many cells each.

use super::cdf::{Cdf, CellSample, cdf_len, fill, guide_len};
use rayon::prelude::*;

/// Distributions over n cells each, one table after the other.
#[derive(Debug, Clone)]
pub struct Tables {
    cells: usize,
    /// With stride `cdf_len(cells)`.
    pub(super) cdf: Vec<f64>,
    /// With stride `guide_len(cells)`.
    pub(super) guide: Vec<u16>,
}

impl Tables {
    /// Memory for each cell, if tables are not of a few cells only.
    pub const BYTES: usize = size_of::<f64>() + 2 * size_of::<u16>();

    /// `count` tables from weights (finite, ≥ 0) of their cells, given through `weight(cell, table)`; and the sums of their
    /// weights.
    #[must_use]
    pub fn new(cells: usize, count: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> (Self, Vec<f64>) {
        let (stride, guide_stride) = (cdf_len(cells), guide_len(cells));
        let mut cdf = vec![0.0; stride * count];
        let mut guide = vec![0; guide_stride * count];
        let sums = cdf
            .par_chunks_mut(stride)
            .zip(guide.par_chunks_mut(guide_stride))
            .enumerate()
            .map_init(
                || vec![0.0; cells],
                |weights, (table, (cdf, guide))| {
                    for (cell, w) in weights.iter_mut().enumerate() {
                        *w = weight(cell, table);
                    }
                    fill(weights, cdf, guide)
                },
            )
            .collect();
        (Self { cells, cdf, guide }, sums)
    }

    #[inline]
    pub(super) fn of(&self, table: usize) -> Cdf<'_> {
        let (stride, guide_stride) = (cdf_len(self.cells), guide_len(self.cells));
        Cdf {
            cdf: &self.cdf[table * stride..(table + 1) * stride],
            guide: &self.guide[table * guide_stride..(table + 1) * guide_stride],
        }
    }

    /// The cell of a table for `u` in \[0, 1) and the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, table: usize, u: f64) -> Option<CellSample> {
        let cdf = self.of(table);
        (cdf.cdf[self.cells] > 0.0).then(|| cdf.sample(u))
    }

    /// Probability of a cell of a table.
    #[inline]
    #[must_use]
    pub fn probability(&self, table: usize, cell: usize) -> f64 {
        self.of(table).probability(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_table_has_its_own_weights() {
        let weight = |cell: usize, table: usize| if table == 1 { 0.0 } else { (cell * (table + 1) % 4) as f64 };
        let (tables, sums) = Tables::new(7, 3, weight);
        for (table, sum) in sums.iter().enumerate() {
            for cell in 0..7 {
                let expected = if *sum > 0.0 { weight(cell, table) / sum } else { 0.0 };
                assert!((tables.probability(table, cell) - expected).abs() < 1e-15);
            }
            for i in 0..100 {
                let sample = tables.sample(table, f64::from(i) / 100.0);
                assert_eq!(sample.is_some(), *sum > 0.0);
                assert!(sample.is_none_or(|at| weight(at.cell, table) > 0.0));
            }
        }
    }
}
