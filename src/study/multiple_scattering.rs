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
                let [single, multiple] = bsdfs.each_ref().map(|bsdf| albedo(bsdf, theta_deg.to_radians(), samples));
                AlbedoRow { distribution, theta_deg, alpha, single, multiple }
            })
        };
        let by_alpha: Vec<_> = alphas.par_iter().map(of_alpha).collect();
        rows.extend((0..THETAS_DEG.len()).flat_map(|i| by_alpha.iter().map(move |rows| rows[i])));
    }
    rows
}

/// ∫ f cos θᵢ dωᵢ: the mean weight of samples by additive recurrence with the powers of 1/g, g⁴ = g + 1.
///
/// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
fn albedo(bsdf: &Bsdf, theta: f64, samples: u32) -> f64 {
    const G: f64 = 1.220_744_084_605_759_5;
    let wo = Vec3::new(theta.sin() as f32, 0.0, theta.cos() as f32);
    let weights = (0..samples).map(|i| {
        let number = |power: i32| (0.5 + f64::from(i) * G.powi(-power)).fract() as f32;
        // A number that rounds to 1 is the next to it.
        let [x, y, uc] = [1, 2, 3].map(|power| number(power).min(1.0f32.next_down()));
        bsdf.sample(wo, uc, [x, y]).map_or(0.0, |sample| f64::from(sample.weight.x))
    });
    weights.sum::<f64>() / f64::from(samples)
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
