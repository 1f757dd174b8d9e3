//! Direct light at a hit: next event estimation, and BSDF samples where the strategy asks for them.

use super::integrator::{Integrator, SHORT_OF_LIGHT};
use super::lanes::{LANES, NOTHING, ZERO3, at, set};
use super::lights::{self, Kind, LightSamples};
use super::mis::{balance_weight_over_pdf, power_heuristic};
use super::needs::Needs;
use super::settings::Sampling;
use super::strategies::BsdfOnly;
use super::workspace::{Dimensions, Workspace};
use super::{diffuse, product_warp, rough, shading_normal};
use crate::bsdf::Bsdf;
use crate::math::{Frame, Rgb};
use crate::scene::Environment;
use glam::DVec3;
use std::f32::consts::{FRAC_1_PI, PI};
use std::ops::Range;

impl Integrator<'_> {
    /// Whether light `number` is sampled: always, if rays cannot hit it.
    fn samples_light(&self, number: usize) -> bool {
        self.sampling.by_light() || self.lights[number].object == NOTHING
    }

    /// Adds direct light at the diffuse hits.
    pub(super) fn light_diffuse<const NEEDS: u32>(&self, work: &mut Workspace, dimensions: Dimensions) {
        let samples = self.request.light_samples;
        if Needs::LIGHTS.is_in(NEEDS) {
            for (number, light) in self.lights.iter().enumerate().filter(|(i, _)| self.samples_light(*i)) {
                // A delta light needs one sample.
                let sample_count = if light.has_extent() { samples } else { 1 };
                for index in 0..sample_count {
                    let slots = &work.points.slot[..work.points.count];
                    work.numbers.fill(self.arch, slots, dimensions.light(number), (index, sample_count), &mut work.u);
                    let scale = 1.0 / sample_count as f32;
                    diffuse::towards_light(self.arch, &work.points, light, &work.u, scale, &mut work.shadows);
                    self.trace_shadow_rays::<NEEDS>(work, light.object);
                }
            }
        }
        if Needs::ENVIRONMENT.is_in(NEEDS)
            && let Some(environment) = &self.scene.environment
            && self.strategies.light().is_some()
        {
            for index in 0..samples {
                self.diffuse_to_environment::<NEEDS>(work, environment, dimensions.environment(), (index, samples));
            }
        }
        if let Some(bsdf_only) = self.strategies.bsdf_only() {
            for index in 0..samples {
                self.sample_bsdf_direct::<NEEDS>(work, bsdf_only, dimensions.bsdf_direct(), (index, samples));
            }
        }
    }

    /// Adds one environment sample at each diffuse hit; `sample` is its index and their number.
    fn diffuse_to_environment<const NEEDS: u32>(
        &self,
        work: &mut Workspace,
        environment: &Environment,
        dimension: u32,
        sample: (u32, u32),
    ) {
        let Some(sampler) = self.strategies.light() else { return };
        let scale = environment.scale / (sample.1 as f32 * PI);
        work.shadows.count = 0;
        for i in 0..work.points.count {
            let normal = at(&work.points.normal, i).as_dvec3();
            let u = work.numbers.pair(work.points.slot[i], dimension, sample);
            let Some(light) = sampler.sample_for(u, environment.to_map(normal)) else { continue };
            let wi: DVec3 = environment.to_world * light.wi;
            let cos = normal.dot(wi);
            if cos <= 0.0 {
                continue;
            }
            let other = self.strategies.bsdf_only().map_or(0.0, |scatter| scatter.pdf(cos));
            let share = (cos * balance_weight_over_pdf(light.pdf, other)) as f32;
            let value = at(&work.points.weight, i) * scale * light.radiance * share;
            let (slot, word) = (work.points.slot[i], work.points.path_class[i]);
            work.shadows.push(at(&work.points.position, i), wi.as_vec3(), f32::INFINITY, value, slot, word);
        }
        self.trace_shadow_rays::<NEEDS>(work, NOTHING);
    }

    /// Adds the emission found in a direction sampled at each diffuse hit without regard to the lights.
    fn sample_bsdf_direct<const NEEDS: u32>(
        &self,
        work: &mut Workspace,
        bsdf_only: BsdfOnly,
        dimension: u32,
        sample: (u32, u32),
    ) {
        work.shadows.count = 0;
        for i in 0..work.points.count {
            let slot = work.points.slot[i];
            let normal = at(&work.points.normal, i);
            let Frame { x, y, .. } = Frame::from_normal(normal);
            let local = bsdf_only.sample(work.numbers.pair(slot, dimension, sample));
            let wi = x * local.x as f32 + y * local.y as f32 + normal * local.z as f32;
            let pdf = bsdf_only.pdf(local.z);
            if pdf <= 0.0 {
                continue;
            }
            let other = self.environment_pdf(wi, normal);
            let share = (local.z * balance_weight_over_pdf(pdf, other)) as f32 * FRAC_1_PI / sample.1 as f32;
            let value = at(&work.points.weight, i) * share;
            let word = work.points.path_class[i];
            work.shadows.push(at(&work.points.position, i), wi, f32::INFINITY, value, slot, word);
        }
        self.trace_for_emitters::<NEEDS>(work);
    }

    /// Adds direct light at the rough hits on one object.
    pub(super) fn light_rough<const NEEDS: u32>(
        &self,
        work: &mut Workspace,
        group: Range<usize>,
        bsdf: &Bsdf,
        dimensions: Dimensions,
    ) {
        let samples = self.request.light_samples;
        let (count, count_in_mis) = (group.len(), product_warp::light_count_in_mis(bsdf));
        let (mut slots, mut positions) = ([0; LANES], ZERO3);
        for (i, hit) in work.rough[group.clone()].iter().enumerate() {
            slots[i] = hit.slot;
            set(&mut positions, i, hit.surface.position);
        }
        let slots = &slots[..count];
        let mut light = LightSamples::default();
        if Needs::LIGHTS.is_in(NEEDS) {
            // In a group, light tracing contributes all light of a light to all hits or to none.
            let traced = |number| self.light_tracing.as_ref().is_some_and(|tracing| tracing.starts_at(number));
            let is_traced = work.rough[group.start].is_light_traced();
            let lights =
                self.lights.iter().enumerate().filter(|(i, _)| self.samples_light(*i) && !(is_traced && traced(*i)));
            for (number, source) in lights {
                let sample_count = if source.has_extent() { samples } else { 1 };
                for index in 0..sample_count {
                    work.numbers.fill(self.arch, slots, dimensions.light(number), (index, sample_count), &mut work.u);
                    // BSDF samples find area lights, too: weight both by MIS.
                    let by_mis = source.object != NOTHING && self.sampling == Sampling::Mis;
                    // For broad metal, warp the random numbers in proportion to what it scatters.
                    let warped = match &source.kind {
                        Kind::Rectangle(rectangle) if by_mis && count_in_mis > 1.0 => Some(rectangle),
                        _ => None,
                    };
                    let mut warp_pdf = [1.0; LANES];
                    if let Some(rectangle) = warped {
                        let hits = &work.rough[group.clone()];
                        product_warp::warp(self.arch, bsdf, rectangle, hits, sample_count, &mut work.u, &mut warp_pdf);
                    }
                    lights::sample_many(self.arch, source, &positions, count, &work.u, &mut light);
                    if warped.is_some() {
                        for weight in &mut light.weight {
                            (0..count).for_each(|i| weight[i] /= warp_pdf[i]);
                        }
                    }
                    // Leave out what light tracing contributes.
                    if traced(number) {
                        for (i, hit) in work.rough[group.clone()].iter().enumerate() {
                            if hit.caustic && shading_normal::is_sound_to_light(&hit.surface, at(&light.wi, i)) {
                                set(&mut light.weight, i, Rgb::ZERO);
                            }
                        }
                    }
                    self.sample_light(work, group.clone(), bsdf, &light, sample_count, by_mis.then_some(count_in_mis));
                    self.trace_shadow_rays::<NEEDS>(work, source.object);
                }
            }
        }
        if Needs::ENVIRONMENT.is_in(NEEDS)
            && let (Some(environment), Some(sampler)) = (&self.scene.environment, self.strategies.light())
        {
            for index in 0..samples {
                for (i, hit) in work.rough[group.clone()].iter().enumerate() {
                    let u = work.numbers.pair(hit.slot, dimensions.environment(), (index, samples));
                    let sampled = sampler.sample_for(u, environment.to_map(hit.frame.z.as_dvec3()));
                    let (wi, radiance, pdf) = sampled.map_or((DVec3::Z, Rgb::ZERO, 1.0), |s| (s.wi, s.radiance, s.pdf));
                    set(&mut light.wi, i, (environment.to_world * wi).as_vec3());
                    set(&mut light.weight, i, environment.scale * radiance / pdf as f32);
                    (light.distance[i], light.pdf[i]) = (f32::INFINITY, pdf as f32);
                }
                let by_mis = (self.sampling == Sampling::Mis).then_some(1.0);
                self.sample_light(work, group.clone(), bsdf, &light, samples, by_mis);
                self.trace_shadow_rays::<NEEDS>(work, NOTHING);
            }
        }
        if self.sampling == Sampling::Hemisphere {
            for index in 0..samples {
                for (i, hit) in work.rough[group.clone()].iter().enumerate() {
                    let u = work.numbers.pair(hit.slot, dimensions.bsdf_direct(), (index, samples));
                    let local = BsdfOnly::Hemisphere.sample(u);
                    let pdf = BsdfOnly::Hemisphere.pdf(local.z) as f32;
                    set(&mut light.wi, i, hit.frame.to_world(local.as_vec3()));
                    set(&mut light.weight, i, Rgb::splat(1.0 / pdf));
                    (light.distance[i], light.pdf[i]) = (f32::INFINITY, pdf);
                }
                self.sample_light(work, group.clone(), bsdf, &light, samples, None);
                self.trace_for_emitters::<NEEDS>(work);
            }
        }
    }

    /// Traces a shadow ray from each hit of a group along its sample of `light`, one of `sample_count`. Where BSDF samples find the
    /// same light, `count_in_mis` is the number of light samples that the MIS weight assumes for each.
    fn sample_light(
        &self,
        work: &mut Workspace,
        group: Range<usize>,
        bsdf: &Bsdf,
        light: &LightSamples,
        sample_count: u32,
        count_in_mis: Option<f32>,
    ) {
        let hits = &work.rough[group];
        let mut wo = ZERO3;
        let scattered = &mut work.scattered;
        for (i, hit) in hits.iter().enumerate() {
            set(&mut wo, i, hit.wo);
            set(&mut scattered.wi, i, hit.frame.to_local(at(&light.wi, i)));
        }
        rough::eval_many(self.arch, bsdf, &wo, hits.len(), scattered);
        work.shadows.count = 0;
        for (i, hit) in hits.iter().enumerate() {
            let (wi, f) = (at(&light.wi, i), at(&scattered.weight, i));
            let (cos, weight) = (scattered.wi[2][i], at(&light.weight, i));
            let value = hit.throughput * f * weight * (cos / sample_count as f32);
            // Skip black samples, and those that the shading normal would let through the surface.
            if !(value.max_element() > 0.0 && hit.surface.normal.dot(wi) > 0.0) {
                continue;
            }
            let weight = |count: f32| power_heuristic(count * sample_count as f32 * light.pdf[i], scattered.pdf[i]);
            let share = count_in_mis.map_or(1.0, weight);
            work.shadows.push(
                hit.surface.ray_origin(wi),
                wi,
                light.distance[i],
                value * share,
                hit.slot,
                hit.path_class,
            );
        }
    }

    /// Traces the shadow rays and adds the values of those that are not occluded.
    fn trace_shadow_rays<const NEEDS: u32>(&self, work: &mut Workspace, light: u32) {
        if Needs::OCCLUSION.is_in(NEEDS) {
            let shadows = &mut work.shadows;
            for limit in &mut shadows.limit[..shadows.count] {
                *limit *= SHORT_OF_LIGHT;
            }
            self.geometry.occluded(&shadows.rays, shadows.count, &shadows.limit, light, &mut work.blocked);
        } else {
            work.blocked[..work.shadows.count].fill(0);
        }
        for i in 0..work.shadows.count {
            if work.blocked[i] == 0 {
                work.add(work.shadows.slot[i], work.shadows.path_class[i], at(&work.shadows.value, i));
            }
        }
    }

    /// Traces rays and adds the emission that they find, times their value.
    fn trace_for_emitters<const NEEDS: u32>(&self, work: &mut Workspace) {
        self.geometry.nearest(&work.shadows.rays, work.shadows.count, &mut work.found);
        // Beside light samples only the environment counts.
        let with_objects = !self.sampling.by_light();
        for i in 0..work.shadows.count {
            let direction = at(&work.shadows.rays.direction, i);
            let radiance = match work.found.object[i] {
                NOTHING => match &self.scene.environment {
                    Some(environment) if Needs::ENVIRONMENT.is_in(NEEDS) => environment.radiance(direction.as_dvec3()),
                    _ => continue,
                },
                object => match &self.shaders[object as usize].emission {
                    Some(emission) if with_objects => {
                        let surface = self.geometry.surface(&work.shadows.rays, &work.found, i);
                        if !emission.is_emitted(surface.normal, direction) {
                            continue;
                        }
                        emission.radiance
                    }
                    _ => continue,
                },
            };
            work.add(work.shadows.slot[i], work.shadows.path_class[i], at(&work.shadows.value, i) * radiance);
        }
    }
}
