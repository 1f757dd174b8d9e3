//! The alias method: a piecewise-constant distribution sampled in constant time.

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

    /// The cell for `u` in \[0, 1) and its probability; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f64) -> Option<(usize, f64)> {
        if self.total <= 0.0 {
            return None;
        }
        let scaled = u * self.entries.len() as f64;
        let bucket = (scaled as usize).min(self.entries.len() - 1);
        let AliasEntry { keep, other, .. } = self.entries[bucket];
        let cell = if scaled - (bucket as f64) < f64::from(keep) { bucket } else { other as usize };
        Some((cell, self.probability(cell)))
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
