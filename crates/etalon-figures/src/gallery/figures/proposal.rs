//! Inversion with uniform and with Gaussian random numbers: `proposal`.

use crate::gallery::prelude::*;
use crate::view::proposal as view;
use etalon_bench::proposal::{self, Proposal, RowBin};

/// Rows that are sampled.
const SAMPLES: usize = 100_000;
/// A p-value this near to either end is evidence: of a wrong distribution, or of one that fits too well.
const LEVEL: f64 = 1e-3;

pub fn figures() -> Vec<Maker> {
    vec![maker("proposal", content)]
}

/// Both histograms, if the map has light in enough rows.
pub fn tested(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Option<Proposal>>> {
    studies.get("proposal", || proposal::compare(&inputs.map.map, SAMPLES, inputs.seed))
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let tested = tested(inputs, studies)?;
    let Some(result) = tested.as_ref() else {
        let check = Check::is_true("sampled rows against the map's distribution", false);
        let check = check.unless(Some("the map has light in too few rows for a test"));
        return Content::new(view::nothing_to_test(), &[] as &[RowBin], vec![check]);
    };
    let checks = vec![
        Check::at_least("p-value with uniform random numbers", result.uniform.p, LEVEL),
        Check::at_most("p-value with uniform random numbers (no suspiciously good fit)", result.uniform.p, 1.0 - LEVEL),
        Check::at_most("p-value with Gaussian random numbers", result.gaussian.p, 1e-6),
    ];
    Content::new(view::drawing(result), &result.bins, checks)
}
