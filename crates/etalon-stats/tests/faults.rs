//! Faults that counts in 200 cells do not show: of the numbers that a sampler is fed with, of the order of its samples. The
//! planted faults of `etalon validate` have more of them. And faults that published software had, as models of a few lines, beside those
//! of the museum of `etalon validate`: the first line of the test names each, and the same without the fault is accepted.

use etalon_stats::stream::{CounterRng, Independent, Sobol, Stream};
use etalon_stats::{
    Density, Directions, Discrete, Domain, Line, Outcome, Point, Pole, Protocol, Result, Sample, Sampler, Square,
    Verdict, density, sampler, validate,
};
use rand::RngExt;
use std::f64::consts::{PI, TAU};

fn tested(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> Outcome {
    validate(domain, sampler, density, &Protocol::default()).unwrap()
}

/// Uniform over the sphere.
fn direction([u, v]: [f64; 2]) -> [f64; 3] {
    at_height(1.0 - 2.0 * u, v)
}

/// The direction with this z, at azimuth 2π `u`.
fn at_height(z: f64, u: f64) -> [f64; 3] {
    let ((sin_phi, cos_phi), sin) = ((TAU * u).sin_cos(), ((1.0 - z) * (1.0 + z)).max(0.0).sqrt());
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

/// The tests of these pairs share the level of 1 %.
const PAIRS: usize = 8;

/// Without the fault, the first is accepted; with it, the reason has the words `named`.
fn check(domain: &dyn Domain, pairs: [(&dyn Sampler, &dyn Density); 2], named: &str) {
    let [right, faulty] = pairs.map(|(sampler, density)| {
        validate(domain, sampler, density, &Protocol { tests: PAIRS, ..Protocol::default() }).unwrap()
    });
    assert!(right.is_accepted(), "{named}: {right}");
    let reason = faulty.reason().unwrap_or_default();
    assert!(faulty.verdict == Verdict::Reject && reason.contains(named), "{named}: {faulty}");
}

#[test]
fn faults_of_maps_are_named() {
    let sphere = Directions::sphere(Pole::Y);
    let uniform = density(|_: [f64; 3]| 0.25 / PI);
    let even = sampler(2, |u| Some(Sample::new(at_height(1.0 - 2.0 * u[0], u[1]))));

    // The pdf of a constant map, 4π: tauray 8c6d88a
    let inverted = density(|_: [f64; 3]| 4.0 * PI);
    check(&sphere, [(&even, &uniform), (&even, &inverted)], "the pdf integrates to 157.913670");

    // Texels by radiance, and a pdf that lacks the sine of their row: tauray 8c6d88a. Here radiance is 1 + sin θ in 64 rows.
    let row = |cos: f64| ((64.0 * cos.acos() / PI) as usize).min(63);
    let radiance = |i: usize| 1.0 + (PI * (i as f64 + 0.5) / 64.0).sin();
    let total: f64 = (0..64).map(radiance).sum();
    let texel = sampler(3, move |u| {
        let mut rest = u[0] * total;
        let found = (0..64).find(|&i| {
            rest -= radiance(i);
            rest < 0.0
        });
        let theta = PI * (found.unwrap_or(63) as f64 + u[1]) / 64.0;
        let [x, y, z] = at_height(theta.cos(), u[2]);
        Some(Sample::new([x, z, y]))
    });
    // Per solid angle: rows are π/64 wide in θ, and columns 2π.
    let per_angle = move |w: [f64; 3]| radiance(row(w[1])) / total * 64.0 / PI / TAU;
    let lines = || (1..64).map(|i| 0.5 * (1.0 - (PI * f64::from(i) / 64.0).cos())).collect::<Vec<f64>>();
    let with_sine = density(move |w: [f64; 3]| per_angle(w) / w[0].hypot(w[2]));
    let without = density(per_angle).with_steps([lines(), Vec::new()]);
    check(&sphere, [(&texel, &with_sine), (&texel, &without)], "samples follow the pdf divided by sin θ, not the pdf");
}

#[test]
fn faults_of_phase_functions_and_of_carried_pdfs_are_named() {
    // A table of a phase function, its pdf at -cos: Mitsuba 3, 49e40bad0. The function here is (1 + z/2)/4π.
    let pdf = |z: f64| (1.0 + 0.5 * z) / (4.0 * PI);
    let phase = move |sign: f64| {
        sampler(2, move |u| {
            let z = 2.0 * ((0.25 + 2.0 * u[0]).sqrt() - 1.0);
            Some(Sample::with_pdf(at_height(z, u[1]), pdf(sign * z)))
        })
    };
    let asked = density(move |w: [f64; 3]| pdf(w[2]));
    let (right, faulty) = (phase(1.0), phase(-1.0));
    let named = "what samples carry is the pdf at the opposite direction";
    check(&Directions::sphere(Pole::Z), [(&right, &asked), (&faulty, &asked)], named);

    // u p in place of u/p where a random number is used again: pbrt-v4 795c619b
    let halves = |divide: bool| {
        sampler(1, move |u| {
            let (p, first) = (0.25, u[0] < 0.25);
            let again = if first { if divide { u[0] / p } else { u[0] * p } } else { (u[0] - p) / (1.0 - p) };
            Some(Sample::new(4 * usize::from(!first) + (4.0 * again) as usize))
        })
    };
    let outcomes = density(|i: usize| if i < 4 { 0.0625 } else { 0.1875 });
    let (right, faulty) = (halves(true), halves(false));
    check(&Discrete { outcomes: 8 }, [(&right, &outcomes), (&faulty, &outcomes)], " % too many for outcome 0");
}
