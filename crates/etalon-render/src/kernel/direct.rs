//! Direct light: samples of every source of light at the interactions with a material, and the shadow rays towards them.

use super::scatter::next_q;
use super::state::{ShadowRay, ShadowRays, Step, Vertices};
use crate::bsdf_lanes::{Scattered, eval_many, reverse_pdf_many};
use crate::environment::{EnvironmentSampling, SurfaceSampling, surface_sampling};
use crate::lanes::{Hits, LANES, NONE, Rows, at, fill};
use crate::light_lanes;
use crate::light_sample::{LightSample, LightSampleLanes, balance_heuristic};
use crate::light_selection::Round;
use crate::prepared::PreparedScene;
use crate::radiance::Radiance;
use crate::ray_samples::SubSample;
use crate::shaders::Kind;
use etalon_core::math::{Frame, Rgb};
use etalon_core::scene::Ray;
use std::f32::consts::FRAC_1_PI;

#[derive(Default)]
pub struct DirectLight {
    choices: Vec<light_lanes::Choice>,
    samples: Box<LightSampleLanes>,
    shadow_rays: Box<ShadowRays>,
    hits: Box<Hits>,
}

/// A source of directions towards light.
#[derive(Clone, Copy)]
enum Source<'a> {
    /// A round of light samples, by its number.
    Lights(usize, Round),
    Environment(&'a EnvironmentSampling<'a>),
    /// A strategy that ignores the lights: its rays find emitters.
    Surface(SurfaceSampling),
}

/// The sources for surfaces of a kind, each with its number of samples.
fn sources<'a>(scene: &'a PreparedScene<'a>, surface: Kind) -> impl Iterator<Item = (Source<'a>, u32)> {
    let count = scene.request.light_samples;
    let rounds = scene.lights.rounds().iter().enumerate().map(|(i, &round)| (Source::Lights(i, round), round.count));
    let environment = scene.environment.iter().map(move |environment| (Source::Environment(environment), count));
    let by_surface = surface_sampling(scene.sampling, surface).into_iter();
    rounds.chain(environment).chain(by_surface.map(move |strategy| (Source::Surface(strategy), count)))
}

/// Adds the direct light at interactions with one material.
pub fn sample_direct_light(
    vertices: Vertices,
    scattered: &mut Scattered,
    buffers: &mut DirectLight,
    radiance: &mut Radiance,
) {
    let Vertices { step, interactions, .. } = vertices;
    let DirectLight { choices, samples, shadow_rays, hits } = buffers;
    let is_diffuse = vertices.kind().is_diffuse();
    if is_diffuse {
        // Every interaction has a shadow ray, of no length where its value is 0: copying some only would cost more.
        shadow_rays.count = interactions.count;
        shadow_rays.ray.origin = interactions.origin;
        shadow_rays.slot = interactions.slot;
        shadow_rays.path_class = interactions.path_class;
    }
    for (source, count) in sources(step.scene, vertices.kind()) {
        for index in 0..count {
            let sub = SubSample { index, count };
            sample_light(vertices, source, sub, choices, samples);
            if is_diffuse {
                diffuse_shadow_rays(vertices, samples, count, shadow_rays);
            } else {
                general_shadow_rays(vertices, samples, count, scattered, shadow_rays);
            }
            radiance.work.rays += shadow_rays.count;
            if matches!(source, Source::Environment(_) | Source::Lights(_, Round { light: None, .. })) {
                radiance.work.choices += interactions.count;
            }
            match source {
                Source::Lights(..) | Source::Environment(_) => trace_shadow_rays(step.scene, shadow_rays, radiance),
                Source::Surface(_) => trace_to_emitters(step, shadow_rays, hits, radiance),
            }
        }
    }
}

/// Samples a direction towards light from each interaction. The pdf is infinite where no BSDF samples are combined with it.
fn sample_light(
    vertices: Vertices,
    source: Source,
    sub: SubSample,
    choices: &mut Vec<light_lanes::Choice>,
    out: &mut LightSampleLanes,
) {
    let Vertices { step: Step { scene, samples, .. }, interactions, .. } = vertices;
    let (kind, count, slots) = (vertices.kind(), interactions.count, &interactions.slot[..interactions.count]);
    match source {
        Source::Lights(number, Round { light: Some(light), .. }) => {
            let u = samples.light(number).get_2d_lanes(slots, sub);
            let sampled = &scene.lights.all[light as usize];
            light_lanes::sample_one_light(sampled, &interactions.origin, count, &u, out);
            out.light[..count].fill(light);
            if !scene.lights.is_found_by_rays(light) {
                out.pdf[..count].fill(f32::INFINITY);
            }
        }
        Source::Lights(number, Round { light: None, .. }) => {
            // With the first sample, choose the lights of all.
            if sub.index == 0 {
                let choice = |index| {
                    let [probability, _] = samples.light_choice.get_2d_lanes(slots, SubSample { index, ..sub });
                    light_lanes::Choice { light: [NONE; LANES], probability }
                };
                choices.clear();
                choices.extend((0..sub.count).map(choice));
                let (positions, normals) = (&interactions.origin, &interactions.ns);
                light_lanes::choose(&scene.lights, positions, normals, kind, count, choices);
            }
            let (choice, u) = (&choices[sub.index as usize], samples.light(number).get_2d_lanes(slots, sub));
            light_lanes::sample_chosen(&scene.lights, choice, &interactions.origin, count, &u, out);
        }
        Source::Environment(environment) => {
            let u = samples.environment.get_2d_lanes(slots, sub);
            environment.sample_many(&u, &interactions.ns, kind, count, out);
        }
        Source::Surface(strategy) => {
            for i in 0..count {
                let (local, pdf) = strategy(samples.direct.get_2d(slots[i], sub));
                let wi = Frame::from_normal(at(&interactions.ns, i)).to_world(local.as_vec3());
                let weight = Rgb::splat(1.0 / pdf as f32);
                let sample = LightSample { wi, distance: f32::INFINITY, weight, pdf: f32::INFINITY };
                out.set(i, NONE, sample, f32::INFINITY);
            }
        }
    }
    if !scene.sampling.is_mis() {
        out.pdf[..count].fill(f32::INFINITY);
    }
}

/// Directs the rays from diffuse surfaces towards light samples, `n` for each: beta / π · cos · light.
fn diffuse_shadow_rays(vertices: Vertices, samples: &LightSampleLanes, n: u32, out: &mut ShadowRays) {
    let Vertices { interactions, .. } = vertices;
    let (count, n) = (interactions.count, n as f32);
    out.ray.direction = samples.wi;
    let [r, g, b] = &mut out.value;
    fill(
        count,
        [r, g, b, &mut out.t_max],
        #[inline(always)]
        move |i| {
            let wi = at(&samples.wi, i);
            let cos = at(&interactions.ns, i).dot(wi).max(0.0);
            // What the shading normal would let through the surface is black.
            let cos = if at(&interactions.n, i).dot(wi) > 0.0 { cos } else { 0.0 };
            let by_bsdf = cos * FRAC_1_PI;
            let mis_weight = balance_heuristic(n * samples.pdf[i], [by_bsdf, 0.0]);
            let value = at(&interactions.beta, i) * at(&samples.weight, i) * (by_bsdf * mis_weight / n);
            let t_max = if value == Rgb::ZERO { 0.0 } else { samples.t_max[i] };
            [value.x, value.y, value.z, t_max]
        },
    );
}

/// Rays from any other surface towards light samples, `n` for each, except black ones.
fn general_shadow_rays(
    vertices: Vertices,
    samples: &LightSampleLanes,
    n: u32,
    scattered: &mut Scattered,
    out: &mut ShadowRays,
) {
    let Vertices { step: Step { scene, depth, .. }, bsdfs, interactions, frames, .. } = vertices;
    let (count, n) = (interactions.count, n as f32);
    fill(
        count,
        scattered.wi.each_mut(),
        #[inline(always)]
        move |i| vertices.frame(i).to_local(at(&samples.wi, i)).to_array(),
    );
    eval_many(bsdfs, &frames.local_wo, count, scattered);
    if vertices.needs_reverse_pdf() {
        reverse_pdf_many(bsdfs, &frames.local_wo, count, scattered);
    }
    out.count = 0;
    for i in 0..count {
        let (wi, local, surface) = (at(&samples.wi, i), at(&scattered.wi, i), &frames.surface[i]);
        let (f, pdf) = (at(&scattered.weight, i), scattered.pdf[i]);
        let value = at(&interactions.beta, i) * f * at(&samples.weight, i) * (local.z.abs() / n);
        // Skip black samples, and those on whose side the normals disagree.
        if !(value.max_element() > 0.0 && surface.normal.dot(wi) * local.z > 0.0) {
            continue;
        }
        let by_light_tracing = if interactions.q[i] > 0.0 && depth > 0 {
            let emission = match samples.light[i] {
                NONE => scene.light_path_density(NONE, surface.position, wi, 1.0),
                light => {
                    let point = surface.position + wi * samples.distance[i];
                    let cos = scene.lights.all[light as usize].cos_at(point, wi);
                    scene.light_path_density(light, point, wi, cos)
                }
            };
            next_q(vertices, i, wi, 1.0, scattered.reverse_pdf[i]) * emission
        } else {
            0.0
        };
        let ray = Ray { origin: surface.ray_origin(wi), direction: wi };
        let light = samples.light[i];
        let (mut t_max, mut density) = (samples.t_max[i], n * samples.pdf[i]);
        if light != NONE && local.z * frames.local_wo[2][i] < 0.0 {
            // The light was sampled from the viewer's side, and is seen by the ray that leaves the other side. A BSDF sample on that
            // ray is weighted by the same density.
            let Some(distance) = scene.lights.all[light as usize].ahead(ray, samples.distance[i]) else { continue };
            t_max = scene.t_max(light, ray, distance);
            if density.is_finite() {
                density = scene.lights.density(light, ray.origin, None);
            }
        }
        let value = value * balance_heuristic(density, [pdf, by_light_tracing]);
        let (slot, path_class) = (interactions.slot[i], interactions.path_class[i]);
        out.push(ShadowRay { ray, t_max, value, slot, path_class });
    }
}

/// Traces shadow rays and adds the values of those that are not occluded.
fn trace_shadow_rays(scene: &PreparedScene, rays: &ShadowRays, radiance: &mut Radiance) {
    let mut blocked = [0; LANES];
    if scene.needs.occlusion {
        scene.geometry.occluded(&rays.ray, rays.count, &rays.t_max, &mut blocked);
    }
    for i in (0..rays.count).filter(|&i| blocked[i] == 0) {
        radiance.add(rays.slot[i], rays.path_class[i], at(&rays.value, i));
    }
}

/// Traces rays and adds the emission that they find, times their values.
fn trace_to_emitters(step: Step, rays: &ShadowRays, hits: &mut Hits, radiance: &mut Radiance) {
    step.scene.geometry.nearest(&rays.ray, rays.count, hits);
    for i in 0..rays.count {
        if let Some(light) = step.scene.light_found(&rays.ray, hits, i, step.depth + 1, None) {
            radiance.add(rays.slot[i], rays.path_class[i], at(&rays.value, i) * light);
        }
    }
}
