//! The answer of a comparison: which contender without bias is best after equal time, and by how much.

use super::curve::{Curve, CurveVerdict};
use super::result::Convergence;
use etalon_stats::estimate::Estimate;
use serde::Serialize;

/// The best contender without bias.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Its name.
    pub best: String,
    /// Processor time after which efficiencies are compared.
    pub cpu_seconds: f64,
    /// Its efficiency over that of every other contender without bias, the next best first.
    pub ratios: Vec<Ratio>,
}

/// How many times as efficient the best one is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ratio {
    /// As this contender.
    pub over: String,
    /// The ratio of efficiencies.
    pub ratio: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Answer {
    /// Compares efficiencies, 1/(MSE · processor time), after the processor time that all have had; `None` if no contender
    /// without bias has one. A renderer whose start-up is not separated from its time has none.
    ///
    /// The interval of a ratio is that of its logarithm, whose half width is √(h₁² + h₂²) with the half widths h of the two
    /// logarithms by the jackknife over the replicates (Student's t).
    pub fn of(result: &Convergence) -> Option<Self> {
        let cpu_seconds = result.common_seconds();
        let unbiased = result.curves.iter().filter(|c| c.verdict != CurveVerdict::Biased && !c.includes_start_up());
        let known = |curve: &'_ Curve| Some(curve.log_efficiency_at(cpu_seconds)).filter(|e| e.value.is_finite());
        let mut ranked: Vec<(&Curve, Estimate)> = unbiased.filter_map(|curve| Some((curve, known(curve)?))).collect();
        ranked.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
        let ((best, top), others) = ranked.split_first()?;
        let ratio = |(curve, other): &(&Curve, Estimate)| {
            let (log, half) = (top.value - other.value, top.half_width.hypot(other.half_width));
            Ratio { over: curve.strategy.clone(), ratio: log.exp(), low: (log - half).exp(), high: (log + half).exp() }
        };
        Some(Self { best: best.strategy.clone(), cpu_seconds, ratios: others.iter().map(ratio).collect() })
    }
}
