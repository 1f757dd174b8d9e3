//! Light paths: traced from the lights, and connected to the camera where they scatter.
//!
//! The MIS weights mirror those of the camera paths: see [`crate::render::light_tracing`].

use super::step::Step;
use crate::bsdf::Scatter;
use crate::math::{Frame, Rgb};
use crate::render::film::{PathClass, Splat};
use crate::render::geometry::Surface;
use crate::render::lanes::{Hits, LANES, Lane, NOTHING, Rays, at, set};
use crate::render::lens::Lens;
use crate::render::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH, delta_ratio, projected};
use crate::render::prepared::{Dimensions, PreparedScene, SHORT_OF_LIGHT};
use crate::render::sample_lanes::SampleLanes;
use crate::render::shaders::{Kind, SurfaceShader};
use crate::render::shading_normal::{adjoint_factor, is_sound};
use glam::Vec3;

/// A light path in flight. Its ray is in [`LightPathBuffers`].
#[derive(Clone, Copy)]
struct LightPath {
    /// Power that it carries.
    power: Rgb,
    last: LastVertex,
    /// The slot of its random numbers.
    slot: u32,
    /// The kinds of scattering so far.
    path_class: PathClass,
}

/// What the MIS weight needs of the path up to its last vertex.
#[derive(Clone, Copy)]
enum LastVertex {
    /// It has just left a light (`None`: the environment), with this density.
    Light { light: Option<u32>, density: f32 },
    /// Σ (density of another technique / density of light tracing)², without the factors of the vertices to come.
    Scattering { others: f32 },
}

/// The buffers of a thread, which hold nothing between batches.
#[derive(Default)]
pub struct LightPathBuffers {
    paths: Vec<LightPath>,
    rays: Box<Rays>,
    hits: Box<Hits>,
    connections: Connections,
}

/// Rays to the camera, and what each adds to the image if it is not occluded.
struct Connections {
    splats: Vec<Splat>,
    rays: Box<Rays>,
    limits: Lane,
}

impl Default for Connections {
    fn default() -> Self {
        Self { splats: Vec::new(), rays: Box::default(), limits: [0.0; LANES] }
    }
}

/// Traces a light path for each of the first `count` slots and appends its contributions, which stand for
/// [`SAMPLES_PER_LIGHT_PATH`] samples of a pixel, to `splats`.
pub fn trace_light_paths(
    scene: &PreparedScene,
    lens: &Lens,
    (numbers, count): (&SampleLanes, usize),
    buffers: &mut LightPathBuffers,
    splats: &mut Vec<Splat>,
) {
    let Some(tracing) = &scene.light_tracing else { return };
    let LightPathBuffers { paths, rays, hits, connections } = buffers;
    start(scene, tracing, (numbers, count), paths, rays);
    for scatterings in 0..scene.request.max_depth {
        if paths.is_empty() {
            return;
        }
        scene.geometry.nearest(rays, paths.len(), hits);
        let step = Step { scene, numbers, scatterings };
        let mut kept = 0;
        for i in 0..paths.len() {
            if hits.object[i] == NOTHING {
                continue;
            }
            let Some(vertex) = Vertex::new(scene, rays, hits, i, paths[i]) else { continue };
            if scatterings > 0 {
                vertex.connect(scene, lens, connections);
            }
            if let Some((path, [origin, direction])) = vertex.scatter(step) {
                paths[kept] = path;
                set(&mut rays.origin, kept, origin);
                set(&mut rays.direction, kept, direction);
                kept += 1;
            }
        }
        paths.truncate(kept);
        connections.splat(scene, splats);
    }
    paths.clear();
}

/// Starts the light paths.
fn start(
    scene: &PreparedScene,
    tracing: &LightTracing,
    (numbers, count): (&SampleLanes, usize),
    paths: &mut Vec<LightPath>,
    rays: &mut Rays,
) {
    let dimensions = Dimensions::of_light_paths(0);
    paths.clear();
    for slot in 0..count as u32 {
        let pair = |dimension| numbers.pair(slot, dimension, (0, 1));
        let u = [dimensions.choice(), dimensions.bsdf_direct(), dimensions.bsdf()].map(pair);
        let Some(start) = tracing.start(&scene.lights, u) else { continue };
        let offset = |light: u32| scene.geometry.offset(scene.lights.all[light as usize].object);
        let offset = start.light.map_or(0.0, offset).copysign(start.normal.dot(start.direction));
        set(&mut rays.origin, paths.len(), start.origin + start.normal * offset);
        set(&mut rays.direction, paths.len(), start.direction);
        paths.push(LightPath {
            power: start.power * SAMPLES_PER_LIGHT_PATH as f32,
            last: LastVertex::Light { light: start.light, density: start.density },
            slot,
            path_class: PathClass::DIRECT,
        });
    }
}

/// A point where a light path has hit a surface.
struct Vertex<'a> {
    path: LightPath,
    shader: &'a SurfaceShader,
    surface: Surface,
    frame: Frame,
    /// To the last vertex.
    wo: Vec3,
}

impl<'a> Vertex<'a> {
    /// The vertex, if light is scattered there.
    fn new(scene: &'a PreparedScene, rays: &Rays, hits: &Hits, i: usize, path: LightPath) -> Option<Self> {
        let shader = &scene.shaders[hits.object[i] as usize];
        let from_light = matches!(path.last, LastVertex::Light { .. });
        // Light paths start towards surfaces that are not diffuse.
        if shader.kind == Kind::Black || !shader.bsdf.is_reciprocal() || from_light && shader.kind.is_diffuse() {
            return None;
        }
        let wo = -at(&rays.direction, i);
        let surface = scene.geometry.surface(rays, hits, i);
        let surface = shader.facing(surface, wo);
        let frame = surface.frame(wo);
        is_sound([surface.normal, surface.shading], wo).then_some(Self { path, shader, surface, frame, wo })
    }

    /// The pdf per projected solid angle of a direction.
    fn projected(&self, w: Vec3, pdf: f32) -> f32 {
        projected([self.surface.normal, self.surface.shading], w, pdf)
    }

    /// Whether light goes on in direction `wi`: the normals must agree.
    fn reaches(&self, wi: Vec3) -> bool {
        let normals = [self.surface.normal, self.surface.shading];
        normals[0].dot(wi) * self.frame.z.dot(wi) > 0.0 && is_sound(normals, wi)
    }

    /// The densities of the techniques of camera paths over that of light tracing, squared and summed, at a vertex that
    /// continues in direction `wi` with this pdf; `reverse_pdf` is that of a camera path's direction to the last vertex.
    fn others(&self, scene: &PreparedScene, wi: Vec3, pdf: f32, reverse_pdf: f32) -> f32 {
        let ratio = self.projected(self.wo, 1.0) / self.projected(wi, pdf);
        match self.path.last {
            LastVertex::Scattering { others } => others * (ratio * reverse_pdf).powi(2),
            LastVertex::Light { light, density } => {
                let normal = self.frame.z;
                let one_sided = (self.shader.kind != Kind::Transmitting).then_some(normal);
                let by_light = match light {
                    Some(light) => scene.lights.density(light, self.surface.position, one_sided),
                    None => scene.environment_density(self.wo, normal),
                };
                (ratio / density).powi(2) * (reverse_pdf * reverse_pdf + by_light * by_light)
            }
        }
    }

    /// Connects the vertex to the camera.
    fn connect(&self, scene: &PreparedScene, lens: &Lens, connections: &mut Connections) {
        if self.shader.kind == Kind::Delta {
            return;
        }
        let Some(view) = lens.project(self.surface.position) else { return };
        let wi = view.direction;
        if !self.reaches(wi) {
            return;
        }
        // Evaluate the BSDF, and its pdf for a camera path.
        let [wo_local, wi_local] = [self.wo, wi].map(|w| self.frame.to_local(w));
        let f = self.shader.bsdf.eval_adjoint(wo_local, wi_local);
        if f == Rgb::ZERO {
            return;
        }
        let reverse_pdf = self.shader.bsdf.pdf(wi_local, wo_local);
        // Weight the path by MIS.
        let area = lens.area_at(self.surface.position);
        let others = self.others(scene, wi, 1.0, reverse_pdf) / LightTracing::from_camera(area).powi(2);
        let factor = adjoint_factor(&self.surface, self.wo, wi) * wi_local.z.abs() / area;
        connections.push(
            [self.surface.ray_origin(wi), wi],
            view.distance * SHORT_OF_LIGHT,
            Splat {
                pixel: view.pixel,
                class: scene.classes.map_or(0, |classes| classes.index(self.path.path_class.then(false).reversed())),
                value: self.path.power * f * (factor / (1.0 + others)),
            },
        );
    }

    /// Samples the direction in which the path continues, with its ray.
    fn scatter(&self, step: Step) -> Option<(LightPath, [Vec3; 2])> {
        let Step { scene, numbers, scatterings } = step;
        let dimensions = Dimensions::of_light_paths(scatterings + 1);
        let slot = self.path.slot;
        let [uc, roulette] = numbers.short_pair(slot, dimensions.choice(), (0, 1));
        let u = numbers.short_pair(slot, dimensions.bsdf(), (0, 1));
        let wo = self.frame.to_local(self.wo);
        let sample = self.shader.bsdf.sample_adjoint(wo, uc, u)?;
        let wi = self.frame.to_world(sample.wi);
        if sample.weight == Rgb::ZERO || !self.reaches(wi) {
            return None;
        }
        let others = if sample.is_delta() {
            let ratio = delta_ratio(&self.shader.bsdf, &sample).powi(2);
            match self.path.last {
                LastVertex::Scattering { others } => others * ratio,
                LastVertex::Light { density, .. } => ratio / (density * density),
            }
        } else {
            self.others(scene, wi, sample.pdf, self.shader.bsdf.pdf(sample.wi, wo))
        };
        let mut power = self.path.power * sample.weight * adjoint_factor(&self.surface, self.wo, wi);
        // Russian roulette by the weight of this scattering, which keeps the power of a path
        let survival = sample.weight.max_element().min(1.0);
        if roulette >= survival {
            return None;
        }
        power /= survival;
        let path_class = self.path.path_class.then(sample.is_delta());
        let last = LastVertex::Scattering { others };
        Some((LightPath { power, last, slot, path_class }, [self.surface.ray_origin(wi), wi]))
    }
}

impl Connections {
    /// Adds a ray to the camera.
    fn push(&mut self, [origin, direction]: [Vec3; 2], limit: f32, splat: Splat) {
        let i = self.splats.len();
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        self.limits[i] = limit;
        self.splats.push(splat);
    }

    /// Moves what is not occluded to `splats`.
    fn splat(&mut self, scene: &PreparedScene, splats: &mut Vec<Splat>) {
        let mut blocked = [0; LANES];
        scene.geometry.occluded(&self.rays, self.splats.len(), &self.limits, &mut blocked);
        splats.extend(self.splats.drain(..).zip(blocked).filter(|(_, blocked)| *blocked == 0).map(|(splat, _)| splat));
    }
}
