//! The scene as a whole: camera, objects, lights, environment, and what it asks of a render; flags override that.

use super::{Camera, Emission, EmitterVisibility, Environment, Light, Material, Mesh, Rectangle, Sphere};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// A scene. World space is right-handed with y up; lengths are in the scene's own unit.
#[derive(Debug, Clone)]
pub struct Scene {
    pub name: String,
    pub camera: Camera,
    pub objects: Vec<Object>,
    /// Lights that are not objects.
    pub lights: Vec<Light>,
    pub environment: Option<Environment>,
}

impl Scene {
    /// Whether anything lights surfaces. Emission of [`EmitterVisibility::CameraOnly`] does not.
    pub fn has_light(&self) -> bool {
        let emits =
            |object: &Object| object.emission.is_some_and(|emission| emission.visibility == EmitterVisibility::Sampled);
        self.environment.is_some() || !self.lights.is_empty() || self.objects.iter().any(emits)
    }

    /// The scene moved towards the origin, with its camera: along every axis along which the box around it is farther away than
    /// its diagonal is long. Differences of such coordinates are exact, so that it is the same scene. Rays that leave a
    /// surface start off it by a distance that grows with its coordinates; far from the origin that is more than the size of objects.
    #[must_use]
    pub fn near_origin(mut self) -> Self {
        let points = self.lights.iter().filter_map(Light::position).map(|point| [point; 2]);
        let boxes = self.objects.iter().filter_map(|object| object.shape.bounds()).chain(points);
        let Some([low, high]) = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else { return self };
        let middle = 0.5 * low + 0.5 * high;
        let is_far = middle.abs().cmpgt(Vec3::splat((high - low).length()));
        let by = Vec3::select(is_far, middle, Vec3::ZERO);
        if by == Vec3::ZERO {
            return self;
        }
        // Objects that share a mesh keep sharing it.
        let mut moved: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
        for object in &mut self.objects {
            match &mut object.shape {
                Shape::Sphere(sphere) => sphere.centre -= by,
                Shape::Rectangle(rectangle) => *rectangle = rectangle.centred_at(rectangle.centre() - by),
                Shape::Mesh(mesh) => {
                    let of = Arc::as_ptr(mesh);
                    if let Some(moved) = moved.get(&of) {
                        *mesh = Arc::clone(moved);
                        continue;
                    }
                    Arc::make_mut(mesh).positions.iter_mut().for_each(|position| *position -= by);
                    moved.insert(of, Arc::clone(mesh));
                }
            }
        }
        self.lights.iter_mut().for_each(|light| light.translate(-by));
        self.camera.position -= by.as_dvec3();
        self
    }

    /// The scene for an image of another size than `request` has; see [`Camera::fitted`].
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
    pub material: Material,
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
    pub fn new(shape: Shape, material: Material) -> Self {
        Self { shape, material, emission: None, axis: Vec3::Z, meridians: [Vec3::X, Vec3::Y] }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Sphere(Sphere),
    Rectangle(Rectangle),
    /// Triangles; a mesh may be shared by objects.
    Mesh(Arc<Mesh>),
}

impl Shape {
    /// Least and largest coordinates; `None` if there is nothing to hit.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        match self {
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Rectangle(rectangle) => {
                let corners = rectangle.corners();
                Some([corners.into_iter().fold(corners[0], Vec3::min), corners.into_iter().fold(corners[0], Vec3::max)])
            }
            Self::Mesh(mesh) => mesh.bounds(),
        }
    }

    pub fn bounding_sphere(&self) -> Sphere {
        match self {
            Self::Sphere(sphere) => *sphere,
            Self::Rectangle(r) => Sphere { centre: r.centre(), radius: (r.corners()[0] - r.centre()).length() },
            Self::Mesh(mesh) => {
                let [low, high] = mesh.bounds().unwrap_or_default();
                let centre = 0.5 * (low + high);
                let radius2 = mesh.positions.iter().map(|p| p.distance_squared(centre)).fold(0.0, f32::max);
                Sphere { centre, radius: radius2.sqrt() }
            }
        }
    }

    /// The number of triangles that stand for it in a [`Bvh`](super::bvh::Bvh); 0 of a sphere.
    pub fn triangles(&self) -> usize {
        match self {
            Self::Sphere(_) => 0,
            Self::Rectangle(_) => 2,
            Self::Mesh(mesh) => mesh.triangles.len(),
        }
    }
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
    pub light_samples: u32,
    /// 0: emission only; 1: direct light; n: light that arrives over at most n segments after the camera's.
    pub max_depth: u32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use glam::DVec3;

    #[test]
    fn a_far_scene_comes_near_without_any_change_and_a_near_one_stays() {
        let (near, _) = builtin::cornell_spheres();
        let centres = |scene: &Scene| scene.objects.iter().map(|object| object.shape.bounds()).collect::<Vec<_>>();
        assert_eq!(centres(&near), centres(&near.clone().near_origin()));
        let by = Vec3::new(4096.0, 0.0, -65536.0);
        let mesh = |z: f32| {
            let corners = vec![Vec3::new(0.25, 0.0, z), Vec3::new(1.0, 0.0, z), Vec3::new(1.0, 1.0, z)];
            Mesh::new(corners.into_iter().map(|corner| corner + by).collect(), Vec::new(), vec![[0, 1, 2]]).unwrap()
        };
        let shared = Arc::new(mesh(0.5));
        let mut far = near;
        far.objects.truncate(1);
        far.objects[0].shape = Shape::Mesh(Arc::clone(&shared));
        far.objects.push(far.objects[0].clone());
        let sphere = Sphere { centre: by, radius: 0.5 };
        far.objects.push(Object { shape: Shape::Sphere(sphere), ..far.objects[0].clone() });
        far.lights.clear();
        far.camera.position = by.as_dvec3() + DVec3::Z;
        drop(shared);
        let moved = far.clone().near_origin();
        let shift = far.camera.position - moved.camera.position;
        assert_eq!(shift, DVec3::new(4096.25, 0.0, -65536.0));
        for (a, b) in centres(&far).into_iter().zip(centres(&moved)) {
            assert_eq!(a.unwrap().map(|p| p.as_dvec3() - shift), b.unwrap().map(Vec3::as_dvec3));
        }
        let [Shape::Mesh(a), Shape::Mesh(b)] = [&moved.objects[0].shape, &moved.objects[1].shape] else { panic!() };
        assert!(Arc::ptr_eq(a, b));
    }
}
