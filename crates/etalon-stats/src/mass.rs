//! The integral of a density, with a bound of its error and what this bound rests on.

use crate::bounded::mean_interval;
use crate::counting::{Share, Tally};
use crate::cubature::{Check, Integrals};
use crate::extremes::Extremes;
use statrs::distribution::{ContinuousCDF, Normal};
use std::fmt;

/// What the bound of an error rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Bound {
    /// On declared structure: the integral is an exact sum.
    Rigorous,
    /// On random points and samples: it fails with a small probability, if the samples follow the pdf.
    Statistical,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Rigorous => "rigorous",
            Self::Statistical => "statistical",
        })
    }
}

/// An integral and the bound of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Integral {
    /// The estimate.
    #[cfg_attr(feature = "serde", serde(rename = "mass"))]
    pub value: f64,
    /// The bound of its absolute error.
    #[cfg_attr(feature = "serde", serde(rename = "mass_error"))]
    pub error: f64,
    /// What the bound rests on.
    #[cfg_attr(feature = "serde", serde(rename = "mass_bound"))]
    pub bound: Bound,
}

impl Integral {
    /// The sum over the cells where every cell's integral is exact.
    #[must_use]
    pub(crate) fn exact(integrals: &Integrals) -> Self {
        Self { value: integrals.values.iter().sum(), error: 0.0, bound: Bound::Rigorous }
    }

    /// The integral of a density that the cubature may partly miss; its bound fails with probability `risk` at most.
    ///
    /// Let q be the density p clamped to what each piece of the cells is expected to reach. The polynomials that the rules
    /// integrate exactly have the integral of q minus the mean difference at random points (`check`). For samples x of p,
    /// the mean of q(x)/p(x) is ∫q/∫p (`tally`): samples fall into every spike with the probability of its mass, however narrow it is.
    #[must_use]
    pub(crate) fn measured(integrals: &Integrals, check: &Check, tally: &Tally, risk: f64) -> Self {
        let polynomials: f64 = integrals.values.iter().sum();
        let (cells, risk) = (integrals.values.len(), risk / 3.0);
        let samples = tally.observed[..cells].iter().sum::<u64>();
        let interval = |sum: f64, n: u64| {
            let mean = if n > 0 { sum / n as f64 } else { 0.0 };
            let [low, high] = mean_interval(mean, n, risk);
            [low, mean, high]
        };
        let above = interval(check.total(0), check.count);
        let below = interval(check.total(1), check.count);
        let missed = interval(Share::total(tally.missed.iter().copied()), samples);
        // The lower ends, the means and the upper ends of the three intervals, as they affect the integral.
        let [least, value, most] = [0, 1, 2].map(|i| {
            let within_reach = (polynomials + check.reach * (above[i] - below[2 - i])).at_least(0.0);
            if within_reach == 0.0 { 0.0 } else { within_reach / (1.0 - missed[i]) }
        });
        Self { value, error: (most - value).at_least(value - least), bound: Bound::Statistical }
    }

    /// The sum over cells whose integrals have independent standard errors; its bound fails with probability `risk` at most. Samples tell
    /// what the points of the integrals miss.
    #[must_use]
    pub(crate) fn of_standard_errors(integrals: &Integrals, tally: &Tally, risk: f64) -> Self {
        let sum: f64 = integrals.values.iter().sum();
        let error = integrals.errors.iter().fold(0.0, |all: f64, error| all.hypot(*error));
        let samples = tally.observed[..integrals.values.len()].iter().sum::<u64>();
        let missed = Share::total(tally.missed.iter().copied()) / samples.max(1) as f64;
        let [_, most] = mean_interval(missed, samples, 0.5 * risk);
        let error = Normal::standard().inverse_cdf(1.0 - 0.25 * risk) * error;
        Self { value: sum / (1.0 - missed), error: (sum + error) / (1.0 - most) - sum, bound: Bound::Statistical }
    }

    /// The integral with something added that is known exactly.
    #[must_use]
    pub(crate) fn plus(self, known: f64) -> Self {
        Self { value: self.value + known, ..self }
    }
}

impl fmt::Display for Integral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bound {
            Bound::Rigorous => f.pad(&format!("{:.6} rigorous", self.value)),
            Bound::Statistical => f.pad(&format!("{:.6} ± {:.1e} statistical", self.value, self.error)),
        }
    }
}
