//! The next direction of each path, sampled by the BSDF of the surface that it has hit.

use super::state::{PathRay, PathRays, Step, Vertices};
use crate::bsdf_lanes::{Scattered, reverse_pdf_many, sample_cosine_hemisphere, sample_many};
use crate::lanes::{LANES, Lane3, Rows, at};
use crate::light_tracing::{delta_ratio, projected};
use crate::previous::PreviousVertex;
use crate::ray_samples::{Dimension, SubSample};
use crate::shaders::Kind;
use etalon_core::bsdf::{BsdfSample, Scatter};
use etalon_core::math::Rgb;
use etalon_core::scene::Ray;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Appends to `next` the paths that continue at interactions with one material.
pub fn sample_bsdf(vertices: Vertices, scattered: &mut Scattered, next: &mut PathRays) {
    // After the last scattering, go on only if the ray may find light that no light sample counts, as delta lobes do.
    let (scene, kind) = (vertices.step.scene, vertices.kind());
    let has_delta = vertices.shader.bsdf.lobes().iter().any(|lobe| lobe.is_delta());
    let finds_light = scene.rays_find_light(kind) || has_delta && scene.rays_find_light(Kind::Delta);
    if !scene.may_continue(vertices.step.depth) && !finds_light {
        return;
    }
    if kind.is_diffuse() {
        sample_diffuse(vertices, &mut scattered.wi, next);
    } else {
        sample_general(vertices, scattered, next);
    }
}

/// Cosine-weighted directions, about the normal alone: diffuse surfaces need no frame.
fn sample_diffuse(vertices: Vertices, wi: &mut Lane3, next: &mut PathRays) {
    let Vertices { step, rays, interactions, .. } = vertices;
    let u = step.samples.bsdf.get_2d_lanes(&interactions.slot[..interactions.count], SubSample::ONLY);
    sample_cosine_hemisphere(&interactions.ns, &u, interactions.count, wi);
    for i in 0..interactions.count {
        let (n, normal, direction) = (at(&interactions.n, i), at(&interactions.ns, i), at(wi, i));
        // The normals must agree on the side.
        if n.dot(direction) <= 0.0 || at(&interactions.beta, i) == Rgb::ZERO {
            continue;
        }
        let pdf = normal.dot(direction) * FRAC_1_PI;
        let q = PreviousVertex::q_over_pdf(interactions.q[i], || projected([n, normal], direction, pdf));
        next.push(PathRay {
            ray: Ray { origin: at(&interactions.origin, i), direction },
            beta: at(&interactions.beta, i),
            eta_scale: rays.eta_scale[interactions.ray[i] as usize],
            previous: PreviousVertex { pdf, normal, kind: Kind::Diffuse, q },
            slot: interactions.slot[i],
            path_class: interactions.path_class[i],
        });
    }
}

/// Directions by the BSDF of any other surface, in its frame.
fn sample_general(vertices: Vertices, scattered: &mut Scattered, next: &mut PathRays) {
    let Vertices { step, bsdfs, interactions, frames, .. } = vertices;
    vertices.sample(scattered);
    for i in 0..interactions.count {
        let Some(sample) = scattered.sample(i).filter(|sample| sample.weight != Rgb::ZERO) else { continue };
        let frame = vertices.frame(i);
        let wi = frame.to_world(sample.wi);
        let previous = if sample.is_delta() {
            let q = interactions.q[i];
            // Light tracing cannot connect a delta lobe to the camera.
            let is_traced =
                q > 0.0 && step.depth > 0 && vertices.is_sound(i, wi) && vertices.is_sound(i, at(&frames.wo, i));
            let q = if is_traced { q * delta_ratio(bsdfs.at(i), &sample) } else { 0.0 };
            PreviousVertex { q, ..PreviousVertex::SPECULAR }
        } else {
            // The normals must agree on the side.
            if at(&interactions.n, i).dot(wi) * sample.wi.z <= 0.0 {
                continue;
            }
            let q = next_q(vertices, i, wi, sample.pdf, scattered.reverse_pdf[i]);
            PreviousVertex { pdf: sample.pdf, normal: frame.z, kind: vertices.kind(), q }
        };
        next.push(vertices.spawn_ray(i, wi, &sample, at(&interactions.beta, i) * sample.weight, previous));
    }
}

impl Vertices<'_> {
    /// Samples the BSDF at each vertex; needs the frames.
    pub fn sample(&self, out: &mut Scattered) {
        let Self { step: Step { samples, mode, .. }, interactions, .. } = self;
        let (count, slots) = (interactions.count, &interactions.slot[..interactions.count]);
        // Ask for those random numbers only that the BSDF needs.
        let numbers = |needed: bool, from: Dimension| match needed {
            true => from.get_2d_lanes(slots, SubSample::ONLY),
            false => [[0.0; LANES]; 2],
        };
        let [x, y] = numbers(self.kind() != Kind::Delta, samples.bsdf);
        let [uc, _] = numbers(self.shader.bsdf.needs_choice(), samples.choice);
        sample_many(self.bsdfs, *mode, &self.frames.local_wo, [&uc, &x, &y], count, out);
        if self.kind() != Kind::Delta && self.needs_reverse_pdf() {
            reverse_pdf_many(self.bsdfs, &self.frames.local_wo, count, out);
        }
    }

    /// The path that goes on in a sampled direction, `wi` in the world.
    #[inline(always)]
    pub fn spawn_ray(&self, i: usize, wi: Vec3, sample: &BsdfSample, beta: Rgb, previous: PreviousVertex) -> PathRay {
        let (rays, interactions, ray) = (self.rays, self.interactions, self.interactions.ray[i] as usize);
        PathRay {
            ray: Ray { origin: self.frames.surface[i].ray_origin(wi), direction: wi },
            beta,
            eta_scale: rays.eta_scale[ray] * sample.eta * sample.eta,
            previous,
            slot: interactions.slot[i],
            path_class: match sample.is_delta() {
                true => rays.path_class[ray].then_specular(),
                false => interactions.path_class[i],
            },
        }
    }
}

/// [`PreviousVertex::q`] of a direction `wi` and its pdf; `reverse_pdf` is that of the direction to the viewer if light
/// comes from `wi`.
#[inline]
pub fn next_q(vertices: Vertices, i: usize, wi: Vec3, pdf: f32, reverse_pdf: f32) -> f32 {
    let q = vertices.interactions.q[i];
    if q == 0.0 {
        return 0.0;
    }
    // Light tracing connects the first vertex to the camera without sampling.
    let reverse_pdf = if vertices.step.depth == 0 { 1.0 } else { reverse_pdf };
    let reverse = q * vertices.projected(i, at(&vertices.frames.wo, i), reverse_pdf);
    PreviousVertex::q_over_pdf(reverse, || vertices.projected(i, wi, pdf))
}
