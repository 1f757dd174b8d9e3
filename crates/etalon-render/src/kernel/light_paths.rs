//! Light paths: traced from the lights, and connected to the camera where they scatter.
//!
//! The MIS weights mirror those of the camera paths: see [`crate::light_tracing`].

use super::state::{Interaction, Vertices};
use super::surfaces::{ByMaterial, GroupMaterial, shading_frame};
use crate::bsdf_lanes::{Bsdfs, Scattered, TransportMode, eval_many, reverse_pdf_many, sample_many};
use crate::camera::{PreparedCamera, View};
use crate::film::{PathClass, Splat};
use crate::lanes::{Hits, LANES, Lane, Lane3, Ray, Rays, Rows, ZERO3, at, lanes, plain_items, set};
use crate::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH, delta_ratio};
use crate::lights::SHORT;
use crate::prepared::PreparedScene;
use crate::ray_samples::{RaySamples, Streams, SubSample};
use crate::shaders::{Kind, SurfaceShader, adjoint_factor, is_sound};
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::Rgb;
use glam::Vec3;

lanes! {
    /// Light paths in flight: the ray of each, and what it carries.
    pub struct LightPaths of LightPath {
        ray: Ray,
        power: Rgb,
        previous: PreviousOfLight,
        /// The slot of its random numbers.
        slot: u32,
        /// The kinds of scattering so far.
        path_class: PathClass,
    }
}

/// The vertex before a ray of a light path, as far as the MIS weight needs it.
#[derive(Clone, Copy)]
pub enum PreviousOfLight {
    /// It is on a light (`None`: the environment), with this density.
    Light { light: Option<u32>, density: f32 },
    /// Σ density of another technique / density of light tracing, without the factors of the vertices to come.
    Surface { others: f32 },
}

plain_items! { PreviousOfLight = PreviousOfLight::Surface { others: 0.0 } }

/// The buffers of a thread, which hold nothing between batches.
#[derive(Default)]
pub struct LightPathBuffers {
    paths: Box<LightPaths>,
    next: Box<LightPaths>,
    hits: Box<Hits>,
    by_material: ByMaterial,
    vertices: Box<Vertices>,
    scattered: Box<Scattered>,
    connections: Connections,
    /// The BSDFs of vertices on an object with textures.
    varying: Vec<Bsdf>,
}

/// Light that reaches the camera at a film position.
struct Contribution {
    /// The slot of its path.
    slot: u32,
    /// In pixels.
    film: [f32; 2],
    /// The number of the path's class.
    class: usize,
    /// What it adds to a pixel whose filter has the value 1 there.
    value: Rgb,
    /// Σ density of other techniques / density of light tracing.
    others: f32,
}

/// Rays to the camera, and what each adds to the image if it is not occluded.
struct Connections {
    contributions: Vec<Contribution>,
    rays: Box<Rays>,
    t_max: Lane,
    /// The vertices on one object that the camera may see, by number, and the BSDFs there if it has textures.
    views: Vec<(usize, View)>,
    varying: Vec<Bsdf>,
}

impl Default for Connections {
    fn default() -> Self {
        Self {
            contributions: Vec::new(),
            rays: Box::default(),
            t_max: [0.0; LANES],
            views: Vec::new(),
            varying: Vec::new(),
        }
    }
}

/// Traces a light path for each of the first `count` slots and appends its contributions, which stand for
/// [`SAMPLES_PER_LIGHT_PATH`] samples of a pixel, to `splats`. Returns how many rays it has traced.
pub fn trace_light_paths(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    streams: &Streams,
    count: usize,
    buffers: &mut LightPathBuffers,
    splats: &mut Vec<Splat>,
) -> usize {
    let Some(tracing) = &scene.light_tracing else { return 0 };
    let LightPathBuffers { paths, next, hits, by_material, vertices, scattered, connections, varying } = buffers;
    start(scene, tracing, streams, count, paths);
    let mut traced = 0;
    for scatterings in 0..scene.request.max_depth {
        if paths.count == 0 {
            break;
        }
        scene.geometry.nearest(&paths.ray, paths.count, hits);
        traced += paths.count;
        let samples = RaySamples::of_light_paths(streams, scatterings + 1);
        next.count = 0;
        // Light paths start towards surfaces that are not diffuse.
        let group = |i: usize, shader: &SurfaceShader| {
            let is_start = matches!(paths.previous[i], PreviousOfLight::Light { .. }) && shader.kind.is_diffuse();
            (shader.bsdf.is_reciprocal() && !is_start).then_some(hits.object[i])
        };
        for group in by_material.sort(scene, hits, paths.count, group) {
            let shader = evaluate_vertices(scene, paths, hits, group, vertices);
            if scatterings > 0 && shader.kind != Kind::Delta {
                connections.add(scene, camera, shader, paths, vertices, scattered);
            }
            if scatterings + 1 < scene.request.max_depth {
                let bsdfs = Bsdfs::of(shader, &vertices.frames.uv[..vertices.frames.count], varying);
                scatter(scene, samples, GroupMaterial { shader, bsdfs }, paths, vertices, scattered, next);
            }
        }
        traced += connections.contributions.len();
        connections.splat(scene, camera, splats);
        std::mem::swap(paths, next);
    }
    traced
}

/// Starts the light paths.
fn start(scene: &PreparedScene, tracing: &LightTracing, streams: &Streams, count: usize, paths: &mut LightPaths) {
    let samples = RaySamples::of_light_paths(streams, 0);
    paths.count = 0;
    for slot in 0..count as u32 {
        let u = [samples.choice, samples.direct, samples.bsdf].map(|numbers| numbers.get_2d_f64(slot, SubSample::ONLY));
        let Some(start) = tracing.start(&scene.lights, scene.environment.as_deref(), u) else { continue };
        let offset = |light: u32| scene.lights.all[light as usize].offset(start.origin);
        let offset = start.light.map_or(0.0, offset).copysign(start.normal.dot(start.direction));
        paths.push(LightPath {
            ray: Ray { origin: start.origin + start.normal * offset, direction: start.direction },
            power: start.power * SAMPLES_PER_LIGHT_PATH as f32,
            previous: PreviousOfLight::Light { light: start.light, density: start.density },
            slot,
            path_class: PathClass::DIRECT,
        });
    }
}

/// Evaluates the surfaces that these paths, all on one object, have hit, where both normals agree about the light.
fn evaluate_vertices<'a>(
    scene: &'a PreparedScene,
    paths: &LightPaths,
    hits: &Hits,
    group: &[u32],
    vertices: &mut Vertices,
) -> &'a SurfaceShader {
    let Vertices { interactions, frames } = vertices;
    let shader = &scene.shaders[hits.object[group[0] as usize] as usize];
    (interactions.count, frames.count) = (0, 0);
    for &ray in group {
        let i = ray as usize;
        let (frame, ns) = shading_frame(scene, shader, &paths.ray, hits, i);
        let (n, origin) = (frame.surface.normal, frame.surface.position);
        if is_sound([n, frame.surface.shading], frame.wo) {
            let (slot, beta) = (paths.slot[i], at(&paths.power, i));
            let path_class = paths.path_class[i].then_diffuse();
            frames.push(frame);
            interactions.push(Interaction { ray, slot, n, ns, origin, beta, path_class, q: 0.0 });
        }
    }
    shader
}

/// The direction in which a light path goes on from a vertex, with its pdf, and the pdf of a camera path's direction to the vertex
/// before.
struct Continuation {
    wi: Vec3,
    pdf: f32,
    reverse_pdf: f32,
}

impl Vertices {
    /// Whether light goes on in direction `wi`: the normals must agree.
    fn reaches(&self, i: usize, wi: Vec3) -> bool {
        let [n, ns] = [&self.interactions.n, &self.interactions.ns].map(|normal| at(normal, i).dot(wi));
        n * ns > 0.0 && self.is_sound(i, wi)
    }

    /// The densities of the techniques of camera paths, summed, over that of light tracing, for light paths that go on from a
    /// surface of this kind.
    fn others(
        &self,
        scene: &PreparedScene,
        paths: &LightPaths,
        kind: Kind,
        i: usize,
        Continuation { wi, pdf, reverse_pdf }: Continuation,
    ) -> f32 {
        let wo = at(&self.frames.wo, i);
        let ratio = self.projected(i, wo, 1.0) / self.projected(i, wi, pdf);
        match paths.previous[self.interactions.ray[i] as usize] {
            PreviousOfLight::Surface { others } => others * ratio * reverse_pdf,
            PreviousOfLight::Light { light, density } => {
                let normal = at(&self.interactions.ns, i);
                let by_light = match light {
                    Some(light) => scene.lights.density(light, self.surface(i).position, kind.one_sided(normal)),
                    None => scene.environment_density(wo, normal, kind),
                };
                ratio / density * (reverse_pdf + by_light)
            }
        }
    }
}

/// Samples the directions in which the paths continue at vertices on one object.
fn scatter(
    scene: &PreparedScene,
    samples: RaySamples,
    material: GroupMaterial,
    paths: &LightPaths,
    vertices: &Vertices,
    scattered: &mut Scattered,
    next: &mut LightPaths,
) {
    let Vertices { interactions, frames } = vertices;
    let (count, slots) = (interactions.count, &interactions.slot[..interactions.count]);
    let u = samples.bsdf.get_2d_lanes(slots, SubSample::ONLY);
    let [choice, roulette] = samples.choice.get_2d_lanes(slots, SubSample::ONLY);
    let (bsdfs, u) = (material.bsdfs, [&choice, &u[0], &u[1]]);
    sample_many(scene.arch, bsdfs, TransportMode::Importance, &frames.local_wo, u, count, scattered);
    reverse_pdf_many(scene.arch, bsdfs, &frames.local_wo, count, scattered);
    for i in 0..count {
        let path = interactions.ray[i] as usize;
        let Some(sample) = scattered.sample(i) else { continue };
        let wi = vertices.frame(i).to_world(sample.wi);
        if sample.weight == Rgb::ZERO || !vertices.reaches(i, wi) {
            continue;
        }
        let others = if sample.is_delta() {
            let ratio = delta_ratio(bsdfs.at(i), &sample);
            match paths.previous[path] {
                PreviousOfLight::Surface { others } => others * ratio,
                PreviousOfLight::Light { density, .. } => ratio / density,
            }
        } else {
            let onward = Continuation { wi, pdf: sample.pdf, reverse_pdf: scattered.reverse_pdf[i] };
            vertices.others(scene, paths, material.kind(), i, onward)
        };
        let factor = adjoint_factor(vertices.surface(i), at(&frames.wo, i), wi);
        let power = at(&interactions.beta, i) * sample.weight * factor;
        // Russian roulette by the weight of this scattering, which keeps the power of a path
        let survival = sample.weight.max_element().min(1.0);
        if roulette[i] >= survival {
            continue;
        }
        next.push(LightPath {
            ray: Ray { origin: vertices.surface(i).ray_origin(wi), direction: wi },
            power: power / survival,
            previous: PreviousOfLight::Surface { others },
            slot: interactions.slot[i],
            path_class: if sample.is_delta() {
                paths.path_class[path].then_specular()
            } else {
                interactions.path_class[i]
            },
        });
    }
}

impl Connections {
    /// Connects vertices on one object to the camera.
    fn add(
        &mut self,
        scene: &PreparedScene,
        camera: &PreparedCamera,
        shader: &SurfaceShader,
        paths: &LightPaths,
        vertices: &Vertices,
        scattered: &mut Scattered,
    ) {
        // Evaluate the BSDF and its pdf with the roles of both directions exchanged: wo to the camera, as in a camera path.
        let Self { contributions, rays, t_max, views, varying } = self;
        let Vertices { interactions, frames } = vertices;
        let (mut wo, mut uv): (Lane3, _) = (ZERO3, Vec::new());
        for i in 0..interactions.count {
            let view = camera.project(frames.surface[i].position).filter(|view| vertices.reaches(i, view.direction));
            if let Some(view) = view {
                set(&mut wo, views.len(), vertices.frame(i).to_local(view.direction));
                set(&mut scattered.wi, views.len(), at(&frames.local_wo, i));
                uv.push(frames.uv[i]);
                views.push((i, view));
            }
        }
        let bsdfs = Bsdfs::of(shader, &uv, varying);
        eval_many(scene.arch, bsdfs, &wo, views.len(), scattered);
        for (k, (i, view)) in views.drain(..).enumerate() {
            let (f, reverse_pdf) = (at(&scattered.weight, k), scattered.pdf[k]);
            if f == Rgb::ZERO {
                continue;
            }
            // Weight the path by MIS.
            let (surface, wi) = (vertices.surface(i), view.direction);
            let area = camera.area_at(surface.position);
            let others = vertices.others(scene, paths, shader.kind, i, Continuation { wi, pdf: 1.0, reverse_pdf });
            let others = others / LightTracing::q_at_camera(area);
            let factor = adjoint_factor(surface, at(&frames.wo, i), wi) * at(&wo, k).z.abs() / area;
            let path_class = interactions.path_class[i].reversed();
            rays.set(contributions.len(), Ray { origin: surface.ray_origin(wi), direction: wi });
            t_max[contributions.len()] = view.distance * SHORT;
            contributions.push(Contribution {
                slot: interactions.slot[i],
                film: view.film,
                class: scene.classes.map_or(0, |classes| classes.index(path_class)),
                value: at(&interactions.beta, i) * f * (factor / (1.0 + others)),
                others,
            });
        }
    }

    /// Moves what is not occluded to `splats`, weighted by the filters of the pixels around it.
    fn splat(&mut self, scene: &PreparedScene, camera: &PreparedCamera, splats: &mut Vec<Splat>) {
        let mut blocked = [0; LANES];
        scene.geometry.occluded(&self.rays, self.contributions.len(), &self.t_max, &mut blocked);
        for (Contribution { slot, film, class, value, others }, blocked) in self.contributions.drain(..).zip(blocked) {
            if blocked == 0 {
                // Camera samples of a pixel come with the density of its filter. With the densities c of camera paths and l of light paths, and
                // the light f of a path, their variance is ∫ f² c/(c + l)² beside light paths and ∫ f²/c without: for
                // each light path, which contributes v = f/(c + l), that is v² (2 + l/c) more.
                let spared = value.length_squared() * (2.0 + 1.0 / others);
                let path = slot as usize;
                let splat =
                    |pixel, weight| Splat { path, pixel, class, value: value * weight, spared: spared * weight };
                camera.pixels_around(film, |pixel, weight| splats.push(splat(pixel, weight)));
            }
        }
    }
}
