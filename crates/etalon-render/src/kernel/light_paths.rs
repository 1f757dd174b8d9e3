//! Light paths: traced from the lights, and connected to the camera where they scatter.
//!
//! The MIS weights mirror those of the camera paths: see [`crate::light_tracing`].

use super::Buffers;
use super::state::{PathRay, PathRays, Step, Vertices};
use super::surfaces::evaluate;
use crate::bsdf_lanes::{Scattered, TransportMode, eval_many};
use crate::camera::{PreparedCamera, View};
use crate::film::{PathClass, Splat};
use crate::lanes::{LANES, Rows, ZERO3, at, lanes, plain_items, set};
use crate::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH, Start, delta_ratio};
use crate::lights::SHORT;
use crate::prepared::PreparedScene;
use crate::previous::PreviousVertex;
use crate::ray_samples::{RaySamples, Streams, SubSample};
use crate::shaders::{Kind, adjoint_factor};
use etalon_core::bsdf::BsdfSample;
use etalon_core::math::Rgb;
use etalon_core::scene::Ray;
use glam::Vec3;

plain_items! { [f32; 2] = [0.0; 2] }

lanes! {
    /// Rays from vertices of light paths to the camera, and what each adds to the image if nothing is in the way.
    pub struct Connections of Connection {
        ray: Ray,
        t_max: f32,
        /// The slot of the light path.
        slot: u32,
        path_class: PathClass,
        /// Film position in pixels.
        film: [f32; 2],
        /// What it adds to a pixel whose filter has the value 1 there.
        value: Rgb,
        /// [`PreviousVertex::q`] of the whole path.
        q: f32,
    }
}

/// Traces a light path for each of the first `count` slots and appends its contributions, which stand for
/// [`SAMPLES_PER_LIGHT_PATH`] samples of a pixel, to `splats`. Returns how many rays it has traced.
pub fn trace_light_paths(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    streams: &Streams,
    count: usize,
    buffers: &mut Buffers,
    splats: &mut Vec<Splat>,
) -> usize {
    let Some(tracing) = &scene.light_tracing else { return 0 };
    let Buffers { rays, next, hits, by_material, vertex_buffers, scattered, starts, connections, .. } = buffers;
    generate_light_rays(scene, tracing, streams, count, starts, rays);
    let mut traced = 0;
    for depth in 1..=scene.request.max_depth {
        if rays.count == 0 {
            break;
        }
        scene.geometry.nearest(&rays.ray, rays.count, hits);
        traced += rays.count;
        let samples = RaySamples::of_light_paths(streams, depth);
        let step = Step { scene, camera, mode: TransportMode::Importance, samples, depth };
        (next.count, connections.count) = (0, 0);
        for group in by_material.sort(step, hits, rays.count) {
            let vertices = evaluate(step, rays, hits, group, vertex_buffers);
            if depth > 1 && vertices.kind() != Kind::Delta {
                connect_to_camera(vertices, scattered, connections);
            }
            if depth < scene.request.max_depth {
                continue_light_paths(vertices, starts, scattered, next);
            }
        }
        traced += connections.count;
        add_splats(step, connections, splats);
        std::mem::swap(rays, next);
    }
    traced
}

/// Starts the light paths; `starts` are those of the rays.
fn generate_light_rays(
    scene: &PreparedScene,
    tracing: &LightTracing,
    streams: &Streams,
    count: usize,
    starts: &mut Vec<Start>,
    rays: &mut PathRays,
) {
    let samples = RaySamples::of_light_paths(streams, 0);
    starts.clear();
    rays.count = 0;
    for slot in 0..count as u32 {
        let u = [samples.choice, samples.direct, samples.bsdf].map(|numbers| numbers.get_2d(slot, SubSample::ONLY));
        let Some(start) = tracing.start(&scene.lights, scene.environment.as_deref(), u) else { continue };
        rays.push(PathRay {
            ray: start.ray(&scene.lights),
            beta: start.power * SAMPLES_PER_LIGHT_PATH as f32,
            eta_scale: 1.0,
            previous: PreviousVertex::SPECULAR,
            slot,
            path_class: PathClass::DIRECT,
        });
        starts.push(start);
    }
}

/// Whether light goes on from a vertex in direction `wi`: the normals must agree.
fn reaches(vertices: Vertices, i: usize, wi: Vec3) -> bool {
    let [n, ns] = [&vertices.interactions.n, &vertices.interactions.ns].map(|normal| at(normal, i).dot(wi));
    n * ns > 0.0 && vertices.is_sound(i, wi)
}

/// Connects vertices at surfaces of one material to the camera.
fn connect_to_camera(vertices: Vertices, scattered: &mut Scattered, connections: &mut Connections) {
    let Vertices { step: Step { camera, .. }, interactions, frames, .. } = vertices;
    // Evaluate the BSDF and its pdf with the roles of both directions exchanged: wo to the camera, as in a camera path.
    let (mut wo, mut views) = (ZERO3, [None; LANES]);
    scattered.wi = frames.local_wo;
    for i in 0..interactions.count {
        views[i] = camera.project(frames.surface[i].position).filter(|view| reaches(vertices, i, view.direction));
        if let Some(View { direction, .. }) = views[i] {
            set(&mut wo, i, vertices.frame(i).to_local(direction));
        }
    }
    eval_many(vertices.bsdfs, &wo, interactions.count, scattered);
    for i in 0..interactions.count {
        let (f, reverse_pdf, surface) = (at(&scattered.weight, i), scattered.pdf[i], &frames.surface[i]);
        let Some(View { direction: wi, distance, film }) = views[i].filter(|_| f != Rgb::ZERO) else { continue };
        // Weight the path by MIS.
        let (light, area) = (at(&frames.wo, i), camera.area_at(surface.position));
        let ratio = vertices.projected(i, light, 1.0) / vertices.projected(i, wi, 1.0);
        let q = interactions.q[i] * ratio * reverse_pdf / LightTracing::q_at_camera(area);
        let factor = adjoint_factor(surface, light, wi) * at(&wo, i).z.abs() / area;
        connections.push(Connection {
            ray: Ray { origin: surface.ray_origin(wi), direction: wi },
            t_max: distance * SHORT,
            slot: interactions.slot[i],
            path_class: interactions.path_class[i].reversed(),
            film,
            value: at(&interactions.beta, i) * f * (factor / (1.0 + q)),
            q,
        });
    }
}

/// Appends to `next` the light paths that continue at surfaces of one material.
fn continue_light_paths(vertices: Vertices, starts: &[Start], scattered: &mut Scattered, next: &mut PathRays) {
    let Vertices { step, bsdfs, interactions, frames, .. } = vertices;
    vertices.sample(scattered);
    for i in 0..interactions.count {
        let Some(sample) = scattered.sample(i).filter(|sample| sample.weight != Rgb::ZERO) else { continue };
        let (wi, wo) = (vertices.frame(i).to_world(sample.wi), at(&frames.wo, i));
        if !reaches(vertices, i, wi) {
            continue;
        }
        // Russian roulette by the weight of this scattering, which keeps the power of a path
        let survival = sample.weight.max_element().min(1.0);
        let [_, u]: [f32; 2] = step.samples.choice.get_2d(interactions.slot[i], SubSample::ONLY);
        if u >= survival {
            continue;
        }
        let ratio = match sample.is_delta() {
            true => delta_ratio(bsdfs.at(i), &sample),
            false => vertices.projected(i, wo, 1.0) / vertices.projected(i, wi, sample.pdf),
        };
        let reverse_pdf = if sample.is_delta() { 1.0 } else { scattered.reverse_pdf[i] };
        let q = if step.depth > 1 {
            interactions.q[i] * ratio * reverse_pdf
        } else {
            let start = &starts[interactions.ray[i] as usize];
            ratio / start.density * (reverse_pdf + light_sample_density(vertices, i, start, &sample))
        };
        let beta = at(&interactions.beta, i) * sample.weight * adjoint_factor(&frames.surface[i], wo, wi) / survival;
        next.push(vertices.spawn_ray(i, wi, &sample, beta, PreviousVertex { q, ..PreviousVertex::SPECULAR }));
    }
}

/// The density with which light samples at the first vertex of a light path find its start; none do at a delta lobe.
fn light_sample_density(vertices: Vertices, i: usize, start: &Start, sample: &BsdfSample) -> f32 {
    let (scene, kind, normal) = (vertices.step.scene, vertices.kind(), at(&vertices.interactions.ns, i));
    match start.light {
        _ if sample.is_delta() => 0.0,
        Some(light) => scene.lights.density(light, vertices.frames.surface[i].position, kind.one_sided(normal)),
        None => scene.environment_density(at(&vertices.frames.wo, i), normal, kind),
    }
}

/// Moves what is not occluded to `splats`, weighted by the filters of the pixels around it.
fn add_splats(Step { scene, camera, .. }: Step, connections: &Connections, splats: &mut Vec<Splat>) {
    let mut blocked = [0; LANES];
    scene.geometry.occluded(&connections.ray, connections.count, &connections.t_max, &mut blocked);
    for i in (0..connections.count).filter(|&i| blocked[i] == 0) {
        let (path, value) = (connections.slot[i] as usize, at(&connections.value, i));
        let class = scene.classes.map_or(0, |classes| classes.index(connections.path_class[i]));
        // Camera samples of a pixel come with the density of its filter. With the densities c of camera paths and l of light paths, and
        // the light f of a path, their variance is ∫ f² c/(c + l)² beside light paths and ∫ f²/c without: for
        // each light path, which contributes v = f/(c + l), that is v² (2 + l/c) more.
        let spared = value.length_squared() * (2.0 + 1.0 / connections.q[i]);
        let splat = |pixel, weight| Splat { path, pixel, class, value: value * weight, spared: spared * weight };
        camera.pixels_around(connections.film[i], |pixel, weight| splats.push(splat(pixel, weight)));
    }
}
