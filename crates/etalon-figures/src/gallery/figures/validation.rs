//! The program's own samplers under test: `validation`.

use crate::gallery::inputs::Effort;
use crate::gallery::prelude::*;
use crate::view::validation as view;
use etalon_bench::validation::{run, select, suite};

/// Families of tests that a quick run is limited to: samplers that cost little.
const QUICK: [&str; 6] = ["warp", "table", "strata", "light", "bsdf/glass", "bsdf/diffuse"];
/// p-values so near to either end are evidence: too uniform is as suspicious as not uniform.
const LEVEL: f64 = 5e-4;

pub fn figures() -> Vec<Maker> {
    vec![maker("validation", |inputs, _| content(inputs))]
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
    Content::new(view::drawing(&found), &view::rows(&found), checks)
}
