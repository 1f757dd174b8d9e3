//! The figure of the project's own samplers under test.

use super::check::Check;
use super::context::Context;
use super::entries::entry;
use super::registry::{Entry, Made};
use super::{output, validation as view};
use crate::error::Result;
use crate::study::validation::{run, select, suite};
use etalon_stats::{Protocol, SampleCount};

/// Tests that a full run has at least.
const TESTS: usize = 200;
/// What a quick run is content with: families of cheap samplers, and errors of 5 %.
const QUICK: [&str; 6] = ["warp", "table", "strata", "light", "bsdf/glass", "bsdf/diffuse"];

pub(super) fn all() -> Vec<Entry> {
    vec![entry("validation", "Every sampler against its density", "samplers of both reports, tested", validation)]
}

fn validation(context: &Context) -> Result<Made> {
    let mut protocol = Protocol { seed: context.seed, ..Protocol::default() };
    let mut names = Vec::new();
    if context.is_quick() {
        protocol.samples = SampleCount::Detect(0.05);
        names = QUICK.map(str::to_owned).into();
    }
    let found = run(&select(suite::cases(), &names)?, &protocol, &|_| ())?;
    let mut checks = vec![
        Check::near("rejected", 0.0, found.rejected as f64, 0.0),
        Check::near("inconclusive", 0.0, found.inconclusive as f64, 0.0),
        // Rejected at the level of 0.1 % at either end: p-values that are too even are suspicious, too.
        Check::near("uniformity of the p-values", 0.5, found.uniformity.p, 0.4995),
    ];
    if !context.is_quick() {
        checks.push(Check::near("tests short of 200", 0.0, TESTS.saturating_sub(found.tests.len()) as f64, 0.0));
    }
    Ok(Made { drawing: view::drawing(&found), table: output::table(&view::rows(&found))?, picture: None, checks })
}
