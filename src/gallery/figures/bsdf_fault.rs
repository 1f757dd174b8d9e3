//! A BSDF with a planted fault beside the right one: `bsdf-fault`.

use crate::error::Error;
use crate::figure::Drawing;
use crate::gallery::prelude::*;
use crate::study::validation::planted::{all, run_pair};
use crate::view::validation_cells::{drawing, rows};
use etalon_stats::Verdict;

/// A mixture of lobes that takes the random number of its choice again for the direction: values, weights and pdfs are right, and
/// samples alone are not.
const FAULT: &str = "bsdf-mixture/number-used-twice";

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "bsdf-fault",
        title: "A BSDF with a planted fault",
        report: Report::Neither,
        reproduces: "a mistake in sampling a mixture of lobes, found",
        shows: "Directions sampled from a mixture of two lobes, counted in cells of the sphere. Above, the random number that \
                chooses the lobe is used again for the direction: residuals have one sign over large regions, and the test says \
                where. Below, the same test of the right BSDF.",
        command: Some("etalon validate --planted".into()),
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let unknown = || Error::parameter("fault", format!("there is no planted fault {FAULT}"));
    let fault = all().into_iter().find(|fault| fault.name == FAULT).ok_or_else(unknown)?;
    let found = run_pair(fault, &inputs.protocol())?;
    let [faulty, right] = &found.tests[..] else { return Err(unknown()) };
    let is = |verdict| move |found: Verdict| f64::from(u8::from(found == verdict));
    let counts = [faulty, right].map(|tested| tested.outcome.counts.as_ref().map(rows).unwrap_or_default());
    // Residuals of right samples are about normal: beyond 5 standard deviations in one of 1.7 million cells.
    let largest = counts.each_ref().map(|rows| rows.iter().map(|row| row.residual.abs()).fold(0.0, f64::max));
    let checks = vec![
        Check::equal("the fault is rejected", 1.0, is(Verdict::Reject)(faulty.outcome.verdict)),
        Check::equal("the right BSDF is accepted", 1.0, is(Verdict::Accept)(right.outcome.verdict)),
        Check::at_least("largest residual with the fault", largest[0], 10.0),
        Check::at_most("largest residual without the fault", largest[1], 5.0),
    ];
    let drawings = [faulty, right].into_iter().filter_map(drawing).collect();
    let [faulty, _] = counts;
    Content::new(Drawing::stacked(drawings, 0.5, 2.0), &faulty, checks)
}
