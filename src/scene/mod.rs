//! What is rendered: camera, shapes, materials, light, and what a scene file asks of a render.

pub mod builtin;
pub mod camera;
pub mod environment;
pub mod request;
pub mod sphere;

pub use camera::{Camera, Projection, Ray};
pub use environment::Environment;
pub use request::Request;
pub use sphere::{Hit, Sphere};

use crate::raster::Rgb;

/// A scene. World space is right-handed with y up; lengths are in the scene's own unit.
#[derive(Debug, Clone)]
pub struct Scene {
    pub name: String,
    pub camera: Camera,
    pub objects: Vec<Object>,
    /// The light from infinity, if there is any.
    pub environment: Option<Environment>,
}

/// A shape and what it is made of.
#[derive(Debug, Clone)]
pub struct Object {
    pub shape: Sphere,
    pub material: Material,
}

/// How a surface scatters light.
#[derive(Debug, Clone, PartialEq)]
pub enum Material {
    /// Lambertian reflection of the given albedo.
    Diffuse { albedo: Rgb },
}

impl Scene {
    /// The nearest hit of a ray, beyond its origin.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<(Hit, &Material)> {
        let mut nearest: Option<(Hit, &Material)> = None;
        for object in &self.objects {
            let limit = nearest.as_ref().map_or(f32::INFINITY, |(hit, _)| hit.t);
            if let Some(hit) = object.shape.intersect(ray, limit) {
                nearest = Some((hit, &object.material));
            }
        }
        nearest
    }

    /// Whether anything stands in the ray's way.
    #[inline]
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.objects.iter().any(|object| object.shape.intersect(ray, f32::INFINITY).is_some())
    }
}
