//! The result of a comparison: the curves of all contenders on one scene; and its answer: which contender without bias is best
//! after equal time, and by how much; and whether any is better than the strategy by default.

use super::contender::Fault;
use super::curve::{self, Curve, CurveVerdict};
use super::reference::{Facts, Reference};
use etalon_stats::Extremes;
use etalon_stats::estimate::Estimate;
use serde::Serialize;

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
    /// Whether images are shown at equal samples, not after equal time.
    #[serde(skip)]
    pub equal_samples: bool,
    pub faults: Vec<Fault>,
    /// What else must be known of the result, in words.
    pub notes: Vec<String>,
    /// Whether the process was asked to stop before the end of the budget.
    pub interrupted: bool,
    /// Wall-clock time of everything.
    pub seconds: f64,
    /// The part of these that the exact image takes, which is no part of the budget; 0 without one.
    pub exact_seconds: f64,
    #[serde(skip)]
    pub truth: Option<Reference>,
}

impl Convergence {
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

    pub fn has_verdict(&self) -> bool {
        self.curves.iter().any(|curve| curve.verdict != CurveVerdict::Unknown)
    }
}

/// The best contender without bias.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    pub best: String,
    /// Processor time after which efficiencies are compared.
    pub cpu_seconds: f64,
    /// Its efficiency over that of every other contender without bias, the next best first.
    pub ratios: Vec<Ratio>,
    /// The strategy by default beside its strongest rival; `None` if it is not among the contenders without bias, or alone.
    pub default: Option<Rival>,
}

/// How many times as efficient the best one is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ratio {
    /// As this contender.
    pub over: String,
    pub ratio: f64,
    /// Lower end of its interval.
    pub low: f64,
    pub high: f64,
}

/// The contender without bias, other than the default, whose efficiency over that of the strategy by default has the largest lower
/// end. Fixed lights are no rivals: they are biased, whether this is found or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rival {
    pub rival: String,
    /// Its efficiency over that of the default.
    pub ratio: f64,
    /// Lower end of its interval: above 1 if the rival is better beyond chance.
    pub low: f64,
    pub high: f64,
}

impl Answer {
    /// Compares efficiencies, 1/(MSE · processor time), after the processor time that all have had; `None` if no contender
    /// that was tested and has no bias has one. A renderer whose start-up is not separated from its time has none.
    ///
    /// The interval of a ratio, at this confidence, is that of its logarithm, whose half width is √(h₁² + h₂²) with the half
    /// widths h of the two logarithms by the jackknife over the replicates (Student's t).
    pub fn of(result: &Convergence, confidence: f64) -> Option<Self> {
        let cpu_seconds = result.common_seconds();
        let is_unbiased = |c: &&Curve| c.verdict != CurveVerdict::Biased && c.is_tested();
        let unbiased = result.curves.iter().filter(is_unbiased).filter(|c| !c.includes_start_up());
        let known = |curve: &'_ Curve| {
            let estimate = curve.log_efficiency_at(cpu_seconds).at_confidence(confidence, curve.runs.len());
            estimate.value.is_finite().then_some(estimate)
        };
        let mut ranked: Vec<(&Curve, Estimate)> = unbiased.filter_map(|curve| Some((curve, known(curve)?))).collect();
        ranked.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
        let ((best, top), others) = ranked.split_first()?;
        let ratio = |(curve, other): &(&Curve, Estimate)| {
            let [ratio, low, high] = quotient(top, other);
            Ratio { over: curve.strategy.clone(), ratio, low, high }
        };
        let default = ranked.iter().find(|(curve, _)| curve.contender.is_default()).and_then(|(_, default)| {
            let rivals = ranked.iter().filter(|(c, _)| !c.contender.is_default() && !c.contender.has_fixed_lights());
            let against = |(curve, own): &(&Curve, Estimate)| {
                let [ratio, low, high] = quotient(own, default);
                Rival { rival: curve.strategy.clone(), ratio, low, high }
            };
            rivals.map(against).max_by(|a, b| a.low.total_cmp(&b.low))
        });
        Some(Self { best: best.strategy.clone(), cpu_seconds, ratios: others.iter().map(ratio).collect(), default })
    }
}

/// A quotient of two efficiencies and its interval, from their logarithms.
fn quotient(a: &Estimate, b: &Estimate) -> [f64; 3] {
    let (log, half) = (a.value - b.value, a.half_width.hypot(b.half_width));
    [log, log - half, log + half].map(f64::exp)
}

#[cfg(test)]
mod tests {
    use super::super::contender::Contender;
    use super::super::curve::{Measured, Run};
    use super::super::doubling::Times;
    use super::super::reference::Reference;
    use super::super::strategy::Strategy;
    use super::*;
    use etalon_core::math::Rgb;
    use etalon_core::raster::{Comparison, Image, compare, compare_shown};
    use etalon_core::scene::Request;

    #[test]
    fn what_was_not_tested_for_bias_is_no_answer() {
        let mut few = curve(("mis", 1.0, 0.01));
        few.replicates = 2;
        let result = Convergence { curves: vec![few], ..Convergence::default() };
        assert_eq!(Answer::of(&result, 0.95), None);
    }

    /// Four replicates that take a second each, with squared errors of `mse` · (1 ± spread).
    fn curve((name, mse, spread): (&str, f64, f64)) -> Curve {
        let white = || Image::from_fn(2, 1, |_, _| Rgb::ONE);
        let request = Request { width: 2, height: 1, spp: 1, light_samples: 1, max_depth: 1 };
        let reference = Reference::given(white(), &request, "white".into()).unwrap();
        let run = |sign: f64| {
            let errors = Comparison { mse: mse * (1.0 + sign * spread), ..compare(&white(), &white()).unwrap() };
            let times = Times { wall: 1.0, cpu: 1.0 };
            let levels =
                vec![Measured { spp: 1, times, errors, shown: Some((compare_shown(&white(), &white()), white())) }];
            Run { seed: 1, levels, last: None, preparation: 0.0, chosen: None }
        };
        let contender = Contender::from(name.parse::<Strategy>().unwrap());
        Curve::new(&contender, [-1.0, 1.0, -1.0, 1.0].map(run).into(), &reference, None).unwrap()
    }

    fn answer(curves: &[(&str, f64, f64)], confidence: f64) -> Answer {
        let curves = curves.iter().copied().map(curve).collect();
        Answer::of(&Convergence { curves, ..Convergence::default() }, confidence).unwrap()
    }

    #[test]
    fn the_rival_of_the_default_is_better_for_certain_or_nothing_is() {
        let default = ("default", 2.0, 0.01);
        let noisy = ("mis", 0.9, 0.5);
        let all = [noisy, ("light", 1.0, 0.01), ("median-cut-4", 0.1, 0.01), default];
        let [narrow, wide] = [0.95, 0.99].map(|confidence| answer(&all, confidence).default.unwrap());
        assert_eq!(narrow.rival, "light", "fixed lights do not count, nor does luck");
        assert!((narrow.ratio - 2.0).abs() < 1e-3 && narrow.low > 1.9 && narrow.high < 2.1, "{narrow:?}");
        assert!(1.9 < wide.low && wide.low < narrow.low && narrow.high < wide.high, "{wide:?}");
        let chance = answer(&[noisy, default], 0.95);
        assert!(chance.best == "mis" && chance.default.unwrap().low < 1.0);
        let best = answer(&[("light", 3.0, 0.01), default], 0.95);
        assert!(best.best == "default" && best.default.unwrap().high < 1.0);
        assert_eq!(answer(&[default], 0.95).default, None);
        assert_eq!(answer(&all[..2], 0.95).default, None);
    }
}
