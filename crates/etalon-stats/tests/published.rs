//! Faults that published software had, as models of a few lines, beside those of the museum of `etalon validate`: the first line
//! of the test names each, and the same without the fault is accepted.

use etalon_stats::{
    Density, Directions, Discrete, Domain, Pole, Protocol, Sample, Sampler, Verdict, density, sampler, validate,
};
use std::f64::consts::{PI, TAU};

fn direction(z: f64, u: f64) -> [f64; 3] {
    let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), TAU * u);
    [r * phi.cos(), r * phi.sin(), z]
}

/// The tests of this file share the level of 1 %.
const TESTS: usize = 8;

/// Without the fault `faulty` is accepted; with it, the reason has the words `named`.
fn check(domain: &dyn Domain, pairs: [(&dyn Sampler, &dyn Density); 2], named: &str) {
    let [right, faulty] = pairs.map(|(sampler, density)| {
        validate(domain, sampler, density, &Protocol { tests: TESTS, ..Protocol::default() }).unwrap()
    });
    assert!(right.is_accepted(), "{named}: {right}");
    let reason = faulty.reason().unwrap_or_default();
    assert!(faulty.verdict == Verdict::Reject && reason.contains(named), "{named}: {faulty}");
}

#[test]
fn faults_of_maps_are_named() {
    let sphere = Directions::sphere(Pole::Y);
    let uniform = density(|_: [f64; 3]| 0.25 / PI);
    let even = sampler(2, |u| Some(Sample::new(direction(1.0 - 2.0 * u[0], u[1]))));

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
        let [x, y, z] = direction(theta.cos(), u[2]);
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
            Some(Sample::with_pdf(direction(z, u[1]), pdf(sign * z)))
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
