//! `etalon validate --calibrate`: are the p-values of the tests as small as stated under many seeds, and no smaller?

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
        let too_small = || format!("p-values are too small, {}", p_is(test.uniformity.p_too_small));
        let why = test.violation.clone().unwrap_or_else(too_small);
        text += &format!("{}: {why}\n", test.name);
    }
    let conservative = found.tests.iter().filter(|test| test.conservative).count();
    if conservative > 0 {
        text += &format!(
            "{} larger p-values than uniform ones: right samplers are rejected less often than the level says\n",
            if conservative == 1 { "1 test has".to_owned() } else { format!("{conservative} tests have") }
        );
    }
    if found.interrupted {
        text += "interrupted: the other tests are left out\n";
    }
    text + &format!(
        "{} under {} of {}: {:.2} % of the p-values are below 5 %, {:.2} % below 1 %\n\
         all p-values together: too small, {}; tests with p-values that are too small, or a violation: {}\n",
        counted(found.tests.len(), "test"),
        counted(found.seeds as usize, "seed"),
        counted(found.samples as usize, "sample"),
        100.0 * found.below_5_percent,
        100.0 * found.below_1_percent,
        p_is(found.uniformity.p_too_small),
        found.skewed
    )
}
