//! Uniform sampling of the solid angle that a triangle subtends at a point.
//!
//! The construction is that of Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995: one random number
//! selects a part of the triangle beside a corner by its solid angle, the other one a point of the arc that bounds the
//! part. Arvo computes with the angles of the spherical triangle, whose sum is π plus the solid angle: of a small
//! triangle nothing is left by rounding. Here, solid angles are arguments of complex numbers (Van Oosterom & Strackee,
//! "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983), and points are those of the plane
//! triangle. The relative error does not grow as it shrinks, so that small triangles need no other method: their
//! samples become uniform by area.

use crate::math::circular::Circular;
use crate::math::map_array;

/// A triangle as seen from a point, which is the origin.
///
/// Inside, a is the nearest corner, c the one of the others that is nearer in angle, and lengths are in units of the
/// distance of a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalTriangle<T> {
    solid_angle: T,
    labels: Labels,
    /// The second corner, and its distance.
    b: [T; 3],
    b_length: T,
    /// The edges from a to b and to c.
    edges: [[T; 3]; 2],
    /// Length of the edge from a to c, and its component along a.
    length: T,
    along: T,
    /// With the unit vector b' along b: the triple product of a, b' and the edge; 1 + a·b'; (a + b') · edge.
    triple: T,
    one_plus_cos: T,
    sum_along: T,
}

/// Which of the caller's corners a, b and c are: a is the second or the third, else the first; the others follow in their
/// cyclic order, or in the other one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Labels {
    is_second: bool,
    is_third: bool,
    is_swapped: bool,
}

/// One of two vectors, component by component, which vectorizes.
#[inline(always)]
fn select<T: Circular>(condition: bool, a: [T; 3], b: [T; 3]) -> [T; 3] {
    let one = |i: usize| if condition { a[i] } else { b[i] };
    [one(0), one(1), one(2)]
}

impl Labels {
    /// Turns what belongs to the caller's corners into what belongs to a and the two others in cyclic order.
    #[inline(always)]
    fn rotated<T: Circular>(self, [p, q, r]: [T; 3]) -> [T; 3] {
        select(self.is_third, [r, p, q], select(self.is_second, [q, r, p], [p, q, r]))
    }

    /// [`rotated`](Self::rotated), then b before c.
    #[inline(always)]
    fn ordered<T: Circular>(self, corners: [T; 3]) -> [T; 3] {
        let [a, b, c] = self.rotated(corners);
        select(self.is_swapped, [a, c, b], [a, b, c])
    }

    /// The same for vectors.
    #[inline(always)]
    fn ordered_vectors<T: Circular>(self, [p, q, r]: [[T; 3]; 3]) -> [[T; 3]; 3] {
        let axis = |i: usize| self.ordered([p[i], q[i], r[i]]);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let corner = |i: usize| [x[i], y[i], z[i]];
        [corner(0), corner(1), corner(2)]
    }

    /// The inverse of [`ordered`](Self::ordered).
    #[inline(always)]
    fn restored<T: Circular>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        let [a, b, c] = select(self.is_swapped, [a, c, b], [a, b, c]);
        select(self.is_third, [b, c, a], select(self.is_second, [c, a, b], [a, b, c]))
    }
}

#[inline(always)]
fn dot<T: Circular>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<T: Circular>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn scaled<T: Circular>(s: T, a: [T; 3]) -> [T; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

#[inline(always)]
fn sum<T: Circular>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference<T: Circular>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

impl<T: Circular> SphericalTriangle<T> {
    /// The triangle with a corner `a` and the edges from there to the corners b and c. (Edges, because the differences
    /// of corners relative to a distant point have lost digits.)
    #[inline(always)]
    pub fn new(a: [T; 3], [ab, ac]: [[T; 3]; 2]) -> Self {
        let (zero, one) = (T::zero(), T::one());
        let offsets = [[zero; 3], ab, ac];
        let corners = [a, sum(a, ab), sum(a, ac)];
        // Label the corners such that rounding matters least where the point is near a side or a corner.
        let lengths = map_array(corners, |corner| dot(corner, corner).sqrt());
        let is_third = (lengths[2] < lengths[0]) & (lengths[2] < lengths[1]);
        let is_second = !is_third & (lengths[1] < lengths[0]);
        let labels = Labels { is_second, is_third, is_swapped: false };
        let [nearest, p, q] = labels.ordered_vectors(corners);
        let [_, p_length, q_length] = labels.rotated(lengths);
        let is_swapped = dot(nearest, p) / p_length >= dot(nearest, q) / q_length;
        let labels = Labels { is_swapped, ..labels };
        let [length, b_length, c_length] = labels.ordered(lengths);
        let unit = one / length;
        let [a, b, c] = map_array(labels.ordered_vectors(corners), |corner| scaled(unit, corner));
        let [origin, to_b, to_c] = labels.ordered_vectors(offsets);
        let edges = map_array([to_b, to_c], |offset| scaled(unit, difference(offset, origin)));
        let (b_length, c_length) = (unit * b_length, unit * c_length);
        let triple = dot(a, cross(edges[0], edges[1])).abs() / b_length;
        // Twice 1 plus a cosine is the square of the sum of two unit vectors.
        let both = sum(a, scaled(one / b_length, b));
        let one_plus_cos = T::from_f64(0.5) * dot(both, both);
        let real = one_plus_cos + (dot(b, c) / b_length + dot(a, c)) / c_length;
        let solid_angle = T::from_f64(2.0) * T::angle(triple / c_length, real);
        Self {
            // The triple product is not a number if a corner is where the point is.
            solid_angle: if triple > zero { solid_angle } else { zero },
            labels,
            b,
            b_length,
            edges,
            length: dot(edges[1], edges[1]).sqrt(),
            along: dot(a, edges[1]),
            triple,
            one_plus_cos,
            sum_along: dot(both, edges[1]),
        }
    }

    /// Steradians; 0 for a triangle without area, and where the point is in its plane.
    #[inline(always)]
    pub fn solid_angle(&self) -> T {
        self.solid_angle
    }

    /// A point of the triangle, uniform in solid angle, as barycentric weights of the corners b and c. Of no meaning if
    /// the solid angle is 0.
    #[inline(always)]
    pub fn sample(&self, u: [T; 2]) -> [T; 2] {
        let (zero, one, two) = (T::zero(), T::one(), T::from_f64(2.0));
        // Sample the point q = a + t (c − a) such that the triangle a, b, q has the share u0 of the solid angle. Its
        // tangent is that of Van Oosterom & Strackee, an equation for t whose square is linear.
        let (sin, cos) = T::sin_cos_turns(u[0] * self.solid_angle * T::from_f64(0.25 / std::f64::consts::PI));
        let (x, y) = (cos * self.triple - sin * self.sum_along, sin * self.one_plus_cos);
        let t = two * y * (x + y * self.along) / ((x - y * self.length) * (x + y * self.length));
        let t = t.max(zero).min(one);
        // Sample the angle between b and the point b + s (q − b): 1 − cos is uniform.
        let to_q = difference(scaled(t, self.edges[1]), self.edges[0]);
        let along = dot(self.b, to_q) / self.b_length;
        let normal = cross(self.b, to_q);
        let across = dot(normal, normal).sqrt() / self.b_length;
        let (qx, qy) = (self.b_length + along, across);
        let q_length = (qx * qx + qy * qy).sqrt();
        let (qx, qy) = (qx / q_length, qy / q_length);
        let greatest = if qx > zero { qy * qy / (one + qx) } else { one - qx };
        let below = u[1] * greatest;
        let (sin, cos) = ((below * (two - below)).max(zero).sqrt(), one - below);
        let s = self.b_length * sin / (across * cos - along * sin);
        let s = s.max(zero).min(one);
        let [_, b, c] = self.labels.restored([s * (one - t), one - s, s * t]);
        [b, c]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;

    type Corners = [[f64; 3]; 3];

    /// Corners and the largest errors in f32: relative of the solid angle, absolute of a share.
    const CASES: [(&str, Corners, [f64; 2]); 12] = [
        ("octant", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1e-6, 2e-6]),
        ("facing", [[-0.4, -0.3, 1.5], [0.4, -0.2, 1.5], [0.0, 0.5, 1.5]], [1e-6, 2e-6]),
        ("tilted", [[1.0, 0.2, 0.3], [1.5, 0.4, -0.4], [0.7, 0.9, 0.5]], [1e-6, 2e-6]),
        // Here the weights of the corners, of 24 bits, resolve what is close to the point only so far.
        ("touching", [[-0.4, -0.3, 0.005], [0.4, -0.2, 0.005], [0.0, 0.5, 0.005]], [1e-6, 5e-5]),
        ("overhead", [[-500.0, -300.0, 0.01], [400.0, -200.0, 0.01], [0.0, 500.0, 0.01]], [1e-6, 1e-2]),
        ("near a side", [[-1.0, 0.001, 0.001], [1.0, 0.001, 0.001], [0.0, 1.0, 0.001]], [5e-5, 5e-4]),
        ("near a corner", [[0.001, 0.001, 0.001], [1.0, 0.001, 0.001], [0.0, 1.0, 0.001]], [1e-6, 5e-4]),
        ("small", [[1.0, 0.5, 0.3], [1.0001, 0.5, 0.3], [1.0, 0.5001, 0.3]], [1e-6, 2e-6]),
        ("tiny and far", [[1000.0, 500.0, 300.0], [1000.001, 500.0, 300.0], [1000.0, 500.001, 300.0]], [1e-6, 2e-6]),
        ("sliver", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1e-4, 1.0]], [1e-6, 2e-6]),
        // As bad as the strip of the rectangle.
        ("long sliver", [[-100.0, 0.01, 1.0], [100.0, 0.0, 1.0], [100.0, 0.02, 1.0]], [5e-4, 5e-4]),
        ("grazing", [[10.0, 0.0, 1e-6], [10.7, 0.0, 1e-6], [10.0, 0.5, 1e-6]], [1e-6, 2e-6]),
    ];

    /// First corner and edges, exact in f32, with each of the corners as the first one.
    fn rotated(corners: Corners) -> [([f64; 3], [[f64; 3]; 2]); 3] {
        let narrow = |v: [f64; 3]| v.map(|x| f64::from(x as f32));
        [0, 1, 2].map(|first| {
            let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
            (narrow(a), [narrow(difference(b, a)), narrow(difference(c, a))])
        })
    }

    fn single(a: [f64; 3], edges: [[f64; 3]; 2]) -> SphericalTriangle<f32> {
        SphericalTriangle::new(a.map(|x| x as f32), edges.map(|edge| edge.map(|x| x as f32)))
    }

    /// The solid angle of a triangle by Van Oosterom & Strackee's formula.
    fn solid_angle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let triple = dot(a, cross(difference(b, a), difference(c, a))).abs();
        2.0 * triple.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    }

    /// ∫ cos θ / r² over the triangle by the midpoint rule.
    fn by_quadrature([a, b, c]: Corners) -> f64 {
        let n = 1000;
        let normal = cross(difference(b, a), difference(c, a));
        let at = |s: f64, t: f64| sum(scaled(1.0 - s, a), scaled(s, sum(scaled(1.0 - t, b), scaled(t, c))));
        let step = 1.0 / f64::from(n);
        let centre = |i: i32| (f64::from(i) + 0.5) * step;
        (0..n * n)
            .map(|i| {
                let (s, t) = (centre(i / n), centre(i % n));
                let p = at(s, t);
                s * dot(p, normal).abs() / dot(p, p).powf(1.5) * step * step
            })
            .sum()
    }

    /// The random numbers of a sample: the shares of the solid angle and of the arc that it cuts off.
    fn shares<T: Circular>(
        triangle: &SphericalTriangle<T>,
        weights: [T; 2],
        a: [f64; 3],
        [ab, ac]: [[f64; 3]; 2],
    ) -> [f64; 2] {
        let corners = [a, sum(a, ab), sum(a, ac)];
        let [wb, wc] = weights.map(Real::to_f64);
        let all = [1.0 - wb - wc, wb, wc];
        let [a, b, c] = triangle.labels.ordered_vectors(corners);
        let [_, wb, wc] = triangle.labels.ordered(all);
        let q = sum(a, scaled(wc / (1.0 - wb), difference(c, a)));
        let p = sum(b, scaled(1.0 - wb, difference(q, b)));
        let one_minus_cos = |x: [f64; 3]| {
            let (normal, length2) = (cross(b, difference(x, b)), dot(b, b) * dot(x, x));
            let cos = dot(b, x) / length2.sqrt();
            if cos > 0.0 { dot(normal, normal) / length2 / (1.0 + cos) } else { 1.0 - cos }
        };
        [solid_angle(a, b, q) / solid_angle(a, b, c), one_minus_cos(p) / one_minus_cos(q)]
    }

    #[test]
    fn solid_angles_are_right() {
        let octant = SphericalTriangle::new([1.0, 0.0, 0.0], [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]);
        assert!((octant.solid_angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        for (name, corners, _) in &CASES[..3] {
            let (a, edges) = rotated(*corners)[0];
            let (found, expected) = (SphericalTriangle::new(a, edges).solid_angle(), by_quadrature(*corners));
            assert!((found / expected - 1.0).abs() < 1e-5, "{name}: {found} {expected}");
        }
        for (name, corners, [bound, _]) in CASES {
            for (a, edges) in rotated(corners) {
                let expected = solid_angle(a, sum(a, edges[0]), sum(a, edges[1]));
                let found = SphericalTriangle::new(a, edges).solid_angle();
                assert!((found / expected - 1.0).abs() < 1e-11, "{name}: {found} {expected}");
                let found = f64::from(single(a, edges).solid_angle());
                assert!((found / expected - 1.0).abs() < bound, "{name}: {found} {expected}");
            }
        }
    }

    #[test]
    fn equal_shares_of_u_are_equal_shares_of_solid_angle() {
        for (name, corners, [_, bound]) in CASES {
            for (a, edges) in rotated(corners) {
                let (double, single) = (SphericalTriangle::new(a, edges), single(a, edges));
                for u in [[0.25, 0.5], [0.5, 0.25], [0.8, 0.9], [0.01, 0.99], [0.99, 0.01]] {
                    let [x, y] = shares(&double, double.sample(u), a, edges);
                    assert!((x - u[0]).abs().max((y - u[1]).abs()) < 1e-9, "{name} {u:?}: {x} {y}");
                    let narrow = u.map(|u| u as f32);
                    let [x, y] = shares(&single, single.sample(narrow), a, edges);
                    assert!((x - u[0]).abs().max((y - u[1]).abs()) < bound, "{name} {u:?}: {x} {y}");
                }
            }
        }
    }

    #[test]
    fn triangles_that_subtend_nothing_have_solid_angle_0() {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0f32]);
        for (a, edges) in [(x, [x, x]), (x, [y, y]), (x, [[0.0; 3]; 2]), (x, [x, y]), ([0.0; 3], [y, z])] {
            assert_eq!(SphericalTriangle::new(a, edges).solid_angle(), 0.0, "{a:?} {edges:?}");
        }
    }
}
