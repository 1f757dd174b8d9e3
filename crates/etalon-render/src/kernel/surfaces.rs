//! Hits sorted by material, and the interactions there: each surface is evaluated once.

use super::state::{Interaction, Interactions, PathRays, ShadingFrame, Step, Vertices};
use crate::bsdf_lanes::Bsdfs;
use crate::lanes::{Hits, Rays, Rows, at};
use crate::light_tracing::projected;
use crate::prepared::PreparedScene;
use crate::shaders::{Kind, SurfaceShader};
use etalon_core::bsdf::{Bsdf, Scatter};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// The material of interactions: that of one object, or diffuse ones of any.
#[derive(Clone, Copy)]
pub struct GroupMaterial<'a> {
    /// That of the first interaction; others that are diffuse may have another albedo.
    pub shader: &'a SurfaceShader,
    /// In the order of the interactions; of diffuse ones their throughput has the albedo.
    pub bsdfs: Bsdfs<'a>,
}

impl GroupMaterial<'_> {
    pub fn kind(&self) -> Kind {
        self.shader.kind
    }
}

/// The group of all diffuse objects; others are groups by themselves.
pub const DIFFUSE: u32 = u32::MAX;

/// The hits of a step, sorted by material.
#[derive(Default)]
pub struct ByMaterial {
    /// Rays of the group [`DIFFUSE`], which are the most and need not be sorted.
    diffuse: Vec<u32>,
    /// The other rays, in the lower half, below the numbers of their groups.
    others: Vec<u64>,
    /// Those rays, in the same order.
    rays: Vec<u32>,
}

impl ByMaterial {
    /// Groups the first `count` rays by the material that they have hit. `group` is the number of a hit's group; `None` drops it, as
    /// black surfaces are.
    pub fn sort<'a>(
        &'a mut self,
        scene: &PreparedScene,
        hits: &Hits,
        count: usize,
        group: impl Fn(usize, &SurfaceShader) -> Option<u32>,
    ) -> impl Iterator<Item = &'a [u32]> {
        self.diffuse.clear();
        self.others.clear();
        for i in 0..count {
            let Some(shader) = scene.shaders.get(hits.object[i] as usize) else { continue };
            if shader.kind == Kind::Black {
                continue;
            }
            match group(i, shader) {
                Some(DIFFUSE) => self.diffuse.push(i as u32),
                Some(group) => self.others.push(u64::from(group) << 32 | i as u64),
                None => {}
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
    rays: &PathRays,
    hits: &Hits,
    group: &[u32],
    vertices: &mut Vertices,
    varying: &'a mut Vec<Bsdf>,
) -> GroupMaterial<'a> {
    let Vertices { interactions, frames } = vertices;
    let shader = &step.scene.shaders[hits.object[group[0] as usize] as usize];
    (interactions.count, frames.count) = (0, 0);
    if shader.kind.is_diffuse() {
        group.iter().for_each(|&i| diffuse(step, rays, hits, i as usize, interactions));
        return GroupMaterial { shader, bsdfs: Bsdfs::Same(&shader.bsdf) };
    }
    let is_traced = step.scene.light_tracing.is_some() && shader.bsdf.is_reciprocal();
    for &ray in group {
        let i = ray as usize;
        let (frame, normal) = shading_frame(step.scene, shader, &rays.ray, hits, i);
        // The back of what only reflects
        if shader.kind == Kind::Reflecting && frame.surface.normal.dot(frame.wo) < 0.0 {
            continue;
        }
        let (slot, beta) = (rays.slot[i], at(&rays.beta, i));
        // Light paths do not scatter at surfaces that are not reciprocal.
        let q = if is_traced { rays.previous[i].q } else { 0.0 };
        let (n, origin) = (frame.surface.normal, frame.surface.ray_origin(frame.wo));
        let path_class = rays.path_class[i].then_diffuse();
        interactions.push(Interaction { ray, slot, n, ns: normal, origin, beta, path_class, q });
        frames.push(frame);
    }
    GroupMaterial { shader, bsdfs: Bsdfs::of(shader, &frames.uv[..frames.count], varying) }
}

/// Adds the diffuse surface that a ray has hit.
#[inline(always)]
fn diffuse(step: Step, rays: &PathRays, hits: &Hits, i: usize, out: &mut Interactions) {
    let shader = &step.scene.shaders[hits.object[i] as usize];
    let wo = -at(&rays.ray.direction, i);
    let surface = shader.facing(step.scene.geometry.surface(&rays.ray, hits, i), wo);
    let bsdf = shader.bsdf_at(|| step.scene.geometry.uv(hits, i, surface.position));
    let Bsdf::Diffuse(diffuse) = &*bsdf else { unreachable!("a surface of the kind diffuse has a diffuse BSDF") };
    // Light tracing connects the first vertex to the camera without sampling.
    let reverse_pdf = if step.depth == 0 { 1.0 } else { surface.shading.dot(wo) * FRAC_1_PI };
    let q = rays.previous[i].q;
    let normals = [surface.normal, surface.shading];
    out.push(Interaction {
        ray: i as u32,
        slot: rays.slot[i],
        n: surface.normal,
        ns: surface.shading_for(wo),
        origin: surface.ray_origin(wo),
        beta: at(&rays.beta, i) * diffuse.albedo(),
        path_class: rays.path_class[i].then_diffuse(),
        q: if q > 0.0 { q * projected(normals, wo, reverse_pdf) } else { 0.0 },
    });
}

/// The surface that ray `i` has hit, with its shading frame, and the z axis of that.
#[inline(always)]
pub fn shading_frame(
    scene: &PreparedScene,
    shader: &SurfaceShader,
    rays: &Rays,
    hits: &Hits,
    i: usize,
) -> (ShadingFrame, Vec3) {
    let wo = -at(&rays.direction, i);
    let surface = shader.facing(scene.geometry.surface(rays, hits, i), wo);
    let frame = shader.frame(&surface, wo, || scene.geometry.tangent(hits, i, surface.normal));
    let uv = scene.uv(hits, i, surface.position);
    (ShadingFrame { surface, x: frame.x, y: frame.y, wo, local_wo: frame.to_local(wo), uv }, frame.z)
}
