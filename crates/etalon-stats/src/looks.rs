//! Looks at the counts of a test before all samples are drawn: a large error shows in a small share of them.
//!
//! A test of N samples looks at the first n = 2¹³, 2¹⁴ … of them, up to N/2, and at all. It rejects at the first look whose
//! p-value is below that look's share of the level: nine tenths of it for all samples, the rest in equal shares for the
//! looks before. The shares sum to 1, so that a right sampler is rejected at any look with the level's probability at most.
//! A small share costs little: an error that is twice the stated one has a tiny p-value after half of the samples, and
//! nine tenths of the level take 1 % more samples than the whole level does.
//! Source: Lan & DeMets, "Discrete Sequential Boundaries for Clinical Trials", Biometrika 70(3), 1983 (a level spent over looks).

use crate::counting::BATCH;
use crate::extremes::Extremes;

/// The share of the level that the look at all samples has if there are others.
const LAST: f64 = 0.9;

/// The looks of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Looks {
    samples: u64,
    early: u32,
}

impl Looks {
    /// One look at all of `samples` samples.
    pub fn one(samples: u64) -> Self {
        Self { samples, early: 0 }
    }

    /// As many looks as `samples` samples have powers of two of batches before their half.
    pub fn at_doubling(samples: u64) -> Self {
        Self { samples, early: (samples / BATCH).checked_ilog2().unwrap_or(0) }
    }

    /// The number of all samples.
    pub fn samples(self) -> u64 {
        self.samples
    }

    /// The number of looks.
    pub fn count(self) -> f64 {
        f64::from(self.early + 1)
    }

    /// The numbers of samples at which to look before the end.
    pub fn early(self) -> impl Iterator<Item = u64> {
        (0..self.early).map(|look| BATCH << look)
    }

    /// The share of the level that the look at the first `samples` samples has.
    pub fn share(self, samples: u64) -> f64 {
        match self.early {
            0 => 1.0,
            _ if samples == self.samples => LAST,
            early => (1.0 - LAST) / f64::from(early),
        }
    }

    /// The p-value of the whole test, from the p-value of the look at which it ended.
    ///
    /// Let s be the look's share of the `level`, and let p decide this look: the whole then has p/s. A test that did not end
    /// before the last look rejects with a probability of (1 − s) `level` less than p says: above the level the whole has
    /// p + (1 − s) `level`. Both are at most x with a probability of at most x, for every x.
    pub fn overall(self, p: f64, samples: u64, level: f64) -> f64 {
        let share = self.share(samples);
        if p < share * level { p / share } else { (p + (1.0 - share) * level).at_most(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_double_up_to_half_and_share_the_level() {
        let looks = Looks::at_doubling(9 * BATCH);
        assert_eq!(looks.early().collect::<Vec<_>>(), [BATCH, 2 * BATCH, 4 * BATCH]);
        let shares: f64 = looks.early().chain([9 * BATCH]).map(|samples| looks.share(samples)).sum();
        assert!((shares - 1.0).abs() < 1e-15);
        for few in [1, BATCH, 2 * BATCH - 1] {
            assert_eq!(Looks::at_doubling(few), Looks::one(few));
            assert_eq!(Looks::one(few).overall(0.3, few, 0.01), 0.3);
        }
        assert_eq!(Looks::at_doubling(2 * BATCH).early().collect::<Vec<_>>(), [BATCH]);
    }

    #[test]
    fn the_p_value_of_the_whole_is_valid_at_all_levels() {
        // P(overall ≤ x) of independent looks at `level`, exactly.
        let (n, level) = (32 * BATCH, 0.05);
        let looks = Looks::at_doubling(n);
        for x in [1e-9, 0.001, 0.02, 0.05, 0.1, 0.7, 1.0] {
            // The largest p of a look that makes at most x, by bisection.
            let most = |samples: u64| {
                let (mut from, mut to) = (0.0, 1.0);
                for _ in 0..100 {
                    let middle = 0.5 * (from + to);
                    if looks.overall(middle, samples, level) <= x { from = middle } else { to = middle }
                }
                from
            };
            let (mut goes_on, mut probability) = (1.0, 0.0);
            for samples in looks.early() {
                let ends = looks.share(samples) * level;
                probability += goes_on * most(samples).min(ends);
                goes_on *= 1.0 - ends;
            }
            probability += goes_on * most(n);
            assert!(probability <= x * (1.0 + 1e-9), "{x}: {probability}");
            assert!(probability > 0.95 * x.min(1.0) - 1e-12, "{x}: {probability}");
        }
    }
}
