//! Sums: the mean of very many samples of one pixel, and summed-area tables behind one bright texel.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Workload};
use super::number::Number;
use super::precise::Precise;
use etalon_core::envmap::cut::SummedArea;
use etalon_core::envmap::latlong::Block;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_render::film::Film;

pub const FILM: Experiment = Experiment {
    name: "film",
    about: "mean of up to 1e8 samples of one pixel, all alike or far apart",
    figure: "stability-sums",
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
    figure: "stability-sums",
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
