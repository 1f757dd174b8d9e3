//! The study detects planted faults, and the inputs that it prints can be replayed.

use super::sweep::{Deviation, Exact, Range};
use super::*;

/// Places along each side of the grids: for a quick look.
const SIDE: usize = 9;

/// The bounds of a family that do not hold when the values of the code that renders are changed.
fn violated(family: &'static Family, change: &dyn Fn([f64; 3]) -> [f64; 3]) -> Vec<String> {
    let mut sweep = Sweep::new(family, SIDE);
    for case in &mut sweep.cases {
        let exact = Exact::at(family.reference, &case.inputs);
        if let Some(deviation) = &mut case.deviations[0] {
            *deviation = Deviation::between(family.range, case.precision, deviation.value.map(change), &exact);
        }
    }
    let bounds = BoundCheck::of_sweep(&sweep).into_iter().filter(|bound| !bound.holds);
    bounds.map(|bound| format!("{}: {} at {}", bound.name, bound.got, bound.worst)).collect()
}

/// A number with an error of 10 %; a unit vector turned by a few degrees.
fn fault(range: Range, [x, y, z]: [f64; 3]) -> [f64; 3] {
    if range == Range::Unit {
        let length = ((x + 0.1).powi(2) + y * y + z * z).sqrt();
        [(x + 0.1) / length, y / length, z / length]
    } else {
        [1.1 * x, y, z]
    }
}

#[test]
fn every_family_is_complete() {
    for (i, family) in REGISTRY.iter().enumerate() {
        let name = family.name;
        assert!(family.about.len() > 10 && family.figure.starts_with("stability-"), "{name}");
        assert!(REGISTRY[..i].iter().all(|other| other.name != name), "{name} is there twice");
        let mut reasons = family.bounds.iter().map(|bound| bound.reason);
        assert!(!family.bounds.is_empty() && reasons.all(|reason| !reason.is_empty()), "{name} has no bound");
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn bounds_hold_and_faults_violate_them() {
    for family in REGISTRY {
        let violated_as_is = violated(family, &|value| value);
        assert!(violated_as_is.is_empty(), "{violated_as_is:?}");
        let with_fault = violated(family, &|value| fault(family.range, value));
        assert!(!with_fault.is_empty(), "{}: no bound detects a fault", family.name);
    }
    let rows = special::run().unwrap();
    assert!(special::bound(&rows).holds, "{:?}", special::bound(&rows));
    for i in 0..rows.len() {
        let mut rows = rows.clone();
        rows[i].out_of_range += 1;
        assert!(!special::bound(&rows).holds, "{}", rows[i].family);
    }
}

#[test]
fn textbook_variants_violate_the_bounds() {
    for name in ["fresnel", "refraction", "beckmann-d", "ggx-d", "ggx-pdf", "half-cosine"] {
        let family = REGISTRY.into_iter().find(|family| family.name == name).unwrap();
        let textbook = family.variants.iter().position(|variant| variant.name == TEXTBOOK).unwrap();
        let mut sweep = Sweep::new(family, SIDE);
        sweep.cases.iter_mut().for_each(|case| case.deviations.swap(0, textbook));
        assert!(BoundCheck::of_sweep(&sweep).iter().any(|bound| !bound.holds), "{name}");
    }
}

#[test]
fn worst_cases_can_be_replayed() {
    let result = run(&["fresnel", "conductor", "sphere"], SIDE, &mut |_| {}).unwrap();
    assert_eq!(result.rows.len(), 6 + 6 + 3);
    for row in &result.rows {
        let replay = replay(&row.worst).unwrap();
        let line = replay.lines.iter().find(|l| l.variant == row.variant && l.precision == row.precision).unwrap();
        assert_eq!((line.relative, line.condition), (row.max_relative, row.condition_at_worst), "{row:?}");
    }
}

#[test]
fn unknown_families_are_refused() {
    let error = run(&["glass"], SIDE, &mut |_| {}).err().unwrap();
    assert!(error.hint().unwrap().contains("fresnel"));
}
