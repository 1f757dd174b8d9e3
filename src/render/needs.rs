//! What a scene needs of the renderer; what it does not need is neither built nor compiled into the loop that runs.

use super::{Sampling, Settings};
use crate::scene::{Projection, Request, Scene, Shape};

/// The parts of the renderer that a scene can do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    pub environment: bool,
    /// A table to draw directions towards the environment from.
    pub environment_table: bool,
    /// Asking whether a ray that leaves a surface meets another one: shadow rays and further bounces.
    pub occlusion: bool,
}

impl Needs {
    /// Everything, whether needed or not.
    pub const EVERYTHING: Self = Self { environment: true, environment_table: true, occlusion: true };

    pub const OCCLUSION: u32 = 1;
    pub const ENVIRONMENT: u32 = 2;
    pub const ALL: u32 = 3;

    pub fn kernel(&self) -> u32 {
        Self::OCCLUSION * u32::from(self.occlusion) | Self::ENVIRONMENT * u32::from(self.environment)
    }

    /// Looks at a scene once.
    #[must_use]
    pub fn of(scene: &Scene, request: &Request, settings: &Settings) -> Self {
        let by_light = matches!(settings.sampling, Sampling::Light | Sampling::Mis);
        Self {
            environment: scene.environment.is_some(),
            environment_table: by_light && request.max_depth > 0 && scene.environment.is_some(),
            occlusion: !lone_convex_from_outside(scene),
        }
    }

    /// What is missing, in words.
    #[must_use]
    pub fn left_out(&self, scene: &Scene) -> Vec<&'static str> {
        let mut list = Vec::new();
        if scene.environment.is_none() {
            list.push("environment light");
        } else if !self.environment_table {
            list.push("environment sampling table");
        }
        if !self.occlusion {
            list.extend(["shadow rays", "further bounces"]);
        }
        list
    }
}

/// Whether no ray that leaves a surface can meet another: one convex object, seen from outside.
fn lone_convex_from_outside(scene: &Scene) -> bool {
    let [object] = scene.objects.as_slice() else { return scene.objects.is_empty() };
    let Shape::Sphere(sphere) = &object.shape else { return false };
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
    use crate::scene::{Environment, Sphere, builtin};
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
