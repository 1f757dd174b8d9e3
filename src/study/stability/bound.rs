//! Bounds on the errors of the code that renders, and whether they hold.

use super::experiment::Experiment;
use super::family::{Family, Precision, STABLE};
use super::row::Row;
use super::sweep::{Case, Sweep};
use serde::Serialize;

/// What an error may be at most: `T` is a [`Case`] of a formula or the [`Row`] of an experiment.
pub struct Bound<T: 'static> {
    /// Which error, in which unit.
    pub name: &'static str,
    /// The largest error for which it holds.
    pub limit: f64,
    /// Where the limit comes from: counted roundings, or the accuracy that the code states.
    pub reason: &'static str,
    /// The error; `None` where the bound says nothing.
    pub error: fn(&T) -> Option<f64>,
}

impl Bound<Case> {
    /// The error in last places, over the condition number.
    ///
    /// Each of n roundings moves a value by at most half a unit of relative size ε, as if an input had been moved by as
    /// much. The result is then within n last places times the condition number, in either precision.
    pub const fn roundings(limit: f64, reason: &'static str) -> Self {
        Self { name: "last places over condition number", limit, reason, error: over_condition }
    }
}

fn over_condition(case: &Case) -> Option<f64> {
    case.deviations[0].map(|d| d.ulp / case.condition.max(1.0))
}

impl Bound<Row> {
    /// Results that are impossible in themselves: none may be.
    pub const fn possible(name: &'static str) -> Self {
        Self { name, limit: 0.0, reason: "each is a mistake", error: |row| Some(row.out_of_range as f64) }
    }
}

/// Half a unit of the last place of 1: the largest relative error of one rounding.
#[must_use]
pub fn rounding(precision: Precision) -> f64 {
    precision.unit(1.0) / 2.0
}

/// A bound, and the largest error that was found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BoundCheck {
    /// Family or experiment, and which error.
    pub name: String,
    /// The largest error.
    pub got: f64,
    /// What it may be.
    pub limit: f64,
    /// Whether the error is within the limit.
    #[serde(rename = "kept")]
    pub holds: bool,
    /// The input of the largest error, as `--replay` takes it.
    pub worst: String,
}

impl BoundCheck {
    /// The largest of some errors, each with its input. NaN violates every bound.
    fn new(name: String, limit: f64, errors: impl Iterator<Item = (f64, String)>) -> Self {
        let worse = |worst: (f64, String), found: (f64, String)| {
            if found.0 > worst.0 || found.0.is_nan() { found } else { worst }
        };
        let (got, worst) = errors.fold((0.0, String::new()), worse);
        Self { name, got, limit, holds: got <= limit, worst }
    }

    /// The bounds of a formula, over the cases of the variant that renders in which more than rounding decides.
    #[must_use]
    pub fn of_sweep(sweep: &Sweep) -> Vec<Self> {
        let Family { name, bounds, .. } = sweep.family;
        let check = |bound: &Bound<Case>| {
            let cases = sweep.cases.iter().filter(|case| case.condition.is_finite());
            let errors = cases.filter_map(|case| Some(((bound.error)(case)?, case)));
            let errors = errors.filter(|(error, _)| *error > 0.0 || error.is_nan());
            Self::new(
                format!("{name}: {}", bound.name),
                bound.limit,
                errors.map(|(e, case)| (e, case.text(sweep.family))),
            )
        };
        bounds.iter().map(check).collect()
    }

    /// The bounds of an experiment, over its rows of the code that renders.
    #[must_use]
    pub fn of_rows(experiment: &Experiment, rows: &[Row]) -> Vec<Self> {
        let check = |bound: &Bound<Row>| {
            let errors =
                rows.iter().filter(|row| row.is_rendered()).filter_map(|row| (bound.error)(row).map(|e| (e, row)));
            let name = format!("{}: {}", experiment.name, bound.name);
            Self::new(name, bound.limit, errors.map(|(error, row)| (error, row.worst.clone())))
        };
        experiment.bounds.iter().map(check).collect()
    }

    /// Whether all results of the code that renders are finite.
    #[must_use]
    pub fn finite(rows: &[Row]) -> Self {
        let lost: Vec<&Row> = rows.iter().filter(|row| row.is_rendered() && row.non_finite > 0).collect();
        let count: u64 = lost.iter().map(|row| row.non_finite).sum();
        let worst = lost.last().map_or(String::new(), |row| row.worst.clone());
        Self::new("results that are not finite".into(), 0.0, std::iter::once((count as f64, worst)))
    }
}

impl Row {
    /// Whether the row is of the code that renders.
    #[must_use]
    pub fn is_rendered(&self) -> bool {
        self.variant.starts_with(STABLE)
    }
}
