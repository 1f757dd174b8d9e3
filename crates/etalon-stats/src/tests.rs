//! The harness on samplers that are right, and on the same with one thing wrong.

use super::*;
use crate::hash::{mix64, unit_f64};
use crate::stream::CounterRng;
use crate::testing::{Vector, beckmann, beckmann_pdf, uniform_hemisphere};
use rand::RngExt;
use std::f64::consts::{PI, TAU};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

fn protocol() -> Protocol {
    Protocol::default()
}

/// A lobe around +z of width `alpha`, and its pdf.
fn lobe(alpha: f64) -> impl Sampler<Vector> {
    sampler(2, move |u| Some(Sample::new(beckmann(alpha, u))))
}

fn lobe_pdf(alpha: f64) -> impl Fn(Vector) -> f64 {
    move |w| beckmann_pdf(alpha, w)
}

#[test]
fn right_samplers_are_accepted() -> Result<()> {
    let sphere = Directions::sphere(Pole::Z);
    for alpha in [1e-4, 0.01, 0.3, 1.0] {
        let outcome = validate(&sphere, &lobe(alpha), &density(lobe_pdf(alpha)), &protocol())?;
        assert!(outcome.is_accepted(), "{alpha}: {outcome}");
        assert!((outcome.mass.unwrap().value - 1.0).abs() < 2e-5, "{outcome:?}");
        assert!(outcome.dof > 150 && outcome.detectable.unwrap() < 0.0202, "{outcome}");
    }
    let triangular = sampler(1, |u: &[f64]| Some(Sample::with_pdf(u[0].sqrt(), 2.0 * u[0].sqrt())));
    let triangular = triangular.with_inverse(|x: f64| vec![x * x]);
    let outcome = validate(&Line::UNIT, &triangular, &density(|x: f64| 2.0 * x), &protocol())?;
    assert!(outcome.is_accepted(), "{outcome}");
    Ok(())
}

#[test]
fn small_mistakes_are_rejected() -> Result<()> {
    let sphere = Directions::sphere(Pole::Z);
    for alpha in [1e-4, 0.3] {
        // A lobe 3 % wider than the density says.
        let pdf = lobe_pdf(alpha);
        let outcome = validate(&sphere, &lobe(1.03 * alpha), &density(&pdf), &protocol())?;
        assert_eq!((outcome.verdict, outcome.violation.is_none()), (Verdict::Reject, true), "{outcome}");
        assert!(outcome.repeated);
        // A density 0.3 % too large fails the exact check, whatever the counts say.
        let outcome = validate(&sphere, &lobe(alpha), &density(|w| 1.003 * pdf(w)), &protocol())?;
        assert!(outcome.verdict == Verdict::Reject && outcome.violation.is_some(), "{outcome}");
    }
    Ok(())
}

#[test]
fn broken_contracts_are_rejected_and_named() -> Result<()> {
    let half = Directions::hemisphere(Pole::Z);
    let uniform = density(|_: Vector| 1.0 / TAU);
    let violation = |draw: &(dyn Fn(&[f64]) -> Option<Sample<Vector>> + Sync)| -> Result<String> {
        let outcome = validate(&half, &sampler(2, draw), &uniform, &protocol())?;
        assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
        Ok(outcome.violation.unwrap_or_default())
    };
    let good = |u: &[f64]| uniform_hemisphere(u);
    let other_pdf = 0.5f64.mul_add(1.0 / PI, 1e-17).next_up();
    assert!(violation(&|u| Some(Sample::with_pdf(good(u), other_pdf)))?.contains("carries"));
    assert!(
        violation(&|u| Some(Sample::new(if u[0] < 1e-4 { good(u).map(|x| -x) } else { good(u) })))?.contains("outside")
    );
    assert!(
        violation(&|u| Some(Sample::new(good(u).map(|x| x / if u[0] == 0.0 { 0.0 } else { 1.0 }))))?
            .contains("outside")
    );
    assert!(violation(&|u| Some(Sample::atom(good(u))))?.contains("atoms"));
    let backwards = sampler(2, |u: &[f64]| Some(Sample::new(good(u))));
    let backwards = backwards.with_inverse(|w: Vector| vec![w[2], 0.0]);
    assert!(validate(&half, &backwards, &uniform, &protocol())?.violation.unwrap().contains("inverse"));
    let nan = density(|w: Vector| if w[2] > 0.999 { f64::NAN } else { 1.0 / TAU });
    let outcome = validate(&half, &sampler(2, |u: &[f64]| Some(Sample::new(good(u)))), &nan, &protocol())?;
    assert!(outcome.verdict == Verdict::Reject && outcome.violation.is_some());
    Ok(())
}

#[test]
fn atoms_and_no_sample_are_counted() -> Result<()> {
    let half = Directions::hemisphere(Pole::Z);
    let up = [0.0, 0.0, 1.0];
    // One in five at the pole, one in ten nothing, the rest uniform.
    let mixed = |at_pole: f64| {
        sampler(3, move |u: &[f64]| match u[2] {
            c if c < at_pole => Some(Sample::atom(up)),
            c if c < at_pole + 0.1 => None,
            _ => Some(Sample::new(uniform_hemisphere(u))),
        })
    };
    let claim = |mass| {
        let spread = density(move |_: Vector| 0.7 / TAU).with_mass(mass);
        spread.with_atoms(vec![Atom { point: up, probability: 0.2 }])
    };
    for mass in [Mass::Exactly(0.9), Mass::AtMostOne] {
        let outcome = validate(&half, &mixed(0.2), &claim(mass), &protocol())?;
        assert!(outcome.is_accepted() && (outcome.mass.unwrap().value - 0.9).abs() < 1e-9, "{outcome}");
        assert_eq!(validate(&half, &mixed(0.21), &claim(mass), &protocol())?.verdict, Verdict::Reject);
    }
    assert!(validate(&half, &mixed(0.2), &claim(Mass::Exactly(1.0)), &protocol())?.violation.is_some());
    // A sampler that should always draw and once in 2¹² does not.
    let lazy = sampler(2, |u: &[f64]| (u[0] > 2.5e-4).then(|| Sample::new(uniform_hemisphere(u))));
    assert_eq!(validate(&half, &lazy, &density(|_| 1.0 / TAU), &protocol())?.verdict, Verdict::Reject);
    Ok(())
}

#[test]
fn finite_sets() -> Result<()> {
    let fair = Discrete { outcomes: 37 };
    let wheel = sampler(1, |u: &[f64]| Some(Sample::new((u[0] * 37.0) as usize)));
    let uniform = density(|_: usize| 1.0 / 37.0);
    let outcome = validate(&fair, &wheel, &uniform, &protocol())?;
    assert!(outcome.is_accepted() && outcome.dof == 36, "{outcome}");
    let biased = sampler(1, |u: &[f64]| Some(Sample::new((u[0].powf(1.03) * 37.0) as usize)));
    assert_eq!(validate(&fair, &biased, &uniform, &protocol())?.verdict, Verdict::Reject);
    Ok(())
}

#[test]
fn too_few_samples_never_pass() -> Result<()> {
    let line = density(|_: f64| 1.0);
    let uniform = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    for n in [1, 4, 100, 1000] {
        let outcome =
            validate(&Line::UNIT, &uniform, &line, &Protocol { samples: SampleCount::Fixed(n), ..protocol() })?;
        assert_eq!(outcome.verdict, Verdict::Inconclusive, "{n}: {outcome}");
    }
    // But few samples may be enough to reject.
    let few = Protocol { samples: SampleCount::Fixed(1000), ..protocol() };
    let wrong = sampler(1, |u: &[f64]| Some(Sample::new(u[0].powi(3))));
    assert_eq!(validate(&Line::UNIT, &wrong, &line, &few)?.verdict, Verdict::Reject);
    Ok(())
}

#[test]
fn an_integral_that_stays_uncertain_is_not_a_pass() -> Result<()> {
    // Noise instead of a density: its mean is 1, but no rule will agree with another.
    let noise = density(|[x, y]: [f64; 2]| {
        let bits = (x.to_bits() ^ y.to_bits().rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11;
        2.0 * bits as f64 / (1u64 << 53) as f64
    });
    let uniform = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1]])));
    let few = Protocol { samples: SampleCount::Fixed(1 << 24), ..protocol() };
    let outcome = examine(&Square, &uniform, &noise, &few, 0)?;
    assert!(outcome.p.is_none() && outcome.inconclusive_reason.is_some(), "{outcome}");
    Ok(())
}

#[test]
fn p_values_of_right_samplers_are_uniform() -> Result<()> {
    let density = density(lobe_pdf(0.01));
    let p: Vec<f64> = (0..100)
        .filter_map(|seed| {
            let few = Protocol { seed, samples: SampleCount::Fixed(20_000), cells: 50, ..protocol() };
            examine(&Directions::hemisphere(Pole::Z), &lobe(0.01), &density, &few, 0).ok()?.p
        })
        .collect();
    let found = kolmogorov::uniformity(&p);
    assert!(p.len() == 100 && found.p > 1e-3, "{found:?}");
    Ok(())
}

#[test]
fn impossible_protocols_are_refused() {
    let uniform = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    for bad in [
        Protocol { level: 0.0, ..protocol() },
        Protocol { level: f64::NAN, ..protocol() },
        Protocol { cells: 1, ..protocol() },
        Protocol { samples: SampleCount::Fixed(0), ..protocol() },
        Protocol { samples: SampleCount::Detect(f64::NAN), ..protocol() },
        Protocol { samples: SampleCount::Detect(1e-9), ..protocol() },
    ] {
        assert!(validate(&Line::UNIT, &uniform, &density(|_| 1.0), &bad).is_err(), "{bad:?}");
    }
}

/// Samples that are used up: uniform numbers to the power of `power`, `count` of them, each handed out once.
struct Stock {
    next: AtomicU64,
    count: u64,
    power: i32,
}

impl Sampler<f64> for Stock {
    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample<f64>>>) -> Result<()> {
        for _ in u {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            assert!(i < self.count, "more samples are asked for than there are");
            let bits = mix64(i) >> 11;
            out.push(Some(Sample::new((bits as f64 / (1u64 << 53) as f64).powi(self.power))));
        }
        Ok(())
    }

    fn finite_len(&self) -> Option<u64> {
        Some(self.count - self.next.load(Ordering::Relaxed))
    }
}

#[test]
fn samples_that_are_used_up_are_used_once() -> Result<()> {
    for (count, power, verdict) in [
        (100_000, 1, Verdict::Accept),
        (100_000, 2, Verdict::Reject),
        (300, 1, Verdict::Inconclusive),
        (3, 1, Verdict::Inconclusive),
        (0, 1, Verdict::Inconclusive),
    ] {
        let stock = Stock { next: AtomicU64::new(0), count, power };
        let outcome = validate(&Line::UNIT, &stock, &density(|_: f64| 1.0), &protocol())?;
        assert_eq!((outcome.verdict, outcome.repeated), (verdict, false), "{count} {power}: {outcome}");
        assert_eq!(stock.finite_len(), Some(0));
    }
    Ok(())
}

#[test]
fn deterministic_samplers_are_tested_exactly() -> Result<()> {
    let half = Directions::hemisphere(Pole::Z);
    let mirror = density(|_: Vector| 0.0).with_atoms(vec![Atom { point: [0.0, 0.0, 1.0], probability: 1.0 }]);
    let outcome = validate(&half, &sampler(1, |_: &[f64]| Some(Sample::atom([0.0, 0.0, 1.0]))), &mirror, &protocol())?;
    assert!(outcome.is_accepted() && outcome.continuous_p().is_none(), "{outcome}");
    let lazy = sampler(1, |u: &[f64]| (u[0] > 1e-3).then(|| Sample::atom([0.0, 0.0, 1.0])));
    assert_eq!(validate(&half, &lazy, &mirror, &protocol())?.verdict, Verdict::Reject);
    let dark = density(|_: Vector| 0.0).with_mass(Mass::Exactly(0.0));
    assert!(validate(&half, &sampler(1, |_: &[f64]| None), &dark, &protocol())?.is_accepted());
    let leaking = sampler(1, |u: &[f64]| (u[0] < 1e-3).then(|| Sample::new([0.0, 0.0, 1.0])));
    assert_eq!(validate(&half, &leaking, &dark, &protocol())?.verdict, Verdict::Reject);
    Ok(())
}

#[test]
fn a_density_that_changes_when_asked_again_is_rejected() -> Result<()> {
    let uniform = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1]])));
    let asked = AtomicU64::new(0);
    // Its mean is 1 everywhere, so that no integral would tell.
    let noise = density(|_: [f64; 2]| {
        let bits = mix64(asked.fetch_add(1, Ordering::Relaxed));
        2.0 * unit_f64(bits)
    });
    let outcome = validate(&Square, &uniform, &noise, &protocol())?;
    assert_eq!((outcome.verdict, outcome.repeated), (Verdict::Reject, false), "{outcome}");
    assert!(outcome.violation.unwrap().contains("not the same when asked again"));
    Ok(())
}

/// Uniform numbers of its own; keeps the seeds.
#[derive(Default)]
struct Seeded(Mutex<Vec<u32>>);

impl Sampler<f64> for Seeded {
    fn dimension(&self) -> usize {
        0
    }

    fn sample(&self, _: &[f64], _: &mut Vec<Option<Sample<f64>>>) -> Result<()> {
        panic!("it takes no random numbers")
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample<f64>>>) -> Result<()> {
        self.0.lock().unwrap().push(seed);
        let mut rng = CounterRng::new(u64::from(seed), 0);
        out.extend((0..count).map(|_| Some(Sample::new(rng.random::<f64>()))));
        Ok(())
    }
}

#[test]
fn samplers_with_their_own_generator_get_a_seed_for_each_batch() -> Result<()> {
    let run = |seed| -> Result<(Outcome, Vec<u32>)> {
        let sampler = Seeded::default();
        let many = Protocol { seed, samples: SampleCount::Fixed(3_000_000), ..protocol() };
        let outcome = validate(&Line::UNIT, &sampler, &density(|_: f64| 1.0), &many)?;
        let mut seeds = sampler.0.into_inner().unwrap();
        seeds.sort_unstable();
        Ok((outcome, seeds))
    };
    let (outcome, seeds) = run(1)?;
    assert!(outcome.is_accepted() && seeds.len() > 300, "{outcome}");
    let mut distinct = seeds.clone();
    distinct.dedup();
    assert_eq!(distinct, seeds);
    assert_eq!(run(1)?.0.statistic, outcome.statistic);
    assert_ne!(run(2)?.0.statistic, outcome.statistic);
    Ok(())
}

#[test]
fn a_sampler_without_random_numbers_must_implement_sample_seeded() {
    let constant = sampler(0, |_: &[f64]| Some(Sample::new(0.5)));
    assert!(validate(&Line::UNIT, &constant, &density(|_: f64| 1.0), &protocol()).is_err());
}

#[test]
fn a_cancelled_test_is_an_error() {
    let uniform = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    let stop = Protocol { cancelled: || true, ..protocol() };
    let outcome = validate(&Line::UNIT, &uniform, &density(|_: f64| 1.0), &stop);
    assert!(matches!(outcome, Err(Error::Cancelled)), "{outcome:?}");
}

/// A pdf that another process would compute, if it were there.
struct Unreachable;

impl Density<f64> for Unreachable {
    fn pdf(&self, _: &[f64], _: &mut Vec<f64>) -> Result<()> {
        Err(Error::external("no answer"))
    }
}

#[test]
fn errors_of_external_samplers_and_pdfs_are_returned() {
    let uniform = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    let error = validate(&Line::UNIT, &uniform, &Unreachable, &protocol()).unwrap_err();
    assert_eq!(error.to_string(), "no answer");
    let impossible = Protocol { level: 2.0, ..protocol() };
    let error = validate(&Line::UNIT, &uniform, &Unreachable, &impossible).unwrap_err();
    assert_eq!(error.to_string(), "level: level 2 (use a probability such as 0.01)");
}
