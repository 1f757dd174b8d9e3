//! Local frames of surfaces: orthonormal, right-handed, the normal at +z.

use glam::Vec3;

/// Three orthonormal axes in the world: tangent, bitangent and normal, which are x, y and z of the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Tangent.
    pub x: Vec3,
    /// Bitangent, z × x.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// The frame of a unit normal, its tangent chosen without trigonometry, continuously over each hemisphere of normals.
    ///
    /// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    #[inline(always)]
    pub fn from_normal(normal: Vec3) -> Self {
        let n = normal;
        let sign = 1.0f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        let x = Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
        let y = Vec3::new(b, sign + n.y * n.y * a, -n.y);
        Self { x, y, z: n }
    }

    /// The frame of a unit normal whose x axis points as far along `tangent` as the normal allows: the frame of an
    /// anisotropic material. Falls back to [`Frame::from_normal`] where the tangent is zero, not finite, or along the normal.
    #[inline]
    pub fn from_normal_and_tangent(normal: Vec3, tangent: Vec3) -> Self {
        // Gram-Schmidt: what of the tangent lies in the surface. Below this share of its length it is rounding.
        const LEAST_SHARE: f32 = 1e-3;
        let in_surface = |t: Vec3| t - normal * normal.dot(t);
        let x = in_surface(tangent);
        let length = x.length();
        if !(length > LEAST_SHARE * tangent.length() && length.is_finite()) {
            return Self::from_normal(normal);
        }
        let mut x = x / length;
        if length < 0.5 * tangent.length() {
            // Once more: a tangent near the normal leaves the rounding of the first difference.
            x = in_surface(x).normalize();
        }
        Self { x, y: normal.cross(x), z: normal }
    }

    /// Components of a world vector in this frame.
    #[inline(always)]
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(w), self.y.dot(w), self.z.dot(w))
    }

    /// The world vector of these components.
    #[inline(always)]
    pub fn to_world(&self, w: Vec3) -> Vec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(frame: Frame) {
        let Frame { x, y, z } = frame;
        for (a, b, expected) in [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)] {
            assert!((a.dot(b) - expected).abs() < 2e-6, "{frame:?}");
        }
        assert!((x.cross(y) - z).length() < 2e-6, "right-handed: {frame:?}");
        let w = Vec3::new(0.48, -0.6, 0.64);
        assert!((frame.to_world(frame.to_local(w)) - w).length() < 2e-6);
        assert!((frame.to_local(z) - Vec3::Z).length() < 2e-6);
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for i in 0..200 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 200.0;
            let (sin, cos) = (i as f32 * 2.4).sin_cos();
            let n = Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z).normalize();
            check(Frame::from_normal(n));
            let t = Vec3::new(0.3, -2.0, 0.7);
            let frame = Frame::from_normal_and_tangent(n, t);
            check(frame);
            assert!(frame.x.dot(t) >= 0.0 && frame.y.dot(t).abs() < 1e-5, "{frame:?}");
        }
        check(Frame::from_normal(Vec3::Z));
        check(Frame::from_normal(Vec3::NEG_Z));
    }

    #[test]
    fn useless_tangents_are_ignored() {
        let n = Vec3::new(0.0, 0.6, 0.8);
        for t in [Vec3::ZERO, n, -3.0 * n, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(Frame::from_normal_and_tangent(n, t), Frame::from_normal(n), "{t}");
        }
    }
}
