//! Test cases: tabulated distributions: cumulative tables with their guides in one and two dimensions.

use super::super::case::Case;
use etalon_core::sampling::table::{Table1, Table2};
use etalon_stats::{Line, Sample, Square, density, sampler};

type Weights = fn(usize, usize) -> f64;

/// Shapes of weights: constant, linear, 90 % in one cell, zeros at the ends, zeros in between.
const SHAPES: [(&str, Weights); 5] = [
    ("even", |_, _| 1.0),
    ("linear", |i, _| i as f64 + 0.5),
    ("one-huge", |i, n| if i == n / 3 { 9.0 * n as f64 } else { 1.0 }),
    ("dark-ends", |i, n| f64::from(4 * i > n && 4 * i < 3 * n)),
    ("gaps", |i, _| if i % 3 == 1 { 0.0 } else { (i % 7) as f64 + 0.1 }),
];
const CELLS: [usize; 5] = [1, 2, 37, 1024, 65535];

fn weights(shape: Weights, n: usize) -> Vec<f64> {
    let mut weights: Vec<f64> = (0..n).map(|i| shape(i, n)).collect();
    if weights.iter().all(|w| *w == 0.0) {
        weights[n / 2] = 1.0;
    }
    weights
}

/// The inner edges of `n` equal steps.
fn steps(n: usize) -> Vec<f64> {
    (1..n).map(|i| i as f64 / n as f64).collect()
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, shape) in SHAPES {
        // A single cell is uniform whatever its weight.
        for n in CELLS.into_iter().filter(|n| *n > 2 || name == "even") {
            cases.push(cumulative(format!("table/cdf/{name}/{n}"), shape, n));
        }
        for (width, height) in [(16, 8), (5, 63), (300, 200)] {
            cases.push(grid(format!("table/grid/{name}/{width}x{height}"), shape, width, height));
        }
    }
    cases
}

/// The position along the table: the cell and the position inside it, which is uniform.
fn cumulative(name: String, shape: Weights, n: usize) -> Case {
    Case::of(name, Line::UNIT, move || {
        let table = Table1::new(&weights(shape, n));
        let (cells, of) = (n as f64, table.clone());
        let pdf = move |x: f64| of.probability(((x * cells) as usize).min(n - 1)) * cells;
        let back = table.clone();
        let draw = move |u: &[f64]| {
            let draw = table.sample(u[0])?;
            Some(Sample::with_pdf((draw.cell as f64 + draw.offset) / cells, draw.probability * cells))
        };
        // Random number of a position, by its cell.
        let invert = move |x: f64| {
            let cell = ((x * cells) as usize).min(n - 1);
            vec![back.invert(cell, x * cells - cell as f64)]
        };
        (sampler(1, draw).with_inverse(invert), density(pdf).with_steps([steps(n), Vec::new()]))
    })
}

/// The place on a grid whose weights are a product of two shapes, turned against each other.
fn grid(name: String, shape: Weights, width: usize, height: usize) -> Case {
    Case::of(name, Square, move || {
        let (row, column) = (weights(shape, height), weights(shape, width));
        let table = Table2::new(width, height, |x, y| row[y] * column[(x + y) % width]);
        let (w, h, of) = (width as f64, height as f64, table.clone());
        let cell = move |[y, x]: [f64; 2]| [((x * w) as usize).min(width - 1), ((y * h) as usize).min(height - 1)];
        let pdf = move |place: [f64; 2]| {
            let [x, y] = cell(place);
            of.probability(x, y) * (w * h)
        };
        let back = table.clone();
        let draw = move |u: &[f64]| {
            let draw = table.sample([u[0], u[1]])?;
            let place = [(draw.y.cell as f64 + draw.y.offset) / h, (draw.x.cell as f64 + draw.x.offset) / w];
            Some(Sample::with_pdf(place, draw.probability() * (w * h)))
        };
        let invert = move |place: [f64; 2]| {
            let [x, y] = cell(place);
            back.invert((x, y), (place[1] * w - x as f64, place[0] * h - y as f64)).to_vec()
        };
        (sampler(2, draw).with_inverse(invert), density(pdf).with_steps([steps(height), steps(width)]))
    })
}
