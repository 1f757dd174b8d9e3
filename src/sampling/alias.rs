//! The alias method: a piecewise-constant distribution sampled in constant time.

use super::batch::{BATCH, Batch};
use super::prefetch::prefetch;
use super::table::{CellSample, inside};

/// An alias table: constant time per sample, but neither monotone nor invertible, so that stratification is lost.
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

/// The end of a stack of entries.
const END: u32 = u32::MAX;

/// Puts an entry on a stack, given by its top.
fn push(entries: &mut [AliasEntry], top: &mut u32, i: u32) {
    entries[i as usize].other = *top;
    *top = i;
}

impl AliasTable {
    /// Memory that a table takes for each weight.
    pub const BYTES: usize = size_of::<AliasEntry>();

    /// From the weights `weight(0)` to `weight(n − 1)`, at least one and fewer than 2³², all finite and ≥ 0, each of which is
    /// asked for several times.
    ///
    /// While the table is built it needs no memory beside its entries: those that are not finished hold their scaled
    /// weight as their probability, and are linked into two stacks, of small and of large ones, through `other`.
    #[must_use]
    pub fn from_fn(n: usize, weight: impl Fn(usize) -> f64) -> Self {
        let total: f64 = (0..n).map(&weight).sum();
        let mut entries: Vec<AliasEntry> =
            (0..n).map(|i| AliasEntry { keep: 1.0, other: i as u32, probability: 0.0 }).collect();
        if total <= 0.0 {
            return Self { entries, total: 0.0 };
        }
        let [mut small, mut large] = [END; 2];
        for i in 0..n {
            let scaled = weight(i) / total * n as f64;
            entries[i].probability = scaled;
            push(&mut entries, if scaled < 1.0 { &mut small } else { &mut large }, i as u32);
        }
        // Fill up each small entry from a large one, which may become small thereby.
        while small != END && large != END {
            let (s, l) = (small, large as usize);
            small = entries[s as usize].other;
            let scaled = entries[s as usize].probability;
            entries[s as usize] = AliasEntry { keep: scaled as f32, other: l as u32, probability: 0.0 };
            entries[l].probability -= 1.0 - scaled;
            if entries[l].probability < 1.0 {
                large = entries[l].other;
                push(&mut entries, &mut small, l as u32);
            }
        }
        // Entries that remain are 1 up to rounding, unless their weight is 0: such a cell must never be sampled.
        let heaviest = (0..n).max_by(|&a, &b| weight(a).total_cmp(&weight(b))).unwrap_or(0);
        for mut next in [small, large] {
            while next != END {
                let i = next as usize;
                next = entries[i].other;
                let (keep, other) = if weight(i) == 0.0 { (0.0, heaviest) } else { (1.0, i) };
                entries[i] = AliasEntry { keep, other: other as u32, probability: 0.0 };
            }
        }
        // Compute the probabilities that the finished table realizes.
        for i in 0..n {
            let AliasEntry { keep, other, .. } = entries[i];
            entries[i].probability += f64::from(keep) / n as f64;
            entries[other as usize].probability += (1.0 - f64::from(keep)) / n as f64;
        }
        Self { entries, total }
    }

    /// Sum of the weights; when it is 0 nothing can be sampled.
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

    /// The cell that owns this place of a bucket, and the position inside the cell. The processor cannot predict which of
    /// the two cells it is, so the choice has no branch.
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
    pub fn sample(&self, u: f64) -> Option<CellSample> {
        if self.total <= 0.0 {
            return None;
        }
        let (bucket, rest) = self.bucket(u);
        let (cell, offset) = self.owner(bucket, rest);
        Some(CellSample { cell, offset, probability: self.probability(cell) })
    }

    /// [`AliasTable::sample`] for up to [`BATCH`] pairs at once, to the same bits, from weights that are not all 0. The
    /// cells are those of a grid with `width` columns; the second random number of a pair is the position across the rows.
    /// `values` has one value per cell; those of the sampled cells are prefetched.
    ///
    /// Step by step for all of them, each step prefetching for the next, as [`super::table::Table2::sample_batch`] does.
    #[inline(always)]
    pub fn sample_batch<T>(&self, u: &[[f64; 2]], width: usize, values: &[T], out: &mut Batch) {
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
    use crate::sampling::table::weights;

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (alias, total) = (AliasTable::from_fn(w.len(), |i| w[i]), w.iter().sum::<f64>());
            for (i, &wi) in w.iter().enumerate() {
                assert!((alias.probability(i) - wi / total).abs() < 1e-7);
                assert!(wi > 0.0 || alias.probability(i) == 0.0);
            }
        }
    }
}
