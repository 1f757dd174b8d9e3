//! Cost against the number of lights, spheres and triangles: `scaling`.

use crate::gallery::prelude::*;
use crate::study::fit::log_log_slope;
use crate::study::scaling::{Cost, Many, cost};
use crate::view::scaling as view;

/// Most primitives of a full run and of a quick one, as powers of ten.
fn largest(many: Many, inputs: &Inputs) -> u32 {
    match many {
        Many::Lights => inputs.effort.of(4, 3),
        Many::Spheres | Many::Triangles => inputs.effort.of(6, 4),
    }
}

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "scaling",
        title: "Cost against the number of lights, spheres and triangles",
        report: Report::Neither,
        reproduces: "beyond the reports",
        shows: "Processor time per camera sample, and of the preparation, over the number of primitives.",
        matters: "Logarithmic growth is what makes large scenes possible: a slope near 1 would mean that every ray visits every primitive.",
        papers: &[papers::CONTY_KULLA],
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let (side, spp) = (inputs.effort.of(64, 32), 4);
    let mut costs: Vec<Cost> = Vec::new();
    let mut checks = Vec::new();
    for many in Many::ALL {
        let from = costs.len();
        for power in 0..=largest(many, inputs) {
            costs.push(cost(many, 10usize.pow(power), side, spp, inputs.seed)?);
        }
        // Logarithmic growth has a slope that falls towards 0, linear growth one of 1.
        let points: Vec<[f64; 2]> =
            costs[from + 1..].iter().map(|c| [c.count as f64, c.microseconds_per_sample]).collect();
        checks.push(Check::at_most(
            format!("exponent of the time per sample over the number of {}, from 10 on", many.name()),
            log_log_slope(&points),
            0.5,
        ));
    }
    Content::new(view::drawing(&costs), &costs, checks)
}
