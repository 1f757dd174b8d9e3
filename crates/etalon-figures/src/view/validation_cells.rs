//! What one test looked at: counts, observed and expected, with their residuals; or numbers that should be equal and are not.

use super::text::{capitalized, finding, p_value, wrapped};
use crate::figure::{Axis, Drawing, Heatmap, Marker, Panel, Plot, Point, Shading, Stroke, theme};
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Cell, Compared, Counts, Outcome, Verdict};
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
    let Tested { name, outcome } = tested;
    let by = by(outcome);
    // The mistake, if there is one, is the headline, and need not be said again.
    match &outcome.mistake {
        Some(mistake) if mistake.chars().count() <= WIDEST_TITLE => {
            described(tested, format!("{name}: {}, {}", outcome.verdict, finding(mistake)), by)
        }
        mistake => {
            let by = by.map_or(String::new(), |by| format!(", {by}"));
            described(tested, format!("{name}: {}{by}", outcome.verdict), mistake.clone())
        }
    }
}

/// What the verdict rests on: a p-value, or numbers that must be equal.
fn by(outcome: &Outcome) -> Option<String> {
    let exact = || outcome.violation.is_some().then(|| "by an exact check".to_owned());
    outcome.p.map(p_value).or_else(exact)
}

/// The drawing of the test of a planted fault, under a sentence that says what the fault is.
pub fn fault(tested: &Tested, mistake: &str) -> Drawing {
    let said = match tested.outcome.verdict {
        Verdict::Accept => "accepted",
        Verdict::Reject => "rejected",
        Verdict::Inconclusive => "inconclusive",
    };
    let by = by(&tested.outcome).map_or(String::new(), |by| format!(": {by}"));
    /// Places that are named.
    const PLACES: usize = 2;
    let outcome = &tested.outcome;
    let places = outcome.found().into_iter().chain(outcome.other_places()).take(PLACES);
    let places = places.flat_map(|place| lines(&whole_degrees(place.trim_start_matches("sampling: "))));
    let (below, _) = picture(outcome);
    below.headed(capitalized(mistake), std::iter::once(format!("{said}{by}")).chain(places).collect())
}

/// A text in lines that are not too long.
fn lines(text: &str) -> Vec<String> {
    wrapped(text, "", WIDEST).lines().map(finding).collect()
}

/// A text with its angles in whole degrees.
fn whole_degrees(text: &str) -> String {
    let rounded = |part: &str| {
        let start = part.rfind(|c: char| !c.is_ascii_digit() && c != '.').map_or(0, |at| at + 1);
        let start = start + part[start..].len() - part[start..].trim_start_matches('.').len();
        let degrees = part[start..].parse::<f64>().map(|degrees| format!("{degrees:.0}"));
        format!("{}{}", &part[..start], degrees.unwrap_or_else(|_| part[start..].to_owned()))
    };
    text.split('°').map(rounded).collect::<Vec<_>>().join("°")
}

fn described(tested: &Tested, title: String, first: Option<String>) -> Drawing {
    let outcome = &tested.outcome;
    let findings = outcome.found().into_iter().chain(outcome.other_places()).flat_map(lines);
    let first = first.iter().flat_map(|text| lines(text));
    let (below, beyond) = picture(outcome);
    below.headed(title, first.chain(beyond).chain(findings).collect())
}

/// What a test looked at, under its name.
pub fn pictured(Tested { name, outcome }: &Tested) -> Drawing {
    let (below, beyond) = picture(outcome);
    below.headed(name, beyond.into_iter().collect())
}

/// The counts or the numbers of a test, and what has no place there.
fn picture(outcome: &Outcome) -> (Drawing, Option<String>) {
    match (&outcome.counts, &outcome.compared) {
        (Some(counts), _) => {
            let (plot, beyond) = plot(counts, outcome.wo);
            (plot.draw(), beyond)
        }
        (None, Some(compared)) => (compared_plot(compared, outcome.wo).draw(), None),
        (None, None) => (nothing(), None),
    }
}

/// The plot of the cells, and what has no place there.
fn plot(counts: &Counts, wo: Option<[f64; 3]>) -> (Plot, Option<String>) {
    let rows = rows(counts);
    let (cells, beyond) = rows.split_at(counts.grid.len());
    let is_list = counts.grid.cells().all(|cell| cell.y == [0.0, 1.0]);
    let plot = if cells.iter().all(|row| row.expected < 1.0 && row.observed == 0) {
        listed(beyond, "atoms, then no sample", None)
    } else if is_list {
        let axis = &counts.axes[0];
        let axis = if counts.outcomes.is_some() { axis.clone() } else { format!("cell, by {axis}") };
        listed(cells, &axis, counts.outcomes)
    } else {
        maps(counts.axes.each_ref().map(String::as_str), cells, wo)
    };
    (plot, Some(remainder(counts.atoms.len(), beyond)).filter(|line| !line.is_empty()))
}

/// Most letters of a line above a drawing, and of a mistake in its title.
const WIDEST: usize = 110;
const WIDEST_TITLE: usize = 80;

/// What stands below lines of text alone.
fn nothing() -> Drawing {
    Drawing::stacked(Vec::new(), 0.5)
}

/// The causes for which tests are not accepted, in whole sentences, as many as there is room for; `None` if all are accepted.
pub fn reasons(validation: &Validation) -> Option<Drawing> {
    /// Lines after which no further cause begins.
    const LINES: usize = 9;
    let found = validation.causes();
    let (mut lines, mut told) = (Vec::new(), 0);
    for cause in &found {
        if lines.len() >= LINES {
            break;
        }
        lines.extend(wrapped(cause, "", WIDEST).lines().map(finding));
        told += 1;
    }
    if told < found.len() {
        lines.push(format!("and {} more", found.len() - told));
    }
    let refused = validation.rejected + validation.inconclusive;
    let title = format!("Why {refused} of {} tests do not accept", validation.tests.len());
    (!lines.is_empty()).then(|| nothing().headed(title, lines))
}

/// Numbers of an exact check. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ComparedRow {
    /// The direction `wi`.
    theta_deg: f64,
    phi_deg: f64,
    found: f64,
    expected: f64,
}

pub fn compared_rows(compared: &Compared) -> Vec<ComparedRow> {
    let row = |&([x, y, z], [found, expected]): &([f64; 3], [f64; 2])| ComparedRow {
        theta_deg: x.hypot(y).atan2(z).to_degrees(),
        phi_deg: y.atan2(x).to_degrees().rem_euclid(360.0),
        found,
        expected,
    };
    compared.places.iter().map(row).collect()
}

/// The ratio of what was found to what is expected over the angle of `wi`, and one against the other.
fn compared_plot(compared: &Compared, wo: Option<[f64; 3]>) -> Plot {
    /// Dots of a panel.
    const DOTS: usize = 500;
    let all = compared_rows(compared);
    let shown = || all.iter().filter(|row| row.found > 0.0 && row.expected > 0.0).take(DOTS);
    let ratios: Vec<Point> = shown().map(|row| [row.theta_deg, row.found / row.expected]).collect();
    let furthest = ratios.iter().map(|[_, ratio]| ratio.ln().abs()).fold(0.0, f64::max);
    // Ratios near 1 in percent
    let is_near = furthest < 0.5;
    let (y, points, equal) = match is_near {
        true => {
            let percent = ratios.iter().map(|[theta, ratio]| [*theta, 100.0 * (ratio - 1.0)]).collect::<Vec<_>>();
            (Axis::linear("difference (percent)"), percent, 0.0)
        }
        false => (Axis::log("found / expected"), ratios, 1.0),
    };
    let end = if all.iter().any(|row| row.theta_deg > 90.0) { 180.0 } else { 90.0 };
    let over_angle = Panel::new(Axis::linear("/{θ} of /{ω}i (degrees)").range(0.0, end).every(end / 6.0), y)
        .title("Found over expected, by direction")
        .horizontal(equal, "equal")
        .dots("", theme::REJECTED, points);
    let over_angle = match wo.map(polar) {
        Some([theta, _]) => over_angle.vertical(theta, "/{θ} of /{ω}o"),
        None => over_angle,
    };
    let both: Vec<Point> = shown().map(|row| [row.expected, row.found]).collect();
    let ends = shown().flat_map(|row| [row.found, row.expected]);
    let [least, most] = ends.fold([f64::INFINITY, 0.0f64], |[least, most], x| [least.min(x), most.max(x)]);
    let one_by_other = Panel::new(Axis::log("expected"), Axis::log("found"))
        .title(finding(&compared.law))
        .line("equal", Stroke::solid(theme::EXPECTED, theme::THIN), vec![[least, least], [most, most]])
        .dots("found", theme::REJECTED, both);
    Plot::new([over_angle, one_by_other])
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

/// The angle of a direction with the normal and its azimuth, in degrees.
fn polar([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x.hypot(y).atan2(z), y.atan2(x)].map(f64::to_degrees)
}

/// Where on the axes of the cells each point of a map lies, and the axes of the map.
type Chart = (Box<dyn Fn(usize) -> Option<[f64; 2]>>, [Axis; 2]);

/// A disc of directions around the normal, as the sky above: the angle with it grows from the centre to the rim. A lobe is one spot there,
/// wherever it points.
fn sky(end: f64, place: fn(f64) -> f64, has_normal: bool) -> Chart {
    let at = move |i: usize| {
        let [x, y] = [i % POINTS, POINTS - 1 - i / POINTS].map(|k| 2.0 * (k as f64 + 0.5) / POINTS as f64 - 1.0);
        let theta = x.hypot(y) * end;
        (theta < end).then(|| [place(theta), y.atan2(x).to_degrees().rem_euclid(360.0) / 360.0])
    };
    let axis = |of: &str, also: &str| {
        Axis::linear(format!("/{{θ}} {of} /{{φ}} (degrees{also})")).range(-end, end).every(end / 3.0)
    };
    let [normal, horizon] = [("; N: normal", has_normal), ("; circle: horizon", end > 90.0)];
    let told = |(text, is_seen): (&'static str, bool)| if is_seen { text } else { "" };
    (Box::new(at), [axis("cos", told(normal)), axis("sin", told(horizon))])
}

/// A map whose rows are the first axis, from the top.
fn rectangle(axes: [&str; 2]) -> Chart {
    let [down, across] = axes.map(reading);
    let x = Axis::linear(across.title.as_str()).range(0.0, across.end).every(across.every);
    let y = Axis::linear(down.title.as_str()).range(down.end, 0.0).every(down.every);
    let middle = |i: usize, of: &Reading| (of.place)(of.end * (i as f64 + 0.5) / POINTS as f64);
    (Box::new(move |i| Some([middle(i / POINTS, &down), middle(i % POINTS, &across)])), [x, y])
}

/// Three heat maps, each cell at its place, with the normal and `wo` where these are known.
fn maps(axes: [&str; 2], cells: &[Row], wo: Option<[f64; 3]>) -> Plot {
    let is_empty = |row: &Row| row.observed == 0 && row.expected <= EMPTY;
    let (sphere, (place, [x, y])) = match (axes, reading(axes[0])) {
        ([_, "φ / 2π"], Reading { end: last, place, .. }) if last > 1.0 => {
            // As much below the horizon as there are samples, and `wo`
            let has_wo = |end: &f64| wo.is_none_or(|wo| polar(wo)[0] <= *end);
            let holds = |end: &f64| {
                has_wo(end) && cells.iter().all(|row| is_empty(row) || row.x_to.is_none_or(|x| x <= place(*end) + 1e-9))
            };
            let end = [90.0, 120.0].into_iter().find(holds).unwrap_or(last);
            let area = if last > 90.0 { 4.0 * PI } else { 2.0 * PI };
            (Some((area, end > 90.0)), sky(end, place, wo.is_some()))
        }
        _ => (None, rectangle(axes)),
    };
    let circle = |radius: f64| {
        (0..=72).map(|i| f64::from(5 * i).to_radians().sin_cos()).map(move |(y, x)| [radius * x, radius * y])
    };
    let holds =
        |from: Option<f64>, to: Option<f64>, v: f64| from.zip(to).is_some_and(|(from, to)| (from..to).contains(&v));
    // The cell at each point of the map, where there are any samples
    let at = |i: usize| {
        let [x, y] = place(i)?;
        let cell = cells.iter().find(|row| holds(row.x_from, row.x_to, x) && holds(row.y_from, row.y_to, y));
        cell.filter(|row| !is_empty(row))
    };
    let places: Vec<Option<&Row>> = (0..POINTS * POINTS).map(at).collect();
    let grid = |value: &dyn Fn(&Row) -> f64| places.iter().map(|row| row.map_or(f64::NAN, value)).collect::<Vec<_>>();
    let marked = wo.filter(|_| sphere.is_some()).map_or(Vec::new(), |wo| {
        let [theta, phi] = polar(wo);
        let (sin, cos) = phi.to_radians().sin_cos();
        match theta < 1e-3 {
            true => vec![("N = /{ω}o", [0.0; 2])],
            false => vec![("N", [0.0; 2]), ("/{ω}o", [theta * cos, theta * sin])],
        }
    });
    let panel = |title: &str, map: Heatmap| {
        let panel = Panel::new(x.clone(), y.clone()).title(title).heatmap(map.on_paper());
        let panel = marked.iter().fold(panel, |panel, (name, at)| {
            let panel = panel.dots("", theme::MARKER_SHADE, [*at]).markers("", theme::BORDER, Marker::Open, [*at]);
            panel.note(*at, *name, theme::INK)
        });
        if sphere.is_none_or(|(_, is_horizon_seen)| !is_horizon_seen) {
            return panel;
        }
        panel.line("", Stroke::solid(theme::EXPECTED, theme::THIN), circle(90.0).collect::<Vec<Point>>())
    };
    // Samples of a cell; of directions by solid angle, as cells that have equally many may be of any size
    let per = |row: &Row, samples: f64| {
        let side = |from: Option<f64>, to: Option<f64>| to.zip(from).map_or(1.0, |(to, from)| to - from);
        let area = side(row.x_from, row.x_to) * side(row.y_from, row.y_to);
        sphere.map_or(samples, |(all, _)| samples / (area * all))
    };
    let unit = if sphere.is_some() { "samples per steradian" } else { "samples" };
    // One scale for both counts, in equal factors where a few cells have most of the samples
    let mut expected: Vec<f64> = cells.iter().map(|row| per(row, row.expected)).collect();
    expected.sort_by(f64::total_cmp);
    let highest = cells.iter().map(|row| per(row, row.expected.max(row.observed as f64))).fold(0.0, f64::max);
    let is_peaked = highest > PEAKED * expected.get(expected.len() / 2).copied().unwrap_or(highest);
    let counts = |title: &str, value: &dyn Fn(&Row) -> f64| {
        panel(
            title,
            match is_peaked {
                true => Heatmap::new(POINTS, grid(&|row| value(row).max(DARKEST * highest)), Shading::Log10, unit)
                    .range(DARKEST * highest, highest),
                false => Heatmap::new(POINTS, grid(value), Shading::Linear, unit).range(0.0, highest),
            },
        )
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
    let residual = Heatmap::new(POINTS, grid(&|row| row.residual), Shading::Diverging, label).range(-most, most);
    Plot::new([
        counts("Observed /{O}", &|row| per(row, row.observed as f64)),
        counts("Expected /{E}", &|row| per(row, row.expected)),
        panel("Residual (/{O} − /{E})/√/{E}", residual),
    ])
    .frame_size(260.0, 260.0)
}

/// Fewer samples are none.
const EMPTY: f64 = 0.01;
/// Residuals from here on have the strongest colours at the earliest.
const NOTABLE: f64 = 5.0;

/// Points of a map along each side.
const POINTS: usize = 360;
/// The share of the highest count that has the darkest colour where counts are peaked.
const DARKEST: f64 = 1e-3;
/// Times the median count that the highest one has where counts are peaked.
const PEAKED: f64 = 8.0;

/// Counts one after the other, or at their outcomes, with their residuals.
fn listed(rows: &[Row], axis: &str, outcomes: Option<usize>) -> Plot {
    // The ends of the bars: an outcome is in the middle of its own
    let edges: Vec<f64> = match outcomes {
        Some(outcomes) => {
            let end = |x: &Option<f64>| (x.unwrap_or(0.0) * outcomes as f64).round() - 0.5;
            rows.iter().take(1).map(|row| end(&row.x_from)).chain(rows.iter().map(|row| end(&row.x_to))).collect()
        }
        None => (0..=rows.len()).map(|i| i as f64).collect(),
    };
    let bars = || edges.windows(2).map(|ends| (ends[0], ends[1])).zip(rows);
    // Bars of several outcomes show the mean of these
    let is_mean = bars().any(|((from, to), _)| to - from > 1.5);
    let samples = if is_mean { "samples per outcome" } else { "samples" };
    let expected: Vec<Point> =
        bars().flat_map(|((from, to), row)| [from, to].map(|x| [x, row.expected / (to - from)])).collect();
    let observed = bars().map(|((from, to), row)| row.observed as f64 / (to - from)).collect();
    // Cells at the ends, which may hold a long tail, are shown in part
    let [from, to] = match edges[..] {
        [first, second, .., before, last] => {
            let part = ((before - second) / 8.0).max(1.0);
            [first.max(second - part), last.min(before + part)]
        }
        _ => [edges.first(), edges.last()].map(|end| end.copied().unwrap_or(1.0)),
    };
    let middle = |(start, end): (f64, f64)| 0.5 * (start.max(from) + end.min(to));
    let residuals: Vec<Point> = bars().map(|(ends, row)| [middle(ends), row.residual]).collect();
    let largest = rows.iter().map(|row| row.residual.abs()).fold(1.0, f64::max);
    let numbers = || {
        let axis = Axis::linear(axis).range(from, to);
        if to - from <= 25.0 { axis.every(((to - from) / 12.0).ceil().max(1.0)) } else { axis }
    };
    Plot::new([
        Panel::new(numbers(), Axis::linear(samples))
            .title("Counts")
            .bars("observed", theme::OBSERVED, edges.clone(), observed)
            .line("expected", Stroke::solid(theme::EXPECTED, theme::THIN), expected),
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

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_bench::validation::planted::{all, run_pair};
    use etalon_stats::{Discrete, Protocol, Sample, density, sampler, validate};

    #[test]
    fn outcomes_of_a_finite_set_are_numbers_on_the_axis() {
        let coin = sampler(1, |u| Some(Sample::new((2.0 * u[0]) as usize)));
        let die = density(|_: usize| 1.0 / 3.0);
        let outcome = validate(&Discrete { outcomes: 3 }, &coin, &die, &Protocol::default()).unwrap();
        let svg = pictured(&Tested { name: "coin".into(), outcome }).svg();
        assert!(svg.contains(">outcome</text>") && !svg.contains("cell"), "{svg}");
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
