//! The energy of rough metals with single scattering alone and with multiple scattering: directional albedos of a metal that
//! reflects everything, and spheres in light of radiance 1 from everywhere.

use super::object_ids::ObjectIdBuffer;
use super::pixel_mean::Mean;
use crate::bsdf::{Bsdf, Scatter};
use crate::error::Result;
use crate::math::Rgb;
use crate::optics::metals::{self, Metal};
use crate::raster::Image;
use crate::render::{Settings, Silent, render};
use crate::scene::{Conductor, Distribution, Material, Request, ScatterModel, Scene, builtin};
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// The directional albedo of a metal that reflects everything, for one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct AlbedoRow {
    /// Distribution of the microfacets' normals.
    pub distribution: &'static str,
    /// Angle to the normal in degrees.
    pub theta_deg: f64,
    /// Width of the distribution.
    pub alpha: f32,
    /// With single scattering alone.
    pub single: f64,
    /// With multiple scattering.
    pub multiple: f64,
}

/// The distributions by name.
pub const DISTRIBUTIONS: [(&str, Distribution); 2] = [("GGX", Distribution::Ggx), ("Beckmann", Distribution::Beckmann)];

/// Directions of the albedos, in degrees from the normal.
pub const THETAS_DEG: [f64; 3] = [0.0, 60.0, 85.0];

/// The albedos for all distributions and directions over `alphas`, each by so many samples.
pub fn albedos(alphas: &[f32], samples: u32) -> Vec<AlbedoRow> {
    let mut rows = Vec::new();
    for (distribution, kind) in DISTRIBUTIONS {
        let of_alpha = |&alpha: &f32| {
            // Preparing multiple scattering takes longer than sampling it.
            let bsdfs = [false, true].map(|multiple_scattering| {
                let metal = Conductor::new(Rgb::ZERO, Rgb::ONE, alpha, kind);
                Material::Conductor(Conductor { multiple_scattering, ..metal }).bsdf(ScatterModel::default())
            });
            THETAS_DEG.map(|theta_deg: f64| {
                let wo = Vec3::new(theta_deg.to_radians().sin() as f32, 0.0, theta_deg.to_radians().cos() as f32);
                let single = albedo(&bsdfs[0], wo, samples);
                let multiple = single + added(&bsdfs, wo, samples / 16);
                AlbedoRow { distribution, theta_deg, alpha, single, multiple }
            })
        };
        let by_alpha: Vec<_> = alphas.par_iter().map(of_alpha).collect();
        rows.extend((0..THETAS_DEG.len()).flat_map(|i| by_alpha.iter().map(move |rows| rows[i])));
    }
    rows
}

/// ∫ f cos θᵢ dωᵢ: the mean weight of samples.
fn albedo(bsdf: &Bsdf, wo: Vec3, samples: u32) -> f64 {
    let weight = |u| bsdf.sample(wo, 0.0, u).map_or(0.0, |sample| f64::from(sample.weight.x));
    points(samples).map(weight).sum::<f64>() / f64::from(samples)
}

/// The same of the second BSDF minus the first, whose difference is smooth, by directions of pdf cos θᵢ/π.
fn added(bsdfs: &[Bsdf; 2], wo: Vec3, samples: u32) -> f64 {
    let difference = |[u, v]: [f32; 2]| {
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        let wi = Vec3::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt());
        let [first, second] = bsdfs.each_ref().map(|bsdf| f64::from(bsdf.eval(wo, wi).x));
        second - first
    };
    PI * points(samples).map(difference).sum::<f64>() / f64::from(samples)
}

/// Points of the unit square by additive recurrence with 1/g and 1/g², g³ = g + 1.
///
/// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
fn points(count: u32) -> impl Iterator<Item = [f32; 2]> {
    const G: f64 = 1.324_717_957_244_746;
    // A number that rounds to 1 is the one before.
    let number = |i: u32, step: f64| ((0.5 + f64::from(i) * step).fract() as f32).min(1.0f32.next_down());
    (0..count).map(move |i| [number(i, 1.0 / G), number(i, 1.0 / (G * G))])
}

/// The widths of the rendered spheres, from left to right.
pub const ALPHAS: [f32; 4] = [0.25, 0.5, 0.75, 1.0];

/// Spheres of one metal in light of radiance 1 from everywhere.
pub struct Spheres {
    /// Name of the metal.
    pub metal: &'static str,
    /// Whether they have multiple scattering.
    pub multiple: bool,
    /// The mean radiance of each.
    pub radiance: [Mean; 4],
    /// Samples that were not finite or negative.
    pub dropped: u64,
    /// The render.
    pub image: Image,
}

/// Renders spheres of GGX, of a metal that reflects everything and of gold, each with single and with multiple scattering.
///
/// # Errors
/// Those of the renders.
pub fn spheres(spp: u32, size: [usize; 2], settings: &Settings) -> Result<Vec<Spheres>> {
    let gold: &Metal = metals::GOLD;
    let indices = [("reflects everything", Rgb::ZERO, Rgb::ONE), ("gold", gold.eta_rgb(), gold.k_rgb())];
    let mut results = Vec::new();
    for (metal, eta, k) in indices {
        for multiple_scattering in [false, true] {
            let (mut scene, request) = builtin::furnace();
            for (object, alpha) in scene.objects.iter_mut().zip(ALPHAS) {
                let conductor = Conductor::new(eta, k, alpha, Distribution::Ggx);
                object.material = Material::Conductor(Conductor { multiple_scattering, ..conductor });
            }
            let (scene, request) = scene.resized(Request { spp, ..request }, size);
            let rendered = render(&scene, &request, settings, &Silent)?;
            let radiance = std::array::from_fn(|i| Mean::of(&rendered.part.film, &shows(&scene, &request, i)));
            let dropped = rendered.dropped.total();
            results.push(Spheres { metal, multiple: multiple_scattering, radiance, dropped, image: rendered.image });
        }
    }
    Ok(results)
}

/// Which pixels show the sphere of this number.
fn shows(scene: &Scene, request: &Request, number: usize) -> Vec<bool> {
    let alone = Scene { objects: vec![scene.objects[number].clone()], ..scene.clone() };
    ObjectIdBuffer::new(&alone, request).pixels.iter().map(Option::is_some).collect()
}
