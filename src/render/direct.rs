//! Light that comes straight to a hit: shadow rays towards lights, and rays in search of light where that is asked for.

use super::geometry::at;
use super::integrator::{Dimensions, Integrator, Workspace, power_heuristic};
use super::lanes::{LANES, NOTHING};
use super::lights::SampleLight;
use super::needs::Needs;
use super::strategies::Scatter as Blind;
use super::{Sampling, diffuse};
use crate::bsdf::Scatter;
use crate::raster::Rgb;
use crate::scene::Environment;
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// Shadow rays end this fraction of the way short of the light, which rounding could otherwise put behind itself.
const SHORT_OF_LIGHT: f32 = 1.0 - 1e-4;

impl Integrator<'_> {
    /// Whether light `number` is found by shadow rays: always, if nothing else can find it.
    fn aims_at(&self, number: usize) -> bool {
        matches!(self.sampling, Sampling::Light | Sampling::Mis) || self.lights[number].object == NOTHING
    }

    /// Adds the light that comes straight to the diffuse hits.
    pub(super) fn light_diffuse<const NEEDS: u32>(&self, work: &mut Workspace, dimensions: Dimensions) {
        let samples = self.request.light_samples;
        if Needs::LAMPS.is_in(NEEDS) {
            for (number, light) in self.lights.iter().enumerate().filter(|(i, _)| self.aims_at(*i)) {
                // Light from one direction is the same every time.
                let draws = if light.has_extent() { samples } else { 1 };
                for index in 0..draws {
                    let slots = &work.points.slot[..work.points.count];
                    work.numbers.fill(self.arch, slots, dimensions.light(number), (index, draws), &mut work.u);
                    let scale = 1.0 / draws as f32;
                    diffuse::towards_light(self.arch, &work.points, light, &work.u, scale, &mut work.shadows);
                    self.cast::<NEEDS>(work, light.object);
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
        if let Some(blind) = self.strategies.scatter() {
            for index in 0..samples {
                self.gather_diffuse::<NEEDS>(work, blind, dimensions.gather(), (index, samples));
            }
        }
    }

    fn diffuse_to_environment<const NEEDS: u32>(
        &self,
        work: &mut Workspace,
        environment: &Environment,
        dimension: u32,
        draw: (u32, u32),
    ) {
        let Some(sampler) = self.strategies.light() else { return };
        let scale = environment.scale / (draw.1 as f32 * PI);
        work.shadows.count = 0;
        for i in 0..work.points.count {
            let normal = at(&work.points.normal, i).as_dvec3();
            let u = work.numbers.pair(work.points.slot[i], dimension, draw);
            let Some(light) = sampler.sample_for(u, environment.to_map(normal)) else { continue };
            let wi: DVec3 = environment.to_world * light.wi;
            let cos = normal.dot(wi);
            if cos <= 0.0 {
                continue;
            }
            let other = self.strategies.scatter().map_or(0.0, |scatter| scatter.pdf(cos));
            let share = (cos * balance_heuristic(light.pdf, other)) as f32;
            let value = at(&work.points.weight, i) * scale * light.radiance * share;
            let (slot, word) = (work.points.slot[i], work.points.word[i]);
            work.shadows.push(at(&work.points.position, i), wi.as_vec3(), f32::INFINITY, value, slot, word);
        }
        self.cast::<NEEDS>(work, NOTHING);
    }

    /// Looks for light in directions that do not depend on where it is.
    fn gather_diffuse<const NEEDS: u32>(&self, work: &mut Workspace, blind: Blind, dimension: u32, draw: (u32, u32)) {
        work.shadows.count = 0;
        for i in 0..work.points.count {
            let slot = work.points.slot[i];
            let normal = at(&work.points.normal, i);
            let (x, y) = diffuse::frame(normal);
            let local = blind.sample(work.numbers.pair(slot, dimension, draw));
            let wi = x * local.x as f32 + y * local.y as f32 + normal * local.z as f32;
            let pdf = blind.pdf(local.z);
            if pdf <= 0.0 {
                continue;
            }
            let other = match (&self.scene.environment, self.strategies.light()) {
                (Some(environment), Some(light)) => {
                    let map = |w: Vec3| environment.to_map(w.as_dvec3());
                    light.pdf_for(map(wi), map(normal))
                }
                _ => 0.0,
            };
            let share = (local.z * balance_heuristic(pdf, other)) as f32 * FRAC_1_PI / draw.1 as f32;
            let value = at(&work.points.weight, i) * share;
            let word = work.points.word[i];
            work.shadows.push(at(&work.points.position, i), wi, f32::INFINITY, value, slot, word);
        }
        self.find::<NEEDS>(work);
    }

    /// Adds the light that comes straight to the rough hits.
    pub(super) fn light_rough<const NEEDS: u32>(&self, work: &mut Workspace, dimensions: Dimensions) {
        let samples = self.request.light_samples;
        let mut slots = [0; LANES];
        for (slot, hit) in slots.iter_mut().zip(&work.rough) {
            *slot = hit.slot;
        }
        let slots = &slots[..work.rough.len()];
        if Needs::LAMPS.is_in(NEEDS) {
            for (number, light) in self.lights.iter().enumerate().filter(|(i, _)| self.aims_at(*i)) {
                let draws = if light.has_extent() { samples } else { 1 };
                for index in 0..draws {
                    work.numbers.fill(self.arch, slots, dimensions.light(number), (index, draws), &mut work.u);
                    work.shadows.count = 0;
                    for k in 0..work.rough.len() {
                        let hit = work.rough[k];
                        let sample = light.sample(hit.surface.position, [work.u[0][k], work.u[1][k]]);
                        // Where the material's own directions find the light as well, they share it.
                        let rivals = if light.object == NOTHING { 0.0 } else { draws as f32 * sample.pdf };
                        self.aim(work, k, sample.wi, sample.distance, sample.weight / draws as f32, rivals);
                    }
                    self.cast::<NEEDS>(work, light.object);
                }
            }
        }
        if Needs::ENVIRONMENT.is_in(NEEDS)
            && let (Some(environment), Some(sampler)) = (&self.scene.environment, self.strategies.light())
        {
            for index in 0..samples {
                work.shadows.count = 0;
                for k in 0..work.rough.len() {
                    let u = work.numbers.pair(slots[k], dimensions.environment(), (index, samples));
                    let normal = environment.to_map(work.rough[k].frame.z.as_dvec3());
                    let Some(light) = sampler.sample_for(u, normal) else { continue };
                    let wi = (environment.to_world * light.wi).as_vec3();
                    let weight = environment.scale * light.radiance / (light.pdf as f32 * samples as f32);
                    self.aim(work, k, wi, f32::INFINITY, weight, samples as f32 * light.pdf as f32);
                }
                self.cast::<NEEDS>(work, NOTHING);
            }
        }
        if self.sampling == Sampling::Hemisphere {
            for index in 0..samples {
                work.shadows.count = 0;
                for k in 0..work.rough.len() {
                    let local =
                        Blind::Hemisphere.sample(work.numbers.pair(slots[k], dimensions.gather(), (index, samples)));
                    let wi = work.rough[k].frame.world(local.as_vec3());
                    let weight = Rgb::splat(1.0 / (samples as f32 * Blind::Hemisphere.pdf(local.z) as f32));
                    self.aim(work, k, wi, f32::INFINITY, weight, 0.0);
                }
                self.find::<NEEDS>(work);
            }
        }
    }

    /// Puts up a ray from rough hit `k` to `wi`. `weight` is what arrives from there, over its density; `light_pdf` is
    /// that density times the number of samples if the material's own directions compete, else 0.
    #[inline]
    fn aim(&self, work: &mut Workspace, k: usize, wi: Vec3, distance: f32, weight: Rgb, light_pdf: f32) {
        let hit = work.rough[k];
        let Some(bsdf) = self.rough_bsdf(&hit) else { return };
        let local = hit.frame.local(wi);
        if local.z <= 0.0 || hit.surface.normal.dot(wi) <= 0.0 || weight == Rgb::ZERO {
            return;
        }
        let (f, pdf) = bsdf.eval_pdf(hit.wo, local);
        let competes = self.sampling == Sampling::Mis && light_pdf > 0.0;
        let share = if competes { power_heuristic(light_pdf, pdf) } else { 1.0 };
        let value = hit.throughput * f * weight * (local.z * share);
        work.shadows.push(hit.surface.leave(wi), wi, distance, value, hit.slot, hit.word);
    }

    /// Adds what the shadow rays bring that nothing stands in the way of.
    fn cast<const NEEDS: u32>(&self, work: &mut Workspace, light: u32) {
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
                work.add(work.shadows.slot[i], work.shadows.word[i], at(&work.shadows.value, i));
            }
        }
    }

    /// Adds what rays in search of light find, which is multiplied by their value.
    fn find<const NEEDS: u32>(&self, work: &mut Workspace) {
        self.geometry.nearest(&work.shadows.rays, work.shadows.count, &mut work.hits);
        // Beside light samples only the environment is looked for.
        let lamps = matches!(self.sampling, Sampling::Bsdf | Sampling::Hemisphere);
        for i in 0..work.shadows.count {
            let direction = at(&work.shadows.rays.direction, i);
            let radiance = match work.hits.object[i] {
                NOTHING => match &self.scene.environment {
                    Some(environment) if Needs::ENVIRONMENT.is_in(NEEDS) => environment.radiance(direction.as_dvec3()),
                    _ => continue,
                },
                object => match &self.faces[object as usize].emission {
                    Some(emission) if lamps => {
                        let surface = self.geometry.surface(&work.shadows.rays, &work.hits, i);
                        let back = surface.normal.dot(direction) > 0.0;
                        if back && !emission.two_sided { continue } else { emission.radiance }
                    }
                    _ => continue,
                },
            };
            work.add(work.shadows.slot[i], work.shadows.word[i], at(&work.shadows.value, i) * radiance);
        }
    }
}

/// The weight of a sample over its density `p` when another strategy, of density `other` there, draws as many:
/// (p / (p + q)) / p. Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 3.
#[inline]
fn balance_heuristic(p: f64, other: f64) -> f64 {
    1.0 / (p + other)
}
