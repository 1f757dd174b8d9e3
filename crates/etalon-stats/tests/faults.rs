//! Faults that counts in 200 cells do not show: of the numbers that a sampler is fed with, of the order of its samples. The
//! planted faults of `etalon validate` have more of them.

use etalon_stats::stream::{CounterRng, Independent, Sobol, Stream};
use etalon_stats::{
    Density, Directions, Domain, Line, Outcome, Point, Pole, Protocol, Result, Sample, Sampler, Square, Verdict,
    density, sampler, validate,
};
use rand::RngExt;
use std::f64::consts::TAU;

fn tested(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> Outcome {
    validate(domain, sampler, density, &Protocol::default()).unwrap()
}

/// Uniform over the sphere.
fn direction([u, v]: [f64; 2]) -> [f64; 3] {
    let (z, (sin_phi, cos_phi)) = (1.0 - 2.0 * u, (TAU * v).sin_cos());
    let sin = ((1.0 - z) * (1.0 + z)).sqrt();
    [sin * cos_phi, sin * sin_phi, z]
}

/// The tests of samples on a line, a square and a sphere that are uniform except for what `spoil` does to their numbers.
fn of_numbers(spoil: fn(f64) -> f64) -> [Outcome; 3] {
    let line = sampler(1, move |u| Some(Sample::new(spoil(u[0]).sqrt())));
    let square = sampler(2, move |u| Some(Sample::new([spoil(u[0]), u[1]])));
    let sphere = sampler(2, move |u| Some(Sample::new(direction([u[0], spoil(u[1])]))));
    [
        tested(&Line::UNIT, &line, &density(|x: f64| 2.0 * x)),
        tested(&Square, &square, &density(|_: [f64; 2]| 1.0)),
        tested(&Directions::sphere(Pole::Z), &sphere, &density(|_: [f64; 3]| 0.5 / TAU)),
    ]
}

fn assert_rejected(outcome: &Outcome, named: &str) {
    assert!(outcome.verdict == Verdict::Reject && outcome.to_string().contains(named), "{named}: {outcome}");
}

#[test]
fn numbers_of_few_bits_are_named_and_those_of_24_are_right() {
    for outcome in of_numbers(|u| (4096.0 * u).floor() / 4096.0) {
        assert_rejected(&outcome, "random numbers of 12");
    }
    for outcome in of_numbers(|u| (16_777_216.0 * u).floor() / 16_777_216.0) {
        assert!(outcome.is_accepted() && outcome.remarks.is_empty(), "{outcome}");
    }
}

/// A sampler with a generator of its own: `draw` fills a batch of numbers from a seed, `point` makes a point of `N` of them.
struct Own<F, P, const N: usize> {
    draw: F,
    point: fn([f64; N]) -> P,
}

impl<F: Fn(u32, &mut [f64]) + Sync, P: Into<Point>, const N: usize> Sampler for Own<F, P, N> {
    fn dimension(&self) -> usize {
        0
    }

    fn sample(&self, _: &[f64], _: &mut Vec<Option<Sample>>) -> Result<()> {
        unreachable!("it takes no random numbers")
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> Result<()> {
        let mut numbers = vec![0.0; N * count];
        (self.draw)(seed, &mut numbers);
        let (points, _) = numbers.as_chunks::<N>();
        out.extend(points.iter().map(|u| Some(Sample::new((self.point)(*u)))));
        Ok(())
    }
}

fn on_line(draw: impl Fn(u32, &mut [f64]) + Sync) -> Outcome {
    tested(&Line::UNIT, &Own { draw, point: |[x]: [f64; 1]| x }, &density(|_: f64| 1.0))
}

fn on_sphere(draw: impl Fn(u32, &mut [f64]) + Sync) -> Outcome {
    tested(&Directions::sphere(Pole::Z), &Own { draw, point: direction }, &density(|_: [f64; 3]| 0.5 / TAU))
}

/// Independent numbers from a seed.
fn fill(seed: u32, numbers: &mut [f64]) {
    let mut rng = CounterRng::new(u64::from(seed), 7);
    numbers.iter_mut().for_each(|x| *x = rng.random());
}

#[test]
fn independent_numbers_of_a_generator_are_accepted() {
    for outcome in [on_line(fill), on_sphere(fill)] {
        assert!(outcome.is_accepted() && outcome.remarks.is_empty(), "{outcome}");
    }
}

#[test]
fn batches_of_few_seeds_are_named() {
    assert_rejected(&on_sphere(|seed, numbers| fill(seed % 64, numbers)), "with the same samples");
}

#[test]
fn samples_that_are_too_even_are_accepted_with_a_remark() {
    let stratified = |seed: u32, numbers: &mut [f64]| {
        fill(seed, numbers);
        let n = numbers.len() as f64;
        numbers.iter_mut().enumerate().for_each(|(i, x)| *x = (i as f64 + *x) / n);
    };
    let in_quarters = |seed: u32, numbers: &mut [f64]| {
        fill(seed, numbers);
        let n = numbers.len();
        numbers.iter_mut().enumerate().for_each(|(i, x)| *x = ((4 * i / n) as f64 + *x) / 4.0);
    };
    let antithetic = |seed: u32, numbers: &mut [f64]| {
        fill(seed, numbers);
        (1..numbers.len()).step_by(2).for_each(|i| numbers[i] = 1.0 - numbers[i - 1]);
    };
    let sobol = |seed: u32, numbers: &mut [f64]| {
        for (i, pair) in numbers.chunks_exact_mut(2).enumerate() {
            pair.copy_from_slice(&Sobol::new(u64::from(seed), 0, i as u32).pair(0));
        }
    };
    let random = |seed: u32, numbers: &mut [f64]| {
        for (i, pair) in numbers.chunks_exact_mut(2).enumerate() {
            pair.copy_from_slice(&Independent::new(u64::from(seed), 0, i as u32).pair(0));
        }
    };
    for outcome in [on_line(stratified), on_line(in_quarters), on_line(antithetic), on_sphere(sobol), on_line(sobol)] {
        assert!(outcome.is_accepted() && outcome.remarks[0].contains("low-discrepancy"), "{outcome}");
    }
    assert!(on_sphere(random).remarks.is_empty());
}
