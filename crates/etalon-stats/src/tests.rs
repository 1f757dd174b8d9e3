//! The harness on samplers that are right, and on the same with one thing wrong.

use super::*;
use crate::hash::{mix64, unit_f64};
use crate::stream::CounterRng;
use crate::testing::{Vector, beckmann, beckmann_pdf, uniform_hemisphere};
use rand::RngExt;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The outcome of a test by the default protocol.
fn tested(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> Outcome {
    validate(domain, sampler, density, &Protocol::default()).unwrap()
}

/// A lobe around +z of width `alpha`, and its pdf.
fn lobe(alpha: f64) -> impl Sampler {
    sampler(2, move |u| Some(Sample::new(beckmann(alpha, u))))
}

fn lobe_pdf(alpha: f64) -> impl Fn(Vector) -> f64 {
    move |w| beckmann_pdf(alpha, w)
}

#[test]
fn right_samplers_are_accepted() {
    let sphere = Directions::sphere(Pole::Z);
    for alpha in [1e-4, 0.01, 0.3, 1.0] {
        let outcome = tested(&sphere, &lobe(alpha), &density(lobe_pdf(alpha)));
        assert!(outcome.is_accepted(), "{alpha}: {outcome}");
        assert!((outcome.mass.unwrap().value - 1.0).abs() < 2e-5, "{outcome:?}");
        assert!(outcome.dof > 150 && outcome.detectable.unwrap() < 0.0202, "{outcome}");
    }
    let triangular = sampler(1, |u: &[f64]| Some(Sample::with_pdf(u[0].sqrt(), 2.0 * u[0].sqrt())));
    let triangular = triangular.with_inverse(|x: f64| vec![x * x]);
    let outcome = tested(&Line::UNIT, &triangular, &density(|x: f64| 2.0 * x));
    assert!(outcome.is_accepted(), "{outcome}");
}

#[test]
fn small_mistakes_are_rejected() {
    let sphere = Directions::sphere(Pole::Z);
    for alpha in [1e-4, 0.3] {
        // A lobe 3 % wider than the density says.
        let pdf = lobe_pdf(alpha);
        let outcome = tested(&sphere, &lobe(1.03 * alpha), &density(&pdf));
        assert_eq!((outcome.verdict, outcome.violation.is_none()), (Verdict::Reject, true), "{outcome}");
        assert!(outcome.samples < 100_000, "such an error needs a part of the samples: {outcome}");
        // A density 0.3 % too large fails the exact check, whatever the counts say.
        let outcome = tested(&sphere, &lobe(alpha), &density(|w| 1.003 * pdf(w)));
        assert!(outcome.verdict == Verdict::Reject && outcome.violation.is_some(), "{outcome}");
    }
}

#[test]
fn of_an_unknown_mass_the_shape_is_tested() {
    let sphere = Directions::sphere(Pole::Z);
    for factor in [1e-6, 1.0, 1e6] {
        // A lobe, a tenth of whose samples is missing.
        let some = sampler(3, |u: &[f64]| (u[2] < 0.9).then(|| Sample::new(beckmann(0.3, u))));
        let pdf = lobe_pdf(0.3);
        let of = |pdf: f64| density(move |w| factor * lobe_pdf(pdf)(w)).with_mass(Mass::Unknown);
        let outcome = tested(&sphere, &some, &of(0.3));
        assert!(outcome.is_accepted() && outcome.remarks.iter().any(|r| r.contains("only the shape")), "{outcome}");
        assert!((outcome.mass.unwrap().value / factor - 1.0).abs() < 1e-4 && outcome.none > 0, "{outcome:?}");
        assert_eq!(tested(&sphere, &some, &of(0.29)).verdict, Verdict::Reject);
        let stairs =
            density(move |x: f64| factor * if x < 0.3 { 2.0 } else { 4.0 / 7.0 }).with_steps([vec![0.3], vec![]]);
        let draw = |u: &[f64]| Some(Sample::new(if u[0] < 0.6 { u[0] / 2.0 } else { 0.3 + (u[0] - 0.6) * 1.75 }));
        let outcome = tested(&Line::UNIT, &sampler(1, draw), &stairs.with_mass(Mass::Unknown));
        assert!(outcome.is_accepted(), "{outcome}");
        assert!(tested(&sphere, &some, &density(move |w| factor * pdf(w))).verdict == Verdict::Reject);
    }
}

#[test]
fn outcomes_that_never_occur_are_found_by_equal_samples() {
    for (outcomes, skewed) in [(1 << 16, false), (1 << 20, false), (1 << 18, true)] {
        let of = |u: f64| if skewed { (u * u * outcomes as f64) as usize } else { (u * outcomes as f64) as usize };
        let pdf = move |i: usize| {
            let root = |i: usize| (i as f64 / outcomes as f64).sqrt();
            if skewed { root(i + 1) - root(i) } else { 1.0 / outcomes as f64 }
        };
        let right = sampler(1, move |u: &[f64]| Some(Sample::new(of(u[0]))));
        let outcome = tested(&Discrete { outcomes }, &right, &density(pdf));
        assert!(outcome.is_accepted(), "{outcomes}: {outcome}");
        let even = sampler(1, move |u: &[f64]| Some(Sample::new(of(u[0]) / 2 * 2)));
        let outcome = tested(&Discrete { outcomes }, &even, &density(pdf));
        assert_eq!(outcome.verdict, Verdict::Reject, "{outcomes}: {outcome}");
        assert!(outcome.violation.is_some_and(|violation| violation.contains("pairs of equal samples")), "{outcomes}");
    }
}

#[test]
fn equal_samples_of_a_set_that_is_rarely_sampled_are_no_fault() {
    let outcomes = 1 << 14;
    let half = sampler(2, move |u: &[f64]| (u[1] < 0.5).then(|| Sample::new((u[0] * outcomes as f64) as usize)));
    for (mass, pdf) in [(Mass::Exactly(0.5), 0.5), (Mass::AtMostOne, 0.5), (Mass::Unknown, 7.0), (Mass::Unknown, 1e-3)]
    {
        let pdf = density(move |_: usize| pdf / outcomes as f64).with_mass(mass);
        let outcome = tested(&Discrete { outcomes }, &half, &pdf);
        assert!(outcome.is_accepted(), "{mass:?}: {outcome}");
    }
}

#[test]
fn nan_of_samples_and_densities_is_a_finding() {
    let identity = |u: &[f64]| Some(Sample::new(if u[0] > 0.999 { f64::NAN } else { u[0] }));
    let outcome = tested(&Line::UNIT, &sampler(1, identity), &density(|_: f64| 1.0));
    assert!(outcome.verdict == Verdict::Reject && outcome.to_string().contains("NaN"), "{outcome}");
    assert!(outcome.violation.unwrap().contains("sampled from u = (0.999"));
    let right = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    for wrong in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        let outcome = tested(&Line::UNIT, &right, &density(|x: f64| if x > 0.999 { wrong } else { 1.0 }));
        assert!(outcome.verdict == Verdict::Reject && outcome.violation.is_some(), "{wrong}: {outcome}");
    }
    let carries = sampler(1, |u: &[f64]| Some(Sample::with_pdf(u[0], if u[0] > 0.999 { f64::NAN } else { 1.0 })));
    let outcome = tested(&Line::UNIT, &carries, &density(|_: f64| 1.0));
    assert!(outcome.verdict == Verdict::Reject && outcome.to_string().contains("NaN"), "{outcome}");
}

#[test]
fn a_density_may_be_infinite_at_single_points() {
    use std::f64::consts::{FRAC_PI_2, PI};
    let has_remark = |outcome: &Outcome| outcome.remarks.iter().any(|remark| remark.contains("infinite at the point"));
    // The arcsine distribution, infinite at both ends, which u = 0 and u = 1 return.
    let arcsine = sampler(1, |u: &[f64]| Some(Sample::new((FRAC_PI_2 * u[0]).sin().powi(2))));
    let outcome = tested(&Line::UNIT, &arcsine, &density(|x: f64| 1.0 / (PI * (x * (1.0 - x)).sqrt())));
    assert!(outcome.is_accepted() && has_remark(&outcome), "{outcome}");
    // Infinite in the middle, where a node of the cubature is, and in single precision.
    let middle = sampler(1, |u: &[f64]| {
        let v = 2.0 * u[0] - 1.0;
        Some(Sample::new(f64::from((v * v).copysign(v) as f32)))
    });
    let pdf = |x: f64| 0.25 / x.abs().sqrt();
    let outcome = tested(&Line { from: -1.0, to: 1.0 }, &middle, &density(pdf));
    assert!(outcome.is_accepted() && has_remark(&outcome), "{outcome}");
    // Along lines and at points of a plane: 1/sin θ on the sphere.
    let poles = sampler(2, |u: &[f64]| {
        let ((sin, cos), (sin_phi, cos_phi)) = ((PI * u[0]).sin_cos(), (TAU * u[1]).sin_cos());
        Some(Sample::new([sin * cos_phi, sin * sin_phi, cos]))
    });
    let pdf = |w: Vector| 1.0 / (2.0 * PI * PI * w[0].hypot(w[1]));
    let outcome = tested(&Directions::sphere(Pole::Z), &poles, &density(pdf));
    assert!(outcome.is_accepted(), "{outcome}");
    // What is infinite on a set that samples meet, or integrates to another value, is no pdf.
    let uniform = sampler(1, |u: &[f64]| Some(Sample::new(u[0])));
    let outcome = tested(&Line::UNIT, &uniform, &density(|x: f64| if x < 0.01 { f64::INFINITY } else { 1.0 }));
    assert!(outcome.verdict == Verdict::Reject && outcome.to_string().contains("inf"), "{outcome}");
    let outcome = tested(&Line::UNIT, &arcsine, &density(|x: f64| 0.5 / x.sqrt()));
    assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
    let outcome = tested(&Line::UNIT, &arcsine, &density(|x: f64| 1.1 / (PI * (x * (1.0 - x)).sqrt())));
    assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
}

#[test]
fn samples_beyond_the_chart_are_inconclusive_and_infinite_ones_named() {
    use std::f64::consts::PI;
    let cauchy = |u: f64| (PI * (u - 0.5)).tan();
    let logarithmic = sampler(1, move |u: &[f64]| Some(Sample::new(cauchy(u[0]).exp())));
    let pdf = density(|x: f64| 1.0 / (PI * x * (1.0 + x.ln().powi(2))));
    let outcome = tested(&HalfLine::POSITIVE, &logarithmic, &pdf);
    assert_eq!(outcome.verdict, Verdict::Inconclusive, "{outcome}");
    assert!(outcome.to_string().contains("beyond 10⁶⁰"), "{outcome}");
    // Where the pdf is 0, no sample may be, however far away.
    let far = |u: &[f64]| Some(Sample::new(if u[1] < 1e-3 { 1e100 } else { -(1.0 - u[0]).ln() }));
    let outcome = tested(&HalfLine::POSITIVE, &sampler(2, far), &density(|x: f64| (-x).exp()));
    assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
    let pdf = density(|x: f64| 1.0 / (PI * (1.0 + x * x)));
    for (share, is_named) in [(0.0, false), (1e-3, true)] {
        let infinite =
            move |u: &[f64]| Some(Sample::new(if u[1] < share || u[0] == 0.0 { f64::INFINITY } else { cauchy(u[0]) }));
        let outcome = tested(&RealLine::UNIT, &sampler(2, infinite), &pdf);
        assert_eq!(outcome.is_accepted(), !is_named, "{outcome}");
        assert_eq!(outcome.violation.is_some_and(|violation| violation.contains("at infinity")), is_named);
    }
}

#[test]
fn broken_contracts_are_rejected_and_named() {
    type Draw = Box<dyn Fn(&[f64]) -> Option<Sample> + Sync>;
    let half = Directions::hemisphere(Pole::Z);
    let good = uniform_hemisphere;
    let broken: [(&str, Draw); 4] = [
        ("carries", Box::new(move |u| Some(Sample::with_pdf(good(u), (1.0 / TAU).next_up())))),
        ("outside", Box::new(move |u| Some(Sample::new(good(u).map(|x| if u[0] < 1e-4 { -x } else { x }))))),
        ("outside", Box::new(move |u| Some(Sample::new(good(u).map(|x| if u[0] == 0.0 { x / 0.0 } else { x }))))),
        ("atoms", Box::new(move |u| Some(Sample::atom(good(u))))),
    ];
    let rejected = |named: &str, sampler: &dyn Sampler, pdf: &dyn Density| {
        let outcome = tested(&half, sampler, pdf);
        assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
        assert!(outcome.violation.as_ref().is_some_and(|violation| violation.contains(named)), "{named}: {outcome}");
    };
    let uniform = density(|_: Vector| 1.0 / TAU);
    for (named, draw) in broken {
        rejected(named, &sampler(2, draw), &uniform);
    }
    let right = || sampler(2, move |u: &[f64]| Some(Sample::new(good(u))));
    rejected("inverse", &right().with_inverse(|w: Vector| vec![w[2], 0.0]), &uniform);
    rejected("NaN", &right(), &density(|w: Vector| if w[2] > 0.999 { f64::NAN } else { 1.0 / TAU }));
}

#[test]
fn atoms_and_no_sample_are_counted() {
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
        spread.with_atoms(vec![Atom::new(up, 0.2)])
    };
    for mass in [Mass::Exactly(0.9), Mass::AtMostOne] {
        let outcome = tested(&half, &mixed(0.2), &claim(mass));
        assert!(outcome.is_accepted() && (outcome.mass.unwrap().value - 0.9).abs() < 1e-9, "{outcome}");
        assert_eq!(tested(&half, &mixed(0.21), &claim(mass)).verdict, Verdict::Reject);
    }
    assert!(tested(&half, &mixed(0.2), &claim(Mass::Exactly(1.0))).violation.is_some());
    // A sampler that should always draw and once in 2¹² does not.
    let lazy = sampler(2, |u: &[f64]| (u[0] > 2.5e-4).then(|| Sample::new(uniform_hemisphere(u))));
    assert_eq!(tested(&half, &lazy, &density(|_: Point| 1.0 / TAU)).verdict, Verdict::Reject);
}

#[test]
fn finite_sets() {
    let fair = Discrete { outcomes: 37 };
    let wheel = sampler(1, |u: &[f64]| Some(Sample::new((u[0] * 37.0) as usize)));
    let uniform = density(|_: usize| 1.0 / 37.0);
    let outcome = tested(&fair, &wheel, &uniform);
    assert!(outcome.is_accepted() && outcome.dof == 36, "{outcome}");
    let biased = sampler(1, |u: &[f64]| Some(Sample::new((u[0].powf(1.03) * 37.0) as usize)));
    assert_eq!(tested(&fair, &biased, &uniform).verdict, Verdict::Reject);
}

#[test]
fn too_few_samples_never_pass() {
    let verdict = |power: i32, n: u64| {
        let few = Protocol { samples: SampleCount::Fixed(n), ..Protocol::default() };
        let drawn = sampler(1, |u: &[f64]| Some(Sample::new(u[0].powi(power))));
        validate(&Line::UNIT, &drawn, &density(|_: f64| 1.0), &few).unwrap().verdict
    };
    for n in [1, 4, 100, 1000] {
        assert_eq!(verdict(1, n), Verdict::Inconclusive, "{n}");
    }
    assert_eq!(verdict(3, 1000), Verdict::Reject, "few samples may be enough to reject");
}

#[test]
fn an_integral_that_stays_uncertain_is_not_a_pass() {
    // Noise instead of a density: its mean is 1, but no rule will agree with another.
    let noise = density(|[x, y]: [f64; 2]| {
        2.0 * unit_f64((x.to_bits() ^ y.to_bits().rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    });
    let uniform = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1]])));
    let few = Protocol { samples: SampleCount::Fixed(1 << 20), ..Protocol::default() };
    let outcome = examine(&Square, &uniform, &noise, &few, 0).unwrap();
    assert!(outcome.p.is_none() && outcome.inconclusive_reason.is_some(), "{outcome}");
}

#[test]
fn p_values_of_right_samplers_are_uniform() {
    let (half, density) = (Directions::hemisphere(Pole::Z), density(lobe_pdf(0.01)));
    let p_of = |seed| {
        let few = Protocol { seed, samples: SampleCount::Fixed(20_000), cells: 50, ..Protocol::default() };
        examine(&half, &lobe(0.01), &density, &few, 0).unwrap().p.unwrap()
    };
    let found = multiple::uniformity(&(0..100).map(p_of).collect::<Vec<_>>());
    assert!(found.p > 1e-3, "{found:?}");
}

/// Samples that are used up: uniform numbers to the power of `power`, `count` of them, each handed out once.
struct Stock {
    next: AtomicU64,
    count: u64,
    power: i32,
}

impl Sampler for Stock {
    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        for _ in u {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            assert!(i < self.count, "more samples are asked for than there are");
            out.push(Some(Sample::new(unit_f64(mix64(i)).powi(self.power))));
        }
        Ok(())
    }

    fn finite_len(&self) -> Option<u64> {
        Some(self.count - self.next.load(Ordering::Relaxed))
    }
}

#[test]
fn samples_that_are_used_up_are_used_once() {
    for (count, power, verdict) in [
        (100_000, 1, Verdict::Accept),
        (100_000, 2, Verdict::Reject),
        (300, 1, Verdict::Inconclusive),
        (3, 1, Verdict::Inconclusive),
        (0, 1, Verdict::Inconclusive),
    ] {
        let stock = Stock { next: AtomicU64::new(0), count, power };
        let outcome = tested(&Line::UNIT, &stock, &density(|_: f64| 1.0));
        assert_eq!((outcome.verdict, outcome.repeated), (verdict, false), "{count} {power}: {outcome}");
        assert_eq!(stock.finite_len(), Some(0));
    }
}

#[test]
fn a_pdf_whose_integral_overflows_is_rejected() {
    let huge = density(|_: Vector| 1e308);
    let outcome = tested(
        &Directions::hemisphere(Pole::Z),
        &sampler(2, |u: &[f64]| Some(Sample::new(uniform_hemisphere(u)))),
        &huge,
    );
    assert!(outcome.verdict == Verdict::Reject && outcome.mass.is_none(), "{outcome}");
}

#[test]
fn deterministic_samplers_are_tested_exactly() {
    let half = Directions::hemisphere(Pole::Z);
    let mirror = density(|_: Vector| 0.0).with_atoms(vec![Atom::new([0.0, 0.0, 1.0], 1.0)]);
    let outcome = tested(&half, &sampler(1, |_: &[f64]| Some(Sample::atom([0.0, 0.0, 1.0]))), &mirror);
    assert!(outcome.is_accepted() && outcome.continuous_p().is_none(), "{outcome}");
    let lazy = sampler(1, |u: &[f64]| (u[0] > 1e-3).then(|| Sample::atom([0.0, 0.0, 1.0])));
    assert_eq!(tested(&half, &lazy, &mirror).verdict, Verdict::Reject);
    let dark = density(|_: Vector| 0.0).with_mass(Mass::Exactly(0.0));
    assert!(tested(&half, &sampler(1, |_: &[f64]| None), &dark).is_accepted());
    let leaking = sampler(1, |u: &[f64]| (u[0] < 1e-3).then(|| Sample::new([0.0, 0.0, 1.0])));
    assert_eq!(tested(&half, &leaking, &dark).verdict, Verdict::Reject);
}

#[test]
fn a_density_that_changes_when_asked_again_is_rejected() {
    let uniform = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1]])));
    let asked = AtomicU64::new(0);
    // Its mean is 1 everywhere, so that no integral would tell.
    let noise = density(|_: [f64; 2]| 2.0 * unit_f64(mix64(asked.fetch_add(1, Ordering::Relaxed))));
    let outcome = tested(&Square, &uniform, &noise);
    assert_eq!((outcome.verdict, outcome.repeated), (Verdict::Reject, false), "{outcome}");
    assert!(outcome.violation.unwrap().contains("not the same when asked again"));
}

/// Uniform numbers of its own; keeps the seeds.
#[derive(Default)]
struct Seeded(Mutex<Vec<u32>>);

impl Sampler for Seeded {
    fn dimension(&self) -> usize {
        0
    }

    fn sample(&self, _: &[f64], _: &mut Vec<Option<Sample>>) -> Result<()> {
        panic!("it takes no random numbers")
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> Result<()> {
        self.0.lock().unwrap().push(seed);
        let mut rng = CounterRng::new(u64::from(seed), 0);
        out.extend((0..count).map(|_| Some(Sample::new(rng.random::<f64>()))));
        Ok(())
    }
}

#[test]
fn samplers_with_their_own_generator_get_a_seed_for_each_batch() {
    let run = |seed| {
        let sampler = Seeded::default();
        let many = Protocol { seed, samples: SampleCount::Fixed(3_000_000), ..Protocol::default() };
        let outcome = validate(&Line::UNIT, &sampler, &density(|_: f64| 1.0), &many).unwrap();
        (outcome, sampler.0.into_inner().unwrap())
    };
    let (outcome, seeds) = run(1);
    assert!(outcome.is_accepted() && seeds.len() > 300, "{outcome}");
    assert_eq!(seeds.iter().collect::<HashSet<_>>().len(), seeds.len());
    assert_eq!(run(1).0.statistic, outcome.statistic);
    assert_ne!(run(2).0.statistic, outcome.statistic);
}

/// A pdf that another process would compute, if it were there.
struct Unreachable;

impl Density for Unreachable {
    fn pdf(&self, _: &[Point], _: &mut Vec<f64>) -> Result<()> {
        Err(Error::external("no answer"))
    }
}

#[test]
fn what_could_not_be_tested_is_an_error() {
    let uniform = |dimension| sampler(dimension, |u: &[f64]| Some(Sample::new(u[0])));
    let (one, right) = (density(|_: f64| 1.0), Protocol::default());
    let error = |dimension, density: &dyn Density, protocol: Protocol| {
        validate(&Line::UNIT, &uniform(dimension), density, &protocol).unwrap_err().to_string()
    };
    assert_eq!(error(1, &Unreachable, right), "no answer");
    let level = error(1, &Unreachable, Protocol { level: 2.0, ..right });
    assert_eq!(level, "level: level 2 (use a probability such as 0.01)");
    assert_eq!(error(1, &one, Protocol { cancelled: || true, ..right }), "cancelled");
    assert!(error(0, &one, right).contains("sample_seeded"));
    for bad in [
        Protocol { level: 0.0, ..right },
        Protocol { level: f64::NAN, ..right },
        Protocol { cells: 1, ..right },
        Protocol { samples: SampleCount::Fixed(0), ..right },
        Protocol { samples: SampleCount::Detect(f64::NAN), ..right },
        Protocol { samples: SampleCount::Detect(1e-9), ..right },
    ] {
        error(1, &one, bad);
    }
}
