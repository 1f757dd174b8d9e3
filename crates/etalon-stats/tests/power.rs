//! The power that outcomes state, measured: ripples of the stated size, of 1 to 64 periods along each axis, are found as often.
//! `cargo test -p etalon-stats --test power -- --ignored --nocapture` prints the table of the book.

use etalon_stats::stream::CounterRng;
use etalon_stats::{
    Density, Directions, Domain, Line, Outcome, Pole, Protocol, Sample, Sampler, Square, Verdict, density, sampler,
    validate,
};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::f64::consts::TAU;

const PERIODS: [u32; 5] = [1, 4, 8, 16, 64];

/// The error that is found in ripples of n periods along an axis, from the scale whose parts they span two to four times.
fn stated(outcome: &Outcome, axis: &str, periods: u32) -> f64 {
    let fits = |parts: usize| (2 * periods as usize..4 * periods as usize).contains(&parts);
    let scale = outcome.scales.iter().find(|scale| scale.of == axis && fits(scale.parts));
    scale.and_then(|scale| scale.detectable).unwrap()
}

/// How many of n seeds reject `sampler`.
fn rejected(seeds: u64, domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> u64 {
    let verdict = |seed| validate(domain, sampler, density, &Protocol { seed, ..Protocol::default() }).unwrap().verdict;
    (1..=seeds).filter(|&seed| verdict(seed) == Verdict::Reject).count() as u64
}

/// Asserts that errors which are found with 90 % probability are found as often, except for three standard deviations.
fn assert_found(found: u64, runs: u64) {
    let runs = runs as f64;
    assert!(found as f64 >= 0.9 * runs - 3.0 * (0.09 * runs).sqrt(), "{found} of {runs}");
}

/// A line of the table: what is stated and how many are found, for each number of periods. `ripple` is the density that has it
/// with this amplitude and 2π times that many periods along the axis.
fn line<R>(
    seeds: u64,
    [name, axis]: [&str; 2],
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    ripple: impl Fn(f64, f64) -> R,
) -> u64
where
    R: Density,
{
    let right = validate(domain, sampler, &ripple(0.0, 1.0), &Protocol::default()).unwrap();
    assert!(right.is_accepted(), "{right}");
    let mut text = format!("{name:<22}");
    let mut total = 0;
    for periods in PERIODS {
        let error = stated(&right, axis, periods);
        let found = rejected(seeds, domain, sampler, &ripple(error * 2f64.sqrt(), TAU * f64::from(periods)));
        text += &format!(" {:>6.2} % {found:>2}/{seeds}", 100.0 * error);
        total += found;
    }
    println!("{text}");
    total
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn ripples_of_the_stated_size_are_found_as_often_as_stated() {
    measure(2);
}

#[ignore = "takes a minute"]
#[test]
fn the_table_of_the_book() {
    measure(6);
}

fn measure(seeds: u64) {
    println!("periods                {}", PERIODS.map(|n| format!("{n:>14}")).concat());
    let sphere = Directions::sphere(Pole::Z);
    let directions = || {
        sampler(2, |u| {
            let (z, (sin_phi, cos_phi)) = (1.0 - 2.0 * u[0], (TAU * u[1]).sin_cos());
            let sin = ((1.0 - z) * (1.0 + z)).sqrt();
            Some(Sample::new([sin * cos_phi, sin * sin_phi, z]))
        })
    };
    let along_phi =
        |a: f64, f: f64| density(move |w: [f64; 3]| 0.5 / TAU * (1.0 + a * (f / TAU * w[1].atan2(w[0])).cos()));
    let along_z = |a: f64, f: f64| density(move |w: [f64; 3]| 0.5 / TAU * (1.0 + a * (f * 0.5 * (1.0 - w[2])).cos()));
    let found = line(seeds, ["line", "x"], &Line::UNIT, &sampler(1, |u| Some(Sample::new(u[0]))), |a: f64, f: f64| {
        density(move |x: f64| 1.0 + a * (f * x).cos())
    }) + line(seeds, ["sphere, along theta", "(1 - cos θ) / 2"], &sphere, &directions(), along_z)
        + line(seeds, ["sphere, along phi", "φ / 2π"], &sphere, &directions(), along_phi);
    assert_found(found, 3 * PERIODS.len() as u64 * seeds);

    // A texture of both axes: products of two ripples.
    let square = sampler(2, |u| Some(Sample::new([u[0], u[1]])));
    let texture = |a: f64, periods: [f64; 2]| {
        density(move |[x, y]: [f64; 2]| 1.0 + a * (TAU * periods[0] * x).cos() * (TAU * periods[1] * y).cos())
    };
    let right = validate(&Square, &square, &texture(0.0, [1.0; 2]), &Protocol::default()).unwrap();
    let mut total = 0;
    for (periods, parts) in [([10.0, 20.0], 3200), ([20.0, 40.0], 12_800)] {
        let scale = right.scales.iter().find(|scale| scale.of == "cells" && scale.parts == parts).unwrap();
        let error = scale.detectable.unwrap();
        // w² is a quarter of the squared amplitude.
        let found = rejected(seeds, &Square, &square, &texture(2.0 * error, periods));
        println!("square, {periods:?} periods: {:.2} % {found}/{seeds}", 100.0 * error);
        total += found;
    }
    assert_found(total, 2 * seeds);
}

/// Errors of ±w in equal numbers of cells, in random order: finer tests see next to nothing of them that cells do not.
/// With them, what larger ones cost.
#[ignore = "takes a minute"]
#[test]
fn errors_of_cells_are_found_as_often_as_stated() {
    const CELLS: usize = 200;
    let of_size = |w: f64, seed: u64| {
        let mut signs: Vec<f64> = (0..CELLS).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        signs.shuffle(&mut CounterRng::new(seed, 0x70e4));
        let lines = (1..CELLS).map(|i| i as f64 / CELLS as f64).collect();
        let pdf = density(move |x: f64| 1.0 + w * signs[((x * CELLS as f64) as usize).min(CELLS - 1)]);
        pdf.with_steps([lines, Vec::new()])
    };
    let uniform = sampler(1, |u| Some(Sample::new(u[0])));
    for (w, runs) in [(0.02, 800), (0.03, 100), (0.05, 100), (0.1, 100), (0.0, 100)] {
        let protocol = |seed| Protocol { seed, ..Protocol::default() };
        let run = |seed| validate(&Line::UNIT, &uniform, &of_size(w, seed), &protocol(seed)).unwrap();
        let outcomes: Vec<Outcome> = (1..=runs).into_par_iter().map(run).collect();
        let found = outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Reject).count() as u64;
        let samples = outcomes.iter().map(|outcome| outcome.samples).sum::<u64>() / runs;
        println!("{:.0} %: {found} of {runs}, {samples} samples on average", 100.0 * w);
        if w > 0.0 {
            assert_found(found, runs);
        }
    }
}
