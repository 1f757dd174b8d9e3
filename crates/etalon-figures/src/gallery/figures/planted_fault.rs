//! A sampler and a BSDF with planted faults, as a test sees them: `test-chi-square`, `bsdf-fault`.

use crate::gallery::prelude::*;
use crate::view::validation_cells::{drawing, rows};
use etalon_bench::validation::planted::{all, run_pair};
use etalon_core::error::Error;
use etalon_stats::Verdict;

/// Points of the disc at the radius u in place of √u, lifted to the hemisphere.
const SAMPLER: &str = "warp/hemisphere/disc-without-root";

/// A mixture of lobes that takes the random number of its choice again for the direction: values, weights and pdfs are right, and
/// samples alone are not.
const BSDF: &str = "whole/mixture/random-number-reused";

pub fn figures() -> Vec<Maker> {
    vec![
        maker("test-chi-square", |inputs, _| content(inputs, SAMPLER)),
        maker("bsdf-fault", |inputs, _| content(inputs, BSDF)),
    ]
}

fn content(inputs: &Inputs, name: &str) -> Result<Content> {
    let unknown = || Error::parameter("names", format!("there is no planted fault {name}"));
    let fault = all().into_iter().find(|fault| fault.name == name).ok_or_else(unknown)?;
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
    Content::new(drawing(faulty), &counts, checks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::registry;

    #[test]
    fn the_command_makes_the_same() {
        for (id, fault) in [("test-chi-square", SAMPLER), ("bsdf-fault", BSDF)] {
            let figure = registry().iter().find(|figure| figure.id == id).unwrap();
            assert_eq!(figure.command, Some(format!("etalon validate --planted {fault}")));
        }
    }
}
