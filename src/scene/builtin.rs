//! The built-in scenes.

use super::{Camera, Environment, Material, Object, Projection, Request, Scene, Shape, Sphere};
use crate::raster::Rgb;
use glam::{DVec3, Vec3};

/// The first report's scene: a white diffuse unit sphere in an environment scaled by 8, seen in parallel along −z
/// from the plane z = 1 that touches it.
#[must_use]
pub fn sphere_env(environment: Environment) -> (Scene, Request) {
    let camera = Camera {
        position: DVec3::Z,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Orthographic { half_width: 1.0, half_height: 1.0 },
    };
    let sphere = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 1.0 });
    let objects = vec![Object::new(sphere, Material::Diffuse { albedo: Rgb::ONE })];
    let scene =
        Scene { name: "sphere-env".into(), camera, objects, lights: Vec::new(), environment: Some(environment) };
    (scene, Request { width: 511, height: 511, spp: 16, light_samples: 4, max_depth: 1 })
}

/// How much the first report's scene brightens its map.
pub const SPHERE_ENV_SCALE: f32 = 8.0;
