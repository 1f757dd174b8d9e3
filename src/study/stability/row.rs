//! One line of the study's table: a family's form in one precision, its worst case, and what it got wrong.

use super::error::Flaw;
use super::family::{Family, Precision};
use super::sweep::{Case, Sweep};
use serde::{Serialize, Serializer};

/// A form over all its cases. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Row {
    pub family: &'static str,
    pub form: &'static str,
    pub precision: Precision,
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
    pub non_finite: u64,
    pub negative: u64,
    pub out_of_range: u64,
    /// The input of the largest relative error, as `--replay` takes it, or what it was.
    pub worst: String,
}

/// JSON knows no infinity.
fn finite_or_word<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if x.is_finite() { serializer.serialize_f64(*x) } else { serializer.serialize_str(&x.to_string()) }
}

impl Row {
    /// One line for each form and precision.
    #[must_use]
    pub fn of_sweep(sweep: &Sweep) -> Vec<Self> {
        let forms = 0..sweep.family.forms.len();
        let rows = forms.flat_map(|form| Precision::ALL.map(|precision| Self::of_form(sweep, form, precision)));
        rows.flatten().collect()
    }

    fn of_form(sweep: &Sweep, form: usize, precision: Precision) -> Option<Self> {
        let cases = sweep.cases.iter().filter(|case| case.precision == precision);
        let mut cases = cases.filter_map(|case| case.off[form].map(|off| (case, off))).peekable();
        cases.peek()?;
        let family = sweep.family;
        let mut row = Self { family: family.name, form: family.forms[form].name, precision, ..Self::default() };
        let mut worst = None;
        for (case, off) in cases {
            row.cases += 1;
            match off.flaw {
                Some(Flaw::NonFinite) => row.non_finite += 1,
                Some(Flaw::Negative) => row.negative += 1,
                Some(Flaw::OutOfRange) => row.out_of_range += 1,
                None => {}
            }
            // An answer that only rounding decides for or against is nobody's fault.
            if case.condition.is_infinite() {
                continue;
            }
            if worst.is_none() || off.relative > row.max_relative {
                (row.max_relative, worst) = (off.relative, Some(case));
            }
            row.max_ulp = row.max_ulp.max(off.ulp);
            row.max_ulp_per_condition = row.max_ulp_per_condition.max(off.ulp / case.condition.max(1.0));
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
