//! Hits sorted by material, and the interactions there: each surface is evaluated once.

use super::state::{Interaction, Interactions, PathRays, ShadingFrame, ShadingFrames, Step, VertexBuffers, Vertices};
use crate::bsdf_lanes::{Bsdfs, TransportMode};
use crate::lanes::{Hits, Rows, at};
use crate::light_tracing::projected;
use crate::shaders::{Kind, is_sound};
use etalon_core::bsdf::{Bsdf, Scatter};
use std::f32::consts::FRAC_1_PI;

/// The hits of a step, sorted by material.
#[derive(Default)]
pub struct ByMaterial {
    /// Camera paths' rays that have hit diffuse objects, which are the most and need not be sorted.
    diffuse: Vec<u32>,
    /// The other rays, each as the number of its object in the high 32 bits and its own in the low ones, to be sorted.
    others: Vec<u64>,
    /// Those rays, in the same order.
    rays: Vec<u32>,
}

impl ByMaterial {
    /// Groups the first `count` rays by the material that they have hit: of camera paths all diffuse objects together, others by
    /// themselves. Black ones are left out.
    pub fn sort<'a>(&'a mut self, step: Step, hits: &Hits, count: usize) -> impl Iterator<Item = &'a [u32]> {
        self.diffuse.clear();
        self.others.clear();
        for i in 0..count {
            let Some(shader) = step.scene.shaders.get(hits.object[i] as usize) else { continue };
            match step.mode {
                _ if shader.kind == Kind::Black => {}
                TransportMode::Radiance if shader.kind.is_diffuse() => self.diffuse.push(i as u32),
                // Light paths start towards surfaces that are not diffuse, and scatter at reciprocal BSDFs alone.
                TransportMode::Importance if step.depth == 1 && shader.kind.is_diffuse() => {}
                TransportMode::Importance if !shader.bsdf.is_reciprocal() => {}
                _ => self.others.push(u64::from(hits.object[i]) << 32 | i as u64),
            }
        }
        self.others.sort_unstable();
        self.rays.clear();
        self.rays.extend(self.others.iter().map(|&hit| hit as u32));
        let (others, rays, mut start) = (&self.others, &self.rays, 0);
        let groups = others.chunk_by(|a, b| a >> 32 == b >> 32).map(move |group| {
            start += group.len();
            &rays[start - group.len()..start]
        });
        groups.chain((!self.diffuse.is_empty()).then_some(&self.diffuse[..]))
    }
}

/// Evaluates the surfaces that these rays, all of one material, have hit.
pub fn evaluate<'a>(
    step: Step<'a>,
    rays: &'a PathRays,
    hits: &Hits,
    group: &[u32],
    buffers: &'a mut VertexBuffers,
) -> Vertices<'a> {
    let VertexBuffers { interactions, frames, varying } = buffers;
    let shader = &step.scene.shaders[hits.object[group[0] as usize] as usize];
    (interactions.count, frames.count) = (0, 0);
    for i in group.iter().map(|&i| i as usize) {
        match step.mode {
            TransportMode::Radiance if shader.kind.is_diffuse() => evaluate_diffuse(step, rays, hits, i, interactions),
            _ => evaluate_general(step, rays, hits, i, interactions, frames),
        }
    }
    let bsdfs = Bsdfs::of(shader, &frames.uv[..frames.count], varying);
    Vertices { step, shader, bsdfs, rays, interactions, frames }
}

/// Adds the diffuse surface that a ray has hit.
#[inline(always)]
fn evaluate_diffuse(step: Step, rays: &PathRays, hits: &Hits, i: usize, out: &mut Interactions) {
    let shader = &step.scene.shaders[hits.object[i] as usize];
    let wo = -at(&rays.ray.direction, i);
    let surface = shader.facing(step.scene.geometry.surface(&rays.ray, hits, i), wo);
    let bsdf = shader.bsdf_at(|| step.scene.geometry.uv(hits, i, surface.position));
    let Bsdf::Diffuse(diffuse) = &*bsdf else { unreachable!("a surface of the kind diffuse has a diffuse BSDF") };
    // Light tracing connects the first vertex to the camera without sampling.
    let reverse_pdf = if step.depth == 0 { 1.0 } else { surface.shading.dot(wo) * FRAC_1_PI };
    let q = step.q(rays, hits, i);
    out.push(Interaction {
        ray: i as u32,
        slot: rays.slot[i],
        n: surface.normal,
        ns: surface.shading_for(wo),
        origin: surface.ray_origin(wo),
        beta: at(&rays.beta, i) * diffuse.albedo(),
        path_class: rays.path_class[i].then_diffuse(),
        q: if q > 0.0 { q * projected(surface.normals(), wo, reverse_pdf) } else { 0.0 },
    });
}

/// Adds any other surface, with its shading frame.
#[inline(always)]
fn evaluate_general(
    step: Step,
    rays: &PathRays,
    hits: &Hits,
    i: usize,
    interactions: &mut Interactions,
    frames: &mut ShadingFrames,
) {
    let (scene, shader) = (step.scene, &step.scene.shaders[hits.object[i] as usize]);
    let wo = -at(&rays.ray.direction, i);
    let surface = shader.facing(scene.geometry.surface(&rays.ray, hits, i), wo);
    let is_back = shader.kind == Kind::Reflecting && surface.normal.dot(wo) < 0.0;
    // The back of what only reflects is black. On light paths the normals must agree about the light that arrives.
    if is_back || step.mode == TransportMode::Importance && !is_sound(surface.normals(), wo) {
        return;
    }
    let frame = shader.frame(&surface, wo, || scene.geometry.tangent(hits, i, surface.normal));
    interactions.push(Interaction {
        ray: i as u32,
        slot: rays.slot[i],
        n: surface.normal,
        ns: frame.z,
        origin: surface.ray_origin(wo),
        beta: at(&rays.beta, i),
        path_class: rays.path_class[i].then_diffuse(),
        // Light paths do not scatter at surfaces that are not reciprocal.
        q: if shader.bsdf.is_reciprocal() { step.q(rays, hits, i) } else { 0.0 },
    });
    let uv = scene.uv(hits, i, surface.position);
    frames.push(ShadingFrame { surface, x: frame.x, y: frame.y, wo, local_wo: frame.to_local(wo), uv });
}
