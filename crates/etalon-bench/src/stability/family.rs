//! A family of formulas for one quantity: its inputs, the grids that they are swept over, the reference and the variants (the code that
//! renders, textbook formulas, formulas of the reports); the rows of their errors and the bounds on these; and inputs that several
//! families share: directions, their scales, and sin² θ by two formulas.
//!
//! Families import all of it, and what it re-exports.

pub use super::number::{Machine, Number, Precision, Value, cross, dot, minus, normalized, scalar};
pub use super::sweep::{Case, Range};

use super::number::{Formula, Precise};
use etalon_core::math::Real;
use etalon_stats::Extremes;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Formulas for one quantity, swept over grids of their inputs.
pub struct Family {
    pub name: &'static str,
    /// The quantity, in a line.
    pub about: &'static str,
    /// Id of the figure that shows it.
    pub figure: &'static str,
    /// Names of the inputs, as replays give them.
    pub inputs: &'static [&'static str],
    /// Least and largest value of each of the first inputs; the others may be any number.
    pub domains: &'static [(f64, f64)],
    /// The grids that the inputs are swept over.
    pub sections: &'static [Section],
    /// Inputs that no grid of equal factors reaches, such as zeros and poles.
    pub edges: &'static [&'static [f64]],
    /// The defining formula, at the very input that the variants get.
    pub reference: fn(&[Precise]) -> Value<Precise>,
    /// The first is the one that renders.
    pub variants: &'static [Variant],
    /// The values that the quantity can have.
    pub range: Range,
    /// Upper bounds of the errors of the variant that renders.
    pub bounds: &'static [Bound],
    /// Divisor of the number of places along the sides of the grids, where the reference takes long.
    pub coarser: usize,
}

impl Family {
    /// Whether any variant exists in that precision.
    pub fn runs_in(&self, precision: Precision) -> bool {
        precision == Precision::Single || self.variants.iter().any(|variant| variant.double.is_some())
    }

    /// A case as `--replay` takes it.
    pub fn text(&self, case: &Case) -> String {
        let inputs = self.inputs.iter().zip(&case.inputs);
        let inputs: Vec<String> = inputs.map(|(name, x)| format!("{name}={}", case.precision.text(*x))).collect();
        format!("{}:{}", self.name, inputs.join(","))
    }
}

/// Domain of dielectrics' indices of refraction: their squares neither overflow nor underflow in f32.
pub const INDEX: (f64, f64) = (1e-18, 1e18);
/// Domain of cosines: what rounding makes of −1 to 1.
pub const COSINES: (f64, f64) = (-1.000_001, 1.000_001);
/// Domain of what must be positive, such as widths and radii.
pub const POSITIVE: (f64, f64) = (f32::MIN_POSITIVE as f64, f32::MAX as f64);

pub struct Section {
    /// What the grid spans.
    pub title: &'static str,
    /// From left to right.
    pub x: Scale,
    /// From bottom to top.
    pub y: Scale,
    /// The inputs at a place of the grid.
    pub at: fn(f64, f64) -> Vec<f64>,
}

impl Section {
    pub const fn new(title: &'static str, x: Scale, y: Scale, at: fn(f64, f64) -> Vec<f64>) -> Self {
        Self { title, x, y, at }
    }
}

/// One side of a grid: equal factors between two ends.
pub struct Scale {
    pub label: &'static str,
    pub from: f64,
    pub to: f64,
}

impl Scale {
    /// Equal factors from `from` to `to`.
    pub const fn new(label: &'static str, from: f64, to: f64) -> Self {
        Self { label, from, to }
    }

    /// Place number `i` of `n`, both ends included.
    pub fn at(&self, i: usize, n: usize) -> f64 {
        match i {
            0 => self.from,
            _ if i + 1 == n => self.to,
            _ => self.from * (self.to / self.from).powf(i as f64 / (n - 1) as f64),
        }
    }
}

/// Cosines from grazing to normal incidence.
pub const COSINE: Scale = Scale::new("cos /{θ}", 1e-12, 1.0);

/// Widths of microfacet distributions, from almost smooth to rougher than any material.
pub const ALPHA: Scale = Scale::new("/{α}", 1e-5, 10.0);

/// The unit vector of that cos θ, off all symmetries in azimuth.
pub fn of_cosine(cos: f64) -> [f64; 3] {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    [0.6 * sin, 0.8 * sin, cos]
}

/// The unit vector of that tan θ.
pub fn of_slope(tan: f64) -> [f64; 3] {
    let cos = (1.0 + tan * tan).sqrt().recip();
    [0.6 * tan * cos, 0.8 * tan * cos, cos]
}

/// The modulus of a cosine, at most 1.
pub fn incidence<T: Number>(cos: T) -> T {
    let (cos, one) = (if cos < T::of(0.0) { -cos } else { cos }, T::of(1.0));
    if cos > one { one } else { cos }
}

/// A number and the components of a vector, as inputs of a family.
pub fn with(number: f64, [x, y, z]: [f64; 3]) -> Vec<f64> {
    vec![number, x, y, z]
}

/// The vector whose components start at input `first`.
pub fn vector<T: Number>(inputs: &[T], first: usize) -> [T; 3] {
    std::array::from_fn(|c| inputs[first + c])
}

/// sin² θ = x² + y², without cancellation.
pub fn sin2_from_xy<T: Number>(w: [T; 3]) -> T {
    w[0].square() + w[1].square()
}

/// sin² θ = 1 − cos² θ, as books and most renderers have it.
pub fn sin2_from_z<T: Number>(w: [T; 3]) -> T {
    T::of(1.0) - w[2].square()
}

/// One way of computing a family's quantity.
pub struct Variant {
    pub name: &'static str,
    pub single: Formula<f32>,
    /// The formula in f64; `None` for code that exists in f32 alone.
    pub double: Option<Formula<f64>>,
}

/// A [`Variant`] of one generic formula in both precisions: `variant!(NAME, formula)`.
macro_rules! variant {
    ($name:expr, $formula:expr) => {
        $crate::stability::family::Variant::new($name, $formula, $formula)
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

    pub fn is_special(&self) -> bool {
        self.family.starts_with(Self::SPECIAL)
    }

    /// Whether its results were compared with exact ones.
    pub fn is_compared(&self) -> bool {
        !self.family.starts_with("special/bsdf/")
    }

    pub fn is_rendered(&self) -> bool {
        self.variant == STABLE
    }
}

pub struct Bound {
    /// Which error, in which unit.
    pub name: &'static str,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_reach_both_ends() {
        let scale = Scale::new("", 1e-3, 1e3);
        assert_eq!((scale.at(0, 7), scale.at(6, 7)), (1e-3, 1e3));
        assert!((scale.at(3, 7) - 1.0).abs() < 1e-15);
    }
}
