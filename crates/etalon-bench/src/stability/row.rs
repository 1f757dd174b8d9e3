//! One row of the study's table: a family's variant in one precision, its largest errors, and its impossible results; and bounds on
//! the errors of the code that renders.

pub use super::number::Precision;

use super::sweep::Case;
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
    /// Name of the family, or of a function at special directions.
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
        self.variant == STABLE
    }
}

/// An upper bound of an error of a formula.
pub struct Bound {
    /// Which error, in which unit.
    pub name: &'static str,
    /// The largest error for which it holds.
    pub limit: f64,
    /// Where the limit comes from: counted roundings, or the accuracy that the code states.
    pub reason: &'static str,
    /// The error; `None` where the bound says nothing.
    pub error: fn(&Case) -> Option<f64>,
}

impl Bound {
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
