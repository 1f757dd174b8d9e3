//! Mistakes in sampling directions over a hemisphere.

use super::super::case::{DirectionSampler, direction_sampler};
use super::fault::PlantedFault;
use crate::validation::case::direction_density;
use etalon_core::math::circular::sin_cos_turns;
use etalon_core::sampling::warp;
use etalon_stats::{DensityFn, Directions, Mass, Point, Pole, Sample, Sampler};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The unit vector at that cosine with +z and that azimuth in turns.
pub(super) fn polar(cos: f64, turns: f64) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(turns);
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

const N: f64 = 20.0;

/// The direction of a lobe cosⁿ around `axis`, whose tangent frame is given.
fn in_lobe(axis: DVec3, [tangent, bitangent]: [DVec3; 2], cos: f64, turns: f64) -> DVec3 {
    let w = polar(cos, turns);
    w.x * tangent + w.y * bitangent + w.z * axis
}

/// Samples from the lobe around the mirrored direction of light at 60°; where that leaves the hemisphere there is no sample.
fn lobe(power: f64) -> impl Sampler {
    let (axis, frame) = mirrored();
    direction_sampler(move |u| Some(in_lobe(axis, frame, (1.0 - u[0]).powf(power), u[1])).filter(|w| w.z > 0.0))
}

fn mirrored() -> (DVec3, [DVec3; 2]) {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    (DVec3::new(sin, 0.0, cos), [DVec3::Y, DVec3::new(cos, 0.0, -sin)])
}

/// Its pdf with the given factor for (n + 1).
fn lobe_pdf(factor: f64) -> DensityFn<impl Fn(Point) -> f64 + Sync> {
    direction_density(move |w| factor / TAU * w.dot(mirrored().0).max(0.0).powf(N))
}

/// A right sampler in proportion to the cosine.
fn cosine() -> DirectionSampler<impl Fn(&[f64]) -> Option<Sample> + Sync> {
    direction_sampler(|u| Some(warp::cosine_hemisphere(u)))
}

pub fn faults() -> Vec<PlantedFault> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        PlantedFault::of("warp/hemisphere/even-in-theta", half, |faulty| {
            let cos = move |u: f64| if faulty { (u * FRAC_PI_2).cos() } else { 1.0 - u };
            (direction_sampler(move |u| Some(polar(cos(u[0]), u[1]))), direction_density(|_: DVec3| 1.0 / TAU))
        })
        .mistake("θ sampled uniformly from 0 to π/2, which crowds the pole: a frequent first sampler"),
        PlantedFault::of("warp/hemisphere/disc-without-root", half, |faulty| {
            let r2 = move |u: f64| if faulty { u * u } else { u };
            let draw = move |u: [f64; 2]| Some(polar((1.0 - r2(u[0])).sqrt(), u[1]));
            (direction_sampler(draw), direction_density(|w: DVec3| w.z / PI))
        })
        .mistake("a disc sampled with radius u instead of √u, then lifted to the hemisphere"),
        PlantedFault::of("warp/hemisphere/cosine-floor", half, |faulty| {
            let least = if faulty { 0.05 } else { 0.0 };
            (cosine(), direction_density(move |w: DVec3| w.z.max(least) / PI))
        })
        .mistake("the pdf's cosine clamped to 0.05 to keep clear of divisions by zero"),
        PlantedFault::of("warp/hemisphere/sine-left-in", half, |faulty| {
            let sine = move |w: DVec3| if faulty { w.truncate().length() } else { 1.0 };
            (cosine(), direction_density(move |w: DVec3| w.z / PI * sine(w)))
        })
        .mistake("the pdf per θ and φ taken for the one per solid angle: a factor sin θ too many"),
        PlantedFault::of("warp/hemisphere/swapped-numbers", half, |faulty| {
            let inverse = move |w: [f64; 3]| {
                let [a, b] = warp::invert_cosine_hemisphere(w.into());
                if faulty { vec![b, a] } else { vec![a, b] }
            };
            (cosine().with_inverse(inverse), direction_density(|w: DVec3| w.z / PI))
        })
        .mistake(
            "the two random numbers exchanged in the inverse: directions are right, \
                stratification and replay are wrong",
        ),
        PlantedFault::of("warp/hemisphere/frame-at-the-pole", half, |faulty| {
            let axis = DVec3::Z;
            let tangent = if faulty { axis.cross(DVec3::Z).normalize() } else { DVec3::X };
            let frame = [tangent, axis.cross(tangent)];
            let draw = move |u: [f64; 2]| Some(in_lobe(axis, frame, (1.0 - u[0]).powf(1.0 / (N + 1.0)), u[1]));
            (direction_sampler(draw), direction_density(|w: DVec3| (N + 1.0) / TAU * w.z.powf(N)))
        })
        .mistake("a tangent frame from the cross product with the normal, which is 0 for the normal itself: NaN"),
        PlantedFault::of("bsdf/lobe/below-the-horizon", half, |faulty| {
            let mass = if faulty { Mass::Exactly(1.0) } else { Mass::AtMostOne };
            (lobe(1.0 / (N + 1.0)), lobe_pdf(N + 1.0).with_mass(mass))
        })
        .mistake("directions lost below the horizon forgotten: the pdf is said to integrate to 1"),
        PlantedFault::of("bsdf/lobe/exponent", half, |faulty| {
            let power = 1.0 / if faulty { N } else { N + 1.0 };
            (lobe(power), lobe_pdf(N + 1.0).with_mass(Mass::AtMostOne))
        })
        .mistake("cos α sampled as u^(1/n) instead of u^(1/(n+1)): the solid angle's own power forgotten"),
        PlantedFault::of("bsdf/lobe/factor-of-the-reflectance", half, |faulty| {
            let factor = N + if faulty { 2.0 } else { 1.0 };
            (lobe(1.0 / (N + 1.0)), lobe_pdf(factor).with_mass(Mass::AtMostOne))
        })
        .mistake("the lobe's pdf with the reflectance's factor n + 2 instead of n + 1"),
    ]
}
