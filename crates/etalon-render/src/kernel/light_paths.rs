//! Light paths: traced from the lights, and connected to the camera where they scatter.
//!
//! The MIS weights mirror those of the camera paths: see [`crate::light_tracing`].

use super::general::groups;
use super::paths::Step;
use super::rough::{self, Bsdfs, Scattered};
use crate::film::{PathClass, Splat};
use crate::geometry::Surface;
use crate::lanes::{Hits, LANES, Lane, Lane3, Rays, ZERO3, at, set};
use crate::lens::{Lens, View};
use crate::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH, delta_ratio, projected};
use crate::lights::SHORT;
use crate::prepared::{Dimensions, PreparedScene};
use crate::sample_lanes::SampleLanes;
use crate::shaders::{Kind, SurfaceShader, adjoint_factor, is_sound};
use etalon_core::bsdf::{Bsdf, BsdfSample, Scatter};
use etalon_core::math::{Frame, Rgb};
use glam::{Vec2, Vec3};

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
    /// Σ density of another technique / density of light tracing, without the factors of the vertices to come.
    Scattering { others: f32 },
}

/// The buffers of a thread, which hold nothing between batches.
#[derive(Default)]
pub struct LightPathBuffers {
    paths: Vec<LightPath>,
    rays: Box<Rays>,
    hits: Box<Hits>,
    vertices: Vec<Vertex>,
    views: Vec<(usize, View)>,
    local: Box<Local>,
    connections: Connections,
    /// The BSDFs of vertices on an object with textures.
    varying: Vec<Bsdf>,
    /// How many rays were traced.
    pub traced: usize,
}

/// Directions at the vertices on one object, in their shading frames.
struct Local {
    /// Where the BSDF is sampled or evaluated for.
    wo: Lane3,
    scattered: Scattered,
}

impl Default for Local {
    fn default() -> Self {
        Self { wo: ZERO3, scattered: Scattered::default() }
    }
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
    limits: Lane,
}

impl Default for Connections {
    fn default() -> Self {
        Self { contributions: Vec::new(), rays: Box::default(), limits: [0.0; LANES] }
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
    let LightPathBuffers { paths, rays, hits, vertices, views, local, connections, varying, traced } = buffers;
    start(scene, tracing, (numbers, count), paths, rays);
    for scatterings in 0..scene.request.max_depth {
        if paths.is_empty() {
            return;
        }
        scene.geometry.nearest(rays, paths.len(), hits);
        *traced += paths.len();
        let step = Step { scene, numbers, scatterings };
        vertices.clear();
        vertices.extend((0..paths.len()).filter_map(|i| Vertex::new(scene, rays, hits, i, paths[i])));
        paths.clear();
        for group in groups(vertices, |vertex| vertex.object) {
            let shader = &scene.shaders[group[0].object as usize];
            if scatterings > 0 && shader.kind != Kind::Delta {
                connect(scene, lens, shader, group, (views, local, varying), connections);
            }
            let bsdfs = Bsdfs::of(shader, group.iter().map(|vertex| vertex.uv), varying);
            scatter(step, (shader, bsdfs), group, local, (paths, rays));
        }
        *traced += connections.contributions.len();
        connections.splat(scene, lens, splats);
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
        let Some(start) = tracing.start(&scene.lights, scene.environment.as_deref(), u) else { continue };
        let offset = |light: u32| scene.lights.all[light as usize].offset(start.origin);
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
#[derive(Clone, Copy)]
struct Vertex {
    path: LightPath,
    object: u32,
    surface: Surface,
    frame: Frame,
    /// Texture coordinates, if the material has textures.
    uv: Vec2,
    /// To the last vertex.
    wo: Vec3,
}

impl Vertex {
    /// The vertex, if light is scattered there.
    fn new(scene: &PreparedScene, rays: &Rays, hits: &Hits, i: usize, path: LightPath) -> Option<Self> {
        let object = hits.object[i];
        let shader = scene.shaders.get(object as usize)?;
        let from_light = matches!(path.last, LastVertex::Light { .. });
        // Light paths start towards surfaces that are not diffuse.
        if shader.kind == Kind::Black || !shader.bsdf.is_reciprocal() || from_light && shader.kind.is_diffuse() {
            return None;
        }
        let wo = -at(&rays.direction, i);
        let surface = scene.geometry.surface(rays, hits, i);
        let surface = shader.facing(surface, wo);
        let frame = shader.frame(&surface, wo, || scene.geometry.tangent(hits, i, surface.normal));
        let uv = scene.uv(hits, i, surface.position);
        is_sound([surface.normal, surface.shading], wo).then_some(Self { path, object, surface, frame, uv, wo })
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

    /// The densities of the techniques of camera paths, summed, over that of light tracing, at a vertex that
    /// continues in direction `wi` with this pdf; `reverse_pdf` is that of a camera path's direction to the last vertex.
    fn others(&self, scene: &PreparedScene, kind: Kind, wi: Vec3, pdf: f32, reverse_pdf: f32) -> f32 {
        let ratio = self.projected(self.wo, 1.0) / self.projected(wi, pdf);
        match self.path.last {
            LastVertex::Scattering { others } => others * ratio * reverse_pdf,
            LastVertex::Light { light, density } => {
                let normal = self.frame.z;
                let by_light = match light {
                    Some(light) => scene.lights.density(light, self.surface.position, kind.one_sided(normal)),
                    None => scene.environment_density(self.wo, normal, kind),
                };
                ratio / density * (reverse_pdf + by_light)
            }
        }
    }
}

/// Connects vertices on one object to the camera.
fn connect(
    scene: &PreparedScene,
    lens: &Lens,
    shader: &SurfaceShader,
    vertices: &[Vertex],
    (views, local, varying): (&mut Vec<(usize, View)>, &mut Local, &mut Vec<Bsdf>),
    connections: &mut Connections,
) {
    let Local { wo, scattered } = local;
    // Evaluate the BSDF and its pdf for a camera path, which comes from the camera.
    views.clear();
    for (number, vertex) in vertices.iter().enumerate() {
        if let Some(view) = lens.project(vertex.surface.position).filter(|view| vertex.reaches(view.direction)) {
            set(wo, views.len(), vertex.frame.to_local(view.direction));
            set(&mut scattered.wi, views.len(), vertex.frame.to_local(vertex.wo));
            views.push((number, view));
        }
    }
    let bsdfs = Bsdfs::of(shader, views.iter().map(|&(number, _)| vertices[number].uv), varying);
    rough::eval_many(scene.arch, bsdfs, wo, views.len(), scattered);
    for (i, (number, view)) in views.drain(..).enumerate() {
        let (f, reverse_pdf) = (at(&scattered.weight, i), scattered.pdf[i]);
        if f == Rgb::ZERO {
            continue;
        }
        // Weight the path by MIS.
        let (vertex, wi) = (&vertices[number], view.direction);
        let area = lens.area_at(vertex.surface.position);
        let others = vertex.others(scene, shader.kind, wi, 1.0, reverse_pdf) / LightTracing::from_camera(area);
        let factor = adjoint_factor(&vertex.surface, vertex.wo, wi) * at(wo, i).z.abs() / area;
        let path_class = vertex.path.path_class.then(false).reversed();
        connections.push(
            [vertex.surface.ray_origin(wi), wi],
            view.distance * SHORT,
            Contribution {
                slot: vertex.path.slot,
                film: view.film,
                class: scene.classes.map_or(0, |classes| classes.index(path_class)),
                value: vertex.path.power * f * (factor / (1.0 + others)),
                others,
            },
        );
    }
}

/// Samples the directions in which the paths continue at vertices on one object.
fn scatter(
    step: Step,
    (shader, bsdfs): (&SurfaceShader, Bsdfs),
    vertices: &[Vertex],
    local: &mut Local,
    (paths, rays): (&mut Vec<LightPath>, &mut Rays),
) {
    let Step { scene, numbers, scatterings } = step;
    let Local { wo, scattered } = local;
    let dimensions = Dimensions::of_light_paths(scatterings + 1);
    let (mut choice, mut u, mut slots) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [0; LANES]);
    for (i, vertex) in vertices.iter().enumerate() {
        set(wo, i, vertex.frame.to_local(vertex.wo));
        slots[i] = vertex.path.slot;
    }
    numbers.fill(scene.arch, &slots[..vertices.len()], dimensions.bsdf(), (0, 1), &mut u);
    numbers.fill(scene.arch, &slots[..vertices.len()], dimensions.choice(), (0, 1), &mut choice);
    let random = (&choice[0], &u);
    let is_sampled = rough::sample_many(scene.arch, bsdfs, wo, random, vertices.len(), scattered);
    if is_sampled {
        rough::reverse_pdf_many(scene.arch, bsdfs, wo, vertices.len(), scattered);
    }
    for (i, vertex) in vertices.iter().enumerate() {
        let (slot, bsdf) = (vertex.path.slot, bsdfs.at(i));
        let [uc, roulette] = [choice[0][i], choice[1][i]];
        let sample = if is_sampled {
            scattered.sample(i).map(BsdfSample::adjoint)
        } else {
            bsdf.sample_adjoint(at(wo, i), uc, [u[0][i], u[1][i]])
        };
        let Some(sample) = sample else { continue };
        let wi = vertex.frame.to_world(sample.wi);
        if sample.weight == Rgb::ZERO || !vertex.reaches(wi) {
            continue;
        }
        let others = if sample.is_delta() {
            let ratio = delta_ratio(bsdf, &sample);
            match vertex.path.last {
                LastVertex::Scattering { others } => others * ratio,
                LastVertex::Light { density, .. } => ratio / density,
            }
        } else {
            let reverse_pdf = if is_sampled { scattered.reverse_pdf[i] } else { bsdf.pdf(sample.wi, at(wo, i)) };
            vertex.others(scene, shader.kind, wi, sample.pdf, reverse_pdf)
        };
        let power = vertex.path.power * sample.weight * adjoint_factor(&vertex.surface, vertex.wo, wi);
        // Russian roulette by the weight of this scattering, which keeps the power of a path
        let survival = sample.weight.max_element().min(1.0);
        if roulette >= survival {
            continue;
        }
        set(&mut rays.origin, paths.len(), vertex.surface.ray_origin(wi));
        set(&mut rays.direction, paths.len(), wi);
        paths.push(LightPath {
            power: power / survival,
            last: LastVertex::Scattering { others },
            slot,
            path_class: vertex.path.path_class.then(sample.is_delta()),
        });
    }
}

impl Connections {
    /// Adds a ray to the camera.
    fn push(&mut self, [origin, direction]: [Vec3; 2], limit: f32, contribution: Contribution) {
        let i = self.contributions.len();
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        self.limits[i] = limit;
        self.contributions.push(contribution);
    }

    /// Moves what is not occluded to `splats`, weighted by the filters of the pixels around it.
    fn splat(&mut self, scene: &PreparedScene, lens: &Lens, splats: &mut Vec<Splat>) {
        let mut blocked = [0; LANES];
        scene.geometry.occluded(&self.rays, self.contributions.len(), &self.limits, &mut blocked);
        for (Contribution { slot, film, class, value, others }, blocked) in self.contributions.drain(..).zip(blocked) {
            if blocked == 0 {
                // Camera samples of a pixel come with the density of its filter. With the densities c of camera paths and l of light paths, and
                // the light f of a path, their variance is ∫ f² c/(c + l)² beside light paths and ∫ f²/c without: for
                // each light path, which contributes v = f/(c + l), that is v² (2 + l/c) more.
                let spared = value.length_squared() * (2.0 + 1.0 / others);
                let path = slot as usize;
                let splat =
                    |pixel, weight| Splat { path, pixel, class, value: value * weight, spared: spared * weight };
                lens.pixels_around(film, |pixel, weight| splats.push(splat(pixel, weight)));
            }
        }
    }
}
