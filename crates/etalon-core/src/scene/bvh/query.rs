//! Queries of the tree and their results: rays and hits.

use crate::scene::camera::Ray;
use glam::Vec3;

/// Where a ray hits a primitive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// Number of the shape, in the order of [`super::Bvh::build`].
    pub shape: u32,
    /// Number of the triangle in its mesh; 0 for spheres, and 0 or 1 for the halves of a rectangle.
    pub triangle: u32,
    /// Where the tree keeps the triangle, for [`super::Bvh::surface`], [`super::Bvh::plane`] and
    /// [`super::Bvh::triangle`], which panic for one that no hit of a triangle had; 0 for spheres.
    pub place: u32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// That of its third corner.
    pub v: f32,
}

impl Hit {
    /// Whether a hit of this primitive at the distance `t` comes before this one.
    #[inline(always)]
    pub(super) fn is_beaten_by(&self, t: f32, shape: u32, triangle: u32) -> bool {
        t < self.t || (t == self.t && (shape, triangle) < (self.shape, self.triangle))
    }
}

/// Rays, component by component. The slices are of one length.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// Where they start.
    pub origin: [&'a [f32]; 3],
    pub direction: [&'a [f32]; 3],
    /// Where each ray ends; one that is not above 0 hits nothing and costs nothing.
    pub t_max: &'a [f32],
}

impl Rays<'_> {
    /// Ray number `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        let at = |v: &[&[f32]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        Ray { origin: at(&self.origin), direction: at(&self.direction) }
    }
}
