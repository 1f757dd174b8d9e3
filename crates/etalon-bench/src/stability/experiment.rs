//! One row of the study's table: a family's variant in one precision, its largest errors, and its impossible results; bounds on
//! the errors of the code that renders; and experiments whose exact results no formula of the inputs gives: sums, tables, paths.

pub use super::number::Precision;

use super::sweep::Case;
use etalon_core::error::Result;
use etalon_stats::Extremes;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Name of the variant that renders.
pub const STABLE: &str = "stable";
/// Name of the formula as books print it.
pub const TEXTBOOK: &str = "textbook";
/// Name of the formula of one of the two reports, where that is another one.
pub const REPORT: &str = "report";

/// A variant over all its cases. Field names are the CSV columns, except where noted.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ErrorRow {
    /// Name of the family, or of a part of an experiment.
    pub family: Cow<'static, str>,
    /// Which way of computing it.
    pub variant: &'static str,
    pub precision: Precision,
    /// Inputs that were tried.
    pub cases: u64,
    /// Largest |value − exact| / |exact|.
    #[serde(serialize_with = "finite_or_word")]
    pub max_relative: f64,
    /// Largest |value − exact| in units of the last place.
    #[serde(serialize_with = "finite_or_word")]
    pub max_ulp: f64,
    /// The condition number where the relative error is largest.
    #[serde(serialize_with = "finite_or_word")]
    pub condition_at_worst: f64,
    /// Largest error in units of the last place over the condition number (or 1 if that is less).
    #[serde(serialize_with = "finite_or_word")]
    pub max_ulp_per_condition: f64,
    /// Results that are infinite or not a number.
    pub non_finite: u64,
    /// Results below 0 of quantities that cannot be.
    pub negative: u64,
    /// Results that are impossible in another way.
    pub out_of_range: u64,
    /// The input of the largest relative error, as `--replay` takes it, or what it was.
    pub worst: String,
}

/// JSON knows no infinity.
fn finite_or_word<S: Serializer>(x: &f64, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    if x.is_finite() { serializer.serialize_f64(*x) } else { serializer.serialize_str(&x.to_string()) }
}

impl ErrorRow {
    /// Without any case yet.
    pub fn new(family: impl Into<Cow<'static, str>>, variant: &'static str, precision: Precision) -> Self {
        Self { family: family.into(), variant, precision, ..Self::default() }
    }

    /// Takes an error of a further case into the largest ones. `what` is called if it is the largest relative one.
    pub fn add(&mut self, relative: f64, ulp: f64, condition: f64, what: impl FnOnce() -> String) {
        self.max_ulp = self.max_ulp.at_least(ulp);
        self.max_ulp_per_condition = self.max_ulp_per_condition.at_least(ulp / condition.at_least(1.0));
        if self.worst.is_empty() || relative > self.max_relative || relative.is_nan() {
            (self.max_relative, self.condition_at_worst, self.worst) = (relative, condition, what());
        }
    }

    /// Compares one result with the exact one. `condition` is the sum of the summands' moduli over the result: rounding
    /// of the summands alone changes the result by that many units of its last place.
    pub fn compare(&mut self, value: f64, exact: f64, condition: f64, what: impl FnOnce() -> String) {
        self.cases += 1;
        self.non_finite += u64::from(!value.is_finite());
        self.negative += u64::from(value < 0.0);
        let error = if value == exact { 0.0 } else { (value - exact).abs() };
        let relative = if error == 0.0 { 0.0 } else { error / exact.abs() };
        self.add(relative, error / self.precision.unit(exact), condition, what);
    }

    /// Counts results of which only is known that they are finite and not negative.
    pub fn judge(&mut self, values: impl Iterator<Item = f64>, what: impl FnOnce() -> String) {
        self.cases += 1;
        let (finite, flawed): (Vec<f64>, Vec<f64>) = values.partition(|value| value.is_finite());
        let negative = finite.iter().any(|value| *value < 0.0);
        self.non_finite += u64::from(!flawed.is_empty());
        self.negative += u64::from(negative);
        self.out_of_range += u64::from(negative);
        if negative || !flawed.is_empty() {
            self.worst = what();
        }
    }

    /// Adds the errors that another thread found of the same variant.
    #[must_use]
    pub fn merge(mut self, other: Self) -> Self {
        if self.cases == 0 || other.max_relative > self.max_relative || other.max_relative.is_nan() {
            self.max_relative = other.max_relative;
            (self.condition_at_worst, self.worst) = (other.condition_at_worst, other.worst);
        }
        self.max_ulp = self.max_ulp.at_least(other.max_ulp);
        self.max_ulp_per_condition = self.max_ulp_per_condition.at_least(other.max_ulp_per_condition);
        self.cases += other.cases;
        self.non_finite += other.non_finite;
        self.negative += other.negative;
        self.out_of_range += other.out_of_range;
        self
    }

    /// What names of functions at special directions begin with.
    pub const SPECIAL: &str = "special/";

    /// Whether it is of a function at special directions.
    pub fn is_special(&self) -> bool {
        self.family.starts_with(Self::SPECIAL)
    }

    /// Whether its results were compared with exact ones.
    pub fn is_compared(&self) -> bool {
        !self.family.starts_with("special/bsdf/")
    }

    /// Whether the row is of the code that renders.
    pub fn is_rendered(&self) -> bool {
        self.variant.starts_with(STABLE)
    }
}

/// An upper bound of an error: `T` is a [`Case`] of a formula or the [`ErrorRow`] of an experiment.
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
    /// The error in units of the last place, over the condition number.
    ///
    /// Each of n roundings moves a value by at most half a unit of relative size ε, as if an input had been moved by as
    /// much. A last place is at least ε/2 of the value, so the result is within n last places times the condition number, in
    /// either precision, and typically within √n: each `reason` says which of the two its limit is.
    pub const fn roundings(limit: f64, reason: &'static str) -> Self {
        let error = |case: &Case| case.rendered().map(|d| d.ulp / case.amplification());
        Self { name: "last places over condition number", limit, reason, error }
    }
}

impl Bound<ErrorRow> {
    /// The number of impossible results, which must be 0.
    pub const fn possible(name: &'static str) -> Self {
        Self { name, limit: 0.0, reason: "each is a mistake", error: |row| Some(row.out_of_range as f64) }
    }
}

/// An experiment whose exact result is known by integers, by construction, or in closed form.
pub struct Experiment {
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// Id of the figure that shows it.
    pub figure: &'static str,
    /// Upper bounds of the errors of the code that renders.
    pub bounds: &'static [Bound<ErrorRow>],
    /// Runs it with an amount of work and a seed.
    pub run: fn(&Workload, u64) -> Result<Vec<ErrorRow>>,
}

/// How much work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Workload {
    /// Places along each side of the grids.
    pub side: usize,
    pub film_samples: u32,
    /// Columns and rows of the map whose tables are tested.
    pub map: [usize; 2],
    pub table_samples: u32,
    pub bounces: u32,
}

impl Workload {
    /// The effort of the subcommand.
    pub const FULL: Self =
        Self { side: 33, film_samples: 100_000_000, map: [8192, 4096], table_samples: 10_000_000, bounces: 10_000 };

    /// For figures: finer than a page shows, and a quarter of the map.
    pub const FIGURES: Self = Self { side: 25, map: [4096, 2048], ..Self::FULL };

    /// For a quick look: coarse grids, small sums.
    pub const QUICK: Self =
        Self { side: 9, film_samples: 1_000_000, map: [1024, 512], table_samples: 100_000, bounces: 10_000 };
}
