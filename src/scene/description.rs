//! The scene as a whole: camera, objects, lights, environment, and what it asks of a render; flags override that.

use super::{Camera, Emission, EmitterVisibility, Environment, Light, Material, Mesh, Rectangle, Sphere};
use glam::Vec3;
use std::sync::Arc;

/// A scene. World space is right-handed with y up; lengths are in the scene's own unit.
#[derive(Debug, Clone)]
pub struct Scene {
    /// What results and messages call it.
    pub name: String,
    /// Position, orientation and projection.
    pub camera: Camera,
    /// What rays can hit.
    pub objects: Vec<Object>,
    /// Lights that are not objects.
    pub lights: Vec<Light>,
    /// The light from infinity, if there is any.
    pub environment: Option<Environment>,
}

impl Scene {
    /// Whether anything lights surfaces. Emission of [`EmitterVisibility::CameraOnly`] does not.
    #[must_use]
    pub fn has_light(&self) -> bool {
        let emits =
            |object: &Object| object.emission.is_some_and(|emission| emission.visibility == EmitterVisibility::Sampled);
        self.environment.is_some() || !self.lights.is_empty() || self.objects.iter().any(emits)
    }

    /// The scene for an image of another size than `request` has; see [`Camera::fitted`].
    #[must_use]
    pub fn resized(self, request: Request, [width, height]: [usize; 2]) -> (Self, Request) {
        let camera = self.camera.fitted([request.width, request.height], [width, height]);
        (Self { camera, ..self }, Request { width, height, ..request })
    }
}

/// A shape, its material, and whether it emits light.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its surface, in the world.
    pub shape: Shape,
    /// How the surface scatters light.
    pub material: Material,
    /// The light that the surface gives off; `None` for most.
    pub emission: Option<Emission>,
    /// The unit axis, in the world, around which the tangents of a sphere run: +z of its object space, as in pbrt. The
    /// tangents of a rectangle run along its first edge, those of a mesh are [`Mesh::tangent`]. Only anisotropic
    /// materials depend on tangents.
    pub axis: Vec3,
    /// The unit directions, in the world, of azimuth 0° and 90° around [`axis`](Self::axis): +x and +y of object space. Only
    /// textures on spheres depend on them.
    pub meridians: [Vec3; 2],
}

impl Object {
    /// An object that emits no light, its axis along +z, its meridians along +x and +y.
    #[must_use]
    pub fn new(shape: Shape, material: Material) -> Self {
        Self { shape, material, emission: None, axis: Vec3::Z, meridians: [Vec3::X, Vec3::Y] }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A whole sphere.
    Sphere(Sphere),
    /// A flat rectangle.
    Rectangle(Rectangle),
    /// Triangles; a mesh may be shared by objects.
    Mesh(Arc<Mesh>),
}

impl From<Mesh> for Shape {
    fn from(mesh: Mesh) -> Self {
        Self::Mesh(Arc::new(mesh))
    }
}

/// Image size and sampling that a scene asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// Camera samples per pixel.
    pub spp: u32,
    /// Light samples at each hit.
    pub light_samples: u32,
    /// 0: emission only; 1: direct light; n: light that arrives over at most n segments after the camera's.
    pub max_depth: u32,
}
