//! The path integrator: what light arrives along camera rays.
//!
//! [`LANES`] paths are followed side by side, one scattering after the other. At each step all rays are traced, the
//! light that they find is added, and the hits are sorted by what the surface does: diffuse ones go on together, in
//! loops that vectorize, the rest one by one. That keeps the arithmetic of a Cornell box four to eight lanes wide
//! without a line of vector code, and the order of the paths does not matter: every random number is a function of its
//! pixel, sample and dimension, so a path's light has the same bits in any company.

use super::diffuse;
use super::geometry::{Geometry, Surface, at, set};
use super::lanes::{Hits, LANES, Lane, Lane3, NOTHING, Paths, Points, Shadows};
use super::lens::Lens;
use super::lights::Sampled;
use super::needs::Needs;
use super::numbers::Numbers;
use super::strategies::Strategies;
use super::{Sampling, Settings};
use crate::bsdf::Bsdf;
use crate::raster::Rgb;
use crate::scene::{Emission, Environment, Material, Request, Role, Scene};
use glam::{DVec3, Vec3};
use pulp::Arch;

/// Scatterings before Russian roulette may end a path.
const ROULETTE_AFTER: u32 = 5;

/// Shadow rays end this fraction of the way short of the light, which rounding could otherwise put behind itself.
const SHORT_OF_LIGHT: f32 = 1.0 - 1e-4;

/// A scene made ready for rendering.
pub struct Integrator<'a> {
    pub scene: &'a Scene,
    pub request: Request,
    geometry: Geometry<'a>,
    faces: Vec<Face>,
    lights: Vec<Sampled>,
    strategies: Strategies,
    sampling: Sampling,
    arch: Arch,
}

/// What an object does to light.
struct Face {
    scatter: Scatter,
    emission: Option<Emission>,
    /// The number of the light in [`Integrator::lights`] that samples this object.
    light: Option<usize>,
}

enum Scatter {
    /// Absorbs everything.
    Black,
    Diffuse(Rgb),
    Other(Bsdf),
}

/// What one thread works with.
pub struct Workspace {
    pub numbers: Numbers,
    /// The pixel column of each slot.
    pub pixel: [u32; LANES],
    /// The light found so far, by slot.
    pub radiance: Lane3,
    paths: Paths,
    next: Paths,
    hits: Hits,
    points: Points,
    others: Vec<u32>,
    shadows: Shadows,
    blocked: [u32; LANES],
    u: [Lane; 2],
}

impl Workspace {
    pub fn new(settings: &Settings) -> Self {
        Self {
            paths: Paths::default(),
            pixel: [0; LANES],
            numbers: Numbers::new(settings.stream, settings.seed),
            radiance: [[0.0; LANES]; 3],
            next: Paths::default(),
            hits: Hits::default(),
            points: Points::default(),
            others: Vec::with_capacity(LANES),
            shadows: Shadows::default(),
            blocked: [0; LANES],
            u: [[0.0; LANES]; 2],
        }
    }

    #[inline(always)]
    fn add(&mut self, slot: u32, value: Rgb) {
        let slot = slot as usize % LANES;
        self.radiance[0][slot] += value.x;
        self.radiance[1][slot] += value.y;
        self.radiance[2][slot] += value.z;
    }
}

/// Pairs of random numbers that each scattering draws from, after the one for the film position: one for the
/// material's direction, one for its choices, and one per light.
#[derive(Clone, Copy)]
struct Dimensions {
    first: u32,
}

impl Dimensions {
    fn bsdf(self) -> u32 {
        self.first
    }

    fn choice(self) -> u32 {
        self.first + 1
    }

    fn environment(self) -> u32 {
        self.first + 2
    }

    fn light(self, number: usize) -> u32 {
        self.first + 3 + number as u32
    }
}

impl<'a> Integrator<'a> {
    pub fn new(scene: &'a Scene, request: &Request, settings: &Settings, strategies: Strategies) -> Self {
        let lights = Sampled::all(scene);
        let faces = scene
            .objects
            .iter()
            .enumerate()
            .map(|(i, object)| Face {
                scatter: match object.material {
                    Material::Diffuse { albedo } if albedo == Rgb::ZERO => Scatter::Black,
                    Material::Diffuse { albedo } => Scatter::Diffuse(albedo),
                    ref other => Scatter::Other(Bsdf::new(other)),
                },
                emission: object.emission,
                light: lights.iter().position(|light| light.object == i as u32),
            })
            .collect();
        Self {
            scene,
            request: *request,
            geometry: Geometry::new(scene),
            faces,
            lights,
            strategies,
            sampling: settings.sampling,
            arch: Arch::new(),
        }
    }

    /// Pairs of numbers per scattering.
    fn dimensions(&self, scatterings: u32) -> Dimensions {
        Dimensions { first: 1 + scatterings * (3 + self.lights.len() as u32) }
    }

    /// Makes the camera rays of the first `count` slots, which belong to row `y`.
    pub fn start(&self, work: &mut Workspace, count: usize, lens: &Lens, y: u32) {
        let paths = &mut work.paths;
        paths.count = count;
        for (slot, number) in paths.slot[..count].iter_mut().zip(0..) {
            *slot = number;
        }
        work.numbers.fill(self.arch, &paths.slot[..count], 0, (0, 1), &mut work.u);
        lens.rays(self.arch, &work.pixel, y, &work.u, count, &mut paths.rays);
        for channel in &mut paths.throughput {
            channel[..count].fill(1.0);
        }
        paths.pdf[..count].fill(f32::INFINITY);
        paths.sky[..count].fill(1.0);
        paths.word[..count].fill(1);
        for channel in &mut work.radiance {
            channel[..count].fill(0.0);
        }
    }

    /// Follows the camera rays in `work.paths` to their ends and adds the light that they find to `work.radiance`.
    pub fn trace<const NEEDS: u32>(&self, work: &mut Workspace) {
        let has = |need: u32| NEEDS & need != 0;
        let mut scatterings = 0;
        while work.paths.count > 0 {
            let count = work.paths.count;
            self.geometry.nearest(&work.paths.rays, count, &mut work.hits);
            work.points.count = 0;
            work.others.clear();
            let last = scatterings == self.request.max_depth;
            for i in 0..count {
                let id = work.hits.object[i];
                if id == NOTHING {
                    if has(Needs::ENVIRONMENT) {
                        self.leave(work, i);
                    }
                    continue;
                }
                let face = &self.faces[id as usize];
                if let Some(emission) = &face.emission {
                    self.glow(work, i, face, emission);
                }
                if last {
                    continue;
                }
                match face.scatter {
                    Scatter::Black => {}
                    Scatter::Diffuse(albedo) => self.collect(work, i, albedo),
                    Scatter::Other(_) => work.others.push(i as u32),
                }
            }
            let dimensions = self.dimensions(scatterings);
            scatterings += 1;
            work.next.count = 0;
            let goes_on = has(Needs::OCCLUSION) && scatterings < self.request.max_depth;
            if work.points.count > 0 {
                self.light_diffuse::<NEEDS>(work, dimensions);
                if goes_on {
                    let slots = &work.points.slot[..work.points.count];
                    work.numbers.fill(self.arch, slots, dimensions.bsdf(), (0, 1), &mut work.u);
                    diffuse::carry_on(self.arch, &work.points, &work.u, &mut work.next);
                }
            }
            for k in 0..work.others.len() {
                let i = work.others[k] as usize;
                self.scatter_other(work, i, dimensions);
            }
            if scatterings > ROULETTE_AFTER {
                self.roulette(work, dimensions);
            }
            std::mem::swap(&mut work.paths, &mut work.next);
        }
    }

    /// A ray leaves the scene.
    #[inline]
    fn leave(&self, work: &mut Workspace, i: usize) {
        let share = work.paths.sky[i];
        if let Some(environment) = &self.scene.environment
            && share > 0.0
        {
            let radiance = environment.radiance(at(&work.paths.rays.direction, i).as_dvec3());
            work.add(work.paths.slot[i], at(&work.paths.throughput, i) * radiance * share);
        }
    }

    /// A ray has hit a lamp.
    #[inline]
    fn glow(&self, work: &mut Workspace, i: usize, face: &Face, emission: &Emission) {
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        let direction = at(&work.paths.rays.direction, i);
        if !emission.two_sided && surface.normal.dot(direction) > 0.0 {
            return;
        }
        let pdf = work.paths.pdf[i];
        let share = match (emission.role, face.light) {
            _ if pdf == f32::INFINITY => 1.0,
            (Role::Picture, _) => 0.0,
            (Role::Lamp, None) => 1.0,
            (Role::Lamp, Some(_)) if pdf == 0.0 => 0.0,
            (Role::Lamp, Some(light)) => {
                let other = self.lights[light].pdf(at(&work.paths.rays.origin, i));
                power_heuristic(pdf, self.request.light_samples as f32 * other)
            }
        };
        work.add(work.paths.slot[i], at(&work.paths.throughput, i) * emission.radiance * share);
    }

    /// Puts a diffuse hit with the others.
    #[inline]
    fn collect(&self, work: &mut Workspace, i: usize, albedo: Rgb) {
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        let side = if surface.normal.dot(at(&work.paths.rays.direction, i)) > 0.0 { -1.0 } else { 1.0 };
        let points = &mut work.points;
        let j = points.count;
        set(&mut points.position, j, surface.position + surface.normal * (side * surface.offset));
        set(&mut points.normal, j, surface.shading * side);
        set(&mut points.weight, j, at(&work.paths.throughput, i) * albedo);
        points.slot[j] = work.paths.slot[i];
        points.word[j] = work.paths.word[i];
        points.count += 1;
    }

    /// Adds the light that comes straight to the diffuse hits.
    fn light_diffuse<const NEEDS: u32>(&self, work: &mut Workspace, dimensions: Dimensions) {
        let samples = self.request.light_samples;
        for (number, light) in self.lights.iter().enumerate() {
            for index in 0..samples {
                let slots = &work.points.slot[..work.points.count];
                work.numbers.fill(self.arch, slots, dimensions.light(number), (index, samples), &mut work.u);
                let scale = 1.0 / samples as f32;
                diffuse::towards_light(self.arch, &work.points, light, &work.u, scale, &mut work.shadows);
                self.cast(work, light.object);
            }
        }
        if NEEDS & Needs::ENVIRONMENT != 0
            && let (Some(environment), Some(_)) = (&self.scene.environment, self.strategies.light())
        {
            for index in 0..samples {
                self.environment_light::<NEEDS>(work, environment, dimensions.environment(), (index, samples));
            }
        }
    }

    /// Adds what the shadow rays bring that nothing stands in the way of.
    fn cast(&self, work: &mut Workspace, light: u32) {
        let shadows = &mut work.shadows;
        for limit in &mut shadows.limit[..shadows.count] {
            *limit *= SHORT_OF_LIGHT;
        }
        self.geometry.occluded(&shadows.rays, shadows.count, &shadows.limit, light, &mut work.blocked);
        for i in 0..work.shadows.count {
            if work.blocked[i] == 0 {
                work.add(work.shadows.slot[i], at(&work.shadows.value, i));
            }
        }
    }

    fn environment_light<const NEEDS: u32>(
        &self,
        work: &mut Workspace,
        environment: &Environment,
        dimension: u32,
        draw: (u32, u32),
    ) {
        let Some(sampler) = self.strategies.light() else { return };
        let scale = environment.scale / (draw.1 as f32 * std::f32::consts::PI);
        let mut count = 0;
        for i in 0..work.points.count {
            let normal = at(&work.points.normal, i).as_dvec3();
            let u = work.numbers.pair(work.points.slot[i], dimension, draw);
            let Some(light) = sampler.sample_for(u, environment.to_map(normal)) else { continue };
            let wi: DVec3 = environment.to_world * light.wi;
            let cos = normal.dot(wi);
            if cos <= 0.0 {
                continue;
            }
            let value = at(&work.points.weight, i) * scale * light.radiance * (cos / light.pdf) as f32;
            if NEEDS & Needs::OCCLUSION == 0 {
                work.add(work.points.slot[i], value);
                continue;
            }
            set(&mut work.shadows.rays.origin, count, at(&work.points.position, i));
            set(&mut work.shadows.rays.direction, count, wi.as_vec3());
            set(&mut work.shadows.value, count, value);
            work.shadows.limit[count] = f32::INFINITY;
            work.shadows.slot[count] = work.points.slot[i];
            work.shadows.word[count] = work.points.word[i];
            count += 1;
        }
        work.shadows.count = count;
        self.cast(work, NOTHING);
    }

    /// Scatters one path at a surface that is not diffuse.
    #[inline]
    fn scatter_other(&self, work: &mut Workspace, i: usize, dimensions: Dimensions) {
        let Scatter::Other(bsdf) = &self.faces[work.hits.object[i] as usize].scatter else { return };
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        let direction = at(&work.paths.rays.direction, i);
        let (tangent, bitangent) = diffuse::frame(surface.shading);
        let local = |w: Vec3| Vec3::new(tangent.dot(w), bitangent.dot(w), surface.shading.dot(w));
        let wo = local(-direction);
        let slot = work.paths.slot[i];
        let u = work.numbers.pair(slot, dimensions.bsdf(), (0, 1));
        let [uc, _] = work.numbers.pair(slot, dimensions.choice(), (0, 1));
        let Some(sample) = bsdf.sample(wo, uc as f32, u.map(|u| u as f32)) else { return };
        let wi = tangent * sample.wi.x + bitangent * sample.wi.y + surface.shading * sample.wi.z;
        let Surface { position, normal, offset, .. } = surface;
        let side = if normal.dot(wi) < 0.0 { -1.0 } else { 1.0 };
        let next = &mut work.next;
        let j = next.count;
        set(&mut next.rays.origin, j, position + normal * (side * offset));
        set(&mut next.rays.direction, j, wi);
        set(&mut next.throughput, j, at(&work.paths.throughput, i) * sample.weight);
        next.pdf[j] = f32::INFINITY;
        next.sky[j] = 1.0;
        next.slot[j] = slot;
        next.word[j] = work.paths.word[i] << 1 | 1;
        next.count += 1;
    }

    /// Ends paths at random that carry little light, and lets the others stand for them.
    fn roulette(&self, work: &mut Workspace, dimensions: Dimensions) {
        let next = &mut work.next;
        let mut kept = 0;
        for i in 0..next.count {
            let throughput = at(&next.throughput, i);
            let survival = throughput.max_element().min(1.0);
            let [_, u] = work.numbers.pair(next.slot[i], dimensions.choice(), (0, 1));
            if u as f32 >= survival {
                continue;
            }
            let (origin, direction) = (at(&next.rays.origin, i), at(&next.rays.direction, i));
            set(&mut next.rays.origin, kept, origin);
            set(&mut next.rays.direction, kept, direction);
            set(&mut next.throughput, kept, throughput / survival);
            next.pdf[kept] = next.pdf[i];
            next.sky[kept] = next.sky[i];
            next.slot[kept] = next.slot[i];
            next.word[kept] = next.word[i];
            kept += 1;
        }
        next.count = kept;
    }
}

/// The share of a sample of density `p` when other samples find the same light with density `q`: p² / (p² + q²).
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 4.
#[inline]
fn power_heuristic(p: f32, q: f32) -> f32 {
    let ratio = q / p;
    1.0 / (1.0 + ratio * ratio)
}
