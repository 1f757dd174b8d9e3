//! The reference: a path tracer as the textbook describes it, one path after the other.
//!
//! It renders with every BSDF and light of the program, by light sampling, BSDF sampling, uniform sampling of directions, or light and
//! BSDF sampling combined by multiple importance sampling, with Russian roulette. Of the path tracer in lanes it shares the
//! random numbers, the BSDFs, the scene, and the samplers of the map and of lights, each of which `validate` tests by itself.
//! Its own are the MIS weights, which light samples are complete, emission and roulette; the lanes are tested against them
//! sample by sample.
//!
//! Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 13.4.

use super::camera::PreparedCamera;
use super::film::PathClass;
use super::geometry::Surface;
use super::lanes::{Hits, LANES, NONE, Rays};
use super::prepared::{PreparedScene, ROULETTE_AFTER, ROULETTE_BELOW};
use super::ray_samples::{RaySamples, Streams, SubSample};
use super::settings::Sampling;
use super::shaders::{Kind, SurfaceShader};
use etalon_core::bsdf::{Bsdf, BsdfSample, Scatter};
use etalon_core::math::{Frame, Rgb};
use etalon_core::sampling::warp;
use etalon_core::scene::EmitterVisibility;
use etalon_core::scene::Ray;
use glam::Vec3;
use std::borrow::Cow;

/// The path tracer, with room for the ray that it traces.
pub struct Reference<'a> {
    scene: &'a PreparedScene<'a>,
    camera: &'a PreparedCamera,
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
    emission: Option<Emission>,
}

/// The vertex before a ray, as far as the weight of the light that the ray finds depends on it.
#[derive(Clone, Copy)]
enum Previous {
    /// The camera or a delta lobe: light samples cannot find what the ray finds.
    Specular,
    /// A surface of this kind and shading normal, whose BSDF was sampled with this pdf.
    Surface { pdf: f32, normal: Vec3, kind: Kind },
}

/// Light that a ray finds.
#[derive(Clone, Copy)]
struct Emission {
    radiance: Rgb,
    source: Source,
}

/// Where it comes from.
#[derive(Clone, Copy)]
enum Source {
    Environment,
    /// A surface that only the camera and delta lobes see.
    CameraOnly,
    /// A surface, and the number of the light that samples it, if one does.
    Surface(Option<u32>),
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

    /// The ray that leaves in a direction.
    fn ray(&self, wi: Vec3) -> Ray {
        Ray { origin: self.surface.ray_origin(wi), direction: wi }
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
    pub fn new(scene: &'a PreparedScene<'a>, camera: &'a PreparedCamera) -> Self {
        Self { scene, camera, rays: Box::default(), hits: Box::default() }
    }

    /// Traces the camera sample of a slot, which belongs to a pixel, and calls `add` with the light that it finds.
    pub fn trace(&mut self, streams: &Streams, slot: u32, [x, y]: [u32; 2], mut add: impl FnMut(PathClass, Rgb)) {
        let scene = self.scene;
        // Generate the camera ray.
        let u = streams.film().get_2d(slot, SubSample::ONLY).map(|u| [u; LANES]);
        self.camera.rays(&[x; LANES], y, &u, 1, &mut self.rays);
        let mut ray = self.rays.at(0);
        let (mut throughput, mut eta_scale) = (Rgb::ONE, 1.0);
        let (mut path_class, mut previous) = (PathClass::DIRECT, Previous::Specular);
        for scatterings in 0..=scene.request.max_depth {
            // Add the light that the ray finds.
            let vertex = self.nearest(ray);
            let found = vertex.as_ref().map_or_else(|| self.environment(ray.direction), |vertex| vertex.emission);
            if let Some(emission) = found {
                add(path_class, throughput * emission.radiance * self.weight(emission.source, previous, ray));
            }
            let Some(vertex) = vertex else { return };
            if vertex.shader.kind == Kind::Black || scatterings == scene.request.max_depth {
                return;
            }
            let samples = scene.ray_samples(streams, scatterings);
            // Add direct light, of which a delta BSDF scatters none.
            add(path_class.then_diffuse(), throughput * self.direct_light(&vertex, samples, slot));
            // Sample the next direction.
            let [uc, roulette] = samples.choice.get_2d(slot, SubSample::ONLY);
            let u = samples.bsdf.get_2d(slot, SubSample::ONLY);
            let Some((sample, wi)) = vertex.sample(uc, u) else { return };
            (previous, path_class) = if sample.is_delta() {
                (Previous::Specular, path_class.then_specular())
            } else {
                let (normal, kind) = (vertex.frame.z, vertex.shader.kind);
                (Previous::Surface { pdf: sample.pdf, normal, kind }, path_class.then_diffuse())
            };
            ray = vertex.ray(wi);
            throughput *= sample.weight;
            // Russian roulette, by the throughput without the scale of radiance in the medium
            eta_scale *= sample.eta * sample.eta;
            if scatterings >= ROULETTE_AFTER {
                let survival = (eta_scale * throughput.max_element() / ROULETTE_BELOW).min(1.0);
                if roulette >= survival {
                    return;
                }
                throughput /= survival;
            }
        }
    }

    /// The weight of light that a ray finds, among the techniques that could have found it from the previous vertex.
    fn weight(&self, source: Source, previous: Previous, Ray { origin, direction: wi }: Ray) -> f32 {
        let Previous::Surface { pdf, normal, kind } = previous else { return 1.0 };
        match (self.scene.sampling, source) {
            (_, Source::CameraOnly) => 0.0,
            // Complete: directions were sampled at the vertex for all light that it scatters.
            (Sampling::Light | Sampling::Hemisphere, _) => 0.0,
            (Sampling::Bsdf, _) => {
                if kind == Kind::Diffuse {
                    0.0
                } else {
                    1.0
                }
            }
            // The balance heuristic
            (Sampling::Mis | Sampling::MisLt, source) => {
                let by_light = match source {
                    Source::Environment => self.scene.environment_density(wi, normal, kind),
                    Source::Surface(Some(light)) => self.scene.lights.density(light, origin, kind.one_sided(normal)),
                    Source::Surface(None) | Source::CameraOnly => 0.0,
                };
                balance_heuristic(pdf, by_light)
            }
        }
    }

    /// Direct light at a vertex, scattered towards the viewer.
    fn direct_light(&mut self, vertex: &Vertex, samples: RaySamples, slot: u32) -> Rgb {
        let scene = self.scene;
        let by_mis = matches!(scene.sampling, Sampling::Mis | Sampling::MisLt);
        let (kind, normal) = (vertex.shader.kind, vertex.frame.z);
        let position = vertex.surface.ray_origin(vertex.frame.to_world(vertex.wo));
        let mut sum = Rgb::ZERO;
        // Sample the lights. BSDF samples find only those that rays can hit.
        for (number, &round) in scene.lights.rounds().iter().enumerate() {
            for index in 0..round.count {
                let sub = SubSample { index, count: round.count };
                let [choice, _] = samples.light_choice.get_2d(slot, sub);
                let u = samples.light(number).get_2d(slot, sub);
                let chosen = match round.light {
                    Some(light) => Some((light, 1.0)),
                    None => scene
                        .lights
                        .selection(position, kind.one_sided(normal))
                        .and_then(|selection| selection.sample(choice)),
                };
                let Some((light, probability)) = chosen else { continue };
                let sample = scene.lights.sample(light, probability, position, u);
                // Beyond a surface that transmits, the light is seen from the other side.
                let (f, pdf) = vertex.eval(sample.wi);
                let ray = vertex.ray(sample.wi);
                let sampled = &scene.lights.all[light as usize];
                let Some(distance) = sampled.ahead(ray, sample.distance) else { continue };
                let is_weighted = by_mis && sampled.object != NONE;
                let density = || scene.lights.density(light, ray.origin, kind.one_sided(normal));
                let share = if is_weighted { balance_heuristic(density(), pdf) } else { 1.0 };
                let value = f * sample.weight * (share / round.count as f32);
                sum += self.unoccluded(light, ray, distance, value);
            }
        }
        let count = scene.request.light_samples;
        for index in 0..count {
            let sub = SubSample { index, count };
            // Sample the environment.
            let u = samples.environment.get_2d(slot, sub);
            if let Some(sample) = scene.environment.as_ref().and_then(|map| map.sample(u, normal, kind)) {
                let (wi, density) = (sample.wi.as_vec3(), count as f32 * sample.pdf as f32);
                let (f, pdf) = vertex.eval(wi);
                let share = if by_mis { balance_heuristic(density, pdf) } else { 1.0 };
                let value = f * sample.radiance * (share / density);
                sum += self.unoccluded(NONE, vertex.ray(wi), f32::INFINITY, value);
            }
            // Sample directions without regard to light: by the BSDF of a diffuse surface, or uniformly.
            let u = samples.direct.get_2d(slot, sub);
            let sampled = match (scene.sampling, kind) {
                (Sampling::Bsdf, Kind::Diffuse) => {
                    let local = warp::cosine_hemisphere(u);
                    Some((local, warp::cosine_hemisphere_pdf(local.z)))
                }
                (Sampling::Hemisphere, Kind::Transmitting) => Some((warp::uniform_sphere(u), warp::UNIFORM_SPHERE_PDF)),
                (Sampling::Hemisphere, _) => Some((warp::uniform_hemisphere(u), warp::UNIFORM_HEMISPHERE_PDF)),
                _ => None,
            };
            if let Some((local, pdf)) = sampled {
                let wi = Frame::from_normal(normal).to_world(local.as_vec3());
                let weight = 1.0 / (pdf as f32 * count as f32);
                let found = self.nearest(vertex.ray(wi)).map_or_else(|| self.environment(wi), |vertex| vertex.emission);
                if let Some(Emission { radiance, source: Source::Environment | Source::Surface(_) }) = found {
                    sum += vertex.eval(wi).0 * radiance * weight;
                }
            }
        }
        sum
    }

    /// The value of a shadow ray that is not occluded.
    fn unoccluded(&mut self, light: u32, ray: Ray, distance: f32, value: Rgb) -> Rgb {
        self.rays.set(0, ray);
        let t_max = [self.scene.t_max(light, ray, distance); LANES];
        let mut blocked = [0; LANES];
        self.scene.geometry.occluded(&self.rays, 1, &t_max, &mut blocked);
        if blocked[0] == 0 { value } else { Rgb::ZERO }
    }

    /// The light of the environment from a direction.
    fn environment(&self, wi: Vec3) -> Option<Emission> {
        let environment = self.scene.scene.environment.as_ref()?;
        Some(Emission { radiance: environment.radiance(wi.as_dvec3()), source: Source::Environment })
    }

    /// The first surface along a ray.
    fn nearest(&mut self, ray: Ray) -> Option<Vertex<'a>> {
        self.rays.set(0, ray);
        let geometry = &self.scene.geometry;
        geometry.nearest(&self.rays, 1, &mut self.hits);
        if self.hits.object[0] == NONE {
            return None;
        }
        let shader = &self.scene.shaders[self.hits.object[0] as usize];
        let outside = geometry.surface(&self.rays, &self.hits, 0);
        // A light emits from the side of its normal, or from both.
        let emits = shader.emission.filter(|emission| emission.two_sided || outside.normal.dot(ray.direction) < 0.0);
        let emission = emits.map(|emission| {
            let source = match emission.visibility {
                EmitterVisibility::CameraOnly => Source::CameraOnly,
                EmitterVisibility::Sampled => {
                    Source::Surface(shader.light.map(|first| first + geometry.triangle(&self.hits, 0)))
                }
            };
            Emission { radiance: emission.radiance, source }
        });
        let wo = -ray.direction;
        let surface = shader.facing(outside, wo);
        let frame = shader.frame(&surface, wo, || geometry.tangent(&self.hits, 0, surface.normal));
        let bsdf = shader.bsdf_at(|| geometry.uv(&self.hits, 0, surface.position));
        Some(Vertex { surface, shader, bsdf, frame, wo: frame.to_local(wo), emission })
    }
}

/// The weight of a technique of density `a` beside one of density `b`, by the balance heuristic.
fn balance_heuristic(a: f32, b: f32) -> f32 {
    if b == 0.0 { 1.0 } else { 1.0 / (1.0 + b / a) }
}
