//! Sums: the mean of very many samples of one pixel; summed-area tables behind one bright texel; sampling tables of a map with one
//! texel of 10¹² among 10⁻¹²: which bins can be sampled, and with which probability.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Workload};
use super::number::{Number, Precise};
use etalon_core::envmap::cut::SummedArea;
use etalon_core::envmap::latlong::Block;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::memory;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::sampling::table::Table2;
use etalon_render::film::Film;
use rayon::prelude::*;

pub const FILM: Experiment = Experiment {
    name: "film",
    about: "mean of up to 1e8 samples of one pixel, all alike or far apart",
    figure: "stability-worst",
    bounds: &[Bound {
        name: "last places",
        limit: 0.5,
        reason: "sums are exact, and the mean is rounded once",
        error: |row| Some(row.max_ulp),
    }],
    run: run_film,
};

/// The samples of a channel: these two, alternating.
const CHANNELS: [[f32; 2]; 3] = [[0.1, 0.1], [1e6, 1e-6], [1.0, 3e-8]];

fn run_film(workload: &Workload, _seed: u64) -> Result<Vec<ErrorRow>> {
    let pairs = workload.film_samples / 2;
    // Two films, merged at the end as parts of a render are.
    let (a, b) = rayon::join(|| accumulated(pairs / 2), || accumulated(pairs - pairs / 2));
    let mut film = a?;
    film.merge(&b?)?;
    let mean = film.image().get(0, 0).to_array();
    let mut stable = ErrorRow::new("film", STABLE, Precision::Single);
    let mut textbook = [Precision::Single, Precision::Double].map(|p| ErrorRow::new("film", TEXTBOOK, p));
    for (c, values) in CHANNELS.into_iter().enumerate() {
        let sum = Precise::of(f64::from(values[0])) + Precise::of(f64::from(values[1]));
        let exact = (sum / Precise::of(2.0)).to_f64();
        let what = || format!("{} samples of {:e} and {:e}, alternating", 2 * pairs, values[0], values[1]);
        // All samples are positive: nothing cancels.
        stable.compare(f64::from(mean[c]), exact, 1.0, what);
        // Textbook: one running sum in f32, and one in f64.
        let single: f32 = plain_sum(pairs, values, |sum, v| sum + v);
        textbook[0].compare(f64::from(single / (2 * pairs) as f32), exact, 1.0, what);
        let double: f64 = plain_sum(pairs, values.map(f64::from), |sum, v| sum + v);
        textbook[1].compare(double / f64::from(2 * pairs), exact, 1.0, what);
    }
    Ok(std::iter::once(stable).chain(textbook).collect())
}

/// A film of one pixel with that many pairs of samples.
fn accumulated(pairs: u32) -> Result<Film> {
    let samples = [0, 1].map(|i| Rgb::from_array(CHANNELS.map(|values| values[i])));
    let mut film = Film::new(1, 1, None)?;
    film.accumulate(|row| {
        for _ in 0..pairs {
            samples.iter().for_each(|&sample| row.add(0, sample, &[]));
        }
    });
    Ok(film)
}

/// The plain sum of both values, alternating.
fn plain_sum<T: Copy + Default>(pairs: u32, values: [T; 2], plus: impl Fn(T, T) -> T) -> T {
    (0..pairs).fold(T::default(), |sum, _| plus(plus(sum, values[0]), values[1]))
}

pub const AREAS: Experiment = Experiment {
    name: "areas",
    about: "summed-area tables with one texel of 2^20 among 1 (areas), of 2^40 among 2^-40 (areas-extreme)",
    figure: "stability-worst",
    bounds: &[Bound {
        name: "error of sums of few digits",
        limit: 0.0,
        reason: "all partial sums are whole multiples of 2^−12 below 2^41",
        error: |row| (row.family == "areas").then_some(row.max_relative),
    }],
    run: run_areas,
};

const BLOCK: usize = 8;

fn run_areas(workload: &Workload, _seed: u64) -> Result<Vec<ErrorRow>> {
    let [width, height] = workload.map.map(|side| side / 8);
    let rows = [("areas", 2f64.powi(20), 1.0 + 2f64.powi(-12)), ("areas-extreme", 2f64.powi(40), 2f64.powi(-40))];
    let rows = rows.into_iter().flat_map(|(name, hot, cold)| {
        let at = (width / 8, height / 8);
        let value = |x: usize, y: usize| if (x, y) == at { hot } else { cold };
        let table = SummedArea::new(width, height, value);
        let single = single_sums(width, height, value);
        let mut stable = ErrorRow::new(name, STABLE, Precision::Double);
        let mut textbook = ErrorRow::new(name, TEXTBOOK, Precision::Single);
        for (x0, y0) in (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (x * BLOCK, y * BLOCK))) {
            let block = Block { x0, y0, x1: x0 + BLOCK, y1: y0 + BLOCK };
            let inside = |r: Block| (r.x0..r.x1).contains(&at.0) && (r.y0..r.y1).contains(&at.1);
            // Both values have few digits, so that this is exact.
            let exact = |r: Block| {
                let cells = ((r.x1 - r.x0) * (r.y1 - r.y0)) as f64;
                if inside(r) { hot + (cells - 1.0) * cold } else { cells * cold }
            };
            let sum = exact(block);
            // Condition of the difference of four sums.
            let condition = 4.0 * exact(Block { x0: 0, y0: 0, ..block }) / sum;
            let what = || format!("block from ({x0}, {y0}) of {width}x{height}");
            stable.compare(table.sum(block), sum, condition, what);
            // The same difference of four sums in f32.
            let corner = |x: usize, y: usize| single[y * (width + 1) + x];
            let four = corner(block.x1, block.y1) - corner(x0, block.y1) - corner(block.x1, y0) + corner(x0, y0);
            textbook.compare(f64::from(four), sum, condition, what);
        }
        [stable, textbook]
    });
    Ok(rows.collect())
}

/// The table in f32, row by row.
fn single_sums(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Vec<f32> {
    let stride = width + 1;
    let mut sums = vec![0.0; stride * (height + 1)];
    for y in 0..height {
        let mut row = 0.0;
        for x in 0..width {
            row += value(x, y) as f32;
            sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
        }
    }
    sums
}

pub const TABLES: Experiment = Experiment {
    name: "tables",
    about: "probabilities of the bins of a map with one texel of 1e12 among 1e-12; out of range: bins out of reach",
    figure: "stability-worst",
    bounds: &[Bound::possible("bins of positive weight out of reach")],
    run: run_tables,
};

const HOT: f64 = 1e12;
const COLD: f64 = 1e-12;

fn run_tables(workload: &Workload, seed: u64) -> Result<Vec<ErrorRow>> {
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
