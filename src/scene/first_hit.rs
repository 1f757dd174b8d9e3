//! Which object a ray meets first, one ray at a time.

use super::{MeshBvh, Object, Ray, Scene, Shape};

/// The objects of a scene, its meshes in one tree.
pub struct FirstHit<'a> {
    objects: &'a [Object],
    meshes: MeshBvh,
    /// Which object each mesh of the tree is.
    mesh_objects: Vec<usize>,
}

impl<'a> FirstHit<'a> {
    /// Builds the tree.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        let meshes = scene.objects.iter().enumerate().filter_map(|(i, object)| match &object.shape {
            Shape::Mesh(mesh) => Some((&**mesh, i)),
            _ => None,
        });
        let (meshes, mesh_objects): (Vec<_>, _) = meshes.unzip();
        Self { objects: &scene.objects, meshes: MeshBvh::build(&meshes), mesh_objects }
    }

    /// The object that the ray meets first; `None` when it meets none.
    #[must_use]
    pub fn along(&self, ray: &Ray) -> Option<&'a Object> {
        let (mut nearest, mut first) = (f32::INFINITY, None);
        for object in self.objects {
            let distance = match &object.shape {
                Shape::Sphere(sphere) => sphere.distance(ray.origin, ray.direction),
                Shape::Rectangle(rectangle) => rectangle.distance(ray.origin, ray.direction),
                Shape::Mesh(_) => f32::INFINITY,
            };
            if distance < nearest {
                (nearest, first) = (distance, Some(object));
            }
        }
        match self.meshes.nearest(ray, nearest) {
            Some(hit) => Some(&self.objects[self.mesh_objects[self.meshes.mesh_of(hit.triangle) as usize]]),
            None => first,
        }
    }
}
