//! One line of the study's table: a family's variant in one precision, its worst case, and what it got wrong.

use super::error::Flaw;
use super::family::{Family, Precision};
use super::sweep::{Case, Sweep};
use serde::{Serialize, Serializer};

/// A variant over all its cases. Field names are the CSV columns, but for one.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Row {
    /// Name of the family, or of a part of an experiment.
    pub family: &'static str,
    /// Which way of computing it; the column is called `form`.
    #[serde(rename = "form")]
    pub variant: &'static str,
    /// That it ran in.
    pub precision: Precision,
    /// Inputs that were tried.
    pub cases: u64,
    /// Largest |answer − exact| / |exact|.
    #[serde(serialize_with = "finite_or_word")]
    pub max_relative: f64,
    /// Largest |answer − exact| in units of the last place.
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
    /// Results below 0 where there are none.
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

impl Row {
    /// One line for each variant and precision.
    #[must_use]
    pub fn of_sweep(sweep: &Sweep) -> Vec<Self> {
        let variants = 0..sweep.family.variants.len();
        let rows =
            variants.flat_map(|variant| Precision::ALL.map(|precision| Self::of_variant(sweep, variant, precision)));
        rows.flatten().collect()
    }

    fn of_variant(sweep: &Sweep, variant: usize, precision: Precision) -> Option<Self> {
        let cases = sweep.cases.iter().filter(|case| case.precision == precision);
        let mut cases = cases.filter_map(|case| case.deviations[variant].map(|deviation| (case, deviation))).peekable();
        cases.peek()?;
        let family = sweep.family;
        let mut row =
            Self { family: family.name, variant: family.variants[variant].name, precision, ..Self::default() };
        let mut worst = None;
        for (case, deviation) in cases {
            row.cases += 1;
            match deviation.flaw {
                Some(Flaw::NonFinite) => row.non_finite += 1,
                Some(Flaw::Negative) => row.negative += 1,
                Some(Flaw::OutOfRange) => row.out_of_range += 1,
                None => {}
            }
            // Rounding alone decides whether there is a value: not judged.
            if case.condition.is_infinite() {
                continue;
            }
            if worst.is_none() || deviation.relative > row.max_relative {
                (row.max_relative, worst) = (deviation.relative, Some(case));
            }
            row.max_ulp = row.max_ulp.max(deviation.ulp);
            row.max_ulp_per_condition = row.max_ulp_per_condition.max(deviation.ulp / case.condition.max(1.0));
        }
        if let Some(case) = worst {
            row.condition_at_worst = case.condition;
            row.worst = case.text(family);
        }
        Some(row)
    }
}

impl Case {
    /// The case as `--replay` takes it.
    #[must_use]
    pub fn text(&self, family: &Family) -> String {
        let inputs = family.inputs.iter().zip(&self.inputs);
        let inputs: Vec<String> = inputs.map(|(name, x)| format!("{name}={}", self.precision.text(*x))).collect();
        format!("{}:{}", family.name, inputs.join(","))
    }
}
