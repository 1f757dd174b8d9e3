//! Histograms of the rows that inversion samples with uniform and with Gaussian random numbers.

use super::text::p_value;
use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use etalon_bench::proposal::{Proposal, RowBin};

/// Two histograms over elevation, each with the target that it should follow and its p-value.
pub fn drawing(result: &Proposal) -> Drawing {
    let first = result.bins.iter().take(1).map(|b| b.theta_from_deg);
    let edges: Vec<f64> = first.chain(result.bins.iter().map(|b| b.theta_to_deg)).collect();
    let highest = result.bins.iter().map(|b| b.target.max(b.uniform).max(b.gaussian)).fold(0.0, f64::max);
    let target: Vec<Point> =
        result.bins.iter().flat_map(|b| [[b.theta_from_deg, b.target], [b.theta_to_deg, b.target]]).collect();
    let panel = |title: String, shares: Vec<f64>| {
        empty(title, highest * 1.08).bars("samples", theme::OBSERVED, edges.clone(), shares).line(
            "target: energy of the rows",
            Stroke::solid(theme::EXPECTED, theme::LINE),
            target.clone(),
        )
    };
    let share = |f: fn(&RowBin) -> f64| result.bins.iter().map(f).collect();
    Plot::new([
        panel(format!("Uniform random numbers: chi-square {}", p_value(result.uniform.p)), share(|b| b.uniform)),
        panel(format!("Gaussian random numbers: chi-square {}", p_value(result.gaussian.p)), share(|b| b.gaussian)),
    ])
    .draw()
}

/// The drawing for a map with too little light for the experiment.
pub fn nothing_to_test() -> Drawing {
    Plot::new([empty("This map has light in too few rows for the experiment".into(), 1.0)]).draw()
}

fn empty(title: String, highest: f64) -> Panel {
    let angle = Axis::linear("angle from the zenith (degrees)").range(0.0, 180.0).every(30.0);
    Panel::new(angle, Axis::linear("share of the samples").range(0.0, highest)).title(title)
}
