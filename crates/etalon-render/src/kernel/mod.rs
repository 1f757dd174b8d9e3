//! The path tracer in lanes: the algorithm of [`super::reference`], for [`LANES`] paths at once.
//!
//! The paths take one step together: all rays are traced, emission is added, and the hits are sorted by
//! the kind of their BSDF, so that diffuse and rough surfaces are shaded in loops that the compiler vectorizes. Every random
//! number is a function of its pixel, sample and dimension, so the radiance of a path has the same bits whichever paths share
//! its batch.

mod diffuse;
mod direct;
mod general;
mod light_paths;
mod light_samples;
mod paths;
mod rough;

pub use diffuse::ExtendPaths;
pub use light_paths::{LightPathBuffers, trace_light_paths};
pub use paths::{Paths, Points};
pub use paths::{Radiance, Work};
pub use rough::{Bsdfs, Scattered, eval_many, reverse_pdf_many, sample_many};

use super::departure::{Departure, EmitterHit};
use super::film::PathClass;
use super::lanes::{Hits, LANES, NOTHING, at, set};
use super::lens::Lens;
use super::light_tracing::LightTracing;
use super::prepared::{PreparedScene, ROULETTE_AFTER, ROULETTE_BELOW};
use super::sample_lanes::SampleLanes;
use super::shaders::Kind;
use direct::DirectLight;
use etalon_core::bsdf::Bsdf;
use paths::{Step, Vertex};

/// The buffers of a thread, which hold nothing between batches.
#[derive(Default)]
pub struct Buffers {
    paths: Box<Paths>,
    next: Box<Paths>,
    hits: Box<Hits>,
    sorted: Sorted,
    scattered: Box<Scattered>,
    direct: DirectLight,
    /// The BSDFs of hits on an object with textures.
    varying: Vec<Bsdf>,
}

/// The hits of a step by the kind of their BSDF.
#[derive(Default)]
struct Sorted {
    diffuse: Box<Points>,
    /// Indices of paths.
    delta: Vec<u32>,
    general: Vec<Vertex>,
}

/// Traces the camera samples in the first `count` slots, which belong to row `y` of the film and to these columns of it.
pub fn trace(
    scene: &PreparedScene,
    lens: &Lens,
    (columns, y, count): (&[u32; LANES], u32, usize),
    numbers: &SampleLanes,
    buffers: &mut Buffers,
    radiance: &mut Radiance,
) {
    let Buffers { paths, next, hits, sorted, scattered, direct, varying } = buffers;
    radiance.clear(count);
    start(scene, lens, (columns, y, count), numbers, paths);
    for scatterings in 0..=scene.request.max_depth {
        if paths.count == 0 {
            break;
        }
        scene.geometry.nearest(&paths.rays, paths.count, hits);
        radiance.work.rays += paths.count;
        add_emission(scene, paths, hits, radiance);
        if scatterings == scene.request.max_depth {
            break;
        }
        if scatterings == 0 && scene.light_tracing.is_some() {
            begin_light_tracing(scene, lens, hits, paths);
        }
        sort(scene, scatterings == 0, paths, hits, sorted);
        // Add direct light and sample the next directions, kind by kind.
        let step = Step { scene, numbers, scatterings };
        next.count = 0;
        if sorted.diffuse.count > 0 {
            direct::light_diffuse(step, &sorted.diffuse, direct, radiance);
            diffuse::extend(step, &sorted.diffuse, next);
        }
        if !sorted.delta.is_empty() {
            general::extend_delta(step, paths, hits, &sorted.delta, next);
        }
        for group in general::groups(&mut sorted.general, |vertex| vertex.object) {
            let shader = &scene.shaders[group[0].object as usize];
            let bsdfs = Bsdfs::of(shader, group.iter().map(|vertex| vertex.uv), varying);
            direct::light_general(step, group, (shader, bsdfs), direct, radiance);
            general::extend(step, group, (shader, bsdfs), scattered, next);
        }
        roulette(step, next);
        std::mem::swap(paths, next);
    }
}

/// Generates the camera rays.
fn start(
    scene: &PreparedScene,
    lens: &Lens,
    (columns, y, count): (&[u32; LANES], u32, usize),
    numbers: &SampleLanes,
    paths: &mut Paths,
) {
    let mut u = [[0.0; LANES]; 2];
    paths.count = count;
    for (slot, number) in paths.slot[..count].iter_mut().zip(0..) {
        *slot = number;
    }
    numbers.fill(scene.arch, &paths.slot[..count], 0, (0, 1), &mut u);
    lens.rays(scene.arch, columns, y, &u, count, &mut paths.rays);
    for channel in &mut paths.throughput {
        channel[..count].fill(1.0);
    }
    paths.eta_scale[..count].fill(1.0);
    paths.departure[..count].fill(Departure::CAMERA);
    paths.path_class[..count].fill(PathClass::DIRECT);
}

/// Adds the emission of the surfaces that the rays have hit, and the environment's radiance to those that have left the scene.
fn add_emission(scene: &PreparedScene, paths: &Paths, hits: &Hits, radiance: &mut Radiance) {
    for i in 0..paths.count {
        let direction = at(&paths.rays.direction, i);
        let departure = &paths.departure[i];
        let found = match hits.object[i] {
            NOTHING => scene.environment_light(departure, at(&paths.rays.origin, i), direction),
            object => {
                let shader = &scene.shaders[object as usize];
                let Some(emission) = &shader.emission else { continue };
                let surface = scene.geometry.surface(&paths.rays, hits, i);
                if !emission.is_emitted(surface.normal, direction) {
                    continue;
                }
                let hit = EmitterHit {
                    visibility: emission.visibility,
                    light: shader.light.map(|first| first + scene.geometry.triangle(hits, i)),
                    cos: surface.normal.dot(direction).abs(),
                    position: surface.position,
                };
                emission.radiance * scene.emitter_weight(departure, at(&paths.rays.origin, i), direction, &hit)
            }
        };
        radiance.add(paths.slot[i], paths.path_class[i], at(&paths.throughput, i) * found);
    }
}

/// Sets the density of light tracing at the first hits.
fn begin_light_tracing(scene: &PreparedScene, lens: &Lens, hits: &Hits, paths: &mut Paths) {
    for i in 0..paths.count {
        if hits.object[i] != NOTHING {
            let position = at(&paths.rays.origin, i) + hits.t[i] * at(&paths.rays.direction, i);
            paths.departure[i].light_tracing = match scene.shaders[hits.object[i] as usize].kind {
                Kind::Delta => 0.0,
                _ => LightTracing::from_camera(lens.area_at(position)),
            };
        }
    }
}

/// Sorts the hits by the kind of their BSDF.
fn sort(scene: &PreparedScene, is_first: bool, paths: &Paths, hits: &Hits, sorted: &mut Sorted) {
    let Sorted { diffuse, delta, general } = sorted;
    diffuse.count = 0;
    delta.clear();
    general.clear();
    for i in 0..paths.count {
        let object = hits.object[i];
        if object == NOTHING {
            continue;
        }
        let shader = &scene.shaders[object as usize];
        match shader.kind {
            Kind::Black => {}
            Kind::Diffuse => {
                let surface =
                    shader.facing(scene.geometry.surface(&paths.rays, hits, i), -at(&paths.rays.direction, i));
                let bsdf = shader.bsdf_at(|| scene.geometry.uv(hits, i, surface.position));
                diffuse::collect(surface, is_first, paths, i, &bsdf, diffuse);
            }
            Kind::Delta => delta.push(i as u32),
            Kind::Reflecting | Kind::Transmitting => {
                general.extend(general::collect(scene, paths, hits, i));
            }
        }
    }
}

/// Russian roulette: ends paths of low throughput at random and raises the throughput of the survivors. The scale of radiance in a
/// medium of index η, 1/η², does not count: it is undone where the light has come from.
fn roulette(step: Step, paths: &mut Paths) {
    if step.scatterings < ROULETTE_AFTER {
        return;
    }
    let dimension = step.scene.dimensions(step.scatterings).choice();
    paths.retain(|paths, i| {
        let throughput = at(&paths.throughput, i);
        let survival = (paths.eta_scale[i] * throughput.max_element() * ROULETTE_BELOW.recip()).min(1.0);
        let [_, u] = step.numbers.short_pair(paths.slot[i], dimension, (0, 1));
        set(&mut paths.throughput, i, throughput / survival);
        u < survival
    });
}
