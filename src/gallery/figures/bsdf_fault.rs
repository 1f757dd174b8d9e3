//! A BSDF with a planted fault, as a test sees it: `bsdf-fault`.

use crate::error::Error;
use crate::gallery::prelude::*;
use crate::study::validation::planted::{all, run_pair};
use crate::view::validation_cells::{drawing, rows};
use etalon_stats::Verdict;

/// A mixture of lobes that takes the random number of its choice again for the direction: values, weights and pdfs are right, and
/// samples alone are not.
const FAULT: &str = "bsdf-mixture/random-number-reused";

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "bsdf-fault",
        title: "A BSDF with a planted fault",
        report: Report::Neither,
        reproduces: "a mistake in sampling a mixture of lobes, found",
        shows: "Directions sampled from a mixture of two lobes, counted in cells of the sphere. The random number that chooses \
                the lobe is used again for the direction: residuals have one sign over large regions, and the test says where. \
                The same test accepts the right BSDF.",
        matters: "A test is worth what it finds: this error leaves every single value right, and only the joint distribution of samples shows it.",
        papers: &[papers::SUBR_ARVO],
        command: Some("etalon validate --planted".into()),
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let unknown = || Error::parameter("names", format!("there is no planted fault {FAULT}"));
    let fault = all().into_iter().find(|fault| fault.name == FAULT).ok_or_else(unknown)?;
    let found = run_pair(fault, &inputs.protocol())?;
    let [faulty, right] = &found.tests[..] else { return Err(unknown()) };
    let is = |verdict| move |found: Verdict| f64::from(u8::from(found == verdict));
    let uncounted = || Error::parameter("names", format!("the test of {FAULT} has no counts"));
    let counts = faulty.outcome.counts.as_ref().map(rows).ok_or_else(uncounted)?;
    let largest = counts.iter().map(|row| row.residual.abs()).fold(0.0, f64::max);
    let said = faulty.outcome.diagnosis.as_deref().unwrap_or_default();
    let checks = vec![
        Check::equal("the fault is rejected", 1.0, is(Verdict::Reject)(faulty.outcome.verdict)),
        Check::equal("the right BSDF is accepted", 1.0, is(Verdict::Accept)(right.outcome.verdict)),
        // One of 1.7 million cells of a right sampler is that far off.
        Check::at_least("largest residual with the fault", largest, 5.0),
        Check::at_least("regions that the test names", said.matches(" % too ").count() as f64, 1.0),
    ];
    Content::new(drawing(faulty).ok_or_else(uncounted)?, &counts, checks)
}
