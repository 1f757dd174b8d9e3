//! Direct light at the hits: light sampling, and directions that are sampled without regard to light.

use super::light_samples::{Choice, Places, Source, sample, sources};
use super::paths::{Points, Radiance, Shadows, Step, Vertex};
use super::rough::{self, Bsdfs, Scattered};
use super::{diffuse, general};
use crate::lanes::{Hits, LANES, Lane3, NOTHING, ZERO3, at, set};
use crate::light_sample::{LightSampleLanes, balance_heuristic};
use crate::light_selection::Round;
use crate::prepared::PreparedScene;
use crate::shaders::{Kind, SurfaceShader};
use etalon_core::scene::EmitterVisibility;
use glam::Vec3;

/// The buffers of direct light.
#[derive(Default)]
pub struct DirectLight {
    vertices: Box<VertexLanes>,
    choices: Vec<Choice>,
    samples: Box<LightSampleLanes>,
    scattered: Box<Scattered>,
    shadows: Box<Shadows>,
    hits: Box<Hits>,
}

/// Hits on one object side by side.
struct VertexLanes {
    position: Lane3,
    /// For shading.
    normal: Lane3,
    /// In the shading frame.
    wo: Lane3,
    slots: [u32; LANES],
}

impl Default for VertexLanes {
    fn default() -> Self {
        Self { position: ZERO3, normal: ZERO3, wo: ZERO3, slots: [0; LANES] }
    }
}

/// Adds direct light at the diffuse hits.
pub fn light_diffuse(step: Step, points: &Points, buffers: &mut DirectLight, radiance: &mut Radiance) {
    let DirectLight { choices, samples, shadows, hits, .. } = buffers;
    let slots = &points.slot[..points.count];
    let places = Places { position: &points.position, normal: &points.normal, slots, surface: Kind::Diffuse };
    // Every point has a shadow ray, of no length where its value is 0: copying some only would cost more.
    shadows.count = points.count;
    shadows.rays.origin = points.position;
    shadows.slot = points.slot;
    shadows.path_class = points.path_class;
    for (source, count) in sources(step.scene, Kind::Diffuse) {
        for index in 0..count {
            sample(step, source, (index, count), &places, choices, samples);
            diffuse::values(step.scene.arch, points, samples, count as f32, shadows);
            shadows.rays.direction = samples.wi;
            add_light(step.scene, source, shadows, hits, radiance);
        }
    }
}

/// Adds direct light at hits on one object.
pub fn light_general(
    step: Step,
    vertices: &[Vertex],
    (shader, bsdfs): (&SurfaceShader, Bsdfs),
    buffers: &mut DirectLight,
    radiance: &mut Radiance,
) {
    let DirectLight { vertices: lanes, choices, samples, scattered, shadows, hits } = buffers;
    let VertexLanes { position, normal, wo, slots } = &mut **lanes;
    for (i, vertex) in vertices.iter().enumerate() {
        set(position, i, vertex.surface.ray_origin(vertex.frame.to_world(vertex.wo)));
        set(normal, i, vertex.frame.z);
        set(wo, i, vertex.wo);
        slots[i] = vertex.slot;
    }
    let slots = &slots[..vertices.len()];
    let places = Places { position, normal, slots, surface: shader.kind };
    for (source, count) in sources(step.scene, shader.kind) {
        for index in 0..count {
            sample(step, source, (index, count), &places, choices, samples);
            for (i, vertex) in vertices.iter().enumerate() {
                set(&mut scattered.wi, i, vertex.frame.to_local(at(&samples.wi, i)));
            }
            rough::eval_many(step.scene.arch, bsdfs, wo, vertices.len(), scattered);
            if step.needs_reverse_pdf(&shader.bsdf) {
                rough::reverse_pdf_many(step.scene.arch, bsdfs, wo, vertices.len(), scattered);
            }
            shadows.count = 0;
            for (i, vertex) in vertices.iter().enumerate() {
                let wi = at(&samples.wi, i);
                let local = at(&scattered.wi, i);
                let (f, pdf) = (at(&scattered.weight, i), scattered.pdf[i]);
                let value = vertex.throughput * f * at(&samples.weight, i) * (local.z.abs() / count as f32);
                // Skip black samples, and those on whose side the normals disagree.
                if !(value.max_element() > 0.0 && vertex.surface.normal.dot(wi) * local.z > 0.0) {
                    continue;
                }
                let by_light_tracing = if vertex.light_tracing > 0.0 && step.scatterings > 0 {
                    let emission = emission_density(step.scene, vertex, samples, i);
                    general::light_tracing_ratio(step, vertex, local, 1.0, || scattered.reverse_pdf[i]) * emission
                } else {
                    0.0
                };
                let ray = [vertex.surface.ray_origin(wi), wi];
                let (light, density) = (samples.light[i], count as f32 * samples.pdf[i]);
                let seen = match light != NOTHING && local.z * vertex.wo.z < 0.0 {
                    true => from_other_side(step.scene, light, ray, [samples.distance[i], density]),
                    false => Some([samples.limit[i], density]),
                };
                let Some([limit, density]) = seen else { continue };
                let share = balance_heuristic(density, [pdf, by_light_tracing]);
                shadows.push(ray, limit, value * share, vertex.slot, vertex.path_class.then(false));
            }
            add_light(step.scene, source, shadows, hits, radiance);
        }
    }
}

/// The length of the shadow ray and the density of a light sample, whose distance and density from the viewer's side of a surface are
/// `sampled`, for the ray that leaves its other side; `None` if the light cannot be seen from there. A BSDF sample on that ray is
/// weighted by the same density.
fn from_other_side(scene: &PreparedScene, light: u32, ray: [Vec3; 2], sampled: [f32; 2]) -> Option<[f32; 2]> {
    let [distance, density] = sampled;
    let distance = scene.lights.all[light as usize].ahead(ray, distance)?;
    let is_weighted = density.is_finite();
    let limit = scene.shadow_limit(light, ray, distance);
    Some([limit, if is_weighted { scene.lights.density(light, ray[0], None) } else { density }])
}

/// What the light of sample `i` contributes to the density of light tracing.
fn emission_density(scene: &PreparedScene, vertex: &Vertex, samples: &LightSampleLanes, i: usize) -> f32 {
    let Some(tracing) = &scene.light_tracing else { return 0.0 };
    let wi = at(&samples.wi, i);
    match samples.light[i] {
        NOTHING => scene.density_of_light_paths(vertex.surface.position, wi),
        light => {
            let place = vertex.surface.position + wi * samples.distance[i];
            let cos = scene.lights.all[light as usize].cos_at(place, wi);
            tracing.density(&scene.lights, light, place, -wi, cos)
        }
    }
}

/// Traces the rays of a source and adds their values where they find its light.
fn add_light(scene: &PreparedScene, source: Source, shadows: &Shadows, hits: &mut Hits, radiance: &mut Radiance) {
    radiance.work.rays += shadows.count;
    if matches!(source, Source::Environment | Source::Lights(_, Round { light: None, .. })) {
        radiance.work.choices += shadows.count;
    }
    match source {
        Source::Lights(..) | Source::Environment => add_unoccluded(scene, shadows, radiance),
        Source::BsdfOnly(_) => add_emission_found(scene, shadows, hits, radiance),
    }
}

/// Traces shadow rays and adds the values of those that are not occluded.
fn add_unoccluded(scene: &PreparedScene, shadows: &Shadows, radiance: &mut Radiance) {
    let mut blocked = [0; LANES];
    if scene.needs.occlusion {
        scene.geometry.occluded(&shadows.rays, shadows.count, &shadows.limit, &mut blocked);
    }
    for i in 0..shadows.count {
        if blocked[i] == 0 {
            radiance.add(shadows.slot[i], shadows.path_class[i], at(&shadows.value, i));
        }
    }
}

/// Traces rays and adds the emission that they find, times their values.
fn add_emission_found(scene: &PreparedScene, shadows: &Shadows, hits: &mut Hits, radiance: &mut Radiance) {
    scene.geometry.nearest(&shadows.rays, shadows.count, hits);
    for i in 0..shadows.count {
        let direction = at(&shadows.rays.direction, i);
        let emitted = match hits.object[i] {
            NOTHING => scene.environment_radiance(direction),
            object => {
                let shader = &scene.shaders[object as usize];
                // Emission that only the camera sees lights nothing.
                if shader.emission.is_none_or(|emission| emission.visibility == EmitterVisibility::CameraOnly) {
                    continue;
                }
                shader.emitted(scene.geometry.surface(&shadows.rays, hits, i).normal, direction)
            }
        };
        radiance.add(shadows.slot[i], shadows.path_class[i], at(&shadows.value, i) * emitted);
    }
}
