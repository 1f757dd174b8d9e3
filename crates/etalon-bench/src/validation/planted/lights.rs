//! Mistakes in sampling directions towards lights, and in choosing among lights; in light tracing, and in weighting techniques
//! against each other. The latter are each made in a case of the suite, that is in what the kernel itself calls.

use super::super::case::{Case, direction_density, direction_sampler};
use super::super::suite::adjoint::{KERNEL, LightPaths, adjoint, equal_means, glass};
use super::super::suite::light_paths::{TARGETS, direction, shapes};
use super::super::suite::lights::{Pmf, TRIANGLES, pmf, selection, triangle};
use super::super::suite::renders::{Plant, RenderTest, Split, finer};
use super::super::suite::techniques::{FINE, glass_and_mirror, image, rough_metal};
use super::fault::PlantedFault;
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::Rgb;
use etalon_core::scene::{Material, ScatterModel, Scene};
use etalon_render::probe::SAMPLES_PER_LIGHT_PATH;
use etalon_render::{Sampling, Settings};
use etalon_stats::{Density, Directions, Line, Pole, Sample, Sampler, density, sampler};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Cosines of the cones of two spheres, one above and one below.
const ABOVE: f64 = 0.8;
const BELOW: f64 = 0.6;

/// The direction of that cosine with +y.
fn upright(cos: f64, turns: f64) -> DVec3 {
    let w = super::warps::polar(cos, turns);
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

pub fn lights() -> Vec<PlantedFault> {
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

/// A case with the mistake and without it.
fn planted(name: &'static str, make: impl Fn(String, bool) -> Case) -> PlantedFault {
    let [faulty, sound] = [("planted", true), ("sound", false)].map(|(kind, is)| make(format!("{kind}/{name}"), is));
    PlantedFault { name, mistake: "", faulty, sound }
}

/// An image by `mis+lt` with two light samples at each hit, whose camera paths or light paths have a mistake.
fn image_with(name: &'static str, scene: fn() -> Scene, split: Split) -> PlantedFault {
    let by = |sampling| Settings { sampling, ..Settings::default() };
    planted(name, |name, faulty| {
        let test = image(scene(), by(Sampling::MisLt), by(Sampling::Mis));
        let test = RenderTest { plant: faulty.then_some(Plant::Split(split)), ..test };
        Case::new(name, move |protocol, round| test.examine(&finer(protocol, FINE), round, |_| ()))
    })
}

/// A mistake in how light paths scatter.
fn scattered(name: &'static str, bsdf: Bsdf, degrees: f32, wrong: LightPaths) -> PlantedFault {
    planted(name, |name, faulty| adjoint(name, bsdf.clone(), degrees, if faulty { wrong } else { KERNEL }))
}

/// Radiance 1 after each scattering of albedo ¾, by a path that roulette ends with probability ½ once its throughput is
/// below 1/10.
fn roulette(u: [[f64; 2]; 3], compensated: bool) -> f64 {
    let (mut sum, mut throughput, mut u) = (0.0, 1.0, u[0][0]);
    loop {
        sum += throughput;
        throughput *= 0.75;
        if throughput < 0.1 {
            if u < 0.5 {
                return sum;
            }
            u = 2.0 * u - 1.0;
            throughput *= if compensated { 2.0 } else { 1.0 };
        }
    }
}

pub fn light_paths() -> Vec<PlantedFault> {
    let by = |sampling| Settings { sampling, ..Settings::default() };
    let kernel = Split { settings: by(Sampling::MisLt), light_samples: 2, widths: 1, factor: 1.0 };
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) }.bsdf(ScatterModel::default());
    let without_normal: Pmf = |tree, point, _, light| tree.at(point, None).pmf(light);
    vec![
        image_with("light-path/missing-technique", glass_and_mirror, Split { settings: by(Sampling::Mis), ..kernel })
            .mistake(
                "MIS weights of camera paths without light tracing, those of light paths with it: the sum exceeds 1",
            ),
        image_with("light-path/half-the-density", rough_metal, Split { widths: 2, ..kernel })
            .mistake("MIS weights of camera paths with twice the density of light tracing: the sum is below 1"),
        image_with("light-path/light-samples-forgotten", rough_metal, Split { light_samples: 16, ..kernel })
            .mistake("camera paths take 16 light samples at each hit, the MIS weights of light paths count two"),
        image_with(
            "light-path/number-forgotten",
            glass_and_mirror,
            Split { factor: 1.0 / f64::from(SAMPLES_PER_LIGHT_PATH), ..kernel },
        )
        .mistake("one light path for several camera samples, and their contributions not multiplied by that number"),
        scattered("light-path/shading-normal", diffuse, 25.0, LightPaths { factor: |_, _, _| 1.0, ..KERNEL })
            .mistake("light paths without the factor for shading normals: the adjoint of Veach, section 5.3"),
        scattered("light-path/squared-index", glass(), 0.0, LightPaths { sample: Bsdf::sample, ..KERNEL })
            .mistake("light paths refracted as radiance is: 1/η² too much"),
        planted("light-path/one-target", |name, faulty| {
            let [(_, shape), ..] = shapes();
            let claim = if faulty { |pdf, containing: usize| pdf / containing.max(1) as f64 } else { |pdf, _| pdf };
            direction(name, shape, TARGETS[1].1, claim)
        })
        .mistake("the density of light paths as if a direction belonged to one target, where two overlap"),
        planted("light-path/roulette", |name, faulty| {
            equal_means(name, [Box::new(move |u| roulette(u, !faulty)), Box::new(|_| 4.0)])
        })
        .mistake("Russian roulette without compensation: the surviving paths not divided by their probability"),
        planted("light/tree-without-normal", |name, faulty| {
            let normal = Some(Vec3::new(-0.6, 0.8, 0.0));
            let pmf = if faulty { without_normal } else { pmf };
            selection(name, 200, Vec3::new(0.4, 0.6, 0.3), normal, pmf)
        })
        .mistake("lights chosen by place and normal, but the probability of the choice by the place alone"),
        planted("light/triangle-per-area", |name, faulty| {
            triangle(name, TRIANGLES[1].1, if faulty { |_, area| 1.0 / area } else { |pdf, _| pdf })
        })
        .mistake("a triangle sampled by solid angle, and the pdf of uniform sampling by area"),
    ]
}
