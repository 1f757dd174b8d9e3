//! The next direction of each path, sampled by the BSDF of the surface that it has hit.

use super::state::{Interactions, PathRay, PathRays, Step, Vertices};
use super::surfaces::GroupMaterial;
use crate::bsdf_lanes::{Scattered, TransportMode, reverse_pdf_many, sample_cosine_hemisphere, sample_many};
use crate::lanes::{LANES, Lane, Lane3, Ray, Rows, at};
use crate::light_tracing::{delta_ratio, projected};
use crate::previous::PreviousVertex;
use crate::ray_samples::{Dimension, SubSample};
use crate::shaders::Kind;
use etalon_core::bsdf::Scatter;
use etalon_core::math::Rgb;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Appends to `next` the paths that continue at interactions with one material.
pub fn sample_bsdf(
    step: Step,
    material: GroupMaterial,
    rays: &PathRays,
    vertices: &Vertices,
    scattered: &mut Scattered,
    next: &mut PathRays,
) {
    // After the last scattering, go on only to light that rays find. Light samples miss what delta lobes find.
    let (kind, bsdf) = (material.kind(), &material.shader.bsdf);
    let has_delta = bsdf.lobes().iter().any(|lobe| lobe.is_delta());
    let finds_light = step.scene.rays_find_light(kind) || has_delta && step.scene.rays_find_light(Kind::Delta);
    if !step.scene.may_continue(step.depth) && !finds_light {
        return;
    }
    if kind.is_diffuse() {
        sample_diffuse(step, rays, &vertices.interactions, &mut scattered.wi, next);
    } else {
        sample_general(step, material, rays, vertices, scattered, next);
    }
}

/// Diffuse surfaces need no frame.
fn sample_diffuse(step: Step, rays: &PathRays, interactions: &Interactions, wi: &mut Lane3, next: &mut PathRays) {
    let count = interactions.count;
    let u = step.samples.bsdf.get_2d_lanes(&interactions.slot[..count], SubSample::ONLY);
    sample_cosine_hemisphere(step.scene.arch, &interactions.ns, &u, count, wi);
    for i in 0..count {
        let (n, normal, direction) = (at(&interactions.n, i), at(&interactions.ns, i), at(wi, i));
        // The normals must agree on the side.
        if n.dot(direction) <= 0.0 || at(&interactions.beta, i) == Rgb::ZERO {
            continue;
        }
        let pdf = normal.dot(direction) * FRAC_1_PI;
        let projected_pdf = || projected([n, normal], direction, pdf);
        let q = PreviousVertex::q_over_pdf(interactions.q[i], projected_pdf);
        let kind = Kind::Diffuse;
        next.push(PathRay {
            ray: Ray { origin: at(&interactions.origin, i), direction },
            beta: at(&interactions.beta, i),
            eta_scale: rays.eta_scale[interactions.ray[i] as usize],
            previous: PreviousVertex { pdf, normal, kind, q },
            slot: interactions.slot[i],
            path_class: interactions.path_class[i],
        });
    }
}

/// Random numbers of BSDFs that need none.
static NO_NUMBERS: [Lane; 2] = [[0.0; LANES]; 2];

/// Any other surface.
fn sample_general(
    step: Step,
    material: GroupMaterial,
    rays: &PathRays,
    vertices: &Vertices,
    scattered: &mut Scattered,
    next: &mut PathRays,
) {
    let Vertices { interactions, frames } = vertices;
    let (scene, kind, shared) = (step.scene, material.kind(), &material.shader.bsdf);
    let (count, slots) = (interactions.count, &interactions.slot[..interactions.count]);
    // Ask for those random numbers only that the BSDF needs.
    let numbers = |needed: bool, from: Dimension| needed.then(|| from.get_2d_lanes(slots, SubSample::ONLY));
    let (u, choice) =
        (numbers(kind != Kind::Delta, step.samples.bsdf), numbers(shared.needs_choice(), step.samples.choice));
    let ([x, y], [choice, _]) = (u.as_ref().unwrap_or(&NO_NUMBERS), choice.as_ref().unwrap_or(&NO_NUMBERS));
    let (bsdfs, mode) = (material.bsdfs, TransportMode::Radiance);
    sample_many(scene.arch, bsdfs, mode, &frames.local_wo, [choice, x, y], count, scattered);
    if kind != Kind::Delta && step.needs_reverse_pdf(shared) {
        reverse_pdf_many(scene.arch, bsdfs, &frames.local_wo, count, scattered);
    }
    for i in 0..count {
        let path = interactions.ray[i] as usize;
        let Some(sample) = scattered.sample(i).filter(|sample| sample.weight != Rgb::ZERO) else { continue };
        let (surface, frame) = (vertices.surface(i), vertices.frame(i));
        let wi = frame.to_world(sample.wi);
        // The normals must agree on the side.
        if !sample.is_delta() && surface.normal.dot(wi) * sample.wi.z <= 0.0 {
            continue;
        }
        let previous = if sample.is_delta() {
            let q = interactions.q[i];
            let is_traced =
                q > 0.0 && step.depth > 0 && vertices.is_sound(i, wi) && vertices.is_sound(i, at(&frames.wo, i));
            // Light tracing cannot connect a delta lobe to the camera.
            let q = if is_traced { q * delta_ratio(bsdfs.at(i), &sample) } else { 0.0 };
            PreviousVertex { q, ..PreviousVertex::SPECULAR }
        } else {
            let reverse_pdf = || scattered.reverse_pdf[i];
            PreviousVertex {
                pdf: sample.pdf,
                normal: frame.z,
                kind,
                q: next_q(step, vertices, i, wi, sample.pdf, reverse_pdf),
            }
        };
        next.push(PathRay {
            ray: Ray { origin: surface.ray_origin(wi), direction: wi },
            beta: at(&interactions.beta, i) * sample.weight,
            eta_scale: rays.eta_scale[path] * sample.eta * sample.eta,
            previous,
            slot: interactions.slot[i],
            path_class: if sample.is_delta() {
                rays.path_class[path].then_specular()
            } else {
                interactions.path_class[i]
            },
        });
    }
}

/// [`PreviousVertex::q`] of a direction `wi` and its pdf; `reverse_pdf` is that of the direction to the viewer if light
/// comes from `wi`.
#[inline]
pub fn next_q(step: Step, vertices: &Vertices, i: usize, wi: Vec3, pdf: f32, reverse_pdf: impl FnOnce() -> f32) -> f32 {
    let q = vertices.interactions.q[i];
    if q == 0.0 {
        return 0.0;
    }
    // Light tracing connects the first vertex to the camera without sampling.
    let reverse_pdf = if step.depth == 0 { 1.0 } else { reverse_pdf() };
    let reverse = q * vertices.projected(i, at(&vertices.frames.wo, i), reverse_pdf);
    PreviousVertex::q_over_pdf(reverse, || vertices.projected(i, wi, pdf))
}
