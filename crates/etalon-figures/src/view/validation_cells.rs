//! What one test looked at: counts, observed and expected, with their residuals; or numbers that should be equal and are not.

use super::text::{capitalized, clauses, finding, p_value, rounded};
use crate::figure::{Axis, Drawing, Heatmap, Marker, Panel, Plot, Point, Shading, Stroke, theme};
use etalon_bench::table::Table;
use etalon_bench::validation::{Tested, Validation};
use etalon_core::error::Result;
use etalon_stats::{Cell, Compared, Counts, Finer, Outcome, Point as Place, Verdict};
use serde::Serialize;
use std::f64::consts::PI;

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
        residual: residual(observed as f64, expected),
    };
    places.zip(counts.observed.iter().zip(&counts.expected)).enumerate().map(of).collect()
}

/// (O − E)/√E; 0 where O = E, also where both are 0.
fn residual(observed: f64, expected: f64) -> f64 {
    let difference = observed - expected;
    if difference == 0.0 { 0.0 } else { difference / expected.max(1e-3).sqrt() }
}

/// The drawing of a test: what is wrong, and what shows it.
pub fn drawing(tested: &Tested) -> Drawing {
    let told = said(&tested.outcome);
    let picture = picture(&tested.outcome);
    // Names are as their owner spells them
    let Some((first, others)) = told.split_first() else {
        let would_find = would_find(&tested.outcome).map(|found| capitalized(&found));
        return picture.headed(agreement(&tested.outcome), [of_test(tested)].into_iter().chain(would_find).collect());
    };
    let lines = others.iter().take(LINES - 1).cloned().chain([of_test(tested)]);
    picture.headed(capitalized(first), lines.collect())
}

/// What a test that found nothing says.
fn agreement(outcome: &Outcome) -> &'static str {
    match (outcome.verdict, &outcome.counts) {
        (Verdict::Accept, Some(_)) => "Samples follow the pdf",
        (Verdict::Accept, None) => "Nothing wrong was found",
        _ => "Not decided",
    }
}

/// The error of the pdf that an accepted test would have found.
fn would_find(outcome: &Outcome) -> Option<String> {
    let error = outcome.detectable.filter(|error| outcome.is_accepted() && error.is_finite())?;
    let percent = rounded(100.0 * error, 2);
    Some(format!(
        "an error of the pdf of {percent}\u{a0}% (root mean square) would have been found with 90\u{a0}% probability"
    ))
}

/// A test by its name, and its verdict.
pub fn of_test(Tested { name, outcome }: &Tested) -> String {
    format!("{name}: {}", verdict(outcome))
}

/// The drawing of the test of a planted fault, under a sentence that says what the fault is.
pub fn fault(Tested { outcome, .. }: &Tested, mistake: &str) -> Drawing {
    let told = said(outcome);
    let found = told.first().map_or(String::new(), |found| format!(": {found}"));
    let lines = std::iter::once(verdict(outcome) + &found).chain(told.into_iter().skip(1));
    picture(outcome).headed(capitalized(mistake), lines.take(LINES).collect())
}

/// The verdict, and the p-value that it rests on.
fn verdict(outcome: &Outcome) -> String {
    let verdict = match outcome.verdict {
        Verdict::Accept => "accepted",
        Verdict::Reject => "rejected",
        Verdict::Inconclusive => "inconclusive",
    };
    outcome.p.map_or(verdict.to_owned(), |p| format!("{verdict}, {}", p_value(p)))
}

/// Lines below a title.
const LINES: usize = 2;
/// Most letters of a clause, which may be wrapped once.
const WIDEST: usize = 160;

/// What is wrong, in clauses: the mistake, what was found, where; nothing where that is nothing.
fn said(outcome: &Outcome) -> Vec<String> {
    let mistake = outcome.mistake.as_ref().filter(|_| outcome.verdict == Verdict::Reject).map(ToString::to_string);
    let all = mistake.as_deref().into_iter().chain(outcome.found()).chain(outcome.other_places());
    all.flat_map(clauses).map(|clause| finding(&cut(&clause))).collect()
}

/// The beginning of a text, up to a comma or colon outside of brackets, that is not too long; two causes that belong together are not cut apart.
fn cut(text: &str) -> String {
    let is_open = |text: &str| text.matches('(').count() > text.matches(')').count();
    let ends = text.rmatch_indices([',', ':']).map(|(end, _)| text.split_at(end));
    let is_end =
        |(start, rest): &(&str, &str)| rest[1..].starts_with(' ') && !rest.starts_with(", and ") && !is_open(start);
    let ends = ends.filter(is_end).map(|(start, _)| start);
    let fits = |text: &&str| text.chars().count() <= WIDEST;
    std::iter::once(text).chain(ends).find(fits).unwrap_or(text).to_owned()
}

/// What is wrong in the first cause for which tests are not accepted, and how many there are; `None` if all are accepted.
pub fn reasons(validation: &Validation, first: Option<&Tested>) -> Option<Drawing> {
    let told = said(&first?.outcome);
    let [rejected, inconclusive, all] = [validation.rejected, validation.inconclusive, validation.tests.len()];
    let count = [(rejected, "rejected"), (inconclusive, "inconclusive")].into_iter().filter(|(n, _)| *n > 0);
    let count: Vec<String> = count.map(|(n, what)| format!("{n} of {all} tests {what}")).collect();
    let lines = told.iter().skip(1).take(LINES - 1).cloned().chain([count.join(", ")]);
    Some(nothing().headed(capitalized(told.first()?), lines.collect()))
}

/// What a test of several looked at, under its name.
pub fn pictured(Tested { name, outcome }: &Tested) -> Drawing {
    let name = match check_of(name) {
        Some((check, angle)) => format!("{}, /{{ω}}o at {angle}° to the normal", capitalized(check)),
        None => name.clone(),
    };
    picture(outcome).headed(name, Vec::new())
}

/// The check of a BSDF that a test does, and the angle of `wo`; a comparison with a model is of all angles.
pub fn check_of(name: &str) -> Option<(&str, f64)> {
    let (kind, angle) = name.rsplit_once('/')?;
    Some((kind.rsplit('/').next()?, angle.parse().ok()?))
}

/// What rejects: numbers that are not equal, if they have ratios, or counts.
fn picture(outcome: &Outcome) -> Drawing {
    let has_ratios = |compared: &&Compared| compared.places.iter().any(|(_, [a, b])| *a > 0.0 && *b > 0.0);
    match (&outcome.counts, outcome.compared.as_ref().filter(has_ratios)) {
        (counts, Some(compared)) if counts.is_none() || !outcome.is_rejected_by_p() => {
            compared_plot(compared, counts.as_ref(), outcome.wo).draw()
        }
        (Some(counts), _) => counted(counts, outcome.wo),
        _ => nothing(),
    }
}

/// What rejects: cells or their parts; where delta lobes and "no sample" differ more, these, below cells that have most of the samples.
fn counted(counts: &Counts, wo: Option<[f64; 3]>) -> Drawing {
    let rows = rows(counts);
    let (cells, beyond) = rows.split_at(counts.grid.len());
    let worst = |rows: &[Row]| rows.iter().map(|row| row.residual.abs()).fold(0.0, f64::max);
    let most = |rows: &[Row]| rows.iter().map(|row| row.expected.max(row.observed as f64)).sum::<f64>();
    let is_list = counts.grid.cells().all(|cell| cell.y == [0.0, 1.0]);
    let of_cells = || match &counts.finer {
        Some(finer) => parts(counts, finer),
        None if is_list => listed(counts, cells),
        None => maps(counts, cells, wo),
    };
    if worst(beyond) <= worst(cells).max(NOTABLE) {
        return of_cells().draw();
    }
    let lobes = lobes(counts, cells, beyond).draw();
    if most(cells) > most(beyond) { Drawing::stacked(vec![of_cells().draw(), lobes], 0.5) } else { lobes }
}

/// What stands below lines of text alone.
fn nothing() -> Drawing {
    Drawing::stacked(Vec::new(), 0.5)
}

/// The numbers of an exact check as CSV, by the direction `wi`.
pub fn compared_csv(compared: &Compared) -> Result<Vec<u8>> {
    Table::of(&compared.places)
        .field("theta_deg", |(place, _)| polar((*place).into())[0])
        .field("phi_deg", |(place, _)| polar((*place).into())[1].rem_euclid(360.0))
        .field("found", |(_, [found, _])| *found)
        .field("expected", |(_, [_, expected])| *expected)
        .csv()
}

/// What was found over what is expected, by place, the worst marked; and where they differ much, both.
fn compared_plot(compared: &Compared, counts: Option<&Counts>, wo: Option<[f64; 3]>) -> Plot {
    const DOTS: usize = 500;
    let is_angle = counts.is_none_or(|counts| counts.axes[0].contains("cos θ"));
    let along = |place: Place| if is_angle { polar(place.into())[0] } else { place.coordinates()[0] };
    let all = || compared.places.iter().map(|&(place, [found, expected])| [along(place), found, expected]);
    let is_far = |[_, found, expected]: &[f64; 3]| (found / expected).ln().abs();
    let positive = || all().filter(|[_, found, expected]| *found > 0.0 && *expected > 0.0);
    let worst = positive().max_by(|a, b| is_far(a).total_cmp(&is_far(b)));
    let shown: Vec<[f64; 3]> = positive().take(DOTS).chain(worst).collect();
    let furthest = worst.as_ref().map_or(0.0, is_far);
    let places = || match (is_angle, counts.and_then(|counts| counts.outcomes)) {
        (true, _) => {
            let end = if all().any(|[theta, ..]| theta > 90.0) { 180.0 } else { 90.0 };
            let of = if counts.is_none() { " of /{ω}i" } else { "" };
            Axis::linear(format!("/{{θ}}{of} (degrees)")).range(0.0, end).every(end / 6.0)
        }
        (_, Some(_)) => Axis::linear("outcome"),
        _ => Axis::linear("x"),
    };
    // Ratios near 1 in percent
    let is_near = furthest < 0.5;
    let (y, equal) = match is_near {
        true => (Axis::linear("found − expected (percent)"), 0.0),
        false => (Axis::log("found / expected"), 1.0),
    };
    let ratio = |&[at, found, expected]: &[f64; 3]| match is_near {
        true => [at, 100.0 * (found / expected - 1.0)],
        false => [at, found / expected],
    };
    let law = capitalized(&finding(&compared.law));
    let mut over_place = Panel::new(places(), y)
        .title(if is_near { &law } else { "Found over expected" })
        .horizontal(equal, "equal")
        .dots("", theme::REJECTED, shown.iter().map(ratio).collect::<Vec<Point>>());
    if let Some(worst) = &worst {
        let (at, [found, expected]) = (ratio(worst), [worst[1], worst[2]]);
        let text = format!("worst: {}, not {}", rounded(found, 3), rounded(expected, 3));
        over_place = over_place.markers("", theme::INK, Marker::Open, [at]).note(at, text, theme::INK);
    }
    let over_place = match wo.map(polar) {
        Some([theta, _]) => over_place.vertical(theta, "/{θ} of /{ω}o"),
        None => over_place,
    };
    let values = |i: usize| shown.iter().map(|all| [all[0], all[i]]).collect::<Vec<Point>>();
    let both = (!is_near).then(|| {
        Panel::new(places(), Axis::log("value")).title(law.as_str()).dots("expected", theme::EXPECTED, values(2)).dots(
            "found",
            theme::REJECTED,
            values(1),
        )
    });
    Plot::new(both.into_iter().chain([over_place]).collect::<Vec<_>>())
}

/// An axis of the cells as people read it: its title, its end there, the step between ticks, and where on the cells' axis a value is, and
/// back.
struct Reading {
    title: String,
    end: f64,
    every: f64,
    place: fn(f64) -> f64,
    value: fn(f64) -> f64,
}

/// Polar angles and azimuths in degrees, other coordinates as they are.
fn reading(axis: &str) -> Reading {
    let degrees = |symbol: &str, end: f64, every: f64, place, value| Reading {
        title: format!("/{{{symbol}}} (degrees)"),
        end,
        every,
        place,
        value,
    };
    match axis {
        "φ / 2π" => degrees("φ", 360.0, 90.0, |phi| phi / 360.0, |x| 360.0 * x),
        "1 - cos θ" => {
            degrees("θ", 90.0, 15.0, |theta| 1.0 - theta.to_radians().cos(), |x| (1.0 - x).acos().to_degrees())
        }
        "(1 - cos θ) / 2" => degrees(
            "θ",
            180.0,
            30.0,
            |theta| 0.5 - 0.5 * theta.to_radians().cos(),
            |x| (1.0 - 2.0 * x).acos().to_degrees(),
        ),
        RADIUS => Reading { title: "/{r} / /{R}".into(), end: 1.0, every: 0.5, place: |r| r * r, value: f64::sqrt },
        other => Reading { title: finding(other), end: 1.0, every: 0.2, place: |v| v, value: |v| v },
    }
}

/// The first axis of a disk of radius R.
const RADIUS: &str = "r² / R²";

/// The angle of a direction with the normal and its azimuth, in degrees.
fn polar([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x.hypot(y).atan2(z), y.atan2(x)].map(f64::to_degrees)
}

/// A map of cells.
struct Chart {
    /// Where on the axes of the cells a point of the map lies, if it does.
    place: Box<dyn Fn([f64; 2]) -> Option<[f64; 2]>>,
    /// What of the map's axes is shown.
    ends: [[f64; 2]; 2],
    /// The titles of its axes, and the steps between ticks.
    axes: [(String, Option<f64>); 2],
}

/// A disk of directions around the normal, as the sky above: the angle with it grows from the centre to the rim. A lobe is one spot there,
/// wherever it points. The points of a disk lie as they are.
fn sky(end: f64, place: fn(f64) -> f64) -> Chart {
    let at = move |[x, y]: [f64; 2]| {
        let theta = x.hypot(y);
        (theta < end).then(|| [place(theta), y.atan2(x).to_degrees().rem_euclid(360.0) / 360.0])
    };
    let axis = |function: &str, own: &str| match end {
        1.0 => (format!("/{{{own}}} / /{{R}}"), Some(0.5)),
        _ => (format!("/{{θ}} {function} /{{φ}} (degrees)"), Some(end / 3.0)),
    };
    Chart { place: Box::new(at), ends: [[-end, end]; 2], axes: [axis("cos", "x"), axis("sin", "y")] }
}

/// The first axis from left to right, the second upwards: those of boxes, others as they are read; of a triangle, b0 and b1.
fn rectangle(axes: [&str; 2], boxes: Option<&[Cell]>, cells: &[Row]) -> Chart {
    if let Some(boxes) = boxes {
        let counts = cells.iter().map(|row| [row.observed as f64, row.expected]);
        let along = |of: fn(&Cell) -> [f64; 2]| shown(&boxes.iter().map(of).zip(counts.clone()).collect::<Vec<_>>());
        let ends = [along(|cell| cell.x), along(|cell| cell.y)];
        return Chart { place: Box::new(Some), ends, axes: ["x", "y"].map(|name| (name.to_owned(), None)) };
    }
    if axes == TRIANGLE {
        let at = |[b0, b1]: [f64; 2]| (b0 + b1 < 1.0).then(|| [(1.0 - b0).powi(2), b1 / (1.0 - b0)]);
        let axes = ["/{b}_{0}", "/{b}_{1}"].map(|name| (name.to_owned(), Some(0.2)));
        return Chart { place: Box::new(at), ends: [[0.0, 1.0]; 2], axes };
    }
    let both = axes.map(reading);
    let [ends, steps] = [both.each_ref().map(|of| [0.0, of.end]), both.each_ref().map(|of| [of.every; 2])];
    let axes = [0, 1].map(|i| (both[i].title.clone(), Some(steps[i][0])));
    let at = move |[x, y]: [f64; 2]| Some([(both[0].place)(x), (both[1].place)(y)]);
    Chart { place: Box::new(at), ends, axes }
}

/// The axes of a triangle.
const TRIANGLE: [&str; 2] = ["(1 - b0)²", "b1 / (1 - b0)"];

/// A square of a map around the fullest cells, which have half of the samples: the whole, if it is not much larger, or has a cell elsewhere
/// that differs.
fn window(chart: &Chart, cell: impl Fn([f64; 2]) -> Option<usize>, cells: &[Row]) -> [[f64; 2]; 2] {
    /// Points along each side, and the room around those cells over their size.
    const SIDE: usize = 130;
    const ROOM: f64 = 0.75;
    let counts = |row: &Row| [row.observed as f64, row.expected];
    let total = cells.iter().map(counts).fold([0.0; 2], |[o, e], [a, b]| [o + a, e + b]);
    let share = |row: &Row| counts(row).iter().zip(total).map(|(n, all)| n / all.max(1.0)).fold(0.0, f64::max);
    let side = |from: Option<f64>, to: Option<f64>| to.unwrap_or(1.0) - from.unwrap_or(0.0);
    let density = |row: &Row| share(row) / (side(row.x_from, row.x_to) * side(row.y_from, row.y_to));
    let mut emptiest: Vec<usize> = (0..cells.len()).collect();
    emptiest.sort_by(|&a, &b| density(&cells[a]).total_cmp(&density(&cells[b])));
    let mut outside = 0.0;
    let is_empty = |cell: &usize| {
        outside += share(&cells[*cell]);
        outside <= 0.5
    };
    let empty: Vec<usize> = emptiest.into_iter().take_while(is_empty).collect();
    let at = |[from, to]: [f64; 2], i: usize| from + (to - from) * (i as f64 + 0.5) / SIDE as f64;
    let points = |[x, y]: [[f64; 2]; 2]| {
        let points = (0..SIDE * SIDE).map(move |i| [at(x, i % SIDE), at(y, i / SIDE)]);
        points.filter_map(|point| Some((point, cell(point)?)))
    };
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let full = points(chart.ends).filter(|(_, cell)| !empty.contains(cell));
    let around = full.fold(none, |ends, (at, _)| [0, 1].map(|k| [ends[k][0].min(at[k]), ends[k][1].max(at[k])]));
    let whole = chart.ends[0][1] - chart.ends[0][0];
    let step = whole / SIDE as f64;
    let side = (around.iter().map(|[from, to]| to - from).fold(0.0, f64::max) + step) * (1.0 + 2.0 * ROOM);
    // A lobe on a part of the map
    if !(side > 0.0 && side < 0.6 * whole) {
        return chart.ends;
    }
    let window = [0, 1].map(|k| {
        let [from, to] = chart.ends[k];
        let start = (around[k].iter().sum::<f64>() / 2.0 - side / 2.0).clamp(from, to - side);
        [start, start + side]
    });
    let seen: Vec<usize> = points(window).map(|(_, cell)| cell).collect();
    let differs = |cell: usize| cells[cell].residual.abs() > NOTABLE;
    let has_more = points(chart.ends).any(|(_, cell)| differs(cell) && !seen.contains(&cell));
    if has_more { chart.ends } else { window }
}

/// The share of the samples, and of those that are expected, that each end of an axis may leave out.
const TAIL: f64 = 0.005;

/// What is shown of an axis that is cut into parts, which have their ends and their samples, observed and expected: all but the tails. An end
/// of the axis, and the part that differs most, are shown if they are no farther away than the others are wide.
fn shown(parts: &[([f64; 2], [f64; 2])]) -> [f64; 2] {
    let total = [0, 1].map(|k| parts.iter().map(|(_, counts)| counts[k]).sum::<f64>());
    // The last place that leaves next to nothing on its side
    let tail = |sign: f64, end: usize| {
        let mut passed: Vec<(f64, [f64; 2])> = parts.iter().map(|(ends, counts)| (sign * ends[end], *counts)).collect();
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sums = [0.0; 2];
        let first = passed.iter().find(|(_, counts)| {
            sums = [0, 1].map(|k| sums[k] + counts[k]);
            (0..2).any(|k| sums[k] > TAIL * total[k])
        });
        let first = first.map_or(f64::INFINITY, |(at, _)| *at);
        passed.iter().rev().map(|(at, _)| *at).find(|at| *at < first).map(|at| sign * at)
    };
    let ends = || parts.iter().flat_map(|(ends, _)| *ends);
    let around = |of: &mut dyn Iterator<Item = f64>| {
        of.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
    };
    let (axis, finite) = (around(&mut ends()), around(&mut ends().filter(|end| end.is_finite())));
    let within = [tail(1.0, 1).unwrap_or(axis[0]), tail(-1.0, 0).unwrap_or(axis[1])];
    let within = if within[0] < within[1] { within } else { axis };
    // Parts without an end are shown in part
    let near = [0, 1].map(|k| if within[k].is_finite() { within[k] } else { finite[k] });
    let part = if near[1] > near[0] { (near[1] - near[0]) / 4.0 } else { 1.0 };
    let [low, high] = [0, 1].map(|k| if within[k].is_finite() { near[k] } else { near[k] + [-part, part][k] });
    let size = |(_, [observed, expected]): &([f64; 2], [f64; 2])| residual(*observed, *expected).abs();
    let worst = parts.iter().max_by(|a, b| size(a).total_cmp(&size(b))).map_or([low, high], |(ends, _)| *ends);
    let reach = |place: f64| (low - (high - low)..=high + (high - low)).contains(&place);
    around(&mut [[low, high], axis, worst].into_iter().flatten().filter(|place| reach(*place)))
}

/// A title of an axis, with what the figure leaves out.
fn with_rest<'a>(title: &str, rest: impl Iterator<Item = &'a [f64; 2]>) -> String {
    let [observed, expected] = rest.fold([0.0; 2], |[o, e], [a, b]| [o + a, e + b]);
    match observed > 0.0 || expected >= 0.5 {
        true => format!("{title} (not shown: {observed} samples, {expected:.1} expected)"),
        false => title.to_owned(),
    }
}

/// Three heat maps, each cell at its place, with the normal and `wo` where these are known.
fn maps(counts: &Counts, cells: &[Row], wo: Option<[f64; 3]>) -> Plot {
    let axes = counts.axes.each_ref().map(String::as_str);
    let boxes = counts.boxes.as_deref();
    let is_empty = |row: &Row| row.observed == 0 && row.expected <= EMPTY;
    // The measure of all, and whether the horizon is seen
    let (round, chart) = match (axes, reading(axes[0])) {
        ([RADIUS, "φ / 2π"], Reading { end, place, .. }) => (Some((PI, false)), sky(end, place)),
        ([_, "φ / 2π"], Reading { end: last, place, .. }) if last > 1.0 => {
            // As much below the horizon as there are samples, and `wo`
            let has_wo = |end: &f64| wo.is_none_or(|wo| polar(wo)[0] <= *end);
            let holds = |end: &f64| {
                has_wo(end) && cells.iter().all(|row| is_empty(row) || row.x_to.is_none_or(|x| x <= place(*end) + 1e-9))
            };
            let end = [90.0, 120.0].into_iter().find(holds).unwrap_or(last);
            let area = if last > 90.0 { 4.0 * PI } else { 2.0 * PI };
            (Some((area, end > 90.0)), sky(end, place))
        }
        _ => (None, rectangle(axes, boxes, cells)),
    };
    let circle = |radius: f64| {
        (0..=72).map(|i| f64::from(5 * i).to_radians().sin_cos()).map(move |(y, x)| [radius * x, radius * y])
    };
    let all: Vec<Cell> = boxes.map_or_else(|| counts.grid.cells().collect(), <[Cell]>::to_vec);
    let holds = |[from, to]: [f64; 2], v: f64| (from..to).contains(&v);
    // The cell at a point of the map, where there are any samples
    let at = |point: [f64; 2]| {
        let [x, y] = (chart.place)(point)?;
        let cell = all.iter().position(|cell| holds(cell.x, x) && holds(cell.y, y))?;
        (!is_empty(&cells[cell])).then_some(cell)
    };
    let ends = if round.is_some() { window(&chart, at, cells) } else { chart.ends };
    let is_inside = |point: &Point| [0, 1].into_iter().all(|k| (ends[k][0]..=ends[k][1]).contains(&point[k]));
    let point = |i: usize| {
        let of = |[from, to]: [f64; 2], k: usize| from + (to - from) * (k as f64 + 0.5) / POINTS as f64;
        [of(ends[0], i % POINTS), of(ends[1], POINTS - 1 - i / POINTS)]
    };
    let places: Vec<Option<usize>> = (0..POINTS * POINTS).map(|i| at(point(i))).collect();
    let grid =
        |value: &dyn Fn(usize) -> f64| places.iter().map(|cell| cell.map_or(f64::NAN, value)).collect::<Vec<_>>();
    let marked = wo.filter(|_| round.is_some()).map_or(Vec::new(), |wo| {
        let [theta, phi] = polar(wo);
        let (sin, cos) = phi.to_radians().sin_cos();
        match theta < 1e-3 {
            true => vec![("N = /{ω}o", [0.0; 2])],
            false => vec![("N", [0.0; 2]), ("/{ω}o", [theta * cos, theta * sin])],
        }
    });
    let marked: Vec<(&str, Point)> = marked.into_iter().filter(|(_, at)| is_inside(at)).collect();
    let horizon: Vec<Point> = circle(90.0).collect();
    let has_horizon = round.is_some_and(|(_, is_seen)| is_seen) && horizon.iter().any(is_inside);
    // What is left out has no point on the map, and its middle, as a small cell may have none, neither
    let mut is_seen = vec![ends == chart.ends && boxes.is_none(); cells.len()];
    places.iter().flatten().for_each(|cell| is_seen[*cell] = true);
    for (cell, is_seen) in all.iter().zip(&mut is_seen) {
        let [x, y] = [cell.x, cell.y].map(|ends| 0.5 * (ends[0] + ends[1]));
        let (r, (sin, cos)) = ((reading(axes[0]).value)(x), (2.0 * PI * y).sin_cos());
        *is_seen |= is_inside(&if round.is_some() { [r * cos, r * sin] } else { [x, y] });
    }
    let rest: Vec<[f64; 2]> = cells
        .iter()
        .zip(is_seen)
        .filter(|(_, is_seen)| !is_seen)
        .map(|(row, _)| [row.observed as f64, row.expected])
        .collect();
    let [x, y] = [0, 1].map(|k| {
        let (title, every) = &chart.axes[k];
        let told =
            [("; N: normal", marked.iter().any(|(name, _)| name.starts_with('N'))), ("; circle: horizon", has_horizon)]
                [k];
        let title = if told.1 { title.replace(')', &format!("{})", told.0)) } else { title.clone() };
        let title = if k == 0 { with_rest(&title, rest.iter()) } else { title };
        let axis = Axis::linear(title).range(ends[k][0], ends[k][1]);
        every.filter(|_| ends == chart.ends).map_or(axis.clone(), |step| axis.every(step))
    });
    let panel = |title: &str, map: Heatmap| {
        let panel = Panel::new(x.clone(), y.clone()).title(title).heatmap(map.on_paper());
        let panel = marked.iter().fold(panel, |panel, (name, at)| {
            let panel = panel.dots("", theme::MARKER_SHADE, [*at]).markers("", theme::BORDER, Marker::Open, [*at]);
            panel.note(*at, *name, theme::INK)
        });
        let stroke = Stroke::solid(theme::EXPECTED, theme::THIN);
        if has_horizon { panel.line("", stroke, horizon.clone()) } else { panel }
    };
    // Samples by solid angle or area, as cells that have equally many may be of any size
    let area = |cell: &Cell| (cell.x[1] - cell.x[0]) * (cell.y[1] - cell.y[0]);
    let is_even = all.iter().all(|cell| (area(cell) / area(&all[0]) - 1.0).abs() < 1e-6);
    let (unit, measure) = match round {
        Some((measure, _)) if axes[0] != RADIUS => ("samples per steradian", measure),
        Some((measure, _)) => ("samples per R²", measure),
        None if is_even => ("samples", 1.0 / area(&all[0])),
        None => ("samples per unit of area", 1.0),
    };
    let values = |samples: &dyn Fn(&Row) -> f64| {
        cells.iter().zip(&all).map(|(row, cell)| samples(row) / (area(cell) * measure)).collect::<Vec<f64>>()
    };
    let [observed, expected] = [values(&|row| row.observed as f64), values(&|row| row.expected)];
    // One scale for both counts, in equal factors where a few cells have most of the samples
    let mut sorted = expected.clone();
    sorted.sort_by(f64::total_cmp);
    let highest = observed.iter().chain(&expected).copied().fold(0.0, f64::max);
    let is_peaked = highest > PEAKED * sorted.get(sorted.len() / 2).copied().unwrap_or(highest);
    let counts = |title: &str, values: &[f64]| {
        let least = if is_peaked { DARKEST * highest } else { 0.0 };
        let shading = if is_peaked { Shading::Log10 } else { Shading::Linear };
        let values = grid(&|i| values[i].max(least));
        panel(title, Heatmap::new(POINTS, values, shading, unit).range(least, highest))
    };
    // One cell with many samples where none belong would leave no colours to the others
    let mut sizes: Vec<f64> = cells.iter().map(|row| row.residual.abs()).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let largest = sizes.last().copied().unwrap_or(1.0);
    let most = sizes.get(sizes.len() * 9 / 10).map_or(largest, |size| size.max(NOTABLE).min(largest));
    let is_clipped = most.ceil() < largest;
    let most = if is_clipped { most.ceil() } else { most };
    let beyond = if is_clipped { format!(" (ends: beyond ±{most})") } else { String::new() };
    let label = format!("standard deviations{beyond}");
    let residual = Heatmap::new(POINTS, grid(&|i| cells[i].residual), Shading::Diverging, label).range(-most, most);
    Plot::new([
        counts("Observed /{O}", &observed),
        counts("Expected /{E}", &expected),
        panel("Residual (/{O} − /{E})/√/{E}", residual),
    ])
    .frame_size(260.0, 260.0)
}

/// Fewer samples are none.
const EMPTY: f64 = 0.01;
/// Residuals from here on have the strongest colours at the earliest.
const NOTABLE: f64 = 5.0;

/// Points of a map along each side.
const POINTS: usize = 520;
/// The share of the highest count that has the darkest colour where counts are peaked.
const DARKEST: f64 = 1e-3;
/// Times the median count that the highest one has where counts are peaked.
const PEAKED: f64 = 8.0;

/// Cells along the only axis.
fn listed(counts: &Counts, cells: &[Row]) -> Plot {
    let chart: Vec<Cell> = counts.boxes.clone().unwrap_or_else(|| counts.grid.cells().collect());
    let edges = chart.iter().take(1).map(|cell| cell.x[0]).chain(chart.iter().map(|cell| cell.x[1]));
    let (axis, unit, edges): (_, _, Vec<f64>) = match (counts.outcomes, counts.axes[0].as_str()) {
        // An outcome is in the middle of its own
        (Some(outcomes), axis) => {
            (finding(axis), "outcome", edges.map(|x| (x * outcomes as f64).round() - 0.5).collect())
        }
        (_, "φ / 2π") => ("/{φ} (degrees)".into(), "degree", edges.map(|x| 360.0 * x).collect()),
        (_, axis) if counts.boxes.is_none() => (finding(axis), "unit", edges.collect()),
        _ => ("x".into(), "unit", edges.collect()),
    };
    let pairs: Vec<(f64, f64)> = cells.iter().map(|row| (row.observed as f64, row.expected)).collect();
    bars(&axis, unit, &edges, &pairs)
}

/// Parts of cells around the place where these differ most.
fn parts(counts: &Counts, Finer { axis, ends, observed, expected, .. }: &Finer) -> Plot {
    let of = counts.axes[*axis].as_str();
    let name = if counts.boxes.is_some() { ["x", "y"][*axis].to_owned() } else { finding(of) };
    let pairs: Vec<(f64, f64)> = observed.iter().map(|n| *n as f64).zip(expected.iter().copied()).collect();
    bars(&name, "unit", ends, &pairs)
}

/// Counts, observed and expected, between these edges, with their residuals.
fn bars(title: &str, unit: &str, edges: &[f64], counts: &[(f64, f64)]) -> Plot {
    let all: Vec<([f64; 2], [f64; 2])> = edges
        .windows(2)
        .zip(counts)
        .map(|(ends, &(observed, expected))| ([ends[0], ends[1]], [observed, expected]))
        .collect();
    let [from, to] = shown(&all);
    let all = merged(all, (to - from) / BARS);
    let widths: Vec<f64> = all.iter().map(|(ends, _)| ends[1] - ends[0]).collect();
    let [narrowest, widest] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| widths.iter().copied().reduce(of));
    let is_even = narrowest.zip(widest).is_some_and(|(narrowest, widest)| widest < EVEN * narrowest);
    // Where widths differ, samples by width
    let label = if is_even { "samples".to_owned() } else { format!("samples per {unit}") };
    let by_width = |i: usize, count: f64| if is_even { count } else { count / widths[i] };
    let (inner, rest): (Vec<_>, Vec<_>) = (0..all.len()).partition(|&i| all[i].0[0] < to && all[i].0[1] > from);
    let axis = Axis::linear(with_rest(title, rest.iter().map(|&i| &all[i].1)));
    let ends = |i: usize| all[i].0.map(|x| x.clamp(from, to));
    let expected: Vec<Point> = inner.iter().flat_map(|&i| ends(i).map(|x| [x, by_width(i, all[i].1[1])])).collect();
    let observed = inner.iter().map(|&i| by_width(i, all[i].1[0])).collect();
    let edges = inner.iter().take(1).map(|&i| ends(i)[0]).chain(inner.iter().map(|&i| ends(i)[1])).collect();
    let of = |&i: &usize| [ends(i).iter().sum::<f64>() / 2.0, residual(all[i].1[0], all[i].1[1])];
    let residuals: Vec<Point> = inner.iter().map(of).collect();
    let largest = residuals.iter().map(|[_, size]| size.abs()).fold(1.0, f64::max);
    let numbers = match unit {
        "outcome" if to - from <= 25.0 => axis.range(from, to).every(((to - from) / 12.0).ceil().max(1.0)),
        "degree" if to - from > 180.0 => axis.range(from, to).every(60.0),
        _ => axis.range(from, to),
    };
    let counts = Panel::new(numbers.clone(), Axis::linear(label))
        .title("Counts")
        .bars("observed", theme::OBSERVED, edges, observed)
        .line("expected", Stroke::solid(theme::EXPECTED, theme::THIN), expected);
    // Two residuals tell no more than the counts
    let residual = (residuals.len() > 2).then(|| {
        Panel::new(numbers, Axis::linear("standard deviations").range(-1.1 * largest, 1.1 * largest))
            .title("Residual (/{O} − /{E})/√/{E}")
            .horizontal(0.0, "")
            .dots("", theme::RESIDUAL, residuals)
    });
    Plot::new(std::iter::once(counts).chain(residual).collect::<Vec<_>>())
}

/// Bars along an axis: the counts of narrower ones are mostly chance.
const BARS: f64 = 100.0;

/// Widths of bars that count as equal.
const EVEN: f64 = 1.01;

/// Parts of an axis with their counts, narrow ones together with the next, or the last with the one before.
fn merged(parts: Vec<([f64; 2], [f64; 2])>, least: f64) -> Vec<([f64; 2], [f64; 2])> {
    // Equal parts that make up the width are enough, whatever their rounding
    let is_narrow = |(ends, _): &([f64; 2], [f64; 2])| ends[1] - ends[0] < least * (1.0 - 1e-6);
    let join = |(last, sums): &mut ([f64; 2], [f64; 2]), (ends, counts): ([f64; 2], [f64; 2])| {
        (last[1], *sums) = (ends[1], [0, 1].map(|k| sums[k] + counts[k]));
    };
    let mut all: Vec<([f64; 2], [f64; 2])> = Vec::new();
    for part in parts {
        match all.last_mut().filter(|last| is_narrow(last)) {
            Some(last) => join(last, part),
            None => all.push(part),
        }
    }
    if all.len() > 1
        && let Some(rest) = all.pop_if(|last| is_narrow(last))
        && let Some(last) = all.last_mut()
    {
        join(last, rest);
    }
    all
}

/// What has no place on the chart, delta lobes and "no sample", beside all that has.
fn lobes(counts: &Counts, cells: &[Row], beyond: &[Row]) -> Plot {
    let sum = |rows: &[Row]| rows.iter().fold([0.0; 2], |[o, e], row| [o + row.observed as f64, e + row.expected]);
    let elsewhere = ("elsewhere".to_owned(), sum(cells));
    let names = counts.atoms.iter().cloned().chain(["no sample".to_owned()]);
    let own = names.zip(beyond).map(|(name, row)| (name, sum(std::slice::from_ref(row))));
    let is_any = |(_, [observed, expected]): &(String, [f64; 2])| *observed > 0.0 || *expected >= 0.05;
    let all: Vec<(String, [f64; 2])> = own.chain([elsewhere]).filter(is_any).collect();
    let at = |i: usize| {
        let place = |(row, (_, counts)): (usize, &(String, [f64; 2]))| [counts[i], row as f64 + 0.5];
        all.iter().enumerate().map(place).collect::<Vec<Point>>()
    };
    let most = all.iter().flat_map(|(_, counts)| *counts).fold(0.0, f64::max);
    let names: Vec<String> = all.iter().map(|(name, _)| finding(name)).collect();
    let height = 36.0 * (names.len() + 1) as f64;
    let panel = Panel::new(Axis::linear("samples").range(0.0, 1.08 * most), Axis::named("", names))
        .title("Samples by kind")
        .markers("expected", theme::EXPECTED, Marker::Open, at(1))
        .dots("observed", theme::REJECTED, at(0));
    // Dots that nearly meet are distinguished by their numbers
    let differs =
        |(_, (_, [observed, expected])): &(usize, &(String, [f64; 2]))| residual(*observed, *expected).abs() > NOTABLE;
    let panel = all.iter().enumerate().filter(differs).fold(panel, |panel, (row, (_, [observed, expected]))| {
        panel.note([*observed, row as f64 + 0.5], format!("{observed}, not {expected:.0}"), theme::INK)
    });
    Plot::new([panel]).frame_size(420.0, height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_bench::validation::planted::{all, run_pair};
    use etalon_stats::{
        Barycentric, Density, Directions, Discrete, Domain, Line, Pole, Protocol, RealLine, Rectangle, Sample, Sampler,
        density, sampler, validate,
    };
    use std::f64::consts::TAU;

    fn svg(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> String {
        let outcome = validate(domain, sampler, density, &Protocol::default()).unwrap();
        assert_eq!(outcome.verdict, Verdict::Reject);
        drawing(&Tested { name: "own".into(), outcome }).svg()
    }

    fn has(svg: &str, texts: &[&str]) {
        texts.iter().for_each(|text| assert!(svg.contains(&format!(">{text}</text>")), "{text}: {svg}"));
    }

    #[test]
    fn narrow_bars_are_merged_into_equal_ones() {
        let cells =
            |n: usize| (0..n).map(|i| ([i, i + 1].map(|i| i as f64 / n as f64), [1.0, 2.0])).collect::<Vec<_>>();
        let even = merged(cells(200), 0.01);
        assert!(even.len() == 100 && even.iter().all(|(_, counts)| *counts == [2.0, 4.0]), "{even:?}");
        let rest = merged(cells(250), 0.01);
        assert!(rest.len() == 83 && rest.iter().all(|(ends, _)| ends[1] - ends[0] > 0.0119), "{rest:?}");
        assert_eq!(rest.iter().map(|(_, [n, _])| n).sum::<f64>(), 250.0);
    }

    #[test]
    fn panels_show_what_rejects_in_the_domains_own_coordinates() {
        let uniform = density(|_: [f64; 2]| 0.125);
        let sides = Rectangle { x: Line { from: -1.0, to: 3.0 }, y: Line { from: 0.0, to: 2.0 } };
        let skewed = sampler(2, |u| Some(Sample::new([4.0 * u[0] * u[0] - 1.0, 2.0 * u[1]])));
        has(&svg(&sides, &skewed, &uniform), &["x", "y", "−1", "3", "1.5"]);
        // Right in each cell, and wrong in its parts
        let line = Line { from: 10.0, to: 20.0 };
        let rippled = |u: f64| 10.0 + ((1024.0 * u).floor() + (1024.0 * u).fract().powi(2)) / 102.4;
        let fine = svg(&line, &sampler(1, move |u| Some(Sample::new(rippled(u[0])))), &density(|_: f64| 0.1));
        has(&fine, &["x", "10.20"]);
        let lazy = sampler(1, |u| (u[0] > 0.1).then(|| Sample::new(10.0 + 10.0 * (u[0] - 0.1) / 0.9)));
        // Below the cells, which have most of the samples
        has(&svg(&line, &lazy, &density(|_: f64| 0.1)), &["Counts", "no sample", "elsewhere"]);
        let claimed = sampler(1, |u| Some(Sample { pdf: Some(0.2), ..Sample::new(10.0 + 10.0 * u[0]) }));
        has(&svg(&line, &claimed, &density(|_: f64| 0.1)), &["Found over expected", "worst: 0.200, not 0.100"]);
    }

    #[test]
    fn what_is_shown_has_most_of_the_samples() {
        let even = |ends: &[f64], counts: &[f64]| {
            shown(&ends.windows(2).zip(counts).map(|(ends, &n)| ([ends[0], ends[1]], [n, n])).collect::<Vec<_>>())
        };
        let infinite = f64::INFINITY;
        // Tails without an end, or with one that is far away, are left out; an end that is near is shown
        let line = [-infinite, -1e8, -3.0, -1.0, 1.0, 3.0, 1e8, infinite];
        assert_eq!(even(&line, &[0.0, 1.0, 200.0, 900.0, 200.0, 1.0, 0.0]), [-3.0, 3.0]);
        assert_eq!(even(&[0.0, 1.0, 2.0, 3.0, 4.0], &[0.0, 50.0, 50.0, 0.0]), [0.0, 4.0]);
        assert_eq!(even(&[0.0, 100.0, 101.0, 102.0, 200.0], &[0.0, 50.0, 50.0, 0.0]), [100.0, 102.0]);
        // Parts without an end that have samples are shown in part
        assert_eq!(even(&[-infinite, 0.0, 4.0, infinite], &[30.0, 50.0, 20.0]), [-1.0, 5.0]);
        assert_eq!(even(&[-infinite, 2.0, infinite], &[30.0, 50.0]), [1.0, 3.0]);
        // A fault beside the samples is shown, one far away is not
        let parts = |at: f64| {
            let [few, most] = [([0.0, 1.0], [99.0; 2]), ([1.0, 2.0], [900.0; 2])];
            [few, most, ([2.0, at], [0.0; 2]), ([at, at + 1.0], [4.0, 0.0]), ([at + 1.0, 1e9], [0.0; 2])]
        };
        assert_eq!([shown(&parts(3.0)), shown(&parts(1e8))], [[0.0, 4.0], [0.0, 2.0]]);
    }

    #[test]
    fn the_real_line_is_drawn_where_the_samples_are() {
        let laplace = |b: f64| density(move |x: f64| (-x.abs() / b).exp() / (2.0 * b));
        let sample = |u: f64| if u < 0.5 { 2.0 * (2.0 * u).ln() } else { -2.0 * (2.0 - 2.0 * u).ln() };
        let svg = svg(&RealLine::UNIT, &sampler(1, move |u| Some(Sample::new(sample(u[0])))), &laplace(1.0));
        has(&svg, &["−5", "10"]);
        assert!(svg.contains("(not shown: ") && !svg.contains("×10"), "{svg}");
    }

    #[test]
    fn triangles_are_drawn_as_such_and_lobes_over_their_own_part_of_the_sky() {
        let uniform = sampler(2, |u| Some(Sample::new([u[0], u[1] * (1.0 - u[0])])));
        let svg_of_triangle = svg(&Barycentric, &uniform, &density(|_: [f64; 2]| 2.0));
        assert!(!svg_of_triangle.contains("²"), "{svg_of_triangle}");
        // A lobe of a few degrees, a quarter of a circle away from the normal
        let lobe = |u: &[f64]| {
            let (r, phi) = (0.03 * u[0].sqrt(), TAU * u[1]);
            let [y, z] = [r * phi.cos(), 0.7 + r * phi.sin()];
            Some(Sample::new([(1.0 - y * y - z * z).sqrt(), y, z]))
        };
        let is_inside = |[x, y, z]: [f64; 3]| x > 0.0 && y.hypot(z - 0.7) < 0.03;
        let too_large = density(move |w: [f64; 3]| if is_inside(w) { 400.0 } else { 0.0 });
        let svg = svg(&Directions::hemisphere(Pole::Z), &sampler(2, lobe), &too_large);
        assert!(!svg.contains(">−90</text>") && !svg.contains("not shown"), "{svg}");
    }

    #[test]
    fn names_of_files_are_spelled_as_they_are() {
        let outcome = validate(
            &Line { from: 0.0, to: 1.0 },
            &sampler(1, |u| Some(Sample::new(u[0]))),
            &density(|_: f64| 1.0),
            &Protocol::default(),
        );
        let svg = drawing(&Tested { name: "my_sampler".into(), outcome: outcome.unwrap() }).svg();
        assert!(svg.contains(">my_sampler: accepted"), "{svg}");
    }

    #[test]
    fn outcomes_of_a_finite_set_are_numbers_on_the_axis() {
        let coin = sampler(1, |u| Some(Sample::new((2.0 * u[0]) as usize)));
        has(&svg(&Discrete { outcomes: 3 }, &coin, &density(|_: usize| 1.0 / 3.0)), &["outcome", "0", "1", "2"]);
    }

    #[test]
    fn the_picture_of_a_bsdf_has_its_normal_and_says_what_is_clipped() {
        let fault = all().into_iter().find(|fault| fault.name == "whole/mixture/random-number-reused").unwrap();
        let found = run_pair(fault, &Protocol::default()).unwrap();
        let svg = pictured(&found.tests[0]).svg();
        for text in ["; N: normal)", ">N</text>", "(ends: beyond ±"] {
            assert!(svg.contains(text), "{text}");
        }
    }
}
