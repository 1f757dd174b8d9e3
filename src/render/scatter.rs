//! How paths continue at mirrors, glass and rough metal.

use super::integrator::Integrator;
use super::lanes::{LANES, ZERO3, at, caustic, set};
use super::mis::power_heuristic;
use super::product_warp;
use super::rough;
use super::settings::Sampling;
use super::shaders::Kind;
use super::shading_normal;
use super::workspace::{Dimensions, RoughHit, Workspace};
use crate::bsdf::{Bsdf, Scatter};
use crate::math::Rgb;
use glam::Vec3;
use std::ops::Range;

impl Integrator<'_> {
    /// Extends the paths that have hit mirrors and glass.
    pub(super) fn scatter_delta(&self, work: &mut Workspace, dimensions: Dimensions) {
        let mut slots = [0; LANES];
        for (slot, &i) in slots.iter_mut().zip(&work.delta) {
            *slot = work.paths.slot[i as usize];
        }
        work.numbers.fill(self.arch, &slots[..work.delta.len()], dimensions.choice(), (0, 1), &mut work.u);
        for (k, &i) in work.delta.iter().enumerate() {
            let i = i as usize;
            let Kind::Delta(bsdf) = &self.shaders[work.hits.object[i] as usize].kind else { continue };
            let surface = self.scattering_surface(work, i);
            let direction = at(&work.paths.rays.direction, i);
            let frame = surface.frame(-direction);
            let Some(sample) = bsdf.sample(frame.to_local(-direction), work.u[0][k], [0.0; 2]) else { continue };
            let wi = frame.to_world(sample.wi);
            let throughput = at(&work.paths.throughput, i) * sample.weight;
            let j = work.next.count;
            work.next.push(
                surface.ray_origin(wi),
                wi,
                throughput,
                work.paths.slot[i],
                work.paths.path_class[i].then(true),
            );
            let tracing = self.light_tracing.as_ref();
            let is_traced = tracing.is_some_and(|tracing| tracing.scatters_at(work.hits.object[i]));
            work.next.caustic[j] = if is_traced { caustic::after_other(work.paths.caustic[i]) } else { caustic::NONE };
        }
    }

    /// Adds direct light at the rough hits and extends their paths, one object after the other.
    pub(super) fn scatter_rough<const NEEDS: u32>(&self, work: &mut Workspace, dimensions: Dimensions) {
        for group in work.rough_groups() {
            if let Kind::Rough(bsdf) = &self.shaders[work.rough[group.start].object as usize].kind {
                self.light_rough::<NEEDS>(work, group.clone(), bsdf, dimensions);
                self.extend_rough_paths(work, group, bsdf, dimensions);
            }
        }
    }

    /// Samples the BSDF at the hits on one rough object.
    pub(super) fn sample_rough(&self, work: &mut Workspace, group: Range<usize>, bsdf: &Bsdf, dimensions: Dimensions) {
        let (mut slots, mut wo) = ([0; LANES], ZERO3);
        let count = group.len();
        for (i, hit) in work.rough[group].iter().enumerate() {
            slots[i] = hit.slot;
            set(&mut wo, i, hit.wo);
        }
        work.numbers.fill(self.arch, &slots[..count], dimensions.bsdf(), (0, 1), &mut work.u);
        rough::sample_many(self.arch, bsdf, &wo, &work.u, count, &mut work.scattered);
    }

    /// Extends the paths that have hit one rough object.
    fn extend_rough_paths(&self, work: &mut Workspace, group: Range<usize>, bsdf: &Bsdf, dimensions: Dimensions) {
        self.sample_rough(work, group.clone(), bsdf, dimensions);
        let count_in_mis = product_warp::light_count_in_mis(bsdf);
        for (i, hit) in work.rough[group].iter().enumerate() {
            let weight = at(&work.scattered.weight, i);
            let wi = hit.frame.to_world(at(&work.scattered.wi, i));
            if weight == Rgb::ZERO || hit.surface.normal.dot(wi) <= 0.0 {
                continue;
            }
            let j = work.next.count;
            work.next.push(hit.surface.ray_origin(wi), wi, hit.throughput * weight, hit.slot, hit.path_class);
            let is_traced = hit.caustic && shading_normal::is_sound_to_light(&hit.surface, wi);
            work.next.caustic[j] = if is_traced { caustic::CHAIN } else { caustic::NONE };
            let pdf = work.scattered.pdf[i];
            (work.next.pdf[j], work.next.environment_share[j]) = match self.sampling {
                // All emission counts, except that of surfaces which are visible to the camera only.
                Sampling::Bsdf => (f32::MAX, 1.0),
                Sampling::Light | Sampling::Hemisphere => (0.0, 0.0),
                Sampling::Mis => (pdf / count_in_mis, self.environment_weight(hit, wi, pdf)),
            };
        }
    }

    /// The MIS weight of the environment's radiance in a direction sampled by a rough material.
    #[inline]
    fn environment_weight(&self, hit: &RoughHit, wi: Vec3, pdf: f32) -> f32 {
        let other = self.environment_pdf(wi, hit.frame.z) as f32;
        power_heuristic(pdf, self.request.light_samples as f32 * other)
    }
}
