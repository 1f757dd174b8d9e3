//! One input of a family, and the errors of all variants there.

use super::deviation::Deviation;
use super::precision::Precision;

/// One input in one precision.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Where in which grid; `None` for an input that is in no grid.
    pub place: Option<Place>,
    /// Precision of the inputs, in which all variants are evaluated.
    pub precision: Precision,
    /// Rounded to that precision.
    pub inputs: Vec<f64>,
    /// Relative change of the exact value per relative change of the inputs; infinite where rounding decides whether
    /// there is a value.
    pub condition: f64,
    /// In the order of the family's variants; `None` for one that does not exist in that precision.
    pub deviations: Vec<Option<Deviation>>,
}

/// A place in a family's grids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Number of the grid.
    pub section: usize,
    /// From left to right.
    pub column: usize,
    /// From bottom to top.
    pub row: usize,
}

impl Case {
    /// The error of the variant that renders, if that exists in this precision.
    #[must_use]
    pub fn rendered(&self) -> Option<&Deviation> {
        self.deviations[0].as_ref()
    }

    /// The condition number, but at least 1: results are rounded once, whatever the inputs.
    #[must_use]
    pub fn amplification(&self) -> f64 {
        self.condition.max(1.0)
    }
}
