//! Drawings of the proposal experiment, and of what proposal distributions cost: their densities over rows and columns, and the
//! samples that they need.

use super::text::p_value;
use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, Stroke, theme};
use etalon_bench::proposal::{Along, Cost, Costs, Proposal, RowBin, SHAPES, Shape};

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

/// Parts of an axis in the drawing, at most.
const BINS: usize = 64;
/// The relative standard error whose number of samples is shown.
pub const ACCURACY: f64 = 0.01;

/// The number of samples after which the relative standard error is [`ACCURACY`].
pub fn samples(variance: f64) -> f64 {
    variance / (ACCURACY * ACCURACY)
}

pub fn costs(costs: &Costs) -> Drawing {
    let rows = Axis::linear("angle from the zenith (degrees)").range(0.0, 180.0).every(30.0);
    let columns = Axis::linear("azimuth (degrees)").range(0.0, 360.0).every(60.0);
    let top = vec![
        densities("How often a row of the map is chosen", rows, 180.0, &costs.rows),
        densities("How often a column of the map is chosen", columns, 360.0, &costs.columns),
    ];
    let bottom = vec![
        needed("Cost of the irradiance of a floor", costs, |cost| cost.irradiance_variance),
        needed("Cost of the flux of the map", costs, |cost| cost.flux_variance),
    ];
    Plot::grid([(String::new(), top), (String::new(), bottom)]).frame_size(400.0, 230.0).draw()
}

fn densities(title: &str, x: Axis, degrees: f64, all: &[Vec<f64>]) -> Panel {
    let binned = |probabilities: &[f64]| -> Vec<f64> {
        let per_bin = probabilities.len().div_ceil(BINS);
        let mean = |bin: &[f64]| bin.iter().sum::<f64>() / bin.len() as f64 * probabilities.len() as f64;
        probabilities.chunks(per_bin).map(mean).collect()
    };
    let edge = |i: usize, count: usize, parts: usize| {
        (degrees * (i * count.div_ceil(BINS)) as f64 / parts as f64).min(degrees)
    };
    let mut panel = Panel::new(x, Axis::linear("probability / uniform probability")).title(title);
    for (i, (shape, probabilities)) in SHAPES.iter().zip(all).enumerate() {
        let (values, count) = (binned(probabilities), probabilities.len());
        let label = named(shape);
        let at = |i: usize| edge(i, count, count);
        panel = if *shape == Shape::Map {
            panel.bars(label, theme::GUIDE.colour, (0..=values.len()).map(at).collect(), values)
        } else {
            let middle = |i: usize| 0.5 * (at(i) + at(i + 1));
            let line: Vec<Point> = values.iter().enumerate().map(|(i, value)| [middle(i), *value]).collect();
            panel.line(label, theme::series(i), line)
        };
    }
    panel
}

/// A proposal's name, with the unit of its width.
fn named(shape: &Shape) -> String {
    let unit = if matches!(shape, Shape::Gaussian(_)) { " of the axis" } else { "" };
    shape.name() + unit
}

fn needed(title: &str, costs: &Costs, variance: fn(&Cost) -> f64) -> Panel {
    let marks: [(Along, &str, Colour, Marker); 3] = [
        (Along::Rows, "the proposal for the rows alone", theme::IMPORTANCE_SAMPLING, Marker::Triangle),
        (Along::Columns, "for the columns alone", theme::HEMISPHERE_SAMPLING, Marker::Square),
        (Along::Both, "for both", theme::REFERENCE, Marker::Open),
    ];
    let x = Axis::log("samples for a relative standard error of 1 %");
    let mut panel = Panel::new(x, Axis::named("proposal", SHAPES.iter().map(named).collect::<Vec<_>>())).title(title);
    let mut least = f64::INFINITY;
    for (along, label, colour, marker) in marks {
        let place =
            |cost: &Cost| SHAPES.iter().position(|shape| shape.name() == cost.proposal).unwrap_or(0) as f64 + 0.5;
        // By the map for the rows, for the columns and for both is one and the same
        let is_mine =
            |cost: &&Cost| cost.along == along && (along == Along::Both || cost.proposal != Shape::Map.name());
        let mine = costs.costs.iter().filter(is_mine).filter(|cost| variance(cost) > 1e-9);
        let points: Vec<Point> = mine.map(|cost| [samples(variance(cost)), place(cost)]).collect();
        least = points.iter().map(|[x, _]| *x).fold(least, f64::min);
        panel = panel.markers(label, colour, marker, points);
    }
    // A proposal without variance has no place on the axis
    let exact = costs.costs.iter().find(|cost| cost.proposal == Shape::Map.name() && variance(cost) <= 1e-9);
    let row = SHAPES.iter().position(|shape| *shape == Shape::Map).unwrap_or(0) as f64 + 0.5;
    match exact {
        Some(_) if least.is_finite() => panel.note([least, row - 0.35], "1 sample: all weights are equal", theme::INK),
        _ => panel,
    }
}
