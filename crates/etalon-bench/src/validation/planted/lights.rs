//! Mistakes in sampling directions towards lights, and in choosing among lights.

use super::super::case::direction_sampler;
use super::fault::PlantedFault;
use crate::validation::case::direction_density;
use etalon_stats::{Density, Directions, Line, Pole, Sample, Sampler, density, sampler};
use glam::DVec3;
use std::f64::consts::TAU;

/// Cosines of the cones of two spheres, one above and one below.
const ABOVE: f64 = 0.8;
const BELOW: f64 = 0.6;

/// The direction of that cosine with +y.
fn upright(cos: f64, turns: f64) -> DVec3 {
    let w = super::hemispheres::polar(cos, turns);
    DVec3::new(w.y, w.z, w.x)
}

/// Both spheres, chosen by u₂: the upper one with probability `chosen`, which the pdf takes for `stated` (of the upper, of
/// the lower).
fn two_spheres(chosen: f64, stated: [f64; 2]) -> (impl Sampler, impl Density) {
    let draw = move |u: &[f64]| {
        let (side, cos) = if u[2] < chosen { (1.0, ABOVE) } else { (-1.0, BELOW) };
        Some(Sample::new(upright(side * (1.0 - u[0] * (1.0 - cos)), u[1]).to_array()))
    };
    let pdf = move |w: DVec3| {
        if w.y > ABOVE {
            stated[0] / (TAU * (1.0 - ABOVE))
        } else if w.y < -BELOW {
            stated[1] / (TAU * (1.0 - BELOW))
        } else {
            0.0
        }
    };
    let rows = vec![0.5 * (1.0 - ABOVE), 0.5 * (1.0 + BELOW)];
    (sampler(3, draw), direction_density(pdf).with_steps([rows, Vec::new()]))
}

pub fn faults() -> Vec<PlantedFault> {
    let sphere = Directions::sphere(Pole::Y);
    vec![
        PlantedFault::of("light/area-for-solid-angle", sphere, |faulty| {
            let draw = |u: [f64; 2]| Some(DVec3::new(u[0] - 0.5, 1.0, u[1] - 0.5).normalize());
            // The rectangle is 1×1 at height 1: cos θ = y, d = 1/y.
            let pdf = move |w: DVec3| {
                let hit = w.y > 0.0 && w.x.abs() <= 0.5 * w.y && w.z.abs() <= 0.5 * w.y;
                if hit { if faulty { 1.0 } else { w.y.powi(-3) } } else { 0.0 }
            };
            (direction_sampler(draw), direction_density(pdf))
        })
        .mistake(
            "a rectangle's pdf per area taken for the one per solid angle: \
             d²/cos θ forgotten, or mixed up within MIS",
        ),
        PlantedFault::of("light/triangle-without-root", Line::UNIT, |faulty| {
            let draw = move |u: &[f64]| Some(Sample::new(if faulty { u[0] } else { 1.0 - (1.0 - u[0]).sqrt() }));
            (sampler(1, draw), density(|x: f64| 2.0 * (1.0 - x)))
        })
        .mistake(
            "the first barycentric coordinate of a triangle sampled as u instead of 1 − √(1 − u): \
             one corner is crowded",
        ),
        PlantedFault::of("light/cone-by-its-sine", sphere, |faulty| {
            let draw = |u: [f64; 2]| Some(upright(1.0 - u[0] * (1.0 - ABOVE), u[1]));
            let cos = if faulty { (1.0 - ABOVE * ABOVE).sqrt() } else { ABOVE };
            let pdf = move |w: DVec3| if w.y > cos { 1.0 / (TAU * (1.0 - cos)) } else { 0.0 };
            (direction_sampler(draw), direction_density(pdf).with_steps([vec![0.5 * (1.0 - cos)], Vec::new()]))
        })
        .mistake("a sphere's cone with r/d, which is its sine, in place of its cosine"),
        PlantedFault::of("light/choice-forgotten", sphere, |faulty| {
            two_spheres(0.5, if faulty { [1.0, 1.0] } else { [0.5, 0.5] })
        })
        .mistake("one of two lights is chosen, and the probability of the choice left out of the pdf"),
        PlantedFault::of("light/choice-by-power", sphere, |faulty| {
            two_spheres(0.55, if faulty { [0.5, 0.5] } else { [0.55, 0.45] })
        })
        .mistake("lights chosen by their power, but divided by the pdf of a uniform choice"),
    ]
}
