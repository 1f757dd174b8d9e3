//! The sphere, and where a ray meets it.

use super::mesh::Mesh;
use glam::Vec3;

/// A sphere in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// In the world.
    pub centre: Vec3,
    /// Above 0.
    pub radius: f32,
}

impl Sphere {
    /// The smallest distance t ≥ 0 along a ray at which it meets the sphere; infinite where it does not.
    ///
    /// The discriminant is taken from the ray's closest point to the centre, which keeps its accuracy for small and
    /// distant spheres, and the nearer root from the farther one by their product. Source: Haines, Günther,
    /// Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", *Ray Tracing Gems*, 2019.
    #[inline(always)]
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

    /// Least and largest coordinates. `None` for a sphere on which [`distance`](Self::distance) is of no use: the
    /// square of its radius is not a normal number, or it reaches beyond ±[`Mesh::FARTHEST`], or one of its numbers is
    /// NaN.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        let [low, high] = [self.centre - self.radius, self.centre + self.radius];
        let within = |corner: Vec3| corner.abs().cmple(Vec3::splat(Mesh::FARTHEST)).all();
        let usable = self.radius > 0.0 && (self.radius * self.radius).is_normal() && within(low) && within(high);
        usable.then_some([low, high])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Sphere = Sphere { centre: Vec3::ZERO, radius: 1.0 };

    #[test]
    fn distances_from_outside_inside_and_the_surface() {
        let along = |z: f32, d: f32| UNIT.distance(Vec3::new(0.0, 0.0, z), Vec3::new(0.0, 0.0, d));
        assert_eq!(along(3.0, -1.0), 2.0);
        assert_eq!(along(0.0, -1.0), 1.0);
        assert_eq!(along(1.0, -1.0), 0.0, "touching the pole");
        assert_eq!(along(3.0, 1.0), f32::INFINITY, "behind");
        assert_eq!(UNIT.distance(Vec3::new(2.0, 0.0, 3.0), Vec3::NEG_Z), f32::INFINITY, "beside");
    }

    #[test]
    fn degenerate_spheres_have_no_bounds() {
        assert_eq!(UNIT.bounds(), Some([Vec3::NEG_ONE, Vec3::ONE]));
        for radius in [0.0, -1.0, 1e-30, 1e16, f32::INFINITY, f32::NAN] {
            assert_eq!(Sphere { radius, ..UNIT }.bounds(), None, "{radius}");
        }
        for centre in [Vec3::NAN, Vec3::INFINITY, 1e16 * Vec3::X] {
            assert_eq!(Sphere { centre, ..UNIT }.bounds(), None, "{centre}");
        }
    }
}
