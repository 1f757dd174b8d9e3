//! Sampling tables of a map with one texel of 10¹² among 10⁻¹²: which bins can be sampled, and with which probability.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Workload};
use etalon_core::error::Result;
use etalon_core::memory;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::sampling::table::Table2;
use rayon::prelude::*;

pub const EXPERIMENT: Experiment = Experiment {
    name: "tables",
    about: "probabilities of the bins of a map with one texel of 1e12 among 1e-12; out of range: bins out of reach",
    figure: "stability-sums",
    bounds: &[Bound::possible("bins of positive weight out of reach")],
    run,
};

const HOT: f64 = 1e12;
const COLD: f64 = 1e-12;

fn run(workload: &Workload, seed: u64) -> Result<Vec<ErrorRow>> {
    let [width, height] = workload.map;
    memory::request(width * height * Table2::BYTES, || format!("the table of a map of {width}x{height} texels"))?;
    let weight = hot_texel(workload.map);
    let table = Table2::new(width, height, weight);
    let total = HOT + COLD * (width * height - 1) as f64;
    // Compare all bins of a row.
    let bins = |row: ErrorRow, y: usize, probability: &dyn Fn(usize) -> f64, reached: &dyn Fn(usize) -> bool| {
        (0..width).fold(row, |mut row, x| {
            let exact = weight(x, y) / total;
            // Probabilities are differences of prefix sums of up to 1, which sets the condition number.
            row.compare(probability(x), exact, 1.0 / exact, || format!("bin ({x}, {y}) of {width}x{height}"));
            row.out_of_range += u64::from(!reached(x));
            row
        })
    };
    // A bin is reached if the random numbers of its lower corner lead back to it.
    let stable = (0..height).into_par_iter().map(|y| {
        let reached = |x: usize| {
            table
                .sample(table.invert((x, y), (0.0, 0.0)))
                .is_some_and(|sample| (sample.x.cell, sample.y.cell) == (x, y))
        };
        bins(ErrorRow::new("tables", STABLE, Precision::Double), y, &|x| table.probability(x, y), &reached)
    });
    let stable = stable.reduce(|| ErrorRow::new("tables", STABLE, Precision::Double), ErrorRow::merge);
    // The textbook's prefix sums in f32, as many renderers have them.
    let rows = prefix_sums((0..height).map(|y| row_sum(width, y, weight)));
    let textbook = (0..height).into_par_iter().map(|y| {
        let row = prefix_sums((0..width).map(|x| weight(x, y) as f32));
        let probability = |x: usize| f64::from(row[x + 1] - row[x]) * f64::from(rows[y + 1] - rows[y]);
        bins(ErrorRow::new("tables", TEXTBOOK, Precision::Single), y, &probability, &|x| probability(x) > 0.0)
    });
    let textbook = textbook.reduce(|| ErrorRow::new("tables", TEXTBOOK, Precision::Single), ErrorRow::merge);
    Ok(vec![stable, sampled(&table, workload, seed), textbook])
}

/// The weights of the map: the hot texel lies off all symmetries.
fn hot_texel([width, height]: [usize; 2]) -> impl Fn(usize, usize) -> f64 + Copy + Send + Sync {
    let hot = (width / 3, height / 3);
    move |x, y| if (x, y) == hot { HOT } else { COLD }
}

fn row_sum(width: usize, y: usize, weight: impl Fn(usize, usize) -> f64) -> f32 {
    (0..width).fold(0.0, |sum, x| sum + weight(x, y) as f32)
}

/// Sums of the first n weights over the sum of all.
fn prefix_sums(weights: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut sum = 0.0;
    let mut sums: Vec<f32> = std::iter::once(0.0)
        .chain(weights.map(|w| {
            sum += w;
            sum
        }))
        .collect();
    sums.iter_mut().for_each(|s| *s /= sum);
    sums
}

/// Counts samples whose probability is not that of the bin to the last bit, and samples of the hot texel.
fn sampled(table: &Table2, workload: &Workload, seed: u64) -> ErrorRow {
    let hot = (workload.map[0] / 3, workload.map[1] / 3);
    let [wrong, cold] = (0..workload.table_samples)
        .into_par_iter()
        .map(|i| match table.sample(Independent::new(seed, 0, i).pair(0)) {
            Some(sample) => {
                let cell = (sample.x.cell, sample.y.cell);
                let same = sample.probability().to_bits() == table.probability(cell.0, cell.1).to_bits();
                [u64::from(!same || sample.probability() <= 0.0), u64::from(cell != hot)]
            }
            None => [1, 0],
        })
        .reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let mut row = ErrorRow::new("tables", "stable, drawn", Precision::Double);
    let count = u64::from(workload.table_samples);
    row.compare((count - cold) as f64 / count as f64, 1.0, 1.0, || {
        format!("{cold} of {count} samples outside the hot texel")
    });
    row.out_of_range += wrong;
    row.cases += count - 1;
    row
}
