//! Uniform sampling of the solid angle that a rectangle subtends at a point.
//!
//! Source: Ureña, Fajardo, King, "An Area-Preserving Parametrization for Spherical Rectangles", CGF 32(4), 2013. The
//! solid angle itself is not computed as the sum of four angles minus 2π, which cancels for small rectangles, but as the
//! argument of a product of two complex numbers, one for each of the rectangle's triangles (Van Oosterom & Strackee, "The Solid Angle
//! of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983), whose relative error does not grow as it shrinks.

use crate::math::circular::Circular;

/// A rectangle in front of a point, which is the origin: x in \[`x0`, `x1`\], y in \[`y0`, `y1`\], z = −`depth` ≤ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalRectangle<T> {
    x0: T,
    x1: T,
    y0: T,
    y1: T,
    depth: T,
    solid_angle: T,
    /// z components of the inward normals of the planes through the origin and the sides y = y0 and y = y1.
    b0: T,
    b1: T,
    /// 2π minus the sum of the spherical angles at the side x = x0.
    k: T,
}

/// Below this many steradians, in units of the type's precision, spherical coordinates no longer resolve the rectangle:
/// 0.001 sr in f32. Its middle line in y then stands for all of it where x is sampled.
const SMALL: f64 = 8192.0;

impl<T: Circular> SphericalRectangle<T> {
    /// The rectangle with sides \[x0, x1\] × \[y0, y1\] in the plane at `depth` > 0.
    #[inline(always)]
    pub fn new([x0, x1]: [T; 2], [y0, y1]: [T; 2], depth: T) -> Self {
        let z2 = depth * depth;
        let normal = |side: T| side / (z2 + side * side).sqrt();
        let (b0, b1) = (-normal(y0), normal(y1));
        let left = -normal(x0);
        // Compute k from the spherical angles at the side x = x0. They have the cosines −p q; their sum is the argument of a product of complex numbers.
        let (zero, one) = (T::zero(), T::one());
        let corner = |p: T, q: T| {
            let cos = -p * q;
            (cos, ((one - cos) * (one + cos)).max(zero).sqrt())
        };
        let ((c2, s2), (c3, s3)) = (corner(b1, left), corner(left, b0));
        let (cos, sin) = (c2 * c3 - s2 * s3, s2 * c3 + c2 * s3);
        // k is 2π minus that sum, which lies between 0 and 2π.
        let half = T::angle(sin.abs(), cos);
        let k = if sin < zero { half } else { T::from_f64(std::f64::consts::TAU) - half };
        Self { x0, x1, y0, y1, depth, solid_angle: solid_angle([x0, x1], [y0, y1], depth), b0, b1, k }
    }

    /// Steradians.
    #[inline(always)]
    pub fn solid_angle(&self) -> T {
        self.solid_angle
    }

    /// A point of the rectangle, (x, y), uniform in solid angle.
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> [T; 2] {
        let (zero, one) = (T::zero(), T::one());
        // Sample x by the solid angle of the part left of it, as Ureña et al. do in their section 4.1.
        let turns = (u[0] * self.solid_angle + self.k) * T::from_f64(0.5 / std::f64::consts::PI);
        let (sin, cos) = T::sin_cos_turns(turns);
        let fu = (cos * self.b0 - self.b1) / sin;
        let cu = (one / (fu * fu + self.b0 * self.b0).sqrt()).min(one);
        let cu = if fu > zero { cu } else { -cu };
        let x = -(cu * -self.depth) / (one - cu * cu).max(T::min_positive_value()).sqrt();
        // For a small solid angle, sample x along the middle line instead.
        let middle = T::from_f64(0.5) * (self.y0 + self.y1);
        let depth2 = self.depth * self.depth;
        let on_line = between([self.x0, self.x1], depth2 + middle * middle, u[0]);
        let is_small = self.solid_angle < T::from_f64(SMALL) * T::epsilon();
        let x = if is_small { on_line } else { x.max(self.x0).min(self.x1) };
        // Sample y given x.
        [x, between([self.y0, self.y1], depth2 + x * x, u[1])]
    }
}

/// A number t from `a` to `b` with pdf ∝ (d² + t²)^(−3/2).
///
/// The sine h = t/√(d² + t²) is sampled uniformly. Its difference over the interval and 1 − h², from the nearer end, are written
/// without cancellation: h may be close to 1, and both ends to each other.
#[inline(always)]
fn between<T: Circular>([a, b]: [T; 2], d2: T, u: T) -> T {
    let (one, two) = (T::one(), T::from_f64(2.0));
    let (ra2, rb2) = (d2 + a * a, d2 + b * b);
    let (ha, hb) = (a / ra2.sqrt(), b / rb2.sqrt());
    let range = if a * b > T::zero() { d2 * (b - a) * (b + a) / (ra2 * rb2 * (ha + hb)) } else { hb - ha };
    let near_a = u < T::from_f64(0.5);
    let (h, r2, part) = if near_a { (ha, ra2, u) } else { (hb, rb2, u - one) };
    let step = part * range;
    let cos2 = (d2 / r2 - step * (two * h + step)).max(T::min_positive_value());
    let t = (h + step) * (d2 / cos2).sqrt();
    t.max(a).min(b)
}

/// The solid angle of the rectangle \[x0, x1\] × \[y0, y1\] at z = `depth`, from the origin.
#[inline(always)]
pub fn solid_angle<T: Circular>([x0, x1]: [T; 2], [y0, y1]: [T; 2], depth: T) -> T {
    let z2 = depth * depth;
    let length = |x: T, y: T| (x * x + y * y + z2).sqrt();
    let (l00, l10, l11, l01) = (length(x0, y0), length(x1, y0), length(x1, y1), length(x0, y1));
    // Triangles (00, 10, 11) and (00, 11, 01); both have the same triple product.
    let triple = depth * (x1 - x0) * (y1 - y0);
    let diagonal = x0 * x1 + y0 * y1 + z2;
    let lower = l00 * l10 * l11 + (x0 * x1 + y0 * y0 + z2) * l11 + (x1 * x1 + y0 * y1 + z2) * l00 + diagonal * l10;
    let upper = l00 * l11 * l01 + diagonal * l01 + (x0 * x1 + y1 * y1 + z2) * l00 + (x0 * x0 + y0 * y1 + z2) * l11;
    let two = T::from_f64(2.0);
    // Scaled by the lengths, so that nothing over- or underflows.
    let (a, b) = (lower / (l00 * l10 * l11), upper / (l00 * l11 * l01));
    let (ta, tb) = (triple / (l00 * l10 * l11), triple / (l00 * l11 * l01));
    two * T::angle((ta * b + tb * a).max(T::zero()), a * b - ta * tb)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASES: [([f64; 2], [f64; 2], f64); 7] = [
        ([-0.35, 0.35], [-0.25, 0.25], 1.5),
        ([0.5, 1.2], [-1.0, -0.4], 0.7),
        ([-0.35, 0.35], [-0.25, 0.25], 0.005),
        ([-5.0, 4.0], [-3.0, 3.0], 0.01),
        ([1.0, 1.01], [2.0, 2.01], 3.0),
        ([10.0, 10.7], [0.0, 0.5], 0.1),
        ([-100.0, 100.0], [-0.01, 0.01], 1.0),
    ];

    /// ∫∫ depth / r³ by the midpoint rule on a mesh graded towards the foot of the perpendicular.
    fn by_quadrature([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) -> f64 {
        let n = 4000;
        // x = z sinh s turns the peak into a smooth function of s.
        let (s0, s1) = ((x0 / z).asinh(), (x1 / z).asinh());
        let h = (s1 - s0) / f64::from(n);
        (0..n)
            .map(|i| {
                let s = s0 + (f64::from(i) + 0.5) * h;
                let d2 = z * z + (z * s.sinh()).powi(2);
                let inner = |y: f64| y / (d2 * (d2 + y * y).sqrt());
                z * (inner(y1) - inner(y0)) * z * s.cosh() * h
            })
            .sum()
    }

    #[test]
    fn solid_angles_are_right_for_large_small_and_near_rectangles() {
        for (x, y, z) in CASES {
            let expected = by_quadrature(x, y, z);
            let found = solid_angle(x, y, z);
            assert!((found / expected - 1.0).abs() < 3e-6, "{x:?} {y:?} {z}: {found} {expected}");
            let narrow = |a: [f64; 2]| a.map(|v| v as f32);
            let single = solid_angle(narrow(x), narrow(y), z as f32);
            let rounded = narrow(x).map(f64::from);
            let exact = solid_angle(rounded, narrow(y).map(f64::from), f64::from(z as f32));
            // A strip 10⁴ times longer than wide is as bad as it gets.
            let bound = if x[1] - x[0] > 100.0 { 1e-4 } else { 4e-6 };
            assert!((f64::from(single) / exact - 1.0).abs() < bound, "{x:?} {y:?} {z}: {single} {exact}");
        }
    }

    #[test]
    fn equal_shares_of_u_are_equal_shares_of_solid_angle() {
        for (x, y, z) in CASES {
            let r = SphericalRectangle::new(x, y, z);
            for (u, v) in [(0.25, 0.5), (0.5, 0.25), (0.8, 0.9), (0.01, 0.99)] {
                // All points with u' < u lie left of x(u); of those at u, all with v' < v below y(v).
                let [px, py] = r.sample([u, v]);
                let left = solid_angle([x[0], px], y, z) / r.solid_angle;
                assert!((left - u).abs() < 1e-6, "{x:?} {y:?} {z} {u}: {left}");
                let step = 1e-4 * z.min(x[1] - x[0]);
                let strip = [px - step, px + step];
                let below = solid_angle(strip, [y[0], py], z) / solid_angle(strip, y, z);
                assert!((below - v).abs() < 1e-4, "{x:?} {y:?} {z} {v}: {below}");
                let narrow = |a: [f64; 2]| a.map(|v| v as f32);
                let single = SphericalRectangle::new(narrow(x), narrow(y), z as f32).sample([u as f32, v as f32]);
                let error = [(f64::from(single[0]) - px) / (x[1] - x[0]), (f64::from(single[1]) - py) / (y[1] - y[0])];
                assert!(error[0].abs() < 3e-3 && error[1].abs() < 1e-4, "{x:?} {y:?} {z} {u} {v}: {error:?}");
            }
        }
    }
}
