//! A family of formulas for one quantity: its inputs, the grids that they are swept over, the reference and the variants.
//!
//! It re-exports what a family is written with.

pub use super::bound::Bound;
pub use super::case::{Case, Range};
pub use super::number::{Machine, Number, Value, cross, dot, minus, normalized, scalar};
pub use super::precision::Precision;
pub(super) use super::variant::variant;
pub use super::variant::{REPORT, STABLE, TEXTBOOK, Variant};

use super::precise::Precise;

/// Formulas for one quantity, swept over grids of their inputs.
pub struct Family {
    /// Its name.
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
    pub bounds: &'static [Bound<Case>],
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
/// Domain of what must be positive, such as widths and radii.
pub const POSITIVE: (f64, f64) = (f32::MIN_POSITIVE as f64, f32::MAX as f64);

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

impl Section {
    /// A grid of that title.
    pub const fn new(title: &'static str, x: Scale, y: Scale, at: fn(f64, f64) -> Vec<f64>) -> Self {
        Self { title, x, y, at }
    }
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
