//! One test's counts: observed, expected, and their residuals.

use super::text::{finding, p_value, wrapped};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Cell, Counts};
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
    let (title, p) = match &outcome.mistake {
        Some(mistake) => (format!("{name}: {}, {}", outcome.verdict, finding(mistake)), Some(p)),
        None => (format!("{name}: {}, {p}", outcome.verdict), None),
    };
    let lines = |text: &str| wrapped(text, "", WIDEST).lines().map(finding).collect::<Vec<_>>();
    let findings = p.into_iter().chain(outcome.found().into_iter().chain(outcome.other_places()).flat_map(lines));
    let Some(counts) = outcome.counts.as_ref() else {
        return nothing().headed(title, findings.collect());
    };
    let (plot, beyond) = plot(counts);
    plot.draw().headed(title, beyond.into_iter().chain(findings).collect())
}

/// The plot of the cells, and what has no place there.
fn plot(counts: &Counts) -> (Plot, Option<String>) {
    let rows = rows(counts);
    let (cells, beyond) = rows.split_at(counts.grid.len());
    let columns = columns(counts);
    let plot = if cells.iter().all(|row| row.expected < 1.0 && row.observed == 0) {
        listed(beyond, "atoms, then no sample")
    } else if columns.iter().all(|n| *n == 1) {
        listed(cells, &format!("cell, by {}", counts.axes[0]))
    } else {
        maps(counts.axes, cells, &columns)
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

/// Three heat maps: at their places where all cells are equal, else by number of row and column.
fn maps(axes: [&str; 2], cells: &[Row], columns: &[usize]) -> Plot {
    let width = |row: &Row| row.y_to.zip(row.y_from).map_or(0.0, |(to, from)| to - from);
    let height = |row: &Row| row.x_to.zip(row.x_from).map_or(0.0, |(to, from)| to - from);
    let is_constant =
        |size: &dyn Fn(&Row) -> f64| cells.iter().all(|row| (size(row) / size(&cells[0]) - 1.0).abs() < 1e-9);
    let equal = is_constant(&width) && is_constant(&height);
    let most = columns.iter().copied().max().unwrap_or(1);
    let axes = axes.map(finding);
    let (across, down) = if equal {
        (Axis::linear(axes[1].as_str()).range(0.0, 1.0), Axis::linear(axes[0].as_str()).range(1.0, 0.0))
    } else {
        (Axis::linear(format!("column, by {}", axes[1])), Axis::linear(format!("row, by {}", axes[0])))
    };
    // Rows that have fewer columns than others end early.
    let grid = |value: &dyn Fn(&Row) -> f64| -> Vec<f64> {
        let mut rest = cells;
        let row = |&n: &usize| -> Vec<f64> {
            let (row, after) = rest.split_at(n);
            rest = after;
            row.iter().map(value).chain(std::iter::repeat_n(f64::NAN, most - n)).collect()
        };
        columns.iter().flat_map(row).collect()
    };
    let highest = cells.iter().map(|row| row.expected.max(row.observed as f64)).fold(0.0, f64::max);
    let counts = |title: &str, value: &dyn Fn(&Row) -> f64| -> Panel {
        let map = Heatmap::new(most, grid(value), Shading::Linear, "samples").range(0.0, highest);
        Panel::new(across.clone(), down.clone()).title(title).heatmap(map)
    };
    let residual = Heatmap::new(most, grid(&|row| row.residual), Shading::Diverging, "standard deviations");
    Plot::new([
        counts("Observed /{O}", &|row| row.observed as f64),
        counts("Expected /{E}", &|row| row.expected),
        Panel::new(across.clone(), down.clone()).title("Residual (/{O} − /{E})/√/{E}").heatmap(residual),
    ])
    .frame_size(250.0, 210.0)
}

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
        format!("{o} (expected {e:.1})")
    };
    let mut parts = Vec::new();
    if atoms > 0 {
        parts.push(format!("at atoms {}", of("atom")));
    }
    // Most samplers always return a sample; the integral of their pdf is 1 except for rounding.
    if beyond.iter().any(|row| row.kind == "none" && (row.observed > 0 || row.expected >= 0.05)) {
        parts.push(format!("no sample {}", of("none")));
    }
    parts.join("; ")
}

/// The number of cells in each row of the grid.
fn columns(counts: &Counts) -> Vec<usize> {
    let cells: Vec<Cell> = counts.grid.cells().collect();
    cells.chunk_by(|a, b| a.x == b.x).map(<[Cell]>::len).collect()
}
