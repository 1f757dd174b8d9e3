//! Usual mistakes of samplers, and what a test says of each: `mistakes`.

use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::text::{capitalized, finding};
use etalon_stats::{
    Cell, Density, Directions, Domain, Line, Outcome, Pole, Sample, Sampler, Square, Verdict, density, sampler,
    validate,
};
use serde::Serialize;
use std::f64::consts::{PI, TAU};

struct Mistaken {
    mistake: &'static str,
    domain: Box<dyn Domain>,
    sampler: Box<dyn Sampler>,
    density: Box<dyn Density>,
    /// What the test should say that samples follow.
    follows: &'static str,
}

/// A bar of a histogram along the first axis. Field names are the CSV columns.
#[derive(Default, Serialize)]
struct Row {
    mistake: &'static str,
    said: String,
    x_from: f64,
    x_to: f64,
    observed: u64,
    expected: f64,
}

/// Panels in a row, and most bars of each.
const COLUMNS: usize = 3;
const BARS: usize = 20;

pub fn figures() -> Vec<Maker> {
    vec![maker("mistakes", |inputs, _| content(inputs))]
}

fn direction(z: f64, u: f64) -> [f64; 3] {
    let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), TAU * u);
    [r * phi.cos(), r * phi.sin(), z]
}

/// Henyey and Greenstein's phase function, g = 0.6, by the cosine of the angle to the forward direction.
const G: f64 = 0.6;

fn henyey_greenstein(cos: f64) -> f64 {
    (1.0 - G * G) / (4.0 * PI * (1.0 + G * G - 2.0 * G * cos).powf(1.5))
}

/// A table of eight entries.
const TABLE: [f64; 8] = [1.0, 4.0, 2.0, 7.0, 3.0, 5.0, 1.0, 2.0];

fn entry(x: f64) -> usize {
    ((8.0 * x) as usize).min(7)
}

/// The entry at `u`, by the cumulative distribution of `weights`, and a place in it.
fn sample_table(weights: [f64; 8], u: f64, place: f64, shift: usize) -> f64 {
    let mut rest = u * weights.iter().sum::<f64>();
    let found = weights.iter().position(|weight| {
        rest -= weight;
        rest < 0.0
    });
    ((found.unwrap_or(7) + shift) % 8) as f64 / 8.0 + place / 8.0
}

fn all() -> Vec<Mistaken> {
    let hemisphere = || Box::new(Directions::hemisphere(Pole::Z));
    let sphere = || Box::new(Directions::sphere(Pole::Z));
    let cosine = || Box::new(density(|w: [f64; 3]| w[2] / PI));
    let of_table = || {
        let sum: f64 = TABLE.iter().sum();
        let lines = (1..8).map(|i| f64::from(i) / 8.0).collect();
        Box::new(density(move |[x, _]: [f64; 2]| 8.0 * TABLE[entry(x)] / sum).with_steps([lines, Vec::new()]))
    };
    let directions = |of: fn(f64) -> f64| Box::new(sampler(2, move |u| Some(Sample::new(direction(of(u[0]), u[1])))));
    vec![
        Mistaken {
            mistake: "no importance sampling",
            domain: hemisphere(),
            sampler: directions(|u| 1.0 - u),
            density: cosine(),
            follows: "a uniform density",
        },
        Mistaken {
            mistake: "the disk's radius is u, not √u",
            domain: hemisphere(),
            sampler: directions(|u| (1.0 - u * u).sqrt()),
            density: cosine(),
            follows: "a density in proportion to cos θ/sin θ (the radius of a disk is u, not √u)",
        },
        Mistaken {
            mistake: "cosine-weighted samples, uniform pdf",
            domain: hemisphere(),
            sampler: directions(|u| (1.0 - u).sqrt()),
            density: Box::new(density(|_: [f64; 3]| 1.0 / TAU)),
            follows: "cos θ/π",
        },
        Mistaken {
            mistake: "an angle θ that is uniform",
            domain: sphere(),
            sampler: directions(|u| (PI * u).cos()),
            density: Box::new(density(|_: [f64; 3]| 0.25 / PI)),
            follows: "a density in proportion to 1/sin θ (θ is uniform, without the factor sin θ)",
        },
        Mistaken {
            mistake: "the pdf lacks sin θ",
            domain: sphere(),
            sampler: directions(|u| 1.0 - 2.0 * u),
            density: Box::new(density(|w: [f64; 3]| 0.5 / (PI * PI * w[0].hypot(w[1])))),
            follows: "a uniform density",
        },
        Mistaken {
            mistake: "the sign of g of Henyey and Greenstein",
            domain: sphere(),
            sampler: directions(|u| {
                let s = (1.0 - G * G) / (1.0 - G + 2.0 * G * u);
                (1.0 + G * G - s * s) / (2.0 * G)
            }),
            density: Box::new(density(|w: [f64; 3]| henyey_greenstein(-w[2]))),
            follows: "the pdf at the opposite direction or the pdf at (x, y, -z) or 6 more that explain as much",
        },
        Mistaken {
            mistake: "the square u² for the root √u",
            domain: Box::new(Line::UNIT),
            sampler: Box::new(sampler(1, |u| Some(Sample::new(u[0] * u[0])))),
            density: Box::new(density(|x: f64| 2.0 * x)),
            follows: "a density in proportion to 1/√d, d the distance from the lower end",
        },
        Mistaken {
            mistake: "an index that is off by one",
            domain: Box::new(Square),
            sampler: Box::new(sampler(3, |u| Some(Sample::new([sample_table(TABLE, u[0], u[1], 1), u[2]])))),
            density: of_table(),
            follows: "the pdf of the previous entry along x",
        },
        Mistaken {
            mistake: "weights that are applied twice",
            domain: Box::new(Square),
            sampler: Box::new(sampler(3, |u| {
                Some(Sample::new([sample_table(TABLE.map(|weight| weight * weight), u[0], u[1], 0), u[2]]))
            })),
            density: of_table(),
            follows: "the pdf to the power of 2",
        },
    ]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let (mut rows, mut panels, mut checks) = (Vec::new(), Vec::new(), Vec::new());
    for Mistaken { mistake, domain, sampler, density, follows } in all() {
        let outcome = validate(&*domain, &*sampler, &*density, &inputs.protocol())?;
        let said = outcome.mistake.as_ref().map(ToString::to_string).unwrap_or_default();
        let is_named = outcome.verdict == Verdict::Reject && said == format!("samples follow {follows}, not the pdf");
        let follows = outcome.mistake.as_ref().map_or("", |mistake| mistake.first());
        checks.push(Check::equal(format!("named: {mistake}"), 1.0, f64::from(u8::from(is_named))));
        let bars = bars(&outcome, mistake, &said);
        panels.push(panel(domain.axes()[0], mistake, follows, &bars));
        rows.extend(bars);
    }
    let rest = panels.chunks(COLUMNS).map(|row| (String::new(), row.to_vec()));
    let drawing: Drawing = Plot::grid(rest).frame_size(300.0, 150.0).draw();
    Content::new(drawing, &rows, checks)
}

/// Counts along the first axis of the chart, of neighbouring cells together.
fn bars(outcome: &Outcome, mistake: &'static str, said: &str) -> Vec<Row> {
    let Some(counts) = &outcome.counts else { return Vec::new() };
    let cells: Vec<(Cell, (u64, f64))> =
        counts.grid.cells().zip(counts.observed.iter().copied().zip(counts.expected.iter().copied())).collect();
    let strips: Vec<&[(Cell, (u64, f64))]> = cells.chunk_by(|a, b| a.0.x == b.0.x).collect();
    let bar = |strips: &[&[(Cell, (u64, f64))]]| {
        let all = strips.iter().flat_map(|strip| strip.iter());
        let (observed, expected) = all.fold((0, 0.0), |(o, e), (_, (observed, expected))| (o + observed, e + expected));
        let [first, last] = [strips[0][0].0, strips[strips.len() - 1][0].0];
        Row { mistake, said: said.to_owned(), x_from: first.x[0], x_to: last.x[1], observed, expected }
    };
    strips.chunks(strips.len().div_ceil(BARS)).map(bar).collect()
}

/// A finding without its remark in brackets at the end, which says the mistake again.
fn without_aside(text: &str) -> &str {
    text.split_once(" (").map_or(text, |(start, _)| start)
}

fn panel(axis: &str, mistake: &str, follows: &str, bars: &[Row]) -> Panel {
    let edges = bars.iter().map(|bar| bar.x_from).chain(bars.last().map(|bar| bar.x_to)).collect();
    let per_width = |count: f64, bar: &Row| count / (bar.x_to - bar.x_from) / 1000.0;
    let observed = bars.iter().map(|bar| per_width(bar.observed as f64, bar)).collect();
    let expected: Vec<Point> =
        bars.iter().flat_map(|bar| [bar.x_from, bar.x_to].map(|x| [x, per_width(bar.expected, bar)])).collect();
    Panel::new(Axis::linear(finding(axis)).range(0.0, 1.0), Axis::linear("1000 samples per unit"))
        .title(format!("{}: samples follow {}", capitalized(mistake), finding(without_aside(follows))))
        .bars("samples", theme::OBSERVED, edges, observed)
        .line("expected by the pdf", Stroke::solid(theme::EXPECTED, theme::LINE), expected)
}
