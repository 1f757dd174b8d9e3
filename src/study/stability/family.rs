//! What a family of formulas is: its inputs, the grids that they are swept over, the reference and the variants.

use super::bound::Bound;
use super::number::Machine;
use super::precise::Precise;
use super::sweep::Case;

/// What a formula gives: a number (the others are 0), a vector, or nothing, such as a ray that misses.
pub type Value<T> = Option<[T; 3]>;

/// A formula of several inputs.
pub type Formula<T> = fn(&[T]) -> Value<T>;

/// The answer of a formula for a number.
pub fn scalar<T: super::number::Number>(value: T) -> Value<T> {
    Some([value, T::of(0.0), T::of(0.0)])
}

/// Formulas for one quantity, swept over grids of their inputs.
pub struct Family {
    /// Its name.
    pub name: &'static str,
    /// The quantity, in a line.
    pub about: &'static str,
    /// The figure that shows it.
    pub figure: &'static str,
    /// Names of the inputs, as replays give them.
    pub inputs: &'static [&'static str],
    /// Least and largest value of each of the first inputs; the others may be any number.
    pub domains: &'static [(f64, f64)],
    /// The grids that the inputs are swept over.
    pub sections: &'static [Section],
    /// Inputs that no grid of factors reaches: zeros, poles and the like.
    pub edges: &'static [&'static [f64]],
    /// The defining formula, at the very input that the variants get.
    pub reference: fn(&[Precise]) -> Value<Precise>,
    /// The first is the one that renders.
    pub variants: &'static [Variant],
    /// The values that the quantity can have.
    pub range: Range,
    /// What the errors of the variant that renders may be.
    pub bounds: &'static [Bound<Case>],
    /// What the sides of the grids are divided by, where the reference takes long.
    pub coarser: usize,
}

/// Indices of refraction of dielectrics: their squares neither overflow nor underflow in f32.
pub const INDEX: (f64, f64) = (1e-18, 1e18);
/// What must be positive, such as widths and radii.
pub const POSITIVE: (f64, f64) = (f32::MIN_POSITIVE as f64, f32::MAX as f64);

/// One way of computing a family's quantity.
pub struct Variant {
    /// Its name in tables.
    pub name: &'static str,
    /// The formula in f32.
    pub single: Formula<f32>,
    /// `None` for code that exists in f32 alone.
    pub double: Option<Formula<f64>>,
}

/// The variant that renders.
pub const STABLE: &str = "stable";
/// The formula as books print it.
pub const TEXTBOOK: &str = "textbook";
/// The formula of one of the two reports, where that is another one.
pub const REPORT: &str = "report";

impl Variant {
    /// A variant in both precisions.
    pub const fn new(name: &'static str, single: fn(&[f32]) -> Value<f32>, double: fn(&[f64]) -> Value<f64>) -> Self {
        Self { name, single, double: Some(double) }
    }

    /// A variant that exists in f32 alone.
    pub const fn single(name: &'static str, single: fn(&[f32]) -> Value<f32>) -> Self {
        Self { name, single, double: None }
    }
}

/// The values that a quantity can have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// From 0 to this.
    UpTo(f64),
    /// Unit vectors: lengths have an error of at most 4 units of the last place.
    Unit,
}

impl Range {
    /// How many numbers an answer is.
    #[must_use]
    pub fn components(self) -> usize {
        if self == Self::Unit { 3 } else { 1 }
    }
}

/// A grid of inputs.
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

/// One side of a grid: equal factors between two ends.
pub struct Scale {
    /// The axis's label.
    pub label: &'static str,
    /// The first place.
    pub from: f64,
    /// The last place.
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

/// The precision that a variant runs in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub enum Precision {
    /// `f32`.
    #[default]
    #[serde(rename = "f32")]
    Single,
    /// `f64`.
    #[serde(rename = "f64")]
    Double,
}

impl Precision {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        if self == Self::Single { "f32" } else { "f64" }
    }

    /// The nearest number of this precision.
    #[must_use]
    pub fn round(self, x: f64) -> f64 {
        if self == Self::Single { f64::from(x as f32) } else { x }
    }

    /// The smallest normal number.
    #[must_use]
    pub fn least(self) -> f64 {
        if self == Self::Single { f64::from(f32::MIN_POSITIVE) } else { f64::MIN_POSITIVE }
    }

    /// The distance from |x| to the next larger number of this precision.
    #[must_use]
    pub fn unit(self, x: f64) -> f64 {
        match self {
            Self::Single => {
                let x = (x.abs() as f32).min(f32::MAX.next_down());
                f64::from(x.next_up()) - f64::from(x)
            }
            Self::Double => {
                let x = x.abs().min(f64::MAX.next_down());
                x.next_up() - x
            }
        }
    }

    /// The shortest decimal that reads back as `x`.
    #[must_use]
    pub fn text(self, x: f64) -> String {
        if self == Self::Single { format!("{:?}", x as f32) } else { format!("{x:?}") }
    }
}

impl Variant {
    /// What the variant gives for inputs that are numbers of that precision; `None` where it does not run in it.
    pub fn evaluate(&self, precision: Precision, inputs: &[f64]) -> Option<Value<f64>> {
        match precision {
            Precision::Single => Some(run(self.single, inputs)),
            Precision::Double => self.double.map(|variant| run(variant, inputs)),
        }
    }
}

fn run<T: Machine>(variant: fn(&[T]) -> Value<T>, inputs: &[f64]) -> Value<f64> {
    let inputs: Vec<T> = inputs.iter().map(|&x| <T as crate::math::Real>::from_f64(x)).collect();
    variant(&inputs).map(|value| value.map(crate::math::Real::to_f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_last_place() {
        assert_eq!(Precision::Single.unit(1.0), f64::from(f32::EPSILON));
        assert_eq!(Precision::Double.unit(-1.5), f64::EPSILON);
        assert_eq!(Precision::Double.unit(0.0), 5e-324);
        assert!(Precision::Single.unit(1e300).is_finite());
    }

    #[test]
    fn scales_reach_both_ends() {
        let scale = Scale::new("", 1e-3, 1e3);
        assert_eq!((scale.at(0, 7), scale.at(6, 7)), (1e-3, 1e3));
        assert!((scale.at(3, 7) - 1.0).abs() < 1e-15);
    }
}
