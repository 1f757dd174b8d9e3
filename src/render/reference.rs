//! The reference: a path tracer as the textbook describes it, one path after the other.
//!
//! It renders with every BSDF and light of the program, by light sampling, BSDF sampling, uniform hemisphere sampling, or light and BSDF
//! sampling combined by multiple importance sampling, with Russian roulette. It uses the random numbers of [`super::kernel`], which is tested against it
//! sample by sample.
//!
//! Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 13.4.

use super::departure::{Departure, EmitterHit, LightSamples};
use super::environment::BsdfOnly;
use super::film::PathClass;
use super::geometry::Surface;
use super::lanes::{Hits, LANES, NOTHING, Rays, at, set};
use super::lens::Lens;
use super::mis::power_heuristic;
use super::prepared::{PreparedScene, ROULETTE_AFTER, ROULETTE_BELOW};
use super::sample_lanes::SampleLanes;
use super::shaders::{Kind, SurfaceShader};
use crate::bsdf::{Bsdf, BsdfSample, Scatter};
use crate::math::{Frame, Rgb};
use glam::Vec3;
use std::borrow::Cow;

/// The path tracer, with room for the ray that it traces.
pub struct Reference<'a> {
    scene: &'a PreparedScene<'a>,
    lens: &'a Lens,
    rays: Box<Rays>,
    hits: Box<Hits>,
}

/// A point on a surface that a path has hit.
struct Vertex<'a> {
    surface: Surface,
    shader: &'a SurfaceShader,
    bsdf: Cow<'a, Bsdf>,
    frame: Frame,
    /// To the viewer, in the shading frame.
    wo: Vec3,
}

impl Vertex<'_> {
    /// The BSDF times the cosine, and the pdf of BSDF sampling, for a direction in the world.
    fn eval(&self, wi: Vec3) -> (Rgb, f32) {
        let local = self.frame.to_local(wi);
        let (f, pdf) = self.bsdf.eval_pdf(self.wo, local);
        // Black where the normals disagree on the side: the shadow terminator of smooth meshes.
        let agree = self.surface.normal.dot(wi) * local.z > 0.0;
        if agree { (f * local.z.abs(), pdf) } else { (Rgb::ZERO, pdf) }
    }

    /// Samples the BSDF, and a direction in the world.
    fn sample(&self, uc: f32, u: [f32; 2]) -> Option<(BsdfSample, Vec3)> {
        let sample = self.bsdf.sample(self.wo, uc, u)?;
        let wi = self.frame.to_world(sample.wi);
        let agree = sample.is_delta() || self.surface.normal.dot(wi) * sample.wi.z > 0.0;
        (agree && sample.weight != Rgb::ZERO).then_some((sample, wi))
    }
}

impl<'a> Reference<'a> {
    /// A path tracer for a scene and a camera.
    pub fn new(scene: &'a PreparedScene<'a>, lens: &'a Lens) -> Self {
        Self { scene, lens, rays: Box::default(), hits: Box::default() }
    }

    /// Traces the camera sample of a slot, which belongs to a pixel, and calls `add` with the light that it finds.
    pub fn trace(&mut self, numbers: &SampleLanes, slot: u32, [x, y]: [u32; 2], mut add: impl FnMut(PathClass, Rgb)) {
        let scene = self.scene;
        // Generate the camera ray.
        let u = numbers.short_pair(slot, 0, (0, 1)).map(|u| [u; LANES]);
        self.lens.rays(scene.arch, &[x; LANES], y, &u, 1, &mut self.rays);
        let mut ray = [at(&self.rays.origin, 0), at(&self.rays.direction, 0)];
        let (mut throughput, mut path_class, mut departure) = (Rgb::ONE, PathClass::DIRECT, Departure::CAMERA);
        for scatterings in 0..=scene.request.max_depth {
            // Add the light that the ray finds.
            add(path_class, throughput * self.emission(ray, &departure));
            let Some(vertex) = self.nearest(ray) else { return };
            if vertex.shader.kind == Kind::Black || scatterings == scene.request.max_depth {
                return;
            }
            // Add direct light, of which a delta BSDF scatters none.
            add(path_class.then(false), throughput * self.direct_light(&vertex, numbers, slot, scatterings));
            // Sample the next direction.
            let dimensions = scene.dimensions(scatterings);
            let [uc, roulette] = numbers.short_pair(slot, dimensions.choice(), (0, 1));
            let u = numbers.short_pair(slot, dimensions.bsdf(), (0, 1));
            let Some((sample, wi)) = vertex.sample(uc, u) else { return };
            departure = Departure::CAMERA;
            if !sample.is_delta() {
                departure.light_samples = scene.light_samples(sample.pdf, vertex.frame.z, vertex.shader.kind);
            }
            path_class = path_class.then(sample.is_delta());
            ray = [vertex.surface.ray_origin(wi), wi];
            throughput *= sample.weight;
            // Russian roulette
            if scatterings >= ROULETTE_AFTER {
                let survival = (throughput.max_element() / ROULETTE_BELOW).min(1.0);
                if roulette >= survival {
                    return;
                }
                throughput /= survival;
            }
        }
    }

    /// Direct light at a vertex, scattered towards the viewer.
    fn direct_light(&mut self, vertex: &Vertex, numbers: &SampleLanes, slot: u32, scatterings: u32) -> Rgb {
        let scene = self.scene;
        let dimensions = scene.dimensions(scatterings);
        let by_mis = scene.sampling.is_mis();
        let position = vertex.surface.ray_origin(vertex.frame.to_world(vertex.wo));
        let normal = (vertex.shader.kind != Kind::Transmitting).then_some(vertex.frame.z);
        let mut sum = Rgb::ZERO;
        // Sample the lights.
        for (number, &round) in scene.lights.rounds().iter().enumerate() {
            for index in 0..round.count {
                let sub_sample = (index, round.count);
                let [choice, _] = numbers.short_pair(slot, dimensions.light_choice(), sub_sample);
                let u = numbers.short_pair(slot, dimensions.light(number), sub_sample);
                let chosen = match round.light {
                    Some(light) => Some((light, 1.0)),
                    None => scene.lights.selection(position, normal).and_then(|tree| tree.sample(choice)),
                };
                let Some((light, probability)) = chosen else { continue };
                let sample = scene.lights.sample(light, probability, position, u);
                let (f, pdf) = vertex.eval(sample.wi);
                let other = if by_mis && scene.lights.is_found_by_rays(light) { pdf } else { 0.0 };
                let share = power_heuristic(round.count as f32 * sample.pdf, [other, 0.0]);
                let value = f * sample.weight * (share / round.count as f32);
                sum += self.unoccluded(vertex, light, sample.wi, sample.distance, value);
            }
        }
        let count = scene.request.light_samples;
        for index in 0..count {
            let sub_sample = (index, count);
            // Sample the environment.
            if let Some(environment) = &scene.environment
                && let Some(sample) =
                    environment.sample(numbers.pair(slot, dimensions.environment(), sub_sample), vertex.frame.z)
            {
                let (wi, density) = (sample.wi.as_vec3(), count as f32 * sample.pdf as f32);
                let (f, pdf) = vertex.eval(wi);
                let share = power_heuristic(density, [if by_mis { pdf } else { 0.0 }, 0.0]);
                let value = f * sample.radiance * (share / density);
                sum += self.unoccluded(vertex, NOTHING, wi, f32::INFINITY, value);
            }
            // Sample directions without regard to light.
            if let Some(strategy) = BsdfOnly::of(scene.sampling, vertex.shader.kind.is_diffuse()) {
                let local = strategy.sample(numbers.pair(slot, dimensions.bsdf_direct(), sub_sample));
                let wi = Frame::from_normal(vertex.frame.z).to_world(local.as_vec3());
                let weight = 1.0 / (strategy.pdf(local.z) as f32 * count as f32);
                let departure = Departure { light_samples: LightSamples::NotTaken, ..Departure::CAMERA };
                sum += vertex.eval(wi).0 * self.emission([vertex.surface.ray_origin(wi), wi], &departure) * weight;
            }
        }
        sum
    }

    /// The value of a shadow ray that is not occluded.
    fn unoccluded(&mut self, vertex: &Vertex, light: u32, wi: Vec3, distance: f32, value: Rgb) -> Rgb {
        let ray = [vertex.surface.ray_origin(wi), wi];
        self.set_ray(ray);
        let limit = [self.scene.shadow_limit(light, ray, distance); LANES];
        let mut blocked = [0; LANES];
        self.scene.geometry.occluded(&self.rays, 1, &limit, &mut blocked);
        if blocked[0] == 0 { value } else { Rgb::ZERO }
    }

    /// The light that a ray finds, weighted for a path with this departure.
    fn emission(&mut self, ray: [Vec3; 2], departure: &Departure) -> Rgb {
        let (scene, [origin, wi]) = (self.scene, ray);
        let Some(vertex) = self.nearest(ray) else {
            return scene.environment_light(departure, origin, wi);
        };
        let Some(emission) = &vertex.shader.emission else { return Rgb::ZERO };
        let Surface { normal, position, .. } = scene.geometry.surface(&self.rays, &self.hits, 0);
        let light = vertex.shader.light.map(|first| first + scene.geometry.triangle(&self.hits, 0));
        let hit = EmitterHit { visibility: emission.visibility, light, cos: normal.dot(wi).abs(), position };
        vertex.shader.emitted(normal, wi) * scene.emitter_weight(departure, origin, wi, &hit)
    }

    /// The first surface along a ray.
    fn nearest(&mut self, ray: [Vec3; 2]) -> Option<Vertex<'a>> {
        self.set_ray(ray);
        self.scene.geometry.nearest(&self.rays, 1, &mut self.hits);
        if self.hits.object[0] == NOTHING {
            return None;
        }
        let shader = &self.scene.shaders[self.hits.object[0] as usize];
        let surface = shader.facing(self.scene.geometry.surface(&self.rays, &self.hits, 0), -ray[1]);
        let tangent = || self.scene.geometry.tangent(&self.hits, 0, surface.normal);
        let frame = shader.frame(&surface, -ray[1], tangent);
        let bsdf = shader.bsdf_at(|| self.scene.geometry.uv(&self.hits, 0, surface.position));
        Some(Vertex { surface, shader, bsdf, frame, wo: frame.to_local(-ray[1]) })
    }

    fn set_ray(&mut self, [origin, direction]: [Vec3; 2]) {
        set(&mut self.rays.origin, 0, origin);
        set(&mut self.rays.direction, 0, direction);
    }
}
