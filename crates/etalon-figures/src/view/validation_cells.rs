//! One test's counts: observed, expected, and their residuals.

use super::text::{capitalized, finding, p_value, wrapped};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Cell, Counts, Verdict};
use serde::Serialize;

/// A cell. Field names are the CSV columns; atoms and "no sample", which have no place on the chart, come last.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Row {
    /// "cell", "atom" or "none".
    kind: &'static str,
    x_from: Option<f64>,
    x_to: Option<f64>,
    y_from: Option<f64>,
    y_to: Option<f64>,
    observed: u64,
    expected: f64,
    /// (O − E)/√E.
    pub residual: f64,
}

pub fn rows(counts: &Counts) -> Vec<Row> {
    let places = counts.grid.cells().map(Some).chain(std::iter::repeat(None));
    let of = |(i, (place, (&observed, &expected))): (usize, (Option<Cell>, (&u64, &f64)))| Row {
        kind: match i.checked_sub(counts.grid.len()) {
            None => "cell",
            Some(i) if i < counts.atoms.len() => "atom",
            Some(_) => "none",
        },
        x_from: place.map(|cell| cell.x[0]),
        x_to: place.map(|cell| cell.x[1]),
        y_from: place.map(|cell| cell.y[0]),
        y_to: place.map(|cell| cell.y[1]),
        observed,
        expected,
        residual: residual(observed, expected),
    };
    places.zip(counts.observed.iter().zip(&counts.expected)).enumerate().map(of).collect()
}

/// (O − E)/√E; 0 where O = E, also where both are 0.
fn residual(observed: u64, expected: f64) -> f64 {
    let difference = observed as f64 - expected;
    if difference == 0.0 { 0.0 } else { difference / expected.max(1e-3).sqrt() }
}

/// The drawing of a test: its verdict, why, and its cells, if it has counted anything.
pub fn drawing(tested: &Tested) -> Drawing {
    let p = tested.outcome.p.map_or("no /{p}-value".into(), p_value);
    let Tested { name, outcome } = tested;
    // The mistake, if there is one, is the headline, and need not be said again.
    match &outcome.mistake {
        Some(mistake) => described(tested, format!("{name}: {}, {}", outcome.verdict, finding(mistake)), Some(p)),
        None => described(tested, format!("{name}: {}, {p}", outcome.verdict), None),
    }
}

/// The drawing of the test of a planted fault, under a sentence that says what the fault is.
pub fn fault(tested: &Tested, mistake: &str) -> Drawing {
    let said = match tested.outcome.verdict {
        Verdict::Accept => "accepted",
        Verdict::Reject => "rejected",
        Verdict::Inconclusive => "inconclusive",
    };
    let p = tested.outcome.p.map_or("no /{p}-value".into(), p_value);
    described(tested, capitalized(mistake), Some(format!("{said} by the test of the sampler: {p}")))
}

fn described(tested: &Tested, title: String, first: Option<String>) -> Drawing {
    let outcome = &tested.outcome;
    let lines = |text: &str| wrapped(text, "", WIDEST).lines().map(finding).collect::<Vec<_>>();
    let findings = outcome.found().into_iter().chain(outcome.other_places()).flat_map(lines);
    let Some(counts) = outcome.counts.as_ref() else {
        return nothing().headed(title, first.into_iter().chain(findings).collect());
    };
    let (plot, beyond) = plot(counts);
    plot.draw().headed(title, first.into_iter().chain(beyond).chain(findings).collect())
}

/// The plot of the cells, and what has no place there.
fn plot(counts: &Counts) -> (Plot, Option<String>) {
    let rows = rows(counts);
    let (cells, beyond) = rows.split_at(counts.grid.len());
    let is_list = counts.grid.cells().all(|cell| cell.y == [0.0, 1.0]);
    let plot = if cells.iter().all(|row| row.expected < 1.0 && row.observed == 0) {
        listed(beyond, "atoms, then no sample")
    } else if is_list {
        listed(cells, &format!("cell, by {}", counts.axes[0]))
    } else {
        maps(counts.axes.each_ref().map(String::as_str), cells)
    };
    (plot, Some(remainder(counts.atoms.len(), beyond)).filter(|line| !line.is_empty()))
}

/// Most letters of a line above a drawing.
const WIDEST: usize = 110;

/// What stands below lines of text alone.
fn nothing() -> Drawing {
    Drawing::stacked(Vec::new(), 0.5)
}

/// A line for each cause for which tests are not accepted; `None` if all are.
pub fn reasons(validation: &Validation) -> Option<Drawing> {
    const MOST: usize = 12;
    let found = validation.causes();
    let line = |cause: &String| {
        let line = wrapped(cause, "", WIDEST);
        let first = line.lines().next().unwrap_or_default();
        finding(&if line.lines().nth(1).is_some() { format!("{first} …") } else { first.to_owned() })
    };
    let more = found.len().checked_sub(MOST + 1).map(|rest| format!("and {} more", rest + 1));
    let lines: Vec<String> = found.iter().take(MOST).map(line).chain(more).collect();
    (!lines.is_empty()).then(|| nothing().headed("Why", lines))
}

/// An axis of the cells as people read it: its title, its end there, the step between ticks, and where on the cells' axis a value is.
struct Reading {
    title: String,
    end: f64,
    every: f64,
    place: fn(f64) -> f64,
}

/// Polar angles and azimuths in degrees, other coordinates as they are.
fn reading(axis: &str) -> Reading {
    let degrees = |symbol: &str, end: f64, every: f64, place| Reading {
        title: format!("/{{{symbol}}} (degrees)"),
        end,
        every,
        place,
    };
    match axis {
        "φ / 2π" => degrees("φ", 360.0, 90.0, |phi| phi / 360.0),
        "1 - cos θ" => degrees("θ", 90.0, 15.0, |theta| 1.0 - theta.to_radians().cos()),
        "(1 - cos θ) / 2" => degrees("θ", 180.0, 30.0, |theta| 0.5 - 0.5 * theta.to_radians().cos()),
        other => Reading { title: finding(other), end: 1.0, every: 0.2, place: |v| v },
    }
}

/// Three heat maps, each cell at its place.
fn maps(axes: [&str; 2], cells: &[Row]) -> Plot {
    let [down, across] = axes.map(reading);
    let holds =
        |from: Option<f64>, to: Option<f64>, v: f64| from.zip(to).is_some_and(|(from, to)| (from..to).contains(&v));
    // The cell at each point of the map
    let middle = |i: usize, of: &Reading| (of.place)(of.end * (i as f64 + 0.5) / POINTS as f64);
    let at = |i: usize| {
        let [x, y] = [middle(i / POINTS, &down), middle(i % POINTS, &across)];
        cells.iter().find(|row| holds(row.x_from, row.x_to, x) && holds(row.y_from, row.y_to, y))
    };
    let places: Vec<Option<&Row>> = (0..POINTS * POINTS).map(at).collect();
    let grid = |value: &dyn Fn(&Row) -> f64| places.iter().map(|row| row.map_or(f64::NAN, value)).collect::<Vec<_>>();
    let panel = |title: &str, map: Heatmap| {
        let x = Axis::linear(across.title.as_str()).range(0.0, across.end).every(across.every);
        let y = Axis::linear(down.title.as_str()).range(down.end, 0.0).every(down.every);
        Panel::new(x, y).title(title).heatmap(map)
    };
    // One scale for both counts, in equal factors where a few cells have most of the samples
    let mut expected: Vec<f64> = cells.iter().map(|row| row.expected).collect();
    expected.sort_by(f64::total_cmp);
    let highest = cells.iter().map(|row| row.expected.max(row.observed as f64)).fold(0.0, f64::max);
    let is_peaked = highest > PEAKED * expected.get(expected.len() / 2).copied().unwrap_or(highest);
    let counts = |title: &str, value: &dyn Fn(&Row) -> f64| {
        panel(
            title,
            match is_peaked {
                true => Heatmap::new(POINTS, grid(&|row| value(row).max(1.0)), Shading::Log10, "samples")
                    .range(1.0, highest),
                false => Heatmap::new(POINTS, grid(value), Shading::Linear, "samples").range(0.0, highest),
            },
        )
    };
    let residual = Heatmap::new(POINTS, grid(&|row| row.residual), Shading::Diverging, "standard deviations");
    Plot::new([
        counts("Observed /{O}", &|row| row.observed as f64),
        counts("Expected /{E}", &|row| row.expected),
        panel("Residual (/{O} − /{E})/√/{E}", residual),
    ])
    .frame_size(250.0, 210.0)
}

/// Points of a map along each side.
const POINTS: usize = 180;
/// Times the median count that the highest one has where counts are peaked.
const PEAKED: f64 = 8.0;

/// Counts one after the other, with their residuals.
fn listed(rows: &[Row], axis: &str) -> Plot {
    let n = rows.len() as f64;
    let edges: Vec<f64> = (0..=rows.len()).map(|i| i as f64).collect();
    let steps = |value: fn(&Row) -> f64| -> Vec<Point> {
        rows.iter().enumerate().flat_map(|(i, row)| [[i as f64, value(row)], [i as f64 + 1.0, value(row)]]).collect()
    };
    let residuals: Vec<Point> = rows.iter().enumerate().map(|(i, row)| [i as f64 + 0.5, row.residual]).collect();
    let largest = rows.iter().map(|row| row.residual.abs()).fold(1.0, f64::max);
    let numbers = || {
        let axis = Axis::linear(axis).range(0.0, n);
        if rows.len() <= 12 { axis.every(1.0) } else { axis }
    };
    let observed: Vec<f64> = rows.iter().map(|row| row.observed as f64).collect();
    Plot::new([
        Panel::new(numbers(), Axis::linear("samples"))
            .title("Counts")
            .bars("observed", theme::OBSERVED, edges, observed)
            .line("expected", Stroke::solid(theme::EXPECTED, theme::THIN), steps(|row| row.expected)),
        Panel::new(numbers(), Axis::linear("standard deviations").range(-1.1 * largest, 1.1 * largest))
            .title("Residual (/{O} − /{E})/√/{E}")
            .horizontal(0.0, "")
            .dots("", theme::RESIDUAL, residuals),
    ])
}

/// What has no place on the chart.
fn remainder(atoms: usize, beyond: &[Row]) -> String {
    let of = |kind: &str| {
        let of_kind = beyond.iter().filter(|row| row.kind == kind);
        let (o, e) = of_kind.fold((0, 0.0), |(o, e), row| (o + row.observed, e + row.expected));
        format!("{o} times (expected {e:.1})")
    };
    let mut parts = Vec::new();
    if atoms > 0 {
        parts.push(format!("atoms: {}", of("atom")));
    }
    // Most samplers always return a sample; the integral of their pdf is 1 except for rounding.
    if beyond.iter().any(|row| row.kind == "none" && (row.observed > 0 || row.expected >= 0.05)) {
        parts.push(format!("no sample: {}", of("none")));
    }
    parts.join("; ")
}
