//! The alias method: a piecewise-constant distribution drawn in constant time.

use super::batch::{BATCH, Batch};
use super::prefetch::prefetch;
use super::table::{Draw, inside};

/// Constant time per draw, but neither monotone nor invertible, which spoils stratified numbers.
///
/// Source: Walker 1977; built as in Vose, "A linear algorithm for generating random numbers with a given
/// distribution", IEEE Trans. Softw. Eng. 17(9), 1991.
#[derive(Debug, Clone)]
pub struct AliasTable {
    entries: Vec<AliasEntry>,
    total: f64,
}

#[derive(Debug, Clone, Copy)]
struct AliasEntry {
    /// Share of the bucket that belongs to the cell itself.
    keep: f32,
    /// The cell that owns the rest.
    other: u32,
    /// Probability of the cell, as the finished table realizes it.
    probability: f64,
}

impl AliasTable {
    /// From at least one and fewer than 2³² weights, all finite and ≥ 0.
    #[must_use]
    pub fn new(weights: &[f64]) -> Self {
        let n = weights.len();
        let total: f64 = weights.iter().sum();
        let mut entries: Vec<AliasEntry> =
            (0..n).map(|i| AliasEntry { keep: 1.0, other: i as u32, probability: 0.0 }).collect();
        if total <= 0.0 {
            return Self { entries, total: 0.0 };
        }
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
        let (mut small, mut large): (Vec<u32>, Vec<u32>) = (0..n as u32).partition(|&i| scaled[i as usize] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            let (s, l) = (s as usize, l as usize);
            entries[s] = AliasEntry { keep: scaled[s] as f32, other: l as u32, probability: 0.0 };
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l as u32);
            }
        }
        // What is left over is 1 but for rounding, unless its weight is 0: such a cell must never be drawn.
        let heaviest = (0..n).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
        for &i in &small {
            if weights[i as usize] == 0.0 {
                entries[i as usize] = AliasEntry { keep: 0.0, other: heaviest as u32, probability: 0.0 };
            }
        }
        let mut probability = vec![0.0; n];
        for (i, e) in entries.iter().enumerate() {
            probability[i] += f64::from(e.keep) / n as f64;
            probability[e.other as usize] += (1.0 - f64::from(e.keep)) / n as f64;
        }
        for (e, p) in entries.iter_mut().zip(probability) {
            e.probability = p;
        }
        Self { entries, total }
    }

    /// Sum of the weights; when it is 0 nothing can be drawn.
    #[inline]
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The bucket for `u`, and what is left of `u`.
    #[inline]
    fn bucket(&self, u: f64) -> (usize, f64) {
        let scaled = u * self.entries.len() as f64;
        let bucket = (scaled as usize).min(self.entries.len() - 1);
        (bucket, scaled - bucket as f64)
    }

    /// The cell that owns this place of a bucket, and the position inside the cell. Which of the two it is cannot be
    /// predicted, so it is chosen without a branch.
    #[inline]
    fn owner(&self, bucket: usize, rest: f64) -> (usize, f64) {
        let AliasEntry { keep, other, .. } = self.entries[bucket];
        let (keep, other) = (f64::from(keep), other as usize);
        let (cell, start, share) = if rest < keep { (bucket, 0.0, keep) } else { (other, keep, 1.0 - keep) };
        (cell, inside((rest - start) / share))
    }

    /// The cell for `u` in \[0, 1), and what is left of `u` as the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn draw(&self, u: f64) -> Option<Draw> {
        if self.total <= 0.0 {
            return None;
        }
        let (bucket, rest) = self.bucket(u);
        let (cell, offset) = self.owner(bucket, rest);
        Some(Draw { cell, offset, probability: self.probability(cell) })
    }

    /// [`AliasTable::draw`] for up to [`BATCH`] pairs at once, to the same bits, from weights that are not all 0. The
    /// cells are those of a grid with `width` columns; the second number of a pair is the position across the rows.
    /// `values` has one value per cell; those of the drawn cells are prefetched.
    ///
    /// Step by step for all of them, each step prefetching for the next, as [`super::table::Table2::draw_batch`] does.
    #[inline(always)]
    pub fn draw_batch<T>(&self, u: &[[f64; 2]], width: usize, values: &[T], out: &mut Batch) {
        let n = u.len().min(BATCH);
        let (u, cell, x, y) = (&u[..n], &mut out.cell[..n], &mut out.x[..n], &mut out.y[..n]);
        let (fx, fy, probability) = (&mut out.fx[..n], &mut out.fy[..n], &mut out.probability[..n]);
        for i in 0..n {
            (cell[i], fx[i]) = self.bucket(u[i][0]);
            fy[i] = inside(u[i][1]);
            prefetch(&self.entries, cell[i]);
        }
        for i in 0..n {
            (cell[i], fx[i]) = self.owner(cell[i], fx[i]);
            prefetch(&self.entries, cell[i]);
            prefetch(values, cell[i]);
        }
        for i in 0..n {
            (x[i], y[i]) = ((cell[i] % width) as u32, (cell[i] / width) as u32);
            probability[i] = self.probability(cell[i]);
        }
    }

    /// Probability of a cell, as the table realizes it.
    #[inline]
    #[must_use]
    pub fn probability(&self, cell: usize) -> f64 {
        self.entries[cell].probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::table::tests::weights;

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (alias, total) = (AliasTable::new(&w), w.iter().sum::<f64>());
            for (i, &wi) in w.iter().enumerate() {
                assert!((alias.probability(i) - wi / total).abs() < 1e-7);
                assert!(wi > 0.0 || alias.probability(i) == 0.0);
            }
        }
    }

    #[test]
    fn nothing_can_be_drawn_from_nothing() {
        assert_eq!(AliasTable::new(&[0.0]).draw(0.5), None);
    }

    #[test]
    fn alias_draws_its_own_probabilities() {
        let w = [1.0, 0.0, 3.0, 0.5, 0.5];
        let table = AliasTable::new(&w);
        let n = 100_000u32;
        let mut counts = [0u32; 5];
        for i in 0..n {
            counts[table.draw((f64::from(i) + 0.5) / f64::from(n)).unwrap().cell] += 1;
        }
        for (i, &c) in counts.iter().enumerate() {
            assert!((f64::from(c) / f64::from(n) - table.probability(i)).abs() < 5.0 / f64::from(n), "{counts:?}");
        }
    }
}
