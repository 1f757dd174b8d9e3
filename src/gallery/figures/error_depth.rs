//! Light missing at each maximum depth, and the time that it saves: `error-depth`.

use super::error_time::{LIMIT, small};
use crate::gallery::prelude::*;
use crate::scene::{Request, builtin};
use crate::study::converge::depth::{self, DepthCurve};
use crate::study::converge::doubling::Deadline;
use crate::view::converge_series as view;

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "error-depth",
        title: "Light missing at each maximum depth, and the time that it saves",
        report: Report::Second,
        reproduces: "Figure 1, max_ray_depth",
        shows: "The share of light that a render of limited depth lacks, over the depth and over the time that it takes.",
        matters: "A limit on depth is a bias that is chosen: the figure says how much light each limit costs, and how little time it saves beyond a few scatterings.",
        papers: &[papers::KAJIYA],
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let deadline = Deadline::after(LIMIT);
    let of_scene = |scene| {
        let (scene, request) = small(inputs, scene);
        let request = Request { spp: inputs.effort.of(64, 8), ..request };
        depth::measure(&scene, &request, inputs.effort.of(4, 2), inputs.seed, &deadline)
    };
    let scenes = [of_scene(inputs.spheres())?, of_scene(builtin::cornell_lambert())?];
    let checks = scenes.iter().flat_map(checks).collect();
    Content::new(view::depths(&scenes), &view::depth_rows(&scenes), checks)
}

/// Without any depth, which the time limit may cause, both numbers are NaN.
fn checks(scene: &DepthCurve) -> [Check; 2] {
    let name = &scene.scene;
    let ratios = scene.levels.windows(2).map(|pair| pair[1].missing.value / pair[0].missing.value);
    let largest = ratios.fold(f64::NAN, f64::max);
    let time = scene.levels.iter().find(|l| l.depth == 1).map_or(f64::NAN, |l| l.time_share);
    [
        Check::at_most(format!("missing light over that of the depth before, largest, {name}"), largest, 1.0),
        Check::at_most(format!("time of depth 1 over that of depth 100, {name}"), time, 1.0),
    ]
}
