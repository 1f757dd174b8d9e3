//! Cameras: a film position in, a ray out; and the filter of the film's pixels.

use super::Sphere;
use crate::sampling::filter::PixelFilter;
use glam::{DVec3, Vec3};

/// A half-line. The direction has unit length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ray {
    pub origin: Vec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
}

/// How film positions become rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Parallel rays; the film shows ±`half_width` × ±`half_height` world units.
    Orthographic {
        /// Half of what the film shows across, in world units.
        half_width: f64,
        /// Half of what it shows from bottom to top.
        half_height: f64,
    },
    /// Rays through one point.
    Perspective {
        /// Tangent of half the horizontal field of view.
        tan_half_width: f64,
        /// Tangent of half the vertical one.
        tan_half_height: f64,
    },
}

/// A camera in the world. `right`, `up` and `forward` are orthonormal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the rays start, or the middle of the film of parallel rays.
    pub position: DVec3,
    /// Towards the right edge of the image.
    pub right: DVec3,
    /// Towards its upper edge.
    pub up: DVec3,
    /// Towards what is in its middle.
    pub forward: DVec3,
    pub projection: Projection,
    pub filter: PixelFilter,
}

impl Camera {
    /// A camera at `position` that looks at `target`, `up` pointing upwards in the image; `None` when these three
    /// do not span a frame. A pixel is the plain mean over its area.
    pub fn look_at(position: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Option<Self> {
        let forward = (target - position).try_normalize()?;
        let right = forward.cross(up).try_normalize()?;
        let filter = PixelFilter::default();
        Some(Self { position, right, up: right.cross(forward), forward, projection, filter })
    }

    /// The camera for an image of another size: where its shape differs, the shorter side shows what the shorter side
    /// showed before, and the longer one more or less, so that nothing is stretched.
    pub fn fitted(&self, from: [usize; 2], to: [usize; 2]) -> Self {
        let aspect = to[0] as f64 / to[1] as f64;
        // Also when a side is 0: such a size is refused elsewhere.
        if aspect == from[0] as f64 / from[1] as f64 || !(aspect > 0.0 && aspect.is_finite()) {
            return *self;
        }
        let fit = |width: f64, height: f64| {
            let shorter = width.min(height);
            [shorter * aspect.max(1.0), shorter * (1.0 / aspect).max(1.0)]
        };
        let projection = match self.projection {
            Projection::Orthographic { half_width, half_height } => {
                let [half_width, half_height] = fit(half_width, half_height);
                Projection::Orthographic { half_width, half_height }
            }
            Projection::Perspective { tan_half_width, tan_half_height } => {
                let [tan_half_width, tan_half_height] = fit(tan_half_width, tan_half_height);
                Projection::Perspective { tan_half_width, tan_half_height }
            }
        };
        Self { projection, ..*self }
    }

    /// Whether all rays start outside of a sphere or on it.
    pub fn is_outside(&self, sphere: &Sphere) -> bool {
        let (offset, radius) = (self.position - sphere.centre.as_dvec3(), f64::from(sphere.radius));
        match self.projection {
            Projection::Perspective { .. } => offset.length() >= radius,
            // Rays start on a plane, which must not cut the sphere.
            Projection::Orthographic { .. } => offset.dot(self.forward).abs() >= radius,
        }
    }

    /// The ray through film position (x, y): (0, 0) is the top left corner of the image, (1, 1) the bottom right.
    #[inline]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let (sx, sy) = (2.0 * x - 1.0, 1.0 - 2.0 * y);
        let (origin, direction) = match self.projection {
            Projection::Orthographic { half_width, half_height } => {
                (self.position + self.right * (sx * half_width) + self.up * (sy * half_height), self.forward)
            }
            Projection::Perspective { tan_half_width, tan_half_height } => {
                let d = self.forward + self.right * (sx * tan_half_width) + self.up * (sy * tan_half_height);
                (self.position, d.normalize())
            }
        };
        Ray { origin: origin.as_vec3(), direction: direction.as_vec3() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_not_mirrored() {
        let orthographic = Projection::Orthographic { half_width: 1.0, half_height: 1.0 };
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, orthographic).unwrap();
        let (left, top) = (camera.ray(0.0, 0.5), camera.ray(0.5, 0.0));
        assert_eq!(left.origin, Vec3::new(-1.0, 0.0, 1.0), "+x is right");
        assert_eq!(top.origin, Vec3::new(0.0, 1.0, 1.0), "+y is up");
        assert_eq!(left.direction, Vec3::NEG_Z);
        let perspective = Projection::Perspective { tan_half_width: 1.0, tan_half_height: 0.5 };
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, perspective).unwrap();
        let corner = camera.ray(1.0, 0.0).direction;
        assert!((corner - Vec3::new(1.0, 0.5, -1.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn other_shapes_do_not_stretch() {
        let square = Projection::Orthographic { half_width: 1.0, half_height: 1.0 };
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, square).unwrap();
        assert_eq!(camera.fitted([511, 511], [64, 64]), camera);
        let wide = camera.fitted([511, 511], [400, 200]).projection;
        assert_eq!(wide, Projection::Orthographic { half_width: 2.0, half_height: 1.0 });
        let tall = camera.fitted([511, 511], [100, 200]).projection;
        assert_eq!(tall, Projection::Orthographic { half_width: 1.0, half_height: 2.0 });
    }

    #[test]
    fn impossible_frames_are_refused() {
        let p = Projection::Orthographic { half_width: 1.0, half_height: 1.0 };
        assert!(Camera::look_at(DVec3::Y, DVec3::ZERO, DVec3::Y, p).is_none());
        assert!(Camera::look_at(DVec3::Y, DVec3::Y, DVec3::X, p).is_none());
    }
}
