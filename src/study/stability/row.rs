//! One row of the study's table: a family's variant in one precision, its largest errors, and its impossible results.

use super::precision::Precision;
use super::variant::STABLE;
use serde::{Serialize, Serializer};

/// A variant over all its cases. Field names are the CSV columns, except where noted.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ErrorRow {
    /// Name of the family, or of a part of an experiment.
    pub family: &'static str,
    /// Which way of computing it; the column is called `form`.
    #[serde(rename = "form")]
    pub variant: &'static str,
    /// Precision of the computation.
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
fn finite_or_word<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if x.is_finite() { serializer.serialize_f64(*x) } else { serializer.serialize_str(&x.to_string()) }
}

impl ErrorRow {
    /// Whether the row is of the code that renders.
    #[must_use]
    pub fn is_rendered(&self) -> bool {
        self.variant.starts_with(STABLE)
    }
}
