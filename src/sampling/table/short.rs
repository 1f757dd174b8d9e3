//! Many distributions over as many cells each, in single precision and without a guide: small, and fast for up to some hundred
//! cells, among which a cell is found by counting those that end before it.

use super::cdf::{CellSample, inside};
use rayon::prelude::*;

/// Distributions over n cells each.
#[derive(Debug, Clone)]
pub struct ShortTables {
    cells: usize,
    /// One table after the other: n + 1 values from 0 to 1, or zeros where all weights are 0.
    cdf: Vec<f32>,
}

impl ShortTables {
    /// Memory for each cell, if tables are not of a few cells only.
    pub const BYTES: usize = size_of::<f32>();

    /// `count` tables from weights (finite, ≥ 0) of their cells, given through `weight(cell, table)`; and the sums of their
    /// weights.
    #[must_use]
    pub fn new(cells: usize, count: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> (Self, Vec<f64>) {
        let mut cdf = vec![0.0; (cells + 1) * count];
        let one = |(table, cdf): (usize, &mut [f32])| {
            let weights: Vec<f64> = (0..cells).map(|cell| weight(cell, table)).collect();
            fill(&weights, cdf)
        };
        let sums = cdf.par_chunks_mut(cells + 1).enumerate().map(one).collect();
        (Self { cells, cdf }, sums)
    }

    #[inline]
    fn of(&self, table: usize) -> &[f32] {
        &self.cdf[table * (self.cells + 1)..(table + 1) * (self.cells + 1)]
    }

    /// The cell of a table for `u` in \[0, 1) and the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, table: usize, u: f64) -> Option<CellSample> {
        let cdf = self.of(table);
        // What is at most u is at most u rounded down.
        let nearest = u as f32;
        let below = if f64::from(nearest) > u { nearest.next_down() } else { nearest };
        let cell = cdf[1..].iter().map(|&end| u32::from(end <= below)).sum::<u32>() as usize;
        let [start, end] = [*cdf.get(cell)?, *cdf.get(cell + 1)?].map(f64::from);
        Some(CellSample { cell, offset: inside((u - start) / (end - start)), probability: end - start })
    }

    /// Probability of a cell of a table.
    #[inline]
    #[must_use]
    pub fn probability(&self, table: usize, cell: usize) -> f64 {
        let cdf = self.of(table);
        f64::from(cdf[cell + 1]) - f64::from(cdf[cell])
    }
}

/// Fills a table and returns the sum of its weights. A cell of positive weight always gets a positive probability.
fn fill(weights: &[f64], cdf: &mut [f32]) -> f64 {
    let total: f64 = weights.iter().sum();
    let Some(last) = weights.iter().rposition(|&w| w > 0.0) else { return 0.0 };
    let mut sum = 0.0;
    for (i, &w) in weights.iter().enumerate() {
        sum += w;
        cdf[i + 1] = if w > 0.0 { ((sum / total) as f32).max(cdf[i].next_up()) } else { cdf[i] };
    }
    // Let the table end at 1 exactly, and restore increasing values from the right where rounding left no gap.
    cdf[last + 1..].fill(1.0);
    for i in (0..=last).rev() {
        let largest = if weights[i] > 0.0 { cdf[i + 1].next_down() } else { cdf[i + 1] };
        if cdf[i] <= largest {
            break;
        }
        cdf[i] = largest;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::super::cdf::weights;
    use super::*;

    #[test]
    fn probabilities_are_the_weights_and_samples_follow_them() {
        let black = vec![0.0; 5];
        for w in weights().into_iter().chain([black]).filter(|w| w.len() <= 1000) {
            let (n, zeros) = (w.len(), vec![0.0; w.len()]);
            // The table between others.
            let (tables, sums) = ShortTables::new(n, 3, |cell, table| if table == 1 { w[cell] } else { zeros[cell] });
            let total = w.iter().sum::<f64>();
            assert_eq!(sums, [0.0, total, 0.0]);
            for (i, &wi) in w.iter().enumerate() {
                let p = tables.probability(1, i);
                let expected = if total > 0.0 { wi / total } else { 0.0 };
                assert!((p - expected).abs() < 1e-4 && (p > 0.0) == (wi > 0.0), "{p} {expected}");
            }
            for u in (0..5000).map(|i| f64::from(i) / 5000.0).chain([f64::MIN_POSITIVE, 1.0f64.next_down()]) {
                let Some(at) = tables.sample(1, u) else {
                    assert_eq!(total, 0.0);
                    continue;
                };
                let start: f64 = (0..at.cell).map(|i| tables.probability(1, i)).sum();
                assert!(start <= u && u < start + at.probability && (0.0..1.0).contains(&at.offset));
                assert_eq!(at.probability, tables.probability(1, at.cell));
            }
            assert_eq!(tables.sample(0, 0.5), None);
        }
    }
}
