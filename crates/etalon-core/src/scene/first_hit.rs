//! Which object a ray meets first, one ray at a time.

use super::{Bvh, Object, Ray, Scene, Shape};

/// The objects of a scene in a tree.
pub struct FirstHit<'a> {
    objects: &'a [Object],
    bvh: Bvh,
}

impl<'a> FirstHit<'a> {
    /// Builds the tree.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        let shapes: Vec<&Shape> = scene.objects.iter().map(|object| &object.shape).collect();
        Self { objects: &scene.objects, bvh: Bvh::build(&shapes) }
    }

    /// The object that the ray meets first; `None` when it meets none.
    #[must_use]
    pub fn along(&self, ray: &Ray) -> Option<&'a Object> {
        self.bvh.nearest(ray, f32::INFINITY).map(|hit| &self.objects[hit.shape as usize])
    }
}
