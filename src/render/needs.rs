//! The parts of the renderer that a scene needs; the others are neither built nor in the kernel that runs.

use super::settings::Settings;
use crate::bsdf::Scatter;
use crate::scene::{Material, Projection, Request, Scene, Shape};

/// A part of the renderer that some scenes can do without, as a bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Need(u32);

impl Need {
    /// Whether a set of bits has this one.
    #[inline(always)]
    pub const fn is_in(self, set: u32) -> bool {
        set & self.0 != 0
    }
}

/// The parts of the renderer that a scene needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    bits: u32,
    /// A table to sample the environment.
    pub environment_table: bool,
    /// A tree of triangles.
    pub meshes: bool,
}

impl Needs {
    /// Shadow rays and further bounces.
    pub const OCCLUSION: Need = Need(1);
    /// An environment map.
    pub const ENVIRONMENT: Need = Need(2);
    /// Area lights, and lights that are not objects.
    pub const LIGHTS: Need = Need(4);
    /// Mirrors and glass.
    pub const DELTA: Need = Need(8);
    /// Rough metal.
    pub const ROUGH: Need = Need(16);
    const ALL: u32 = 31;

    /// The sets that kernels are compiled for.
    pub const LEAN: [u32; 5] = [
        Self::ENVIRONMENT.0,
        Self::OCCLUSION.0 | Self::LIGHTS.0,
        Self::OCCLUSION.0 | Self::LIGHTS.0 | Self::DELTA.0,
        Self::OCCLUSION.0 | Self::LIGHTS.0 | Self::ROUGH.0,
        Self::ALL,
    ];

    /// Everything, whether needed or not, as far as the scene has it.
    #[must_use]
    pub fn everything(scene: &Scene) -> Self {
        Self { bits: Self::ALL, environment_table: scene.environment.is_some(), meshes: true }
    }

    /// What a scene needs under these settings.
    #[must_use]
    pub fn of(scene: &Scene, request: &Request, settings: &Settings) -> Self {
        let by_light = settings.sampling.by_light();
        let any = |delta: bool| {
            request.max_depth > 0
                && scene.objects.iter().any(|object| match &object.material {
                    Material::Diffuse { .. } => false,
                    other => other.bsdf(settings.model).is_delta() == delta,
                })
        };
        let cut_lights = settings.density.has_fixed_lights() && scene.environment.is_some();
        let lights =
            cut_lights || !scene.lights.is_empty() || scene.objects.iter().any(|object| object.emission.is_some());
        let bits = [
            (Self::OCCLUSION, !lone_convex_from_outside(scene)),
            (Self::ENVIRONMENT, scene.environment.is_some()),
            (Self::LIGHTS, lights),
            (Self::DELTA, any(true)),
            (Self::ROUGH, any(false)),
        ];
        Self {
            bits: bits.into_iter().filter(|(_, needed)| *needed).map(|(need, _)| need.0).sum(),
            environment_table: by_light && !cut_lights && request.max_depth > 0 && scene.environment.is_some(),
            meshes: scene.objects.iter().any(|object| matches!(object.shape, Shape::Mesh(_))),
        }
    }

    /// The kernel to run: the number of the first in [`Needs::LEAN`] that has all needs.
    #[must_use]
    pub fn kernel(&self) -> usize {
        Self::LEAN.iter().position(|set| self.bits & !set == 0).unwrap_or(Self::LEAN.len() - 1)
    }

    /// Names of the parts that are left out.
    #[must_use]
    pub fn left_out(&self, scene: &Scene) -> Vec<&'static str> {
        let compiled = Need(Self::LEAN[self.kernel()]).0;
        let mut list = Vec::new();
        let parts = [
            (Self::ENVIRONMENT, "environment light"),
            (Self::LIGHTS, "area lights"),
            (Self::DELTA, "mirrors and glass"),
            (Self::ROUGH, "rough metal"),
        ];
        list.extend(parts.into_iter().filter(|(need, _)| !need.is_in(compiled)).map(|(_, name)| name));
        if scene.environment.is_some() && !self.environment_table {
            list.push("environment sampling table");
        }
        if !self.meshes {
            list.push("BVH");
        }
        if !Self::OCCLUSION.is_in(compiled) {
            list.extend(["shadow rays", "further bounces"]);
        }
        list
    }
}

/// Whether no ray that leaves a surface can meet another: one convex diffuse object, seen from outside.
fn lone_convex_from_outside(scene: &Scene) -> bool {
    let [object] = scene.objects.as_slice() else { return scene.objects.is_empty() };
    let (Shape::Sphere(sphere), Material::Diffuse { .. }) = (&object.shape, &object.material) else { return false };
    let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
    let offset = scene.camera.position - centre;
    match scene.camera.projection {
        Projection::Perspective { .. } => offset.length() >= radius,
        // Rays start on a plane, which must not cut the sphere.
        Projection::Orthographic { .. } => offset.dot(scene.camera.forward).abs() >= radius,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::EnvMap;
    use crate::raster::Image;
    use crate::render::settings::Sampling;
    use crate::scene::{Environment, Sphere, builtin};
    use glam::{DVec3, Vec3};
    use std::sync::Arc;

    #[test]
    fn only_a_lone_sphere_seen_from_outside_goes_without_occlusion() {
        let map = Arc::new(EnvMap::new(Image::new(2, 1)));
        let (mut scene, request) = builtin::sphere_env(Environment::upright(map, "black", 1.0));
        let needs = |scene: &Scene| Needs::of(scene, &request, &Settings::default());
        assert!(!Needs::OCCLUSION.is_in(needs(&scene).bits) && needs(&scene).environment_table);
        assert_eq!(needs(&scene).kernel(), 0);
        let bsdf = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
        assert!(!Needs::of(&scene, &request, &bsdf).environment_table);
        scene.camera.position = DVec3::ZERO;
        assert!(Needs::OCCLUSION.is_in(needs(&scene).bits), "from inside every ray meets the sphere again");
        scene.camera.position = DVec3::Z;
        let mut second = scene.objects[0].clone();
        second.shape = Shape::Sphere(Sphere { centre: Vec3::splat(3.0), radius: 1.0 });
        scene.objects.push(second);
        assert!(Needs::OCCLUSION.is_in(needs(&scene).bits));
    }

    #[test]
    fn scenes_get_the_leanest_kernel_that_will_do() {
        let kernel = |(scene, request): (Scene, Request)| Needs::of(&scene, &request, &Settings::default()).kernel();
        assert_eq!(kernel(builtin::cornell_lambert()), 1);
        assert_eq!(kernel(builtin::cornell_spheres()), 2);
        let (scene, request) = builtin::cornell_spheres();
        assert_eq!(kernel((scene, Request { max_depth: 0, ..request })), 1, "without scattering no mirrors");
    }
}
