//! Bounds on the errors of the code that renders.

use super::case::Case;
use super::row::ErrorRow;

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
    /// much. The result is then within n/2 last places times the condition number, in either precision, and
    /// typically within √n/2: each `reason` says which of the two its limit is.
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
