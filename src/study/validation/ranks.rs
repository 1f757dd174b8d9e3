//! The p-values of a run in ascending order, beside the distribution of p-values of right samplers at each rank.

use super::run::Validation;
use etalon_stats::Verdict;
use etalon_stats::multiple::holm_level;
use statrs::distribution::{Beta, ContinuousCDF};

/// The share of right samplers inside [`Ranked::interval`].
const INSIDE: f64 = 0.99;

/// One p-value at its rank i of n, from 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked {
    /// The p-value.
    pub p: f64,
    /// The verdict of its test.
    pub verdict: Verdict,
    /// i/(n + 1), the expected p-value of right samplers at this rank.
    pub expected: f64,
    /// Contains 99 % of the p-values of right samplers at this rank.
    pub interval: [f64; 2],
    /// Holm's threshold: a smaller p-value is rejected, if all before it are.
    pub threshold: f64,
}

impl Validation {
    /// The p-values of all tests that have one of continuous distribution, in ascending order.
    pub fn ranked(&self) -> Vec<Ranked> {
        let tests = self.tests.iter().map(|test| &test.outcome);
        let mut known: Vec<(f64, Verdict)> =
            tests.filter_map(|outcome| Some((outcome.continuous_p()?, outcome.verdict))).collect();
        // Sort by p-value: the rank of each decides its expected value and its threshold.
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = known.len();
        // Holm's step-down ranks all tests that have a p-value.
        let mut all: Vec<f64> = self.tests.iter().filter_map(|test| test.outcome.p).collect();
        all.sort_by(f64::total_cmp);
        let ranked = |(i, (p, verdict)): (usize, (f64, Verdict))| {
            // Of n uniform random numbers the i-th smallest is distributed as Beta(i, n − i + 1).
            let beta = Beta::new((i + 1) as f64, (n - i) as f64);
            let quantile = |share: f64| beta.as_ref().map_or(share, |beta| beta.inverse_cdf(share));
            Ranked {
                p,
                verdict,
                expected: (i + 1) as f64 / (n + 1) as f64,
                interval: [quantile(0.5 * (1.0 - INSIDE)), quantile(0.5 * (1.0 + INSIDE))],
                threshold: holm_level(self.level, self.tests.len(), all.partition_point(|&smaller| smaller < p)),
            }
        };
        known.into_iter().enumerate().map(ranked).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{run, select, suite};
    use etalon_stats::{Protocol, SampleCount, Verdict};

    #[test]
    fn ranks_ascend_and_thresholds_decide() {
        let cases = select(suite::cases(), &["warp".to_owned()]).unwrap();
        let protocol = Protocol { samples: SampleCount::Fixed(20_000), ..Protocol::default() };
        let found = run(&cases, &protocol, &|_| ()).unwrap();
        let ranked = found.ranked();
        assert!(ranked.len() > 3 && ranked.len() <= found.tests.len());
        for pair in ranked.windows(2) {
            assert!(
                pair[0].p <= pair[1].p && pair[0].expected < pair[1].expected && pair[0].threshold < pair[1].threshold
            );
        }
        for test in &ranked {
            assert!(test.interval[0] < test.expected && test.expected < test.interval[1], "{test:?}");
            assert!(test.verdict != Verdict::Reject || test.p < test.threshold, "{test:?}");
        }
    }
}
