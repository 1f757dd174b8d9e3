//! Whether right samplers are rejected as often as the level says: runs on sets, lines, squares and the sphere, each with a
//! density of its own. `cargo test -p etalon-stats --test calibration -- --ignored --nocapture` prints the figures of the book.

#[path = "../src/testing.rs"]
mod testing;

use etalon_stats::stream::CounterRng;
use etalon_stats::{
    Density, Directions, Discrete, Domain, Line, Outcome, Pole, Protocol, Sample, Sampler, Square, Verdict, decide,
    density, examine, sampler,
};
use rand::RngExt;
use rayon::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};
use std::f64::consts::TAU;
use testing::{combine, dot, normalize, tangents};

/// Probability that a run rejects a right sampler.
const LEVEL: f64 = 0.05;
/// Levels at which p-values of right samplers are counted.
const LEVELS: [f64; 4] = [0.01, LEVEL, 0.2, 0.5];

/// What the sampler of a run does to its first random number: nothing if it is right.
type Spoil = fn(f64) -> f64;

/// One run on a domain, by its seed.
type Kind = fn(u64, Spoil) -> Run;

const KINDS: [(&str, Kind); 4] = [("discrete", discrete), ("line", line), ("square", square), ("sphere", sphere)];

/// The p-value of the first round, whether a look ended it before all samples were drawn, and what both rounds decide.
struct Run {
    p: f64,
    is_early: bool,
    verdict: Verdict,
}

fn run(seed: u64, domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> Run {
    let protocol = Protocol { seed, level: LEVEL, ..Protocol::default() };
    let round = |round| examine(domain, sampler, density, &protocol, round);
    let mut outcomes: [Outcome; 1] = [round(0).unwrap()];
    let p = outcomes[0].p.unwrap();
    let is_early = outcomes[0].samples < protocol.samples_for(outcomes[0].cells - 1);
    decide(&mut outcomes, LEVEL, |_| round(1)).unwrap();
    // Exact checks reject at once, for whatever level.
    assert_eq!(outcomes[0].violation, None, "seed {seed}");
    Run { p, is_early, verdict: outcomes[0].verdict }
}

/// Parameters of the density of a run.
fn parameters(seed: u64) -> impl FnMut(f64, f64) -> f64 {
    let mut rng = CounterRng::new(seed, 0xca11);
    move |from, to| from + (to - from) * rng.random::<f64>()
}

/// Some probabilities of 2 to 300 outcomes.
fn discrete(seed: u64, spoil: Spoil) -> Run {
    let mut number = parameters(seed);
    let weights: Vec<f64> = (0..number(2.0, 301.0) as usize).map(|_| number(0.05, 1.0)).collect();
    let total: f64 = weights.iter().sum();
    let mut ends = weights.clone();
    (1..ends.len()).for_each(|i| ends[i] += ends[i - 1]);
    let draw = sampler(1, |u| {
        let i = ends.partition_point(|&end| end <= spoil(u[0]) * total);
        Some(Sample::new(i.min(ends.len() - 1)))
    });
    run(seed, &Discrete { outcomes: weights.len() }, &draw, &density(|i: usize| weights[i] / total))
}

/// k xᵏ⁻¹, with a pole at 0 for k < 1.
fn line(seed: u64, spoil: Spoil) -> Run {
    let k = parameters(seed)(0.6, 4.0);
    let draw = sampler(1, |u| Some(Sample::new((1.0 - spoil(u[0])).powf(1.0 / k))));
    run(seed, &Line::UNIT, &draw, &density(|x: f64| k * x.powf(k - 1.0)))
}

/// Products of powers.
fn square(seed: u64, spoil: Spoil) -> Run {
    let mut number = parameters(seed);
    let [a, b] = [number(1.0, 4.0), number(1.0, 4.0)];
    let draw = sampler(2, |u| Some(Sample::new([spoil(u[0]).powf(1.0 / a), u[1].powf(1.0 / b)])));
    run(seed, &Square, &draw, &density(|[x, y]: [f64; 2]| a * x.powf(a - 1.0) * b * y.powf(b - 1.0)))
}

/// The von Mises-Fisher distribution, of any width and direction.
fn sphere(seed: u64, spoil: Spoil) -> Run {
    let mut number = parameters(seed);
    let kappa = number(f64::ln(0.1), f64::ln(1e4)).exp();
    let axis = normalize([number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)]);
    let [s, t] = tangents(axis);
    let none = (-2.0 * kappa).exp();
    let draw = sampler(2, |u| {
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        let v = 1.0 - spoil(u[0]);
        let below = -(v + (1.0 - v) * none).ln() / kappa;
        let sin = (below * (2.0 - below)).max(0.0).sqrt();
        Some(Sample::new(normalize(combine([(1.0 - below, axis), (sin * cos_phi, s), (sin * sin_phi, t)]))))
    });
    let scale = kappa / (TAU * (1.0 - none));
    run(seed, &Directions::sphere(Pole::Z), &draw, &density(|w| scale * (kappa * (dot(w, axis) - 1.0)).exp()))
}

/// Runs each kind at n seeds.
fn runs(of_each: u64, spoil: Spoil) -> Vec<Run> {
    let of = |(name, kind): (&str, Kind)| {
        let runs: Vec<Run> = (0..of_each).into_par_iter().map(|seed| kind(seed, spoil)).collect();
        println!("{name:<10} {}", described(&runs));
        runs
    };
    let all: Vec<Run> = KINDS.into_iter().flat_map(of).collect();
    println!("{:<10} {}", "all", described(&all));
    all
}

fn described(runs: &[Run]) -> String {
    let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / runs.len() as f64);
    let inconclusive = runs.iter().filter(|run| run.verdict == Verdict::Inconclusive).count();
    let below = LEVELS.map(|level| format!("p < {level}: {}", share(below(runs, level)))).join(", ");
    let [count, rejected] = [runs.len(), rejected(runs)];
    format!("{count:>5} runs, {below}, {rejected} rejected ({}), {inconclusive} inconclusive", share(rejected))
}

fn below(runs: &[Run], level: f64) -> usize {
    runs.iter().filter(|run| run.p < level).count()
}

fn rejected(runs: &[Run]) -> usize {
    runs.iter().filter(|run| run.verdict == Verdict::Reject).count()
}

/// The most of n runs that a level explains: more have a probability of 0.1 % at most.
fn most(runs: &[Run], level: f64) -> usize {
    let count = Binomial::new(level, runs.len() as u64).unwrap();
    (0..runs.len()).find(|&k| count.sf(k as u64) <= 1e-3).unwrap()
}

fn assert_calibrated(runs: &[Run]) {
    for level in LEVELS {
        let (below, most) = (below(runs, level), most(runs, level));
        println!("p < {level}: {below}, at most {most} are explained");
        assert!(below <= most, "{below} of {} p-values below {level}", runs.len());
    }
    assert!(rejected(runs) <= most(runs, LEVEL), "{} of {} rejected", rejected(runs), runs.len());
    // Looks before the last have a tenth of the level.
    let early = runs.iter().filter(|run| run.is_early).count();
    println!("ended early: {early}, at most {} are explained", most(runs, 0.1 * LEVEL));
    assert!(early <= most(runs, 0.1 * LEVEL), "{early} of {} ended early", runs.len());
}

#[test]
fn right_samplers_are_rejected_at_most_as_often_as_the_level_says() {
    assert_calibrated(&runs(20, |u| u));
}

/// A first random number of which the density is wrong by 2 %.
#[test]
fn samplers_with_a_fault_are_rejected_more_often() {
    let found = runs(5, |u| u.powf(1.02));
    assert!(rejected(&found) > most(&found, LEVEL), "{} of {}", rejected(&found), found.len());
}

#[ignore = "takes minutes"]
#[test]
fn two_thousand_runs() {
    assert_calibrated(&runs(500, |u| u));
}
