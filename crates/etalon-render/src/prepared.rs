//! A scene made ready for rendering, the parts of the renderer that it needs, and what both implementations of the integrator ask of it.

use super::environment::EnvironmentSampling;
use super::film::PathClasses;
use super::geometry::Geometry;
use super::lanes::Hits;
use super::light_sample::SampleLight;
use super::light_selection::Lights;
use super::light_tracing::LightTracing;
use super::lights;
use super::lights::SampledLight;
use super::ray_samples::{RaySamples, Streams};
use super::settings::{Sampling, Settings};
use super::shaders::{Kind, SurfaceShader};
use etalon_core::error::{Error, Result};
use etalon_core::memory;
use etalon_core::scene::{Bvh, Material, Ray, Request, Scene, Shape};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Russian roulette ends paths with a throughput below this and raises that of the survivors to it. To raise it to 1
/// would cause fireflies.
pub const ROULETTE_BELOW: f32 = 0.1;

/// Scatterings before Russian roulette may end a path.
pub const ROULETTE_AFTER: u32 = 5;

/// A scene made ready for rendering.
pub struct PreparedScene<'a> {
    pub scene: &'a Scene,
    pub request: Request,
    pub needs: Needs,
    pub geometry: Arc<Geometry<'a>>,
    /// BSDF and emission by object.
    pub shaders: Vec<SurfaceShader>,
    pub lights: Arc<Lights>,
    /// Light samples of the environment, if they are taken.
    pub environment: Option<Arc<EnvironmentSampling<'a>>>,
    pub light_tracing: Option<LightTracing>,
    pub sampling: Sampling,
    /// Whether rays can hit light.
    pub has_emitters: bool,
    /// Path classes that are summed separately.
    pub classes: Option<PathClasses>,
}

impl<'a> PreparedScene<'a> {
    /// Prepares a scene.
    ///
    /// # Errors
    /// Those of the lights and samplers that the settings ask for.
    pub fn new(scene: &'a Scene, request: &Request, settings: &Settings) -> Result<Self> {
        let needs = Needs::of(scene, request, settings);
        if needs.tree {
            let bytes = scene.objects.iter().map(|object| Bvh::bytes(&object.shape)).sum();
            memory::request(bytes, || format!("the tree of {} objects", scene.objects.len()))?;
        }
        let geometry = Arc::new(Geometry::new(scene, needs.tree));
        let (objects, lights) = (scene.objects.len(), SampledLight::most(scene));
        memory::request(objects * SurfaceShader::BYTES + lights * Lights::BYTES, || {
            format!("the materials of {objects} objects, and {lights} lights")
        })?;
        let environment = EnvironmentSampling::new(scene, settings, &needs)?.map(Arc::new);
        let fixed = lights::of_cut(scene, settings)?;
        let lights = Arc::new(Lights::new(SampledLight::all(scene, settings, &fixed), request.light_samples));
        let rounds = lights.rounds().len();
        if !RaySamples::suffice(request.max_depth, rounds) {
            let message = format!("{} scatterings with {rounds} light samples each are too many", request.max_depth);
            return Err(Error::parameter("max_depth", message).with_hint("each sample needs random numbers of its own"));
        }
        Ok(Self::assemble(scene, request, settings, needs, geometry, lights, environment))
    }

    /// The same scene for another technique or density of the map, neither of which has fixed lights.
    ///
    /// # Errors
    /// As [`PreparedScene::new`].
    pub fn with(&self, settings: &Settings) -> Result<Self> {
        let Self { scene, ref request, needs, ref geometry, ref lights, ref environment, sampling, .. } = *self;
        let environment = match environment.as_ref().filter(|environment| environment.is_for(settings)) {
            Some(environment) => Some(environment.clone()),
            None => EnvironmentSampling::new(scene, settings, &needs)?.map(Arc::new),
        };
        let lights = match settings.sampling.by_light() == sampling.by_light() {
            true => lights.clone(),
            false => Arc::new(Lights::new(SampledLight::all(scene, settings, &[]), request.light_samples)),
        };
        Ok(Self::assemble(scene, request, settings, needs, geometry.clone(), lights, environment))
    }

    fn assemble(
        scene: &'a Scene,
        request: &Request,
        settings: &Settings,
        needs: Needs,
        geometry: Arc<Geometry<'a>>,
        lights: Arc<Lights>,
        environment: Option<Arc<EnvironmentSampling<'a>>>,
    ) -> Self {
        let shaders = SurfaceShader::all(scene, settings, &lights.all);
        let light_tracing = match settings.sampling {
            Sampling::MisLt => LightTracing::new(scene, request, &shaders, &lights, environment.as_deref(), &geometry),
            _ => None,
        };
        Self {
            scene,
            request: *request,
            needs,
            geometry,
            shaders,
            lights,
            environment,
            light_tracing,
            sampling: settings.sampling,
            has_emitters: scene.objects.iter().any(|object| object.emission.is_some()),
            classes: settings.paths,
        }
    }

    /// How far a shadow ray towards a light may go, so that rounding does not let the light occlude itself.
    #[inline(always)]
    pub fn t_max(&self, light: u32, ray: Ray, distance: f32) -> f32 {
        self.lights.all.get(light as usize).map_or(distance, |light| light.t_max(ray, distance))
    }

    /// The expected number of light samples of the environment per solid angle in direction `wi` at a surface.
    #[inline]
    pub fn environment_density(&self, wi: Vec3, normal: Vec3, surface: Kind) -> f32 {
        let pdf = self.environment.as_ref().map_or(0.0, |environment| environment.pdf(wi, normal, surface));
        self.request.light_samples as f32 * pdf as f32
    }

    /// The texture coordinates of the surface that ray `i` has hit; 0 if its material has no textures.
    #[inline]
    pub fn uv(&self, hits: &Hits, i: usize, position: Vec3) -> Vec2 {
        let is_textured = self.shaders[hits.object[i] as usize].varying.is_some();
        if is_textured { self.geometry.uv(hits, i, position) } else { Vec2::ZERO }
    }

    /// The random numbers of camera paths at a depth.
    #[inline]
    pub fn ray_samples<'s>(&self, streams: &'s Streams, depth: u32) -> RaySamples<'s> {
        RaySamples::of_camera_paths(streams, depth, self.lights.rounds().len())
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// Shadow rays and further bounces.
    pub occlusion: bool,
    pub environment_table: bool,
    pub tree: bool,
}

impl Needs {
    /// What a scene needs under these settings; if they are general, everything that it has, whether needed or not.
    pub fn of(scene: &Scene, request: &Request, settings: &Settings) -> Self {
        let general = settings.general;
        let samples_map =
            settings.sampling.by_light() && !settings.map_sampling().has_fixed_lights() && request.max_depth > 0;
        Self {
            occlusion: general || !lone_convex_from_outside(scene),
            environment_table: scene.environment.is_some() && (general || samples_map),
            tree: general || Geometry::needs_tree(scene),
        }
    }

    pub fn left_out(&self, scene: &Scene) -> impl Iterator<Item = &'static str> {
        let parts = [
            (self.environment_table || scene.environment.is_none(), "environment sampling table"),
            (self.tree, "BVH"),
            (self.occlusion, "shadow rays"),
            (self.occlusion, "further bounces"),
        ];
        parts.into_iter().filter(|(needed, _)| !needed).map(|(_, name)| name)
    }
}

/// Whether no ray that leaves a surface can meet another: one convex diffuse object, seen from outside.
pub fn lone_convex_from_outside(scene: &Scene) -> bool {
    let [object] = scene.objects.as_slice() else { return scene.objects.is_empty() };
    let (Shape::Sphere(sphere), Material::Diffuse { .. }) = (&object.shape, &object.material) else { return false };
    scene.camera.is_outside(sphere)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Sampling;
    use etalon_core::envmap::EnvMap;
    use etalon_core::raster::Image;
    use etalon_core::scene::{Environment, Sphere, builtin};
    use glam::{DVec3, Vec3};
    use std::sync::Arc;

    #[test]
    fn only_a_lone_sphere_seen_from_outside_goes_without_occlusion() {
        let map = Arc::new(EnvMap::new(Image::new(2, 1)));
        let (mut scene, request) = builtin::sphere_env(Environment::upright(map, "black", 1.0));
        let needs = |scene: &Scene| Needs::of(scene, &request, &Settings::default());
        assert!(!needs(&scene).occlusion && needs(&scene).environment_table);
        let bsdf = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
        assert!(!Needs::of(&scene, &request, &bsdf).environment_table);
        scene.camera.position = DVec3::ZERO;
        assert!(needs(&scene).occlusion, "from inside every ray meets the sphere again");
        scene.camera.position = DVec3::Z;
        let mut second = scene.objects[0].clone();
        second.shape = Shape::Sphere(Sphere { centre: Vec3::splat(3.0), radius: 1.0 });
        scene.objects.push(second);
        assert!(needs(&scene).occlusion);
    }
}
