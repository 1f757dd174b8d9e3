//! The result of a comparison: the curves of all contenders on one scene.

use super::contender::Fault;
use super::curve::{self, Curve, CurveVerdict};
use super::reference::{Facts, Reference};
use etalon_stats::Extremes;
use serde::Serialize;

/// The curves of all contenders on one scene.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Convergence {
    pub scene: String,
    /// Columns of the images.
    pub width: usize,
    /// Rows of the images.
    pub height: usize,
    /// None if the budget was over before there was one.
    pub reference: Option<Facts>,
    /// One for each contender, in their order.
    pub curves: Vec<Curve>,
    /// What was asked for and left out for lack of time, in words.
    pub cut: Vec<String>,
    /// Seconds of a budget that would do for all replicates, if this one did not; none where that is not known.
    pub sufficient_budget: Option<f64>,
    /// Runs of renderers that failed.
    pub faults: Vec<Fault>,
    /// What else must be known of the result, in words.
    pub notes: Vec<String>,
    /// Whether the process was asked to stop before the end of the budget.
    pub interrupted: bool,
    /// Wall-clock time of everything.
    pub seconds: f64,
    /// The reference of the errors.
    #[serde(skip)]
    pub truth: Option<Reference>,
}

impl Convergence {
    /// A contender's curve.
    pub fn curve(&self, name: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.strategy == name)
    }

    /// The processor time that all contenders have had: the shortest of their last levels.
    pub fn common_seconds(&self) -> f64 {
        let last = self.curves.iter().filter_map(|curve| Some(curve.levels.last()?.cpu_seconds));
        last.fold(f64::INFINITY, f64::at_most)
    }

    /// The smallest RMSE that every contender without bias has reached.
    pub fn common_rmse(&self) -> f64 {
        let unbiased = self.curves.iter().filter(|curve| curve.verdict != CurveVerdict::Biased);
        // An unbiased estimate of the MSE may be below 0 and has no root then.
        let known = |curve: &Curve| {
            curve.levels.iter().map(curve::Level::rmse).filter(|rmse| !rmse.is_nan()).fold(f64::INFINITY, f64::at_most)
        };
        unbiased.map(known).reduce(f64::at_least).unwrap_or(f64::NAN)
    }

    /// Whether any contender has a verdict.
    pub fn has_verdict(&self) -> bool {
        self.curves.iter().any(|curve| curve.verdict != CurveVerdict::Unknown)
    }
}
