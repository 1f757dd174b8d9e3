//! Maps from the unit square to directions, and the circular functions that they are made of.

use super::super::case::{Case, direction_sampler};
use super::inputs::short;
use crate::validation::case::direction_density;
use etalon_core::math::circular::Circular;
use etalon_core::sampling::warp;
use etalon_stats::{Directions, Line, Pole, Sample, density, sampler};
use glam::DVec3;

pub fn cases() -> Vec<Case> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        Case::of("warp/uniform-hemisphere", half, || {
            let sampler = direction_sampler(|u| Some(warp::uniform_hemisphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_uniform_hemisphere(w.into()).to_vec());
            (sampler, direction_density(|_: DVec3| warp::UNIFORM_HEMISPHERE_PDF))
        }),
        Case::of("warp/uniform-sphere", Directions::sphere(Pole::Z), || {
            let sampler = direction_sampler(|u| Some(warp::uniform_sphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_uniform_sphere(w.into()).to_vec());
            (sampler, direction_density(|_: DVec3| warp::UNIFORM_SPHERE_PDF))
        }),
        Case::of("warp/cosine-hemisphere", half, || {
            let sampler = direction_sampler(|u| Some(warp::cosine_hemisphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_cosine_hemisphere(w.into()).to_vec());
            (sampler, direction_density(|w: DVec3| warp::cosine_hemisphere_pdf(w.z)))
        }),
        // Both f32 functions at once: turns to a point of the circle, and half of the circle back to an angle.
        Case::of("warp/circle-f32/sine-and-cosine", half, || {
            let draw = |u: [f64; 2]| {
                let (sin, cos) = f32::sin_cos_turns(short(u[1]));
                let r = (u[0] * (2.0 - u[0])).sqrt();
                Some(DVec3::new(r * f64::from(cos), r * f64::from(sin), 1.0 - u[0]))
            };
            (direction_sampler(draw), direction_density(|_: DVec3| warp::UNIFORM_HEMISPHERE_PDF))
        }),
        Case::of("warp/circle-f32/angle", Line { from: 0.0, to: std::f64::consts::PI }, || {
            let draw = |u: &[f64]| {
                let (sin, cos) = (0.5 * u[0] * std::f64::consts::TAU).sin_cos();
                let angle = f32::angle(sin as f32, cos as f32);
                Some(Sample::new(f64::from(angle).min(std::f64::consts::PI)))
            };
            (sampler(1, draw), density(|_: f64| std::f64::consts::FRAC_1_PI))
        }),
    ]
}
