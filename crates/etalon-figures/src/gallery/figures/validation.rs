//! The program's own samplers under test: `validation`; a sampler and a BSDF with planted faults, as a test sees them:
//! `test-chi-square`, `bsdf-fault`.

use super::super::inputs::Effort;
use crate::gallery::prelude::*;
use crate::view::validation as view;
use crate::view::validation_cells::{fault as drawing, rows};
use etalon_bench::validation::planted::{all, run_pair};
use etalon_bench::validation::{run, select, suite};
use etalon_core::error::Error;
use etalon_stats::Verdict;

/// Families of tests that a quick run is limited to: samplers that cost little.
const QUICK: [&str; 6] = ["warp", "table", "strata", "light", "bsdf/glass", "bsdf/diffuse"];
/// p-values so near to either end are evidence: too uniform is as suspicious as not uniform.
const LEVEL: f64 = 5e-4;

pub fn figures() -> Vec<Maker> {
    vec![
        maker("validation", |inputs, _| content(inputs)),
        maker("test-chi-square", |inputs, _| planted_fault(inputs, SAMPLER)),
        maker("bsdf-fault", |inputs, _| planted_fault(inputs, BSDF)),
    ]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let names = match inputs.effort {
        Effort::Full => Vec::new(),
        Effort::Quick => QUICK.map(str::to_owned).into(),
    };
    let found = run(&select(suite::cases(), &names)?, &inputs.protocol(), &|_| ())?;
    let checks = vec![
        Check::equal("rejected tests", 0.0, found.rejected as f64),
        Check::equal("inconclusive tests", 0.0, found.inconclusive as f64),
        Check::at_least("uniformity of the p-values (Kolmogorov–Smirnov p)", found.uniformity.p, LEVEL),
        Check::at_most("uniformity of the p-values (no suspiciously good fit)", found.uniformity.p, 1.0 - LEVEL),
    ];
    Ok(Content::of_csv(view::drawing(&found), view::csv(&found)?, checks))
}

/// Points of the disc at the radius u in place of √u, lifted to the hemisphere.
const SAMPLER: &str = "warp/hemisphere/disc-without-root";

/// A mixture of lobes that takes the random number of its choice again for the direction: values, weights and pdfs are right, and
/// samples alone are not.
const BSDF: &str = "whole/mixture/random-number-reused";

fn planted_fault(inputs: &Inputs, name: &str) -> Result<Content> {
    let unknown = || Error::parameter("names", format!("there is no planted fault {name}"));
    let fault = all().into_iter().find(|fault| fault.name == name).ok_or_else(unknown)?;
    let mistake = fault.mistake;
    let found = run_pair(fault, &inputs.protocol())?;
    let [faulty, right] = &found.tests[..] else { return Err(unknown()) };
    let is = |verdict| move |found: Verdict| f64::from(u8::from(found == verdict));
    let uncounted = || Error::parameter("names", format!("the test of {name} has no counts"));
    let counts = faulty.outcome.counts.as_ref().map(rows).ok_or_else(uncounted)?;
    let largest = counts.iter().map(|row| row.residual.abs()).fold(0.0, f64::max);
    let said = faulty.outcome.diagnosis.as_deref().unwrap_or_default();
    let checks = vec![
        Check::equal("the fault is rejected", 1.0, is(Verdict::Reject)(faulty.outcome.verdict)),
        Check::equal("the same without the fault is accepted", 1.0, is(Verdict::Accept)(right.outcome.verdict)),
        // One of 1.7 million cells of a right sampler is that far off.
        Check::at_least("largest residual with the fault", largest, 5.0),
        Check::at_least("regions that the test names", said.matches(" % too ").count() as f64, 1.0),
    ];
    Content::new(drawing(faulty, mistake), &counts, checks)
}

#[cfg(test)]
mod tests {
    use super::super::super::registry;
    use super::*;

    #[test]
    fn the_command_makes_the_same() {
        for (id, fault) in [("test-chi-square", SAMPLER), ("bsdf-fault", BSDF)] {
            let figure = registry().iter().find(|figure| figure.id == id).unwrap();
            assert_eq!(figure.command, Some(format!("etalon validate --planted {fault}")));
        }
    }
}
