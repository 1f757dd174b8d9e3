//! A scalar path tracer that draws the integrator's random numbers: what the textbook describes, one path after the other.
//!
//! Tests compare the integrator with it, sample by sample. It knows light sampling, BSDF sampling and their combination,
//! but not light tracing, caustic cones and product warps.

use super::integrator::{Integrator, ROULETTE_AFTER, ROULETTE_BELOW, SHORT_OF_LIGHT};
use super::job::Job;
use super::lanes::{Hits, LANES, NOTHING, Rays, at, set};
use super::lights::SampleLight;
use super::mis::{balance_weight_over_pdf, power_heuristic};
use super::sample_lanes::SampleLanes;
use super::settings::Sampling;
use super::shaders::{Kind, SurfaceShader};
use super::strategies::BsdfOnly;
use super::workspace::Dimensions;
use crate::bsdf::{Bsdf, Scatter};
use crate::math::{Frame, Rgb};
use crate::render::geometry::Surface;
use crate::scene::EmitterVisibility;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// How far light samples have counted the light that the next ray of a path finds.
#[derive(Clone, Copy)]
enum Counted {
    /// Not at all: light samples cannot find it.
    Nothing,
    /// All light of sampled lights.
    All,
    /// A part: the pdf of the ray's direction gives the MIS weight against area lights; that against the environment is known.
    Part { pdf: f32, environment: f32 },
}

/// A point on a diffuse (without `bsdf`) or rough surface.
struct Vertex<'a> {
    surface: Surface,
    frame: Frame,
    /// Offset from a diffuse surface.
    position: Vec3,
    wo: Vec3,
    albedo: Rgb,
    bsdf: Option<&'a Bsdf>,
}

impl Vertex<'_> {
    /// The BSDF times the cosine, and the pdf of BSDF samples (0 of diffuse surfaces).
    fn eval(&self, wi: Vec3) -> (Rgb, f32) {
        let local = self.frame.to_local(wi);
        let Some(bsdf) = self.bsdf else { return (self.albedo * (FRAC_1_PI * local.z.max(0.0)), 0.0) };
        let (f, pdf) = bsdf.eval_pdf(self.wo, local);
        (if self.surface.normal.dot(wi) > 0.0 { f * local.z.max(0.0) } else { Rgb::ZERO }, pdf)
    }

    fn ray_origin(&self, wi: Vec3) -> Vec3 {
        if self.bsdf.is_some() { self.surface.ray_origin(wi) } else { self.position }
    }
}

/// The path tracer, with room for the ray that it traces.
pub struct Reference<'a> {
    job: &'a Job<'a>,
    numbers: SampleLanes,
    rays: Box<Rays>,
    hits: Box<Hits>,
}

impl<'a> Reference<'a> {
    pub fn new(job: &'a Job<'a>) -> Self {
        let numbers = SampleLanes::new(job.settings.stream, job.settings.seed);
        Self { job, numbers, rays: Box::default(), hits: Box::default() }
    }

    fn integrator(&self) -> &'a Integrator<'a> {
        &self.job.integrator
    }

    /// The radiance of one camera sample.
    pub fn radiance(&mut self, x: u32, y: u32, sample: u32) -> Rgb {
        let integrator = self.integrator();
        let max_depth = integrator.request.max_depth;
        self.numbers.assign(0, u64::from(y) * integrator.request.width as u64 + u64::from(x), sample);
        // Generate the camera ray.
        let u = self.numbers.short_pair(0, 0, (0, 1)).map(|u| [u; LANES]);
        self.job.lens.rays(integrator.arch, &[x; LANES], y, &u, 1, &mut self.rays);
        let (mut origin, mut direction) = (at(&self.rays.origin, 0), at(&self.rays.direction, 0));
        let (mut sum, mut throughput, mut counted) = (Rgb::ZERO, Rgb::ONE, Counted::Nothing);
        for scatterings in 0..=max_depth {
            // Add the light that the ray finds.
            let Some((object, surface)) = self.nearest(origin, direction) else {
                let share = match counted {
                    Counted::Nothing => 1.0,
                    Counted::All => 0.0,
                    Counted::Part { environment, .. } => environment,
                };
                sum += throughput * self.environment(direction) * share;
                break;
            };
            let shader = &integrator.shaders[object];
            sum += throughput * self.emitted(shader, &surface, direction) * self.share(shader, counted, origin);
            if scatterings == max_depth {
                break;
            }
            // Add direct light, and sample the next direction.
            let dimensions = integrator.dimensions(scatterings);
            let surface = if shader.two_sided { surface.facing(-direction) } else { surface };
            let frame = surface.frame(-direction);
            let wo = frame.to_local(-direction);
            let u = self.numbers.short_pair(0, dimensions.bsdf(), (0, 1));
            let [uc, roulette] = self.numbers.short_pair(0, dimensions.choice(), (0, 1));
            match &shader.kind {
                Kind::Black => break,
                &Kind::Diffuse { albedo } => {
                    let side = if surface.normal.dot(direction) > 0.0 { -1.0 } else { 1.0 };
                    let position = surface.position + surface.normal * (side * surface.offset);
                    let frame = Frame::from_normal(surface.shading * side);
                    let vertex = Vertex { surface, frame, position, wo, albedo, bsdf: None };
                    sum += throughput * self.direct(&vertex, dimensions);
                    let local = BsdfOnly::Bsdf.sample(u.map(f64::from)).as_vec3();
                    (origin, direction) = (position, frame.to_world(local));
                    throughput *= albedo;
                    counted = Counted::All;
                }
                Kind::Delta(bsdf) => {
                    let Some(sample) = bsdf.sample(wo, uc, [0.0; 2]) else { break };
                    direction = frame.to_world(sample.wi);
                    origin = surface.ray_origin(direction);
                    throughput *= sample.weight;
                    counted = Counted::Nothing;
                }
                Kind::Rough(bsdf) => {
                    if surface.normal.dot(direction) > 0.0 {
                        break;
                    }
                    let position = surface.position;
                    let vertex = Vertex { surface, frame, position, wo, albedo: Rgb::ONE, bsdf: Some(bsdf) };
                    sum += throughput * self.direct(&vertex, dimensions);
                    let Some(sample) = bsdf.sample(wo, 0.0, u) else { break };
                    direction = frame.to_world(sample.wi);
                    if sample.weight == Rgb::ZERO || surface.normal.dot(direction) <= 0.0 {
                        break;
                    }
                    origin = surface.ray_origin(direction);
                    throughput *= sample.weight;
                    counted = match integrator.sampling {
                        Sampling::Bsdf => Counted::Part { pdf: f32::MAX, environment: 1.0 },
                        Sampling::Light | Sampling::Hemisphere => Counted::All,
                        Sampling::Mis => {
                            let other = integrator.environment_pdf(direction, frame.z) as f32;
                            let environment =
                                power_heuristic(sample.pdf, integrator.request.light_samples as f32 * other);
                            Counted::Part { pdf: sample.pdf, environment }
                        }
                    };
                }
            }
            // Russian roulette
            if scatterings >= ROULETTE_AFTER {
                let survival = (throughput.max_element() / ROULETTE_BELOW).min(1.0);
                if roulette >= survival {
                    break;
                }
                throughput /= survival;
            }
        }
        sum
    }

    /// Direct light at a vertex, scattered towards the viewer.
    fn direct(&mut self, vertex: &Vertex, dimensions: Dimensions) -> Rgb {
        let integrator = self.integrator();
        let samples = integrator.request.light_samples;
        let is_rough = vertex.bsdf.is_some();
        let by_mis = is_rough && integrator.sampling == Sampling::Mis;
        let mut sum = Rgb::ZERO;
        // Sample each area light, and each light that rays cannot hit.
        for (number, light) in integrator.lights.iter().enumerate() {
            if !integrator.sampling.by_light() && light.object != NOTHING {
                continue;
            }
            let count = if light.has_extent() { samples } else { 1 };
            for index in 0..count {
                let u = self.numbers.short_pair(0, dimensions.light(number), (index, count));
                let sample = light.sample(vertex.position, u);
                let (f, pdf) = vertex.eval(sample.wi);
                let share = if by_mis && light.object != NOTHING {
                    power_heuristic(count as f32 * sample.pdf, pdf)
                } else {
                    1.0
                };
                if f != Rgb::ZERO && !self.is_occluded(vertex, sample.wi, sample.distance, light.object) {
                    sum += f * sample.weight * (share / count as f32);
                }
            }
        }
        // Sample the environment.
        if let (Some(environment), Some(sampler)) = (&integrator.scene.environment, integrator.strategies.light()) {
            for index in 0..samples {
                let u = self.numbers.pair(0, dimensions.environment(), (index, samples));
                let normal = environment.to_map(vertex.frame.z.as_dvec3());
                let Some(sample) = sampler.sample_for(u, normal) else { continue };
                let wi = (environment.to_world * sample.wi).as_vec3();
                let (f, pdf) = vertex.eval(wi);
                let over_pdf = if is_rough {
                    let light_pdf = sample.pdf as f32;
                    let share = if by_mis { power_heuristic(samples as f32 * light_pdf, pdf) } else { 1.0 };
                    share / light_pdf
                } else {
                    let cos = f64::from(vertex.frame.z.dot(wi));
                    let other = integrator.strategies.bsdf_only().map_or(0.0, |strategy| strategy.pdf(cos));
                    balance_weight_over_pdf(sample.pdf, other) as f32
                };
                if f != Rgb::ZERO && !self.is_occluded(vertex, wi, f32::INFINITY, NOTHING) {
                    sum += f * environment.scale * sample.radiance * (over_pdf / samples as f32);
                }
            }
        }
        // Sample directions by the surface alone.
        let hemisphere = integrator.sampling == Sampling::Hemisphere;
        let strategy =
            if is_rough { hemisphere.then_some(BsdfOnly::Hemisphere) } else { integrator.strategies.bsdf_only() };
        for index in 0..strategy.map_or(0, |_| samples) {
            let Some(strategy) = strategy else { break };
            let local = strategy.sample(self.numbers.pair(0, dimensions.bsdf_direct(), (index, samples)));
            let wi = vertex.frame.to_world(local.as_vec3());
            let other = if is_rough { 0.0 } else { integrator.environment_pdf(wi, vertex.frame.z) };
            let weight = balance_weight_over_pdf(strategy.pdf(local.z), other) as f32 / samples as f32;
            let found = match self.nearest(vertex.ray_origin(wi), wi) {
                None => self.environment(wi),
                // Beside light samples only the environment counts.
                Some(_) if integrator.sampling.by_light() => Rgb::ZERO,
                Some((object, surface)) => self.emitted(&integrator.shaders[object], &surface, wi),
            };
            sum += vertex.eval(wi).0 * found * weight;
        }
        sum
    }

    /// The share of an emitter's light that light samples have not counted, on a ray from `origin`.
    fn share(&self, shader: &SurfaceShader, counted: Counted, origin: Vec3) -> f32 {
        let integrator = self.integrator();
        let Some(emission) = &shader.emission else { return 0.0 };
        match (counted, emission.visibility, shader.light) {
            (Counted::Nothing, ..) => 1.0,
            (_, EmitterVisibility::CameraOnly, _) | (Counted::All, _, Some(_)) => 0.0,
            (Counted::All, _, None) => f32::from(u8::from(integrator.sampling.by_light())),
            (Counted::Part { .. }, _, None) => 1.0,
            (Counted::Part { pdf, .. }, _, Some(light)) => {
                power_heuristic(pdf, integrator.request.light_samples as f32 * integrator.lights[light].pdf(origin))
            }
        }
    }

    /// The radiance that a surface emits against `direction`.
    fn emitted(&self, shader: &SurfaceShader, surface: &Surface, direction: Vec3) -> Rgb {
        let emission = shader.emission.filter(|emission| emission.is_emitted(surface.normal, direction));
        emission.map_or(Rgb::ZERO, |emission| emission.radiance)
    }

    fn environment(&self, direction: Vec3) -> Rgb {
        let environment = self.integrator().scene.environment.as_ref();
        environment.map_or(Rgb::ZERO, |environment| environment.radiance(direction.as_dvec3()))
    }

    /// The nearest object along a ray, and its surface there.
    fn nearest(&mut self, origin: Vec3, direction: Vec3) -> Option<(usize, Surface)> {
        set(&mut self.rays.origin, 0, origin);
        set(&mut self.rays.direction, 0, direction);
        let geometry = &self.job.integrator.geometry;
        geometry.nearest(&self.rays, 1, &mut self.hits);
        let object = self.hits.object[0];
        (object != NOTHING).then(|| (object as usize, geometry.surface(&self.rays, &self.hits, 0)))
    }

    /// Whether an object other than `light` is nearer than `distance`.
    fn is_occluded(&mut self, vertex: &Vertex, wi: Vec3, distance: f32, light: u32) -> bool {
        set(&mut self.rays.origin, 0, vertex.ray_origin(wi));
        set(&mut self.rays.direction, 0, wi);
        let mut blocked = [0; LANES];
        let limit = [distance * SHORT_OF_LIGHT; LANES];
        self.job.integrator.geometry.occluded(&self.rays, 1, &limit, light, &mut blocked);
        blocked[0] != 0
    }
}
