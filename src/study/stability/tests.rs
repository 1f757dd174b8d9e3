//! The study finds what is planted, and what it prints can be replayed.

use super::*;

fn family(name: &str) -> &'static Family {
    FAMILIES.iter().find(|family| family.name == name).unwrap()
}

/// The textbook's form in the place of the one that renders.
fn planted(name: &str) -> Sweep {
    let Family { about, inputs, domains, sections, edges, reference, range, coarser, .. } = *family(name);
    let textbook = &family(name).forms[1];
    assert_eq!(textbook.name, TEXTBOOK);
    let forms = Box::leak(Box::new([Form { name: STABLE, ..*textbook }]));
    let name = family(name).name;
    let planted = Family { name, about, inputs, domains, sections, edges, reference, forms, range, coarser };
    Sweep::new(Box::leak(Box::new(planted)), Effort::QUICK.side)
}

#[test]
fn promises_are_kept_and_textbook_forms_break_them() {
    let quick = run::<&str>(&[], &Effort::QUICK, 1, &mut |_| {}).unwrap();
    for promise in &quick.promises {
        assert!(promise.kept, "{promise:?}");
    }
    assert_eq!(quick.promises.len(), 7);
    for (name, broken) in
        [("fresnel", "relative"), ("fresnel", "anywhere"), ("beckmann-d", "D and"), ("ggx-d", "D and")]
    {
        let sweep = planted(name);
        let rows = Row::of_sweep(&sweep);
        let promises = promises(&[sweep], &rows);
        assert!(promises.iter().any(|p| p.name.contains(broken) && !p.kept), "{name}: {promises:?}");
    }
    let sweep = planted("beckmann-d");
    let rows = Row::of_sweep(&sweep);
    assert!(!promises(&[sweep], &rows)[0].kept, "its D is 0/0 near the horizon");
}

#[test]
fn plain_sums_and_tables_fail_where_the_renderers_do_not() {
    let quick = run(&["tables", "areas", "film", "offsets"], &Effort::QUICK, 1, &mut |_| {}).unwrap();
    let row = |family: &str, form: &str, precision| {
        quick.rows.iter().find(|r| r.family == family && r.form == form && r.precision == precision).unwrap()
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
    let result = run(&["fresnel", "conductor", "sphere"], &Effort::QUICK, 1, &mut |_| {}).unwrap();
    assert_eq!(result.rows.len(), 6 + 6 + 3);
    for row in &result.rows {
        let replay = replay(&row.worst).unwrap();
        let line = replay.lines.iter().find(|l| l.form == row.form && l.precision == row.precision).unwrap();
        assert_eq!((line.relative, line.condition), (row.max_relative, row.condition_at_worst), "{row:?}");
    }
}

#[test]
fn unknown_families_are_refused() {
    let error = run(&["glass"], &Effort::QUICK, 1, &mut |_| {}).err().unwrap();
    assert!(error.hint().unwrap().contains("fresnel"));
}
