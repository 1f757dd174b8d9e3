//! The parts of the renderer that a scene needs; the others are neither built nor run.

use super::geometry::Geometry;
use super::settings::Settings;
use etalon_core::scene::{Material, Request, Scene, Shape};

/// The parts of the renderer that a scene needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// Shadow rays and further bounces.
    pub occlusion: bool,
    pub environment_table: bool,
    pub tree: bool,
}

impl Needs {
    /// What a scene needs under these settings; if they are general, everything that it has, whether needed or not.
    #[must_use]
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

    /// Names of the parts that are left out.
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
