//! Light tracing of caustics.
//!
//! Few directions from a diffuse surface lead to an area light by way of mirrors, glass or metal. Light paths find these
//! easily: they start from area lights towards the objects that are not diffuse, and where they arrive at a diffuse surface
//! that the camera sees, their contribution is splatted to its pixel; so is what one more diffuse surface scatters there.
//! Camera paths leave this light out ([`caustic`](super::lanes::caustic)), so that it counts once.
//!
//! Source: Arvo, "Backward ray tracing", SIGGRAPH 1986 course notes; Veach, "Robust Monte Carlo Methods for Light
//! Transport Simulation", 1997, sections 5.3 (shading normals) and 10.3.4 (light tracing).

mod plan;
#[cfg(test)]
mod tests;

use super::diffuse;
use super::film::{PathClass, Splat};
use super::integrator::{Integrator, SHORT_OF_LIGHT, roulette};
use super::lanes::{LANES, NOTHING, at, set};
use super::lens::Lens;
use super::shaders::Kind;
use super::shading_normal;
use super::workspace::{Dimensions, Workspace};
use crate::bsdf::Scatter;
use crate::math::Rgb;
pub use plan::LightTracing;
use plan::SAMPLES_PER_LIGHT_PATH;
use std::f32::consts::FRAC_1_PI;

impl Integrator<'_> {
    /// Traces a light path for each of the first `count` slots and appends its contributions, which stand for
    /// [`SAMPLES_PER_LIGHT_PATH`] samples of a pixel, to `work.splats`.
    pub fn trace_light_paths(&self, work: &mut Workspace, count: usize, lens: &Lens) {
        let Some(tracing) = &self.light_tracing else { return };
        self.start_light_paths(work, tracing, count);
        // The scattering at the diffuse surface counts towards the depth.
        for scatterings in 1..=self.request.max_depth {
            let count = work.paths.count;
            if count == 0 {
                return;
            }
            let last = scatterings == self.request.max_depth;
            self.geometry.nearest(&work.paths.rays, count, &mut work.hits);
            work.delta.clear();
            work.rough.clear();
            work.arrived.clear();
            work.points.count = 0;
            for i in 0..count {
                let object = work.hits.object[i];
                if object == NOTHING {
                    continue;
                }
                let after_diffuse = work.paths.caustic[i] != 0;
                match self.shaders[object as usize].kind {
                    // Light samples find direct light.
                    Kind::Diffuse { albedo } if scatterings > 1 => {
                        work.arrived.push(i as u32);
                        let flat = || self.geometry.surface(&work.paths.rays, &work.hits, i).is_flat();
                        if !after_diffuse && !last && flat() {
                            self.collect(work, i, albedo);
                        }
                    }
                    _ if after_diffuse => {}
                    _ if last || !tracing.scatters_at(object) => {}
                    Kind::Delta(_) => work.delta.push(i as u32),
                    Kind::Rough(_) => self.collect_rough(work, i),
                    Kind::Black | Kind::Diffuse { .. } => {}
                }
            }
            self.splat(work, tracing, lens);
            work.next.count = 0;
            let dimensions = Dimensions::of_light_paths(scatterings);
            self.extend_diffuse(work, dimensions);
            self.extend_delta(work, dimensions);
            self.extend_rough(work, dimensions);
            roulette(&mut work.next, &work.numbers, dimensions.choice(), scatterings);
            std::mem::swap(&mut work.paths, &mut work.next);
        }
        work.paths.count = 0;
    }

    /// Samples an area light, a point on it, and a direction to a target for each slot.
    fn start_light_paths(&self, work: &mut Workspace, tracing: &LightTracing, count: usize) {
        work.paths.count = 0;
        let dimensions = Dimensions::of_light_paths(0);
        let slots: [u32; LANES] = std::array::from_fn(|slot| slot as u32);
        let mut u = [[[0.0; LANES]; 2]; 3];
        for (u, dimension) in u.iter_mut().zip([dimensions.choice(), dimensions.bsdf_direct(), dimensions.bsdf()]) {
            work.numbers.fill(self.arch, &slots[..count], dimension, (0, 1), u);
        }
        for slot in 0..count {
            let [[u_light, u_target], place, within] = u.each_ref().map(|[a, b]| [a[slot], b[slot]]);
            let chosen = tracing.light(u_light);
            let light = &self.lights[chosen.light];
            let Some(start) = light.start(place) else { continue };
            let (direction, solid_angle) = tracing.direction(start.position, u_target, within);
            let cos = start.normal.dot(direction);
            let emitted_cos = if start.two_sided { cos.abs() } else { cos.max(0.0) };
            if emitted_cos == 0.0 {
                continue;
            }
            set(&mut work.power, slot, chosen.power * (emitted_cos * solid_angle * SAMPLES_PER_LIGHT_PATH as f32));
            let origin = start.position + start.normal * self.geometry.offset(light.object).copysign(cos);
            work.paths.push(origin, direction, Rgb::ONE, slot as u32, PathClass::DIRECT);
        }
    }

    /// Connects the hits on diffuse surfaces to the camera and splats their contributions.
    fn splat(&self, work: &mut Workspace, tracing: &LightTracing, lens: &Lens) {
        let mut pixel = [[0; 2]; LANES];
        work.shadows.count = 0;
        for k in 0..work.arrived.len() {
            let i = work.arrived[k] as usize;
            let Kind::Diffuse { albedo } = self.shaders[work.hits.object[i] as usize].kind else { continue };
            let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
            let wi = -at(&work.paths.rays.direction, i);
            let Some(view) = lens.project(surface.position) else { continue };
            let side = if surface.normal.dot(view.direction) > 0.0 { 1.0 } else { -1.0 };
            let normal = surface.normal * side;
            let origin = surface.position + normal * surface.offset;
            let area = lens.area_at(origin);
            if normal.dot(wi) <= 0.0 || !surface.is_flat() || !tracing.reaches(area) {
                continue;
            }
            let slot = work.paths.slot[i];
            let power = at(&work.power, slot as usize) * at(&work.paths.throughput, i);
            let importance = normal.dot(view.direction) / area;
            let value = power * albedo * (FRAC_1_PI * importance);
            let word = work.paths.path_class[i].then(false).reversed();
            pixel[work.shadows.count] = view.pixel;
            let limit = view.distance * SHORT_OF_LIGHT;
            work.shadows.push(origin, view.direction, limit, value, slot, word);
        }
        let shadows = &work.shadows;
        self.geometry.occluded(&shadows.rays, shadows.count, &shadows.limit, NOTHING, &mut work.blocked);
        for k in 0..work.shadows.count {
            if work.blocked[k] == 0 {
                let class = self.classes.map_or(0, |classes| classes.index(work.shadows.path_class[k]));
                work.splats.push(Splat { pixel: pixel[k], class, value: at(&work.shadows.value, k) });
            }
        }
    }

    /// Extends the paths that have hit diffuse surfaces, by one scattering.
    fn extend_diffuse(&self, work: &mut Workspace, dimensions: Dimensions) {
        let count = work.points.count;
        work.numbers.fill(self.arch, &work.points.slot[..count], dimensions.bsdf(), (0, 1), &mut work.u);
        diffuse::extend_paths(self.arch, &work.points, &work.u, &mut work.next);
        work.next.caustic[..count].fill(1);
    }

    /// Extends the paths that have hit mirrors and glass, with the adjoint BSDF.
    fn extend_delta(&self, work: &mut Workspace, dimensions: Dimensions) {
        for k in 0..work.delta.len() {
            let i = work.delta[k] as usize;
            let Kind::Delta(bsdf) = &self.shaders[work.hits.object[i] as usize].kind else { continue };
            let surface = self.scattering_surface(work, i);
            let wo = -at(&work.paths.rays.direction, i);
            let (frame, slot) = (surface.frame(wo), work.paths.slot[i]);
            let [uc, _] = work.numbers.short_pair(slot, dimensions.choice(), (0, 1));
            let Some(sample) = bsdf.sample_adjoint(frame.to_local(wo), uc, [0.0; 2]) else {
                continue;
            };
            let wi = frame.to_world(sample.wi);
            let throughput = at(&work.paths.throughput, i) * sample.weight;
            work.next.push(surface.ray_origin(wi), wi, throughput, slot, work.paths.path_class[i].then(true));
        }
    }

    /// Extends the paths that have hit rough metal, one object after the other.
    fn extend_rough(&self, work: &mut Workspace, dimensions: Dimensions) {
        for group in work.rough_groups() {
            let Kind::Rough(bsdf) = &self.shaders[work.rough[group.start].object as usize].kind else { continue };
            self.sample_rough(work, group.clone(), bsdf, dimensions);
            for (i, hit) in work.rough[group].iter().enumerate() {
                let weight = at(&work.scattered.weight, i);
                let wi = hit.frame.to_world(at(&work.scattered.wi, i));
                if weight == Rgb::ZERO || hit.surface.normal.dot(wi) <= 0.0 {
                    continue;
                }
                let Some(factor) = shading_normal::adjoint_factor(&hit.surface, hit.frame.to_world(hit.wo), wi) else {
                    continue;
                };
                work.next.push(
                    hit.surface.ray_origin(wi),
                    wi,
                    hit.throughput * weight * factor,
                    hit.slot,
                    hit.path_class,
                );
            }
        }
    }
}
