//! The study detects planted faults, and the inputs that it prints can be replayed.

use super::sweep::{Deviation, Exact, Range};
use super::*;

/// The bounds of a family that do not hold when the values of the code that renders are changed.
fn violated(family: &'static Family, change: &dyn Fn([f64; 3]) -> [f64; 3]) -> Vec<String> {
    let mut sweep = Sweep::new(family, Workload::QUICK.side);
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
fn every_entry_is_complete() {
    for (i, entry) in REGISTRY.iter().enumerate() {
        let name = entry.name();
        assert!(entry.about().len() > 10 && entry.figure().starts_with("stability-"), "{name}");
        assert!(REGISTRY[..i].iter().all(|other| other.name() != name), "{name} is there twice");
        let reasons: Vec<&str> = match entry {
            Entry::Formula(family) => family.bounds.iter().map(|bound| bound.reason).collect(),
            Entry::Experiment(experiment) => experiment.bounds.iter().map(|bound| bound.reason).collect(),
        };
        assert!(!reasons.is_empty() && reasons.iter().all(|reason| !reason.is_empty()), "{name} has no bound");
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn bounds_hold_and_faults_violate_them() {
    for entry in &REGISTRY {
        let (violated, with_fault) = match entry {
            Entry::Formula(family) => {
                (violated(family, &|value| value), violated(family, &|value| fault(family.range, value)))
            }
            Entry::Experiment(experiment) => {
                let rows = (experiment.run)(&Workload::QUICK, 1).unwrap();
                let wrong = |row: &ErrorRow| ErrorRow {
                    max_relative: row.max_relative + 0.1,
                    max_ulp: row.max_ulp + 1e6,
                    max_ulp_per_condition: row.max_ulp_per_condition + 1e6,
                    out_of_range: row.out_of_range + 1,
                    ..row.clone()
                };
                let violated = |rows: &[ErrorRow]| {
                    let bounds = BoundCheck::of_rows(experiment, rows).into_iter().filter(|bound| !bound.holds);
                    bounds.map(|bound| format!("{}: {}", bound.name, bound.got)).collect::<Vec<_>>()
                };
                (violated(&rows), violated(&rows.iter().map(wrong).collect::<Vec<_>>()))
            }
        };
        assert!(violated.is_empty(), "{violated:?}");
        assert!(!with_fault.is_empty(), "{}: no bound detects a fault", entry.name());
    }
}

#[test]
fn textbook_variants_violate_the_bounds() {
    for name in ["fresnel", "refraction", "beckmann-d", "ggx-d", "ggx-pdf", "half-cosine"] {
        let family = families().find(|family| family.name == name).unwrap();
        let textbook = family.variants.iter().position(|variant| variant.name == TEXTBOOK).unwrap();
        let mut sweep = Sweep::new(family, Workload::QUICK.side);
        sweep.cases.iter_mut().for_each(|case| case.deviations.swap(0, textbook));
        assert!(BoundCheck::of_sweep(&sweep).iter().any(|bound| !bound.holds), "{name}");
    }
}

#[test]
fn plain_sums_and_tables_fail_where_the_renderers_do_not() {
    let quick = run(&["tables", "areas", "film", "offsets"], &Workload::QUICK, 1, &mut |_| {}).unwrap();
    let row = |family: &str, variant: &str, precision| {
        quick.rows.iter().find(|r| r.family == family && r.variant == variant && r.precision == precision).unwrap()
    };
    assert_eq!(row("tables", STABLE, Precision::Double).out_of_range, 0);
    assert!(row("tables", TEXTBOOK, Precision::Single).out_of_range > 1000);
    assert!(row("film", STABLE, Precision::Single).max_ulp <= 0.5, "rounded once");
    assert!(row("film", TEXTBOOK, Precision::Single).max_relative > 1e-3);
    assert!(row("areas", STABLE, Precision::Double).max_relative < 1e-12);
    assert!(row("areas", TEXTBOOK, Precision::Single).max_relative > 1e-5);
    assert_eq!(row("offsets", STABLE, Precision::Single).out_of_range, 0);
    assert!(row("offsets", TEXTBOOK, Precision::Single).out_of_range > 100);
}

#[test]
fn worst_cases_can_be_replayed() {
    let result = run(&["fresnel", "conductor", "sphere"], &Workload::QUICK, 1, &mut |_| {}).unwrap();
    assert_eq!(result.rows.len(), 6 + 6 + 3);
    for row in &result.rows {
        let replay = replay(&row.worst).unwrap();
        let line = replay.lines.iter().find(|l| l.variant == row.variant && l.precision == row.precision).unwrap();
        assert_eq!((line.relative, line.condition), (row.max_relative, row.condition_at_worst), "{row:?}");
    }
}

#[test]
fn unknown_families_are_refused() {
    let error = run(&["glass"], &Workload::QUICK, 1, &mut |_| {}).err().unwrap();
    assert!(error.hint().unwrap().contains("fresnel"));
}
