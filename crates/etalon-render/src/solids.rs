//! Where a ray meets a rectangle or a sphere, as straight-line arithmetic.

use super::lanes::{Hits, LANES, Lane, Rays, at, wide};
use etalon_core::scene::{Plane, Rectangle, Sphere};
use glam::Vec3;

/// A shape that is tried against all rays. Its loops vectorize.
pub trait Solid: Send + Sync {
    /// Distance along the ray to the shape; NaN, negative or infinite where it does not meet it.
    fn distance(&self, origin: Vec3, direction: Vec3) -> f32;

    /// Looks for the nearest hit of each ray.
    fn nearest(&self, object: u32, rays: &Rays, count: usize, hits: &mut Hits) {
        let (t, objects) = (&mut hits.t, &mut hits.object);
        wide(
            #[inline(always)]
            move || {
                for i in 0..count.min(LANES) {
                    let found = self.distance(at(&rays.origin, i), at(&rays.direction, i));
                    let hit = (found >= 0.0) & (found < t[i]);
                    t[i] = if hit { found } else { t[i] };
                    objects[i] = if hit { object } else { objects[i] };
                }
            },
        );
    }

    /// Looks for any hit of each ray that is nearer than its `t_max`.
    fn blocked(&self, rays: &Rays, count: usize, t_max: &Lane, blocked: &mut [u32; LANES]) {
        wide(
            #[inline(always)]
            move || {
                for i in 0..count.min(LANES) {
                    let found = self.distance(at(&rays.origin, i), at(&rays.direction, i));
                    blocked[i] |= u32::from((found >= 0.0) & (found < t_max[i]));
                }
            },
        );
    }
}

/// A rectangle in the form that is quickest to meet.
pub fn solid_of(rectangle: &Rectangle) -> Box<dyn Solid> {
    fn boxed(solid: impl Solid + 'static) -> Box<dyn Solid> {
        Box::new(solid)
    }
    let x = || AxisAlignedRectangle::<0>::new(rectangle).map(boxed);
    let y = || AxisAlignedRectangle::<1>::new(rectangle).map(boxed);
    let z = || AxisAlignedRectangle::<2>::new(rectangle).map(boxed);
    x().or_else(y).or_else(z).unwrap_or_else(|| Box::new(TiltedRectangle::new(rectangle)))
}

impl Solid for Sphere {
    #[inline(always)]
    fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        self.distance(origin, direction)
    }
}

/// A surface at which shadow rays end.
pub trait ShadowRayEnd {
    /// The distance of the first point within `margin` of the shape along a ray that ends on it, at about `limit`; at most 0 if the origin
    /// is within it.
    fn distance_within(&self, origin: Vec3, direction: Vec3, margin: f32, limit: f32) -> f32;
}

/// How far off a sphere a ray must start, so that rounding to f32 does not hide on which side.
#[inline(always)]
pub fn offset_of_sphere(sphere: &Sphere) -> f32 {
    16.0 * f32::EPSILON * (sphere.centre.abs().max_element() + sphere.radius)
}

impl ShadowRayEnd for Plane {
    #[inline(always)]
    fn distance_within(&self, origin: Vec3, direction: Vec3, margin: f32, _limit: f32) -> f32 {
        ((self.normal.dot(origin) - self.height).abs() - margin) / self.normal.dot(direction).abs()
    }
}

impl ShadowRayEnd for Sphere {
    #[inline(always)]
    fn distance_within(&self, origin: Vec3, direction: Vec3, margin: f32, limit: f32) -> f32 {
        let from_centre = origin - self.centre;
        let (d2, larger) = (from_centre.length_squared(), Self { radius: self.radius + margin, ..*self });
        if d2 > larger.radius * larger.radius {
            return larger.distance(origin, direction);
        }
        // From inside, the ray ends where it leaves the sphere. It starts on the surface if it ends nearer to its start.
        let smaller = (self.radius - margin).max(0.0);
        let along = from_centre.dot(direction);
        let half_chord2 = smaller * smaller - (from_centre - along * direction).length_squared();
        let exit = half_chord2.max(0.0).sqrt() - along;
        if limit > 0.5 * exit { exit } else { 0.0 }
    }
}

/// The length of a shadow ray to a light at the distance `limit`, shortened so that rounding does not let the light occlude
/// itself: the ray ends `offset` in front of the light's surface, and more for a large `size` of it. Not above 0 if it starts
/// within that of it.
#[inline(always)]
pub fn short_of(light: &impl ShadowRayEnd, [offset, size]: [f32; 2], origin: Vec3, direction: Vec3, limit: f32) -> f32 {
    // What rounding to f32 does to coordinates relative to the ray's origin.
    let margin = offset + 8.0 * f32::EPSILON * (limit + size);
    light.distance_within(origin, direction, margin, limit).min(limit)
}

/// 1 − cos of half the angle that a sphere fills, seen from a point outside; 2 (all directions) from inside.
#[inline(always)]
pub fn one_minus_cos_of_cone(sphere: &Sphere, point: Vec3) -> f32 {
    let sin2 = sphere.radius * sphere.radius / (sphere.centre - point).length_squared();
    // 1 − √(1 − s²) without the cancellation.
    if sin2 < 1.0 { sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt()) } else { 2.0 }
}

/// A rectangle as its plane and two coordinates on it that are −1 and 1 at the edges.
#[derive(Debug, Clone, Copy)]
struct TiltedRectangle {
    plane: Plane,
    across: [Vec3; 2],
    offset: [f32; 2],
}

impl TiltedRectangle {
    fn new(rectangle: &Rectangle) -> Self {
        let across = rectangle.half_sides().map(|half| half / half.length_squared());
        let offset = across.map(|a| a.dot(rectangle.centre()));
        Self { plane: rectangle.plane(), across, offset }
    }
}

impl Solid for TiltedRectangle {
    #[inline(always)]
    fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let t = self.plane.distance(origin, direction);
        let inside = |i: usize| {
            let at = self.across[i].dot(origin) - self.offset[i] + t * self.across[i].dot(direction);
            at.abs() <= 1.0
        };
        if inside(0) & inside(1) { t } else { f32::INFINITY }
    }
}

/// A rectangle in a plane x, y or z = `height` with sides along the other two axes, as walls and area lights often are:
/// a third of the arithmetic.
#[derive(Debug, Clone, Copy)]
pub struct AxisAlignedRectangle<const AXIS: usize> {
    height: f32,
    low: [f32; 2],
    high: [f32; 2],
}

impl<const AXIS: usize> AxisAlignedRectangle<AXIS> {
    const ACROSS: [usize; 2] = [(AXIS + 1) % 3, (AXIS + 2) % 3];

    pub fn new(rectangle: &Rectangle) -> Option<Self> {
        // Exactly: rays that leave a wall start on the side of its plane.
        let along = |v: &Vec3| v.to_array().iter().filter(|component| **component != 0.0).count() == 1;
        let normal = rectangle.normal();
        if !along(&normal) || normal[AXIS] == 0.0 || !rectangle.half_sides().iter().all(along) {
            return None;
        }
        let [x, y] = rectangle.half_sides();
        let (centre, half) = (rectangle.centre(), x.abs() + y.abs());
        let [low, high] = [centre - half, centre + half].map(|corner| Self::ACROSS.map(|axis| corner[axis]));
        Some(Self { height: centre[AXIS], low, high })
    }
}

impl<const AXIS: usize> Solid for AxisAlignedRectangle<AXIS> {
    #[inline(always)]
    fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let (origin, direction) = (origin.to_array(), direction.to_array());
        let t = (self.height - origin[AXIS]) / direction[AXIS];
        let inside = |i: usize| {
            let at = origin[Self::ACROSS[i]] + t * direction[Self::ACROSS[i]];
            (self.low[i] <= at) & (at <= self.high[i])
        };
        if inside(0) & inside(1) { t } else { f32::INFINITY }
    }
}
