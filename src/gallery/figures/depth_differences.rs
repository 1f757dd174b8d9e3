//! What each path depth adds: `depth-differences`.

use super::depth::DepthSeries;
use crate::gallery::prelude::*;
use crate::study::depth::DEPTHS;
use crate::view::depth as view;

/// One figure.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "depth-differences",
        title: "What each further scattering adds, by path class",
        report: Report::Second,
        reproduces: "Figure 1, what appears at each depth",
        shows: "Each depth minus the one before, on one scale, with the path classes that make up the difference.",
        beside: None,
        command: None,
        make: Box::new(content),
    }]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let result = studies.get(DepthSeries, inputs)?;
    let mut checks = vec![Check::within("total share of all path classes", 1.0, result.share(|_| true), 1e-6)];
    for pair in DEPTHS.windows(2) {
        let added = (result.mean(pair[1]) - result.mean(pair[0])) / result.mean(100);
        let name = format!("share of the classes of depth {} (the difference from depth {})", pair[1], pair[0]);
        checks.push(Check::within(name, added, result.share(|r| r.depth == pair[1]), 1e-6));
    }
    Content::new(view::differences(&result), &result.classes, checks)
}
