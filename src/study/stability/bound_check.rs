//! Whether the bounds on errors hold.

use super::bound::Bound;
use super::case::Case;
use super::experiment::Experiment;
use super::family::Family;
use super::row::ErrorRow;
use super::sweep::Sweep;
use serde::Serialize;

/// A bound, and the largest error that was found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BoundCheck {
    /// Family or experiment, and which error.
    pub name: String,
    /// The largest error.
    pub got: f64,
    /// The largest error that is allowed.
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

    /// The bounds of a formula, over the cases of the variant that renders. Cases where rounding alone decides whether
    /// there is a value are left out.
    #[must_use]
    pub fn of_sweep(sweep: &Sweep) -> Vec<Self> {
        let Family { name, bounds, .. } = sweep.family;
        let check = |bound: &Bound<Case>| {
            let cases = sweep.cases.iter().filter(|case| case.condition.is_finite());
            let errors = cases.filter_map(|case| Some(((bound.error)(case)?, case)));
            let errors = errors.filter(|(error, _)| *error > 0.0 || error.is_nan());
            let errors = errors.map(|(error, case)| (error, sweep.family.text(case)));
            Self::new(format!("{name}: {}", bound.name), bound.limit, errors)
        };
        bounds.iter().map(check).collect()
    }

    /// The bounds of an experiment, over its rows of the code that renders.
    #[must_use]
    pub fn of_rows(experiment: &Experiment, rows: &[ErrorRow]) -> Vec<Self> {
        let check = |bound: &Bound<ErrorRow>| {
            let rendered = rows.iter().filter(|row| row.is_rendered());
            let errors = rendered.filter_map(|row| Some(((bound.error)(row)?, row.worst.clone())));
            Self::new(format!("{}: {}", experiment.name, bound.name), bound.limit, errors)
        };
        experiment.bounds.iter().map(check).collect()
    }

    /// Whether all results of the code that renders are finite.
    #[must_use]
    pub fn finite(rows: &[ErrorRow]) -> Self {
        let lost: Vec<&ErrorRow> = rows.iter().filter(|row| row.is_rendered() && row.non_finite > 0).collect();
        let count: u64 = lost.iter().map(|row| row.non_finite).sum();
        let worst = lost.last().map_or(String::new(), |row| row.worst.clone());
        Self::new("results that are not finite".into(), 0.0, std::iter::once((count as f64, worst)))
    }
}
