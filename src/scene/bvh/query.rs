//! Queries of the tree and their results: rays and hits.

use crate::scene::camera::Ray;
use glam::Vec3;

/// Where a ray hits a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshHit {
    /// Distance along the ray.
    pub t: f32,
    /// Number of the triangle, counted on through all meshes.
    pub triangle: u32,
    /// Where the tree keeps it, for [`super::MeshBvh::surface`].
    pub place: u32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// That of its third corner.
    pub v: f32,
}

/// Rays, component by component. The slices are of one length.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// Where they start.
    pub origin: [&'a [f32]; 3],
    /// Unit directions.
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
