//! The path integrator: what light arrives along camera rays.
//!
//! [`LANES`](super::lanes::LANES) paths are followed together, one scattering at a time. At each step all rays are traced, emission is added, and
//! the hits are sorted by material: diffuse ones continue together in loops that the compiler vectorizes, the others one by
//! one. Every random number is a function of its pixel, sample and dimension, so the radiance of a path has the same bits
//! whichever paths share its batch.
//!
//! Caustics on surfaces that the camera sees come from [`super::light_tracing`].
//!
//! `NEEDS` are the bits of [`Needs`]: parts of the renderer whose bit is 0 are not in the compiled loop.

use super::caustic_cones::{CausticCones, REFLECTIONS_UP_TO};
use super::diffuse;
use super::geometry::{Geometry, Surface};
use super::lanes::{NOTHING, Paths, at, caustic, set};
use super::lens::Lens;
use super::light_tracing::LightTracing;
use super::lights::{SampleLight, Sampled};
use super::mis::power_heuristic;
use super::needs::Needs;
use super::sample_lanes::SampleLanes;
use super::settings::{Sampling, Settings};
use super::shaders::{Kind, SurfaceShader};
use super::shading_normal;
use super::strategies::Strategies;
use super::workspace::{Dimensions, RoughHit, Workspace};
use crate::error::Result;
use crate::math::Rgb;
use crate::render::film::{PathClass, PathClasses};
use crate::scene::{Emission, EmitterVisibility, Request, Scene};
use glam::Vec3;
use pulp::Arch;

/// Russian roulette ends paths with a throughput below this and raises that of the survivors to it. To raise it to 1
/// would cause fireflies.
pub(super) const ROULETTE_BELOW: f32 = 0.1;

/// Scatterings before Russian roulette may end a path.
pub(super) const ROULETTE_AFTER: u32 = 5;

/// Factor on the length of shadow rays, so that rounding does not let a light occlude itself.
pub(super) const SHORT_OF_LIGHT: f32 = 1.0 - 1e-4;

/// A scene made ready for rendering.
pub struct Integrator<'a> {
    /// What is rendered.
    pub(super) scene: &'a Scene,
    /// Size, samples and depth.
    pub(super) request: Request,
    /// Shapes prepared for intersection.
    pub(super) geometry: Geometry<'a>,
    /// BSDF and emission by object.
    pub(super) shaders: Vec<SurfaceShader>,
    /// Lights that are sampled at every hit.
    pub(super) lights: Vec<Sampled>,
    caustic_cones: CausticCones,
    /// Caustics by light paths, where they are used.
    pub(super) light_tracing: Option<LightTracing>,
    /// Sampling of the environment.
    pub(super) strategies: Strategies,
    /// How directions towards light are chosen.
    pub(super) sampling: Sampling,
    /// Instruction set for vectorized loops.
    pub(super) arch: Arch,
    /// Path classes that are summed separately.
    pub(super) classes: Option<PathClasses>,
    /// Whether there are area lights that only directions sampled by a BSDF find.
    only_bsdf_sampled_emitters: bool,
}

impl<'a> Integrator<'a> {
    /// # Errors
    /// As [`Sampled::all`].
    pub fn new(
        scene: &'a Scene,
        request: &Request,
        settings: &Settings,
        strategies: Strategies,
        geometry: Geometry<'a>,
    ) -> Result<Self> {
        let lights = Sampled::all(scene, settings)?;
        let shaders = SurfaceShader::all(scene, settings, &lights);
        let unsampled = |shader: &SurfaceShader| {
            shader.light.is_none() && shader.emission.is_some_and(|e| e.visibility == EmitterVisibility::Sampled)
        };
        let light_tracing = LightTracing::new(scene, request, settings, &shaders, &lights, &geometry);
        let only_bsdf_sampled_emitters = settings.sampling.by_light() && shaders.iter().any(unsampled);
        Ok(Self {
            scene,
            request: *request,
            geometry,
            shaders,
            lights,
            // Other strategies are as their name says.
            caustic_cones: if settings.sampling == Sampling::Mis {
                CausticCones::new(scene)
            } else {
                CausticCones::default()
            },
            light_tracing,
            strategies,
            sampling: settings.sampling,
            arch: Arch::new(),
            classes: settings.paths.map(PathClasses::up_to),
            only_bsdf_sampled_emitters,
        })
    }

    /// What a thread needs to run [`Integrator::trace`].
    pub fn workspace(&self, settings: &Settings) -> Workspace {
        Workspace::new(settings, self.caustic_cones.cones())
    }

    pub(super) fn dimensions(&self, scatterings: u32) -> Dimensions {
        let each = Dimensions::OTHERS + self.lights.len() as u32;
        Dimensions { first: scatterings.wrapping_mul(each).wrapping_add(1) }
    }

    /// Generates the camera rays of the first `count` slots, which belong to row `y`.
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
        paths.environment_share[..count].fill(1.0);
        paths.path_class[..count].fill(PathClass::DIRECT);
        let start = if self.light_tracing.is_some() { caustic::CAMERA } else { caustic::NONE };
        paths.caustic[..count].fill(start);
        for channel in &mut work.radiance {
            channel[..count].fill(0.0);
        }
        work.layers[..count * self.classes.map_or(0, PathClasses::count)].fill(Rgb::ZERO);
    }

    /// Traces the camera paths to their ends and adds their radiance to `work.radiance`.
    pub fn trace<const NEEDS: u32>(&self, work: &mut Workspace, lens: &Lens) {
        let mut scatterings = 0;
        while work.paths.count > 0 {
            let count = work.paths.count;
            self.geometry.nearest(&work.paths.rays, count, &mut work.hits);
            self.sort_hits::<NEEDS>(work, scatterings == self.request.max_depth);
            if scatterings == 0 {
                self.exclude_near(work, lens);
            }
            let dimensions = self.dimensions(scatterings);
            scatterings += 1;
            work.next.count = 0;
            let last = scatterings == self.request.max_depth;
            if work.points.count > 0 {
                self.light_diffuse::<NEEDS>(work, dimensions);
                // After the last hit only area lights without light samples remain to be found.
                if Needs::OCCLUSION.is_in(NEEDS) && (!last || self.only_bsdf_sampled_emitters) {
                    let slots = &work.points.slot[..work.points.count];
                    work.numbers.fill(self.arch, slots, dimensions.bsdf(), (0, 1), &mut work.u);
                    let caustics = &work.points.caustic[..work.points.count];
                    if self.caustic_cones.is_empty() || caustics.iter().all(|&c| c != caustic::NONE) {
                        diffuse::extend_paths(self.arch, &work.points, &work.u, &mut work.next);
                    } else {
                        let reflections = scatterings <= REFLECTIONS_UP_TO;
                        self.caustic_cones.extend_paths(
                            self.arch,
                            &mut work.cones,
                            reflections,
                            &work.points,
                            &work.u,
                            &mut work.next,
                        );
                    }
                }
            }
            if Needs::DELTA.is_in(NEEDS) {
                self.scatter_delta(work, dimensions);
            }
            if Needs::ROUGH.is_in(NEEDS) && !work.rough.is_empty() {
                self.scatter_rough::<NEEDS>(work, dimensions);
            }
            roulette(&mut work.next, &work.numbers, dimensions.choice(), scatterings);
            std::mem::swap(&mut work.paths, &mut work.next);
        }
    }

    /// Adds the emission at the hits, and sorts the hits by the kind of their material.
    fn sort_hits<const NEEDS: u32>(&self, work: &mut Workspace, last: bool) {
        work.points.count = 0;
        work.delta.clear();
        work.rough.clear();
        for i in 0..work.paths.count {
            let id = work.hits.object[i];
            if id == NOTHING {
                if Needs::ENVIRONMENT.is_in(NEEDS) {
                    self.add_environment(work, i);
                }
                continue;
            }
            let shader = &self.shaders[id as usize];
            if Needs::LIGHTS.is_in(NEEDS)
                && let Some(emission) = &shader.emission
            {
                self.add_emission(work, i, shader, emission);
            }
            if last {
                continue;
            }
            match shader.kind {
                Kind::Black => {}
                Kind::Diffuse { albedo } => self.collect(work, i, albedo),
                Kind::Delta(_) if Needs::DELTA.is_in(NEEDS) => work.delta.push(i as u32),
                Kind::Rough(_) if Needs::ROUGH.is_in(NEEDS) => self.collect_rough(work, i),
                Kind::Delta(_) | Kind::Rough(_) => {}
            }
        }
    }

    /// Marks the diffuse hits that are too near to the camera for light tracing.
    fn exclude_near(&self, work: &mut Workspace, lens: &Lens) {
        let points = &mut work.points;
        if let Some(tracing) = &self.light_tracing {
            for i in 0..points.count {
                if !tracing.reaches(lens.area_at(at(&points.position, i))) {
                    points.caustic[i] = caustic::NONE;
                }
            }
        }
    }

    /// Adds the environment's radiance to a path whose ray leaves the scene, weighted against light samples.
    #[inline]
    fn add_environment(&self, work: &mut Workspace, i: usize) {
        let share = work.paths.environment_share[i];
        if let Some(environment) = &self.scene.environment
            && share > 0.0
        {
            let radiance = environment.radiance(at(&work.paths.rays.direction, i).as_dvec3());
            let value = at(&work.paths.throughput, i) * radiance * share;
            work.add(work.paths.slot[i], work.paths.path_class[i], value);
        }
    }

    /// The pdf with which light samples of the environment have direction `wi` at a surface; 0 without such samples.
    #[inline]
    pub(super) fn environment_pdf(&self, wi: Vec3, normal: Vec3) -> f64 {
        let (Some(environment), Some(light)) = (&self.scene.environment, self.strategies.light()) else { return 0.0 };
        let map = |w: Vec3| environment.to_map(w.as_dvec3());
        light.pdf_for(map(wi), map(normal))
    }

    /// Adds the emission of the surface that a path has hit, weighted against light samples.
    #[inline]
    fn add_emission(&self, work: &mut Workspace, i: usize, shader: &SurfaceShader, emission: &Emission) {
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        if !emission.is_emitted(surface.normal, at(&work.paths.rays.direction, i)) {
            return;
        }
        let pdf = work.paths.pdf[i];
        let traced = |light| self.light_tracing.as_ref().is_some_and(|tracing| tracing.starts_at(light));
        if caustic::is_light_traced(work.paths.caustic[i]) && shader.light.is_some_and(traced) {
            return;
        }
        // Compute the MIS weight of the sampled direction.
        let share = match (emission.visibility, shader.light) {
            _ if pdf == f32::INFINITY => 1.0,
            (EmitterVisibility::CameraOnly, _) => 0.0,
            (EmitterVisibility::Sampled, Some(_)) if pdf == 0.0 => 0.0,
            (EmitterVisibility::Sampled, None) => f32::from(u8::from(pdf > 0.0 || self.sampling.by_light())),
            (EmitterVisibility::Sampled, Some(light)) => {
                let other = self.lights[light].pdf(at(&work.paths.rays.origin, i));
                power_heuristic(pdf, self.request.light_samples as f32 * other)
            }
        };
        let value = at(&work.paths.throughput, i) * emission.radiance * share;
        work.add(work.paths.slot[i], work.paths.path_class[i], value);
    }

    /// Adds a diffuse hit to the batch.
    #[inline]
    pub(super) fn collect(&self, work: &mut Workspace, i: usize, albedo: Rgb) {
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        let side = if surface.normal.dot(at(&work.paths.rays.direction, i)) > 0.0 { -1.0 } else { 1.0 };
        let points = &mut work.points;
        let j = points.count;
        set(&mut points.position, j, surface.position + surface.normal * (side * surface.offset));
        set(&mut points.normal, j, surface.shading * side);
        set(&mut points.weight, j, at(&work.paths.throughput, i) * albedo);
        points.slot[j] = work.paths.slot[i];
        points.path_class[j] = work.paths.path_class[i].then(false);
        let caustic = caustic::after_diffuse(work.paths.caustic[i]);
        points.caustic[j] = if surface.is_flat() { caustic } else { caustic::NONE };
        points.count += 1;
    }

    /// The surface that the ray of path `i` has hit; that of a two-sided material faces the ray's origin.
    #[inline]
    pub(super) fn scattering_surface(&self, work: &Workspace, i: usize) -> Surface {
        let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
        let two_sided = self.shaders[work.hits.object[i] as usize].two_sided;
        if two_sided { surface.facing(-at(&work.paths.rays.direction, i)) } else { surface }
    }

    /// Adds a hit on the front of a rough surface to the batch.
    pub(super) fn collect_rough(&self, work: &mut Workspace, i: usize) {
        let surface = self.scattering_surface(work, i);
        let direction = at(&work.paths.rays.direction, i);
        if surface.normal.dot(direction) > 0.0 {
            return;
        }
        let frame = surface.frame(-direction);
        let wo = frame.to_local(-direction);
        work.rough.push(RoughHit {
            surface,
            frame,
            wo,
            throughput: at(&work.paths.throughput, i),
            slot: work.paths.slot[i],
            path_class: work.paths.path_class[i].then(false),
            object: work.hits.object[i],
            caustic: caustic::is_light_traced(work.paths.caustic[i])
                && shading_normal::is_sound_to_camera(&surface, -direction),
        });
    }
}

/// Russian roulette: ends paths of low throughput at random and raises the throughput of the survivors.
pub(super) fn roulette(paths: &mut Paths, numbers: &SampleLanes, dimension: u32, scatterings: u32) {
    if scatterings <= ROULETTE_AFTER {
        return;
    }
    paths.retain(|paths, i| {
        let throughput = at(&paths.throughput, i);
        let survival = (throughput.max_element() * ROULETTE_BELOW.recip()).min(1.0);
        let [_, u] = numbers.short_pair(paths.slot[i], dimension, (0, 1));
        set(&mut paths.throughput, i, throughput / survival);
        u < survival
    });
}
