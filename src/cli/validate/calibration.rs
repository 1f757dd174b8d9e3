//! `etalon validate --calibrate`: are the p-values of the tests uniform under many seeds?

use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict};
use crate::error::Result;
use crate::output;
use crate::study::validation::{Calibration, Case, calibrate};
use crate::view::text::{counted, p_is};
use crate::view::validation as view;
use etalon_stats::Protocol;

/// Tests the tests under `seeds` seeds; writes and prints the distribution of their p-values.
pub fn run(cases: &[Case], protocol: &Protocol, seeds: u64, global: &Global, console: &Console) -> Result<Verdict> {
    let target = global.target(&[]);
    let stem = target.stem("calibration", "", &output::STUDY)?;
    let bar = console.progress(cases.len() as u64, "calibrate", "tests");
    let found = calibrate(cases, protocol, seeds, &|_| bar.inc(1))?;
    bar.finish_and_clear();
    let table = output::table(&view::calibration_rows(&found))?;
    let written = target.written(output::write(&stem, &view::calibration_drawing(&found), &table)?);
    console.saved(&found, &written, || text(&found));
    Ok(Verdict::of(found.accepted, found.interrupted))
}

fn text(found: &Calibration) -> String {
    let mut text = String::new();
    for test in found.tests.iter().filter(|test| test.skewed || test.violation.is_some()) {
        let not_uniform = || format!("p-values are not uniform, {}", p_is(test.uniformity.p));
        let why = test.violation.clone().unwrap_or_else(not_uniform);
        text += &format!("{}: {why}\n", test.name);
    }
    if found.interrupted {
        text += "interrupted: the other tests are left out\n";
    }
    text + &format!(
        "{} under {} of {}: {:.2} % of the p-values are below 5 %, {:.2} % below 1 %\n\
         uniformity of all p-values: {}; tests with skewed p-values or a violation: {}\n",
        counted(found.tests.len(), "test"),
        counted(found.seeds as usize, "seed"),
        counted(found.samples as usize, "sample"),
        100.0 * found.below_5_percent,
        100.0 * found.below_1_percent,
        p_is(found.uniformity.p),
        found.skewed
    )
}
