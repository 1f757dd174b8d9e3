//! The level of the suite: the p-values of right samplers under many seeds are no smaller than uniform ones.

use super::{Case, select, suite};
use etalon_stats::multiple::{sidak, uniformity};
use etalon_stats::{Line, Outcome, Protocol, Sample, SampleCount, density, sampler};
use rayon::prelude::*;

/// Probability that any of a test's right samplers are called too small.
const LEVEL: f64 = 0.01;

/// Few samples and cells, so that many seeds are quick, but hundreds of samples in a cell.
const SAMPLES: u64 = 20_000;
const CELLS: usize = 50;

/// The p-values of the first round of a case under seeds from 1 on.
fn p_values(case: &Case, seeds: u64) -> Vec<f64> {
    let protocol = Protocol { samples: SampleCount::Fixed(SAMPLES), cells: CELLS, ..Protocol::default() };
    case.prepare();
    let at = |seed| case.examine(&Protocol { seed, ..protocol }, 0).unwrap();
    let of = |outcome: Outcome| {
        assert!(outcome.violation.is_none(), "{}: {outcome}", case.name);
        outcome.continuous_p()
    };
    (1..=seeds).into_par_iter().map(at).collect::<Vec<_>>().into_iter().filter_map(of).collect()
}

/// Asserts that the p-values of all `cases` together, and of each, are no smaller than uniform ones (Smirnov's one-sided
/// test), and prints how many are below usual levels.
fn assert_level(cases: &[Case], seeds: u64) {
    let of_each: Vec<Vec<f64>> = cases.iter().map(|case| p_values(case, seeds)).collect();
    let all: Vec<f64> = of_each.iter().flatten().copied().collect();
    let below = |level: f64| 100.0 * all.iter().filter(|p| **p < level).count() as f64 / all.len() as f64;
    let together = uniformity(&all).p_too_small;
    println!(
        "{} cases, {seeds} seeds: {:.2} % of p-values below 1 %, {:.2} % below 5 %; too small: p = {together:.2}",
        cases.len(),
        below(0.01),
        below(0.05)
    );
    assert!(together > 0.5 * LEVEL, "all together: {together}");
    for (case, p) in cases.iter().zip(&of_each).filter(|(_, p)| !p.is_empty()) {
        let own = uniformity(p).p_too_small;
        assert!(own > sidak(0.5 * LEVEL, cases.len()), "{}: {own}", case.name);
    }
}

#[test]
fn p_values_of_right_warps_are_not_too_small_and_those_of_wrong_ones_are() {
    assert_level(&select(suite::cases(), &["warp".to_owned()]).unwrap(), 20);
    // An error of 2 %, which a single run would accept most of the time
    let skewed = Case::of("skewed", Line::UNIT, || {
        (sampler(1, |u: &[f64]| Some(Sample::new(u[0].powf(1.02)))), density(|_: f64| 1.0))
    });
    assert!(uniformity(&p_values(&skewed, 40)).p_too_small < 1e-3);
}

/// Few samples in each of many outcomes: p-values are bounds, larger than uniform ones.
#[test]
fn bounds_of_p_values_are_not_too_small() {
    let bounds = select(suite::cases(), &["table/cdf/even/65535".to_owned()]).unwrap();
    let found = uniformity(&p_values(&bounds[0], 300));
    assert!(found.p < 1e-3 && found.p_too_small > LEVEL, "{found:?}");
}

#[test]
#[ignore = "takes a minute: cargo test --release --lib p_values_of_the_suite -- --ignored --nocapture"]
fn p_values_of_the_suite_are_not_too_small() {
    let mut cases = suite::cases();
    cases.retain(|case| !case.is_large() && !case.name.starts_with("render/"));
    assert_level(&cases, 40);
}
