//! The sphere, and where a ray hits it.

use super::camera::Ray;
use glam::Vec3;

/// A sphere in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    pub centre: Vec3,
    pub radius: f32,
}

/// A point on a surface.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    pub point: Vec3,
    /// Unit normal, pointing to the outside of the shape.
    pub normal: Vec3,
    /// How far `point` may be off the true surface, per axis.
    pub error: f32,
}

impl Sphere {
    /// The smallest distance t ≥ 0 along a ray at which it meets the sphere; infinite where it does not.
    ///
    /// The discriminant is taken from the ray's closest point to the centre, which keeps its accuracy for small and
    /// distant spheres, and the nearer root from the farther one by their product. Source: Haines, Günther,
    /// Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", *Ray Tracing Gems*, 2019.
    #[inline(always)]
    #[must_use]
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let f = origin - self.centre;
        let b = -f.dot(direction);
        let closest = f + b * direction;
        let discriminant = self.radius * self.radius - closest.length_squared();
        let c = f.length_squared() - self.radius * self.radius;
        // The root of larger modulus; c is the product of both. A negative discriminant makes all of this NaN.
        let q = b + discriminant.sqrt().copysign(b);
        let other = c / q;
        let (near, far) = if other < q { (other, q) } else { (q, other) };
        let t = if near >= 0.0 { near } else { far };
        if t >= 0.0 { t } else { f32::INFINITY }
    }
}

impl Hit {
    /// A ray from here that cannot hit the surface it starts from because of rounding.
    #[inline]
    #[must_use]
    pub fn ray_towards(&self, direction: Vec3) -> Ray {
        let side = if self.normal.dot(direction) < 0.0 { -1.0 } else { 1.0 };
        // An error per axis of e is one of at most √3 e along the normal.
        Ray { origin: self.point + self.normal * (side * 2.0 * self.error), direction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Sphere = Sphere { centre: Vec3::ZERO, radius: 1.0 };

    #[test]
    fn hits_from_outside_inside_and_the_surface() {
        let ray = |z: f32, d: f32| Ray { origin: Vec3::new(0.0, 0.0, z), direction: Vec3::new(0.0, 0.0, d) };
        let hit = UNIT.intersect(&ray(3.0, -1.0), f32::INFINITY).unwrap();
        assert_eq!((hit.t, hit.point, hit.normal), (2.0, Vec3::Z, Vec3::Z));
        assert_eq!(UNIT.intersect(&ray(0.0, -1.0), f32::INFINITY).unwrap().point, Vec3::NEG_Z);
        assert_eq!(UNIT.intersect(&ray(1.0, -1.0), f32::INFINITY).unwrap().point, Vec3::Z, "touching the pole");
        assert!(UNIT.intersect(&ray(3.0, 1.0), f32::INFINITY).is_none(), "behind");
        assert!(UNIT.intersect(&ray(3.0, -1.0), 2.0).is_none(), "beyond the limit");
    }

    #[test]
    fn rays_that_leave_do_not_come_back() {
        for sphere in [
            UNIT,
            Sphere { centre: Vec3::new(100.0, -50.0, 7.0), radius: 0.01 },
            Sphere { centre: Vec3::new(0.0, -1000.0, 0.0), radius: 1000.0 },
        ] {
            for i in 0..10_000 {
                let (a, b) = (i as f32 * 0.618_034, i as f32 * 0.754_877_7);
                let around = Vec3::new(a.cos(), b.sin(), a.sin() * b.cos()).normalize();
                let origin = sphere.centre + around * sphere.radius * 3.0;
                let hit = sphere.intersect(&Ray { origin, direction: -around }, f32::INFINITY).unwrap();
                // Even at 10⁻⁴ rad above the horizon.
                let tangent = hit.normal.any_orthonormal_vector();
                let grazing = (tangent + 1e-4 * hit.normal).normalize();
                for direction in [hit.normal, grazing] {
                    let again = sphere.intersect(&hit.ray_towards(direction), f32::INFINITY);
                    assert!(again.is_none(), "{sphere:?} {i} {again:?}");
                }
            }
        }
    }
}
