//! Error of fixed lights in place of a map: `median-cut-error`.

use super::error_time::{biased, plan, sphere_curves, sphere_scene, stopped};
use crate::gallery::prelude::*;
use crate::study::converge::{CUTS, cuts};
use crate::view::{converge, converge_series as view};

/// Numbers of lights that the map is cut into.
const LIGHTS: [u32; 5] = [1, 4, 16, 64, 256];

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "median-cut-error",
        title: "Error of fixed lights in place of the map",
        report: Report::First,
        reproduces: "Figures 7 to 11, their error",
        shows: "Error of the sphere lit by fixed lights of a median cut, over their number and over time, beside light samples \
                of the map itself.",
        matters: "It answers which of both to use: fixed lights win as long as their bias is below the noise that the same time would leave.",
        papers: &[papers::DEBEVEC, papers::VIRIYOTHAI],
        ..Figure::by(content)
    }]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let sampled = sphere_curves(inputs, studies)?;
    let (scene, request) = sphere_scene(inputs);
    let fixed = cuts(&scene, &request, &LIGHTS, &plan(inputs, 1, 3), sampled.truth.as_ref())?;
    let mut checks = vec![stopped(&fixed)];
    let rmse = |cut: &str, lights: u32| {
        let curve = fixed.curve(&format!("{cut}-{lights}"));
        curve.and_then(|curve| curve.levels.last()).map_or(f64::NAN, |level| level.rmse())
    };
    for cut in CUTS {
        let ratio = rmse(cut, 256) / rmse(cut, 1);
        checks.push(Check::at_most(format!("error of 256 lights over that of one, {cut}"), ratio, 0.05));
        checks.extend(fixed.curve(&format!("{cut}-64")).map(biased));
    }
    let rows = [converge::rows(&fixed), converge::rows(&sampled)].concat();
    Content::new(view::lights(&fixed, &sampled), &rows, checks)
}
