//! The path tracer in lanes: the algorithm of [`super::reference`], for [`LANES`] paths at once.
//!
//! The paths take one step together, stage by stage, as in a wavefront path tracer: intersect the rays with the scene; add the
//! light of those that escape and of the emitters that are hit; and for the interactions with each material sample direct light,
//! trace shadow rays, and sample the BSDF, whose directions are the rays of the next step. Loops over the paths of a stage
//! vectorize. Every random number is a function of its pixel, sample and purpose, so the radiance of a path has the same bits
//! whichever paths share its batch.
//!
//! Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, chapter 15 (the stages of the wavefront
//! integrator).

mod direct;
mod light_paths;
mod scatter;
mod state;
mod surfaces;

pub use light_paths::trace_light_paths;

use super::bsdf_lanes::{Scattered, TransportMode};
use super::camera::PreparedCamera;
use super::film::PathClass;
use super::lanes::{Hits, LANES, Rows, at, set};
use super::light_tracing::Start;
use super::prepared::{PreparedScene, ROULETTE_AFTER, ROULETTE_BELOW};
use super::previous::PreviousVertex;
use super::radiance::Radiance;
use super::ray_samples::{Streams, SubSample};
use super::shaders::Kind;
use direct::{DirectLight, sample_direct_light};
use light_paths::Connections;
use scatter::sample_bsdf;
use state::{PathRays, Step, VertexBuffers};
use surfaces::{ByMaterial, evaluate};

/// The buffers of a thread, which hold nothing between batches.
#[derive(Default)]
pub struct Buffers {
    rays: Box<PathRays>,
    next: Box<PathRays>,
    hits: Box<Hits>,
    by_material: ByMaterial,
    vertex_buffers: Box<VertexBuffers>,
    scattered: Box<Scattered>,
    direct: DirectLight,
    /// What light paths alone use.
    starts: Vec<Start>,
    connections: Box<Connections>,
}

/// The pixels of camera samples: of each slot the column, all in one row.
#[derive(Clone, Copy)]
pub struct Pixels<'a> {
    pub columns: &'a [u32; LANES],
    pub row: u32,
    /// Slots in use.
    pub count: usize,
}

/// Traces the camera samples of these pixels.
pub fn trace(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    pixels: Pixels,
    streams: &Streams,
    buffers: &mut Buffers,
    radiance: &mut Radiance,
) {
    let Buffers { rays, next, hits, by_material, vertex_buffers, scattered, direct, .. } = buffers;
    radiance.clear(pixels.count);
    generate_camera_rays(camera, pixels, streams, rays);
    for depth in 0..=scene.request.max_depth {
        if rays.count == 0 {
            break;
        }
        scene.geometry.nearest(&rays.ray, rays.count, hits);
        radiance.work.rays += rays.count;
        add_emission(scene, rays, hits, depth, radiance);
        if depth == scene.request.max_depth {
            break;
        }
        let samples = scene.ray_samples(streams, depth);
        let step = Step { scene, camera, mode: TransportMode::Radiance, samples, depth };
        next.count = 0;
        for group in by_material.sort(step, hits, rays.count) {
            let vertices = evaluate(step, rays, hits, group, vertex_buffers);
            if vertices.kind() != Kind::Delta {
                sample_direct_light(vertices, scattered, direct, radiance);
            }
            sample_bsdf(vertices, scattered, next);
        }
        if depth >= ROULETTE_AFTER {
            russian_roulette(step, next);
        }
        std::mem::swap(rays, next);
    }
}

fn generate_camera_rays(camera: &PreparedCamera, pixels: Pixels, streams: &Streams, rays: &mut PathRays) {
    let Pixels { columns, row, count } = pixels;
    rays.count = count;
    for (slot, number) in rays.slot[..count].iter_mut().zip(0..) {
        *slot = number;
    }
    let u = streams.film().get_2d_lanes(&rays.slot[..count], SubSample::ONLY);
    camera.rays(columns, row, &u, count, &mut rays.ray);
    for channel in &mut rays.beta {
        channel[..count].fill(1.0);
    }
    rays.eta_scale[..count].fill(1.0);
    rays.previous[..count].fill(PreviousVertex::SPECULAR);
    rays.path_class[..count].fill(PathClass::DIRECT);
}

/// Adds the light that rays have found: of the environment where they have left the scene, and of emissive surfaces.
fn add_emission(scene: &PreparedScene, rays: &PathRays, hits: &Hits, depth: u32, radiance: &mut Radiance) {
    for i in 0..rays.count {
        if let Some(light) = scene.light_found(&rays.ray, hits, i, depth, Some(&rays.previous[i])) {
            radiance.add(rays.slot[i], rays.path_class[i], at(&rays.beta, i) * light);
        }
    }
}

/// Ends paths of low throughput at random and raises the throughput of the survivors. The scale of radiance in a medium of index η,
/// 1/η², does not count: it is undone where the path leaves the medium.
fn russian_roulette(step: Step, rays: &mut PathRays) {
    rays.retain(|rays, i| {
        let beta = at(&rays.beta, i);
        let survival = (rays.eta_scale[i] * beta.max_element() * ROULETTE_BELOW.recip()).min(1.0);
        let [_, u]: [f32; 2] = step.samples.choice.get_2d(rays.slot[i], SubSample::ONLY);
        set(&mut rays.beta, i, beta / survival);
        u < survival
    });
}
