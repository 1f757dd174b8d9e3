//! Planes, and how far off them rays must start.

use glam::Vec3;

/// The points p with n · p = `height`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// n, of unit length.
    pub normal: Vec3,
    /// Height of the points along the normal.
    pub height: f32,
}

/// Twice eight roundings of ε/2, relative to Σ |nᵢ pᵢ|: four in [`Plane::project`], one in the ray's origin, three in its distance.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// More than 0, for planes through the origin, where nothing may be rounded; its products with directions are not denormal.
const LEAST_OFFSET: f32 = 1e-30;

impl Plane {
    /// The plane through a point with this unit normal.
    #[must_use]
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        // In f64, so that only the result is rounded.
        Self { normal, height: normal.as_dvec3().dot(point.as_dvec3()) as f32 }
    }

    /// How far the plane may be off a polygon with these corners, one of which it goes through, and off the plane of a neighbour:
    /// at each corner the rounding of the normal and of the height, three times ε/2 of Σ |nᵢ pᵢ|, for both.
    #[must_use]
    pub fn error(&self, corners: &[Vec3]) -> f32 {
        let farthest = corners.iter().fold(Vec3::ZERO, |farthest, corner| farthest.max(corner.abs()));
        3.0 * f32::EPSILON * self.normal.abs().dot(farthest)
    }

    /// The point of the plane below one that is close to it.
    #[inline(always)]
    #[must_use]
    pub fn project(&self, point: Vec3) -> Vec3 {
        point - self.normal * (self.normal.dot(point) - self.height)
    }

    /// The distance along a ray; below 0 behind its origin, infinite or NaN of a parallel ray.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        (self.height - self.normal.dot(origin)) / self.normal.dot(direction)
    }

    /// How far along the normal a ray must start from a point that was [projected](Self::project) onto the plane, so that the sign of
    /// its [distance](Self::distance) is certain.
    #[inline(always)]
    #[must_use]
    pub fn offset(&self, point: Vec3) -> f32 {
        LEAST_OFFSET + ROUNDING * self.normal.abs().dot(point.abs())
    }
}
