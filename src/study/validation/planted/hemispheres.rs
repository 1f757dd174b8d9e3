//! Mistakes in sampling directions over a hemisphere.

use super::fault::PlantedFault;
use crate::math::circular::sin_cos_turns;
use crate::sampling::direction_density;
use crate::sampling::warp;
use etalon_stats::{Directions, Mass, Pole, Sample, density, sampler};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The unit vector at that cosine with +z and that azimuth in turns.
pub(super) fn polar(cos: f64, turns: f64) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(turns);
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Exponent of the lobes.
const N: f64 = 20.0;

/// The direction of a lobe cosⁿ around `axis`, whose tangent frame is given.
fn in_lobe(axis: DVec3, [tangent, bitangent]: [DVec3; 2], cos: f64, turns: f64) -> DVec3 {
    let w = polar(cos, turns);
    w.x * tangent + w.y * bitangent + w.z * axis
}

/// Samples from the lobe around the mirrored direction of light at 60°; where that leaves the hemisphere there is no sample.
fn lobe(power: f64) -> impl Fn(&[f64]) -> Option<Sample<[f64; 3]>> {
    let (axis, frame) = mirrored();
    move |u| {
        let w = in_lobe(axis, frame, (1.0 - u[0]).powf(power), u[1]);
        (w.z > 0.0).then(|| Sample::new(w.to_array()))
    }
}

fn mirrored() -> (DVec3, [DVec3; 2]) {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    (DVec3::new(sin, 0.0, cos), [DVec3::Y, DVec3::new(cos, 0.0, -sin)])
}

/// Its pdf with the given factor for (n + 1).
fn lobe_pdf(w: DVec3, factor: f64) -> f64 {
    factor / TAU * w.dot(mirrored().0).max(0.0).powf(N)
}

/// The faults of this family.
pub fn faults() -> Vec<PlantedFault> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        PlantedFault::of(
            "hemisphere/even-in-theta",
            "θ sampled uniformly from 0 to π/2, which crowds the pole: everyone's first sampler",
            half,
            |faulty| {
                let cos = move |u: f64| if faulty { (u * FRAC_PI_2).cos() } else { 1.0 - u };
                (
                    sampler(2, move |u| Some(Sample::new(polar(cos(u[0]), u[1]).to_array()))),
                    density(|_: [f64; 3]| 1.0 / TAU),
                )
            },
        ),
        PlantedFault::of(
            "hemisphere/disc-without-root",
            "a disc sampled with radius u instead of √u, then lifted to the hemisphere",
            half,
            |faulty| {
                let draw = move |u: &[f64]| {
                    let r2 = if faulty { u[0] * u[0] } else { u[0] };
                    Some(Sample::new(polar((1.0 - r2).sqrt(), u[1]).to_array()))
                };
                (sampler(2, draw), direction_density(|w: DVec3| w.z / PI))
            },
        ),
        PlantedFault::of(
            "hemisphere/cosine-floor",
            "the pdf's cosine clamped to 0.05 to keep clear of divisions by zero",
            half,
            |faulty| {
                let draw = |u: &[f64]| Some(Sample::new(warp::cosine_hemisphere([u[0], u[1]]).to_array()));
                let least = if faulty { 0.05 } else { 0.0 };
                (sampler(2, draw), direction_density(move |w: DVec3| w.z.max(least) / PI))
            },
        ),
        PlantedFault::of(
            "hemisphere/sine-left-in",
            "the pdf per θ and φ taken for the one per solid angle: a factor sin θ too many",
            half,
            |faulty| {
                let draw = |u: &[f64]| Some(Sample::new(warp::cosine_hemisphere([u[0], u[1]]).to_array()));
                let sine = move |w: DVec3| if faulty { w.truncate().length() } else { 1.0 };
                (sampler(2, draw), direction_density(move |w: DVec3| w.z / PI * sine(w)))
            },
        ),
        PlantedFault::of(
            "hemisphere/swapped-numbers",
            "the two random numbers exchanged in the inverse: directions come out right, stratification and replay do not",
            half,
            |faulty| {
                let draw = |u: &[f64]| Some(Sample::new(warp::cosine_hemisphere([u[0], u[1]]).to_array()));
                let inverse = move |w: [f64; 3]| {
                    let [a, b] = warp::invert_cosine_hemisphere(w.into());
                    if faulty { vec![b, a] } else { vec![a, b] }
                };
                (sampler(2, draw).with_inverse(inverse), direction_density(|w: DVec3| w.z / PI))
            },
        ),
        PlantedFault::of(
            "hemisphere/frame-at-the-pole",
            "a tangent frame from the cross product with the normal, which is 0 for the normal itself: NaN",
            half,
            |faulty| {
                let axis = DVec3::Z;
                let tangent = if faulty { axis.cross(DVec3::Z).normalize() } else { DVec3::X };
                let frame = [tangent, axis.cross(tangent)];
                let draw = move |u: &[f64]| {
                    let w = in_lobe(axis, frame, (1.0 - u[0]).powf(1.0 / (N + 1.0)), u[1]);
                    Some(Sample::new(w.to_array()))
                };
                (sampler(2, draw), direction_density(|w: DVec3| (N + 1.0) / TAU * w.z.powf(N)))
            },
        ),
        PlantedFault::of(
            "lobe/below-the-horizon",
            "directions lost below the horizon forgotten: the pdf is said to integrate to 1",
            half,
            |faulty| {
                let mass = if faulty { Mass::Exactly(1.0) } else { Mass::AtMostOne };
                (sampler(2, lobe(1.0 / (N + 1.0))), direction_density(|w| lobe_pdf(w, N + 1.0)).with_mass(mass))
            },
        ),
        PlantedFault::of(
            "lobe/exponent",
            "cos α sampled as u^(1/n) instead of u^(1/(n+1)): the solid angle's own power forgotten",
            half,
            |faulty| {
                let power = 1.0 / if faulty { N } else { N + 1.0 };
                (sampler(2, lobe(power)), direction_density(|w| lobe_pdf(w, N + 1.0)).with_mass(Mass::AtMostOne))
            },
        ),
        PlantedFault::of(
            "lobe/factor-of-the-reflectance",
            "the lobe's pdf with the reflectance's factor n + 2 instead of n + 1",
            half,
            |faulty| {
                let factor = N + if faulty { 2.0 } else { 1.0 };
                (
                    sampler(2, lobe(1.0 / (N + 1.0))),
                    direction_density(move |w| lobe_pdf(w, factor)).with_mass(Mass::AtMostOne),
                )
            },
        ),
    ]
}
