//! The film: the mean of very many samples of one pixel, against 256-bit arithmetic.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Tally, Workload};
use super::number::Number;
use super::precise::Precise;
use crate::error::Result;
use crate::math::Rgb;
use crate::render::film::Film;

/// The entry of the registry.
pub const EXPERIMENT: Experiment = Experiment {
    name: "film",
    about: "mean of up to 1e8 samples of one pixel, all alike or far apart",
    figure: "stability-sums",
    bounds: &[Bound {
        name: "last places",
        limit: 0.5,
        reason: "sums are exact, and the mean is rounded once",
        error: |row| Some(row.max_ulp),
    }],
    run,
};

/// The samples of a channel: these two, alternating.
const CHANNELS: [[f32; 2]; 3] = [[0.1, 0.1], [1e6, 1e-6], [1.0, 3e-8]];

fn run(workload: &Workload, _seed: u64) -> Result<Vec<ErrorRow>> {
    let pairs = workload.film_samples / 2;
    // Two films, merged at the end as parts of a render are.
    let (a, b) = rayon::join(|| accumulated(pairs / 2), || accumulated(pairs - pairs / 2));
    let mut film = a?;
    film.merge(&b?)?;
    let mean = film.image().get(0, 0).to_array();
    let mut stable = Tally::new("film", STABLE, Precision::Single);
    let mut textbook = [Precision::Single, Precision::Double].map(|p| Tally::new("film", TEXTBOOK, p));
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
    Ok(std::iter::once(stable).chain(textbook).map(Tally::row).collect())
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
