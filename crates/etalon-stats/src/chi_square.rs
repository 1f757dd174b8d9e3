//! Pearson's chi-square test of counts against expected counts.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The outcome of a test.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ChiSquare {
    /// Σ (O − E)² / E over the pooled cells.
    pub statistic: f64,
    /// Pooled cells minus one.
    pub dof: usize,
    /// Probability of a statistic at least this large if the counts follow the expectation.
    pub p: f64,
}

/// Fewest expected counts of a pooled cell.
pub const FEWEST: f64 = 5.0;

/// Tests `observed` against `expected` counts, cell by cell; the totals should agree.
///
/// Cells are pooled in ascending order of expectation until each group expects at least 5; what is left over joins the
/// last group, so nothing is dropped. A count where nothing is expected is impossible: p = 0. `None` when fewer than
/// two groups remain, which means too few samples for any verdict, or when an expectation is not finite.
///
/// The p-value is the survival function itself, not 1 − cdf, which would be 0 below 10⁻¹⁶.
#[must_use]
pub fn chi_square(observed: &[u64], expected: &[f64]) -> Option<ChiSquare> {
    if !expected.iter().all(|e| e.is_finite()) {
        return None;
    }
    let mut cells: Vec<(f64, f64)> = expected.iter().copied().zip(observed.iter().map(|&o| o as f64)).collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let impossible = cells.iter().any(|&(e, o)| e <= 0.0 && o > 0.0);
    let mut groups: Vec<(f64, f64)> = Vec::new();
    let mut open = (0.0, 0.0);
    for (e, o) in cells.into_iter().filter(|(e, _)| *e > 0.0) {
        open = (open.0 + e, open.1 + o);
        if open.0 >= FEWEST {
            groups.push(std::mem::take(&mut open));
        }
    }
    if let Some(last) = groups.last_mut() {
        *last = (last.0 + open.0, last.1 + open.1);
    }
    let dof = groups.len().checked_sub(1).filter(|dof| *dof > 0)?;
    let statistic: f64 = groups.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    let p = if impossible { 0.0 } else { ChiSquared::new(dof as f64).ok()?.sf(statistic) };
    Some(ChiSquare { statistic, dof, p })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_textbook_die() {
        // 60 throws: Σ = (5² + 2² + 1² + 2² + 0 + 10²)/10 = 13.4 with 5 degrees of freedom.
        let test = chi_square(&[5, 8, 9, 8, 10, 20], &[10.0; 6]).unwrap();
        assert!((test.statistic - 13.4).abs() < 1e-12);
        assert_eq!(test.dof, 5);
        assert!((test.p - 0.019_905).abs() < 1e-5, "{}", test.p);
    }

    #[test]
    fn nothing_is_dropped_by_pooling() {
        let test = chi_square(&[1, 2, 0, 50, 47], &[1.0, 1.0, 1.0, 48.0, 49.0]).unwrap();
        // The three small cells stay below 5 together, so they join the cell of 48.
        assert_eq!(test.dof, 1);
        assert!((test.statistic - (4.0 / 51.0 + 4.0 / 49.0)).abs() < 1e-12);
    }

    #[test]
    fn impossible_counts_and_too_few_samples() {
        assert_eq!(chi_square(&[1, 50, 49], &[0.0, 50.0, 50.0]).unwrap().p, 0.0);
        assert_eq!(chi_square(&[2, 2], &[2.0, 2.0]), None, "no verdict, rather than a pass");
        assert_eq!(chi_square(&[], &[]), None);
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(chi_square(&[50, 50, 7], &[50.0, 50.0, wrong]), None);
        }
    }

    #[test]
    fn tiny_p_values_are_not_zero() {
        let test = chi_square(&[900, 100], &[500.0, 500.0]).unwrap();
        assert!(test.p > 0.0 && test.p < 1e-100);
    }
}
