//! Distributions over the cells of a line.

use super::cdf::{Cdf, CellSample, cdf_len, fill, guide_len};

/// A distribution over n cells of a line.
#[derive(Debug, Clone)]
pub struct Table1 {
    cdf: Vec<f64>,
    guide: Vec<u16>,
    total: f64,
}

impl Table1 {
    /// From at least one weight, all finite and ≥ 0.
    #[must_use]
    pub fn new(weights: &[f64]) -> Self {
        debug_assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0));
        let mut cdf = vec![0.0; cdf_len(weights.len())];
        // Finer than needed: few tables are of this kind, and they are used most.
        let mut guide = vec![0; guide_len(8 * weights.len())];
        let total = fill(weights, &mut cdf, &mut guide);
        Self { cdf, guide, total }
    }

    #[inline]
    fn view(&self) -> Cdf<'_> {
        Cdf { cdf: &self.cdf, guide: &self.guide }
    }

    /// Sum of the weights; when it is 0 nothing can be sampled.
    #[inline]
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The cell for `u` in \[0, 1) and the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f64) -> Option<CellSample> {
        (self.total > 0.0).then(|| self.view().sample(u))
    }

    /// Probability of a cell (not per length).
    #[inline]
    #[must_use]
    pub fn probability(&self, cell: usize) -> f64 {
        self.view().probability(cell)
    }

    /// The `u` that [`Table1::sample`] maps to this place.
    #[must_use]
    pub fn invert(&self, cell: usize, offset: f64) -> f64 {
        self.view().invert(cell, offset)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cdf::weights;
    use super::*;

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (table, total) = (Table1::new(&w), w.iter().sum::<f64>());
            let mut sum = 0.0;
            for (i, &wi) in w.iter().enumerate() {
                let p = table.probability(i);
                assert!((p - wi / total).abs() < 1e-12, "{p} {wi} {total}");
                assert_eq!(p > 0.0, wi > 0.0, "a cell of positive weight can be sampled");
                sum += p;
            }
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn sample_and_invert_are_inverse() {
        for w in weights() {
            let table = Table1::new(&w);
            for i in 0..2000 {
                let u = (f64::from(i) + 0.5) / 2000.0;
                let at = table.sample(u).unwrap();
                assert!(table.probability(at.cell) > 0.0);
                assert!((table.invert(at.cell, at.offset) - u).abs() < 2e-9 * at.probability + 1e-15);
            }
            // The ends of the interval never leave the table.
            for u in [0.0, f64::MIN_POSITIVE, 1.0f64.next_down()] {
                assert!(table.probability(table.sample(u).unwrap().cell) > 0.0);
            }
        }
    }
}
