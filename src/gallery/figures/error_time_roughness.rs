//! Efficiency over roughness by the way of sampling normals: `error-time-roughness`.

use super::error_time::{LIMIT, small};
use crate::gallery::prelude::*;
use crate::scene::Request;
use crate::study::converge::doubling::Deadline;
use crate::study::converge::roughness::{self, NORMALS, RoughnessLevel};
use crate::view::converge_series as view;

/// Roughnesses of a full run and of a quick one.
const ALPHAS: [f32; 6] = [0.02, 0.05, 0.1, 0.25, 0.5, 1.0];
const QUICK_ALPHAS: [f32; 3] = [0.05, 0.25, 1.0];

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "error-time-roughness",
        title: "Efficiency over roughness, by the way of sampling normals",
        report: Report::Second,
        reproduces: "Figure 3, over all roughnesses",
        shows: "Noise and efficiency on a golden statue with visible normals, with all normals and with uniform directions. Bars are 95 % \
                intervals over the replicates: long where few samples carry most of the light.",
        matters: "The gain of a good sampling technique depends on the material: it is largest for smooth metal and shrinks as the lobe widens.",
        papers: &[papers::HEITZ, papers::WALTER],
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let effort = inputs.effort;
    let (scene, request) = small(inputs, inputs.statue("Au", 0.25)?);
    let request = Request { spp: effort.of(32, 8), ..request };
    let alphas = effort.of(&ALPHAS[..], &QUICK_ALPHAS[..]);
    let levels = roughness::measure(&scene, &request, alphas, effort.of(4, 2), inputs.seed, &Deadline::after(LIMIT))?;
    let missing = alphas.len() - levels.len() / NORMALS.len();
    let mut checks = vec![Check::equal("roughnesses left out by the time limit", 0.0, missing as f64)];
    for three in levels.chunks_exact(NORMALS.len()) {
        if let [visible, all, _] = three {
            checks.extend(visible_against_all(visible, all));
        }
    }
    Content::new(view::roughness(&levels), &view::roughness_rows(&levels), checks)
}

fn visible_against_all(visible: &RoughnessLevel, all: &RoughnessLevel) -> [Check; 2] {
    let alpha = visible.alpha;
    let z = visible.light.z(&all.light);
    let mean = format!("mean of the metal, visible minus all normals (standard errors), α = {alpha}");
    // Light sampling and light tracing find most of the light, too, so that chance may decide which is better: the ends of the
    // intervals are compared.
    let ratio = visible.mse.positive()[0] / all.mse.positive()[1];
    let noise = format!("lower end of the squared error over the upper, visible normals over all normals, α = {alpha}");
    [Check::within(mean, 0.0, z, 4.0), Check::at_most(noise, ratio, 1.0)]
}
