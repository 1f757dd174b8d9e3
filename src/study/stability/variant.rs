//! Ways of computing a quantity: the code that renders, textbook formulas, formulas of the reports.

use super::number::{Formula, Machine, Value};
use super::precision::Precision;
use crate::math::Real;

/// Name of the variant that renders.
pub const STABLE: &str = "stable";
/// Name of the formula as books print it.
pub const TEXTBOOK: &str = "textbook";
/// Name of the formula of one of the two reports, where that is another one.
pub const REPORT: &str = "report";

/// One way of computing a family's quantity.
pub struct Variant {
    /// Its name in tables.
    pub name: &'static str,
    /// The formula in f32.
    pub single: Formula<f32>,
    /// The formula in f64; `None` for code that exists in f32 alone.
    pub double: Option<Formula<f64>>,
}

/// A [`Variant`] of one generic formula in both precisions: `variant!(NAME, formula)`.
macro_rules! variant {
    ($name:expr, $formula:expr) => {
        $crate::study::stability::variant::Variant::new($name, $formula, $formula)
    };
}
pub(super) use variant;

impl Variant {
    /// A variant in both precisions.
    pub const fn new(name: &'static str, single: fn(&[f32]) -> Value<f32>, double: fn(&[f64]) -> Value<f64>) -> Self {
        Self { name, single, double: Some(double) }
    }

    /// A variant that exists in f32 alone.
    pub const fn single(name: &'static str, single: fn(&[f32]) -> Value<f32>) -> Self {
        Self { name, single, double: None }
    }

    /// The variant's value for inputs that are numbers of that precision; `None` where it does not exist in it.
    pub fn evaluate(&self, precision: Precision, inputs: &[f64]) -> Option<Value<f64>> {
        match precision {
            Precision::Single => Some(evaluate(self.single, inputs)),
            Precision::Double => self.double.map(|formula| evaluate(formula, inputs)),
        }
    }
}

fn evaluate<T: Machine>(formula: fn(&[T]) -> Value<T>, inputs: &[f64]) -> Value<f64> {
    let inputs: Vec<T> = inputs.iter().map(|&x| Real::from_f64(x)).collect();
    formula(&inputs).map(|value| value.map(Real::to_f64))
}
