//! The rectangle: walls and area lights. The plane of a flat shape, and how far off it rays must start.

use glam::Vec3;

/// A rectangle in the world; both sides count unless its use says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    centre: Vec3,
    half: [Vec3; 2],
    plane: Plane,
}

/// A vector whose components below 4 ε of the largest are 0, as rotations by right angles leave them.
fn without_rounding(v: Vec3) -> Vec3 {
    let least = 4.0 * f32::EPSILON * v.abs().max_element();
    Vec3::select(v.abs().cmple(Vec3::splat(least)), Vec3::ZERO, v)
}

/// Largest cosine between two sides that still counts as a right angle.
const PERPENDICULAR: f32 = 1e-4;

impl Rectangle {
    /// The rectangle `centre` ± `half_x` ± `half_y`, its front where `half_x` × `half_y` points; `None` when the sides
    /// have no length or are not perpendicular to 10⁻⁴. Sides that are along an axis except for rounding are taken as along it.
    pub fn new(centre: Vec3, half_x: Vec3, half_y: Vec3) -> Option<Self> {
        let [half_x, half_y] = [half_x, half_y].map(without_rounding);
        let (x, y) = (half_x.try_normalize()?, half_y.try_normalize()?);
        let right = x.dot(y).abs() <= PERPENDICULAR && centre.is_finite();
        // The second side is made exactly perpendicular, so that a point has one pair of coordinates.
        let half_y = half_y - x * half_y.dot(x);
        let normal = x.cross(half_y);
        let length = normal.length();
        // Divided, so that an axis has the length 1 to the bit.
        let usable = right && length > 0.0 && length.recip().is_finite();
        usable.then(|| Self { centre, half: [half_x, half_y], plane: Plane::through(centre, normal / length) })
    }

    /// The rectangle with these corners, in order around it; `None` when they do not form one, to 10⁻⁶ of its shorter side.
    pub fn from_corners(corners: [Vec3; 4]) -> Option<Self> {
        let [a, b, c, d] = corners;
        let rectangle = Self::new((a + c) * 0.5, (b - a) * 0.5, (d - a) * 0.5)?;
        let error = corners.into_iter().zip(rectangle.corners()).map(|(p, q)| p.distance(q)).fold(0.0, f32::max);
        let shorter = rectangle.half[0].length().min(rectangle.half[1].length());
        (error <= 2e-6 * shorter).then_some(rectangle)
    }

    /// The rectangle with its middle elsewhere.
    pub(super) fn centred_at(self, centre: Vec3) -> Self {
        Self { centre, plane: Plane::through(centre, self.plane.normal), ..self }
    }

    pub fn centre(&self) -> Vec3 {
        self.centre
    }

    /// Half of the two sides, as vectors from the centre to the middles of two edges.
    pub fn half_sides(&self) -> [Vec3; 2] {
        self.half
    }

    /// The corners, in order around the rectangle.
    pub fn corners(&self) -> [Vec3; 4] {
        let [x, y] = self.half;
        [-x - y, x - y, x + y, y - x].map(|corner| self.centre + corner)
    }

    /// The unit normal of the front.
    pub fn normal(&self) -> Vec3 {
        self.plane.normal
    }

    #[inline(always)]
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// The distance t > 0 along a ray at which it meets the rectangle, from either side; infinite where it does not.
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let from = origin - self.centre;
        let t = -from.dot(self.plane.normal) / direction.dot(self.plane.normal);
        let point = from + t * direction;
        let within = self.half.iter().all(|side| point.dot(*side).abs() <= side.length_squared());
        if t > 0.0 && within { t } else { f32::INFINITY }
    }

    pub fn area(&self) -> f32 {
        4.0 * self.half[0].length() * self.half[1].length()
    }
}

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
    pub fn through(point: Vec3, normal: Vec3) -> Self {
        // In f64, so that only the result is rounded.
        Self { normal, height: normal.as_dvec3().dot(point.as_dvec3()) as f32 }
    }

    /// How far the plane may be off a polygon with these corners, one of which it goes through, and off the plane of a neighbour:
    /// at each corner the rounding of the normal and of the height, three times ε/2 of Σ |nᵢ pᵢ|, for both.
    pub fn error(&self, corners: &[Vec3]) -> f32 {
        let farthest = corners.iter().fold(Vec3::ZERO, |farthest, corner| farthest.max(corner.abs()));
        3.0 * f32::EPSILON * self.normal.abs().dot(farthest)
    }

    /// The point of the plane below one that is close to it.
    #[inline(always)]
    pub fn project(&self, point: Vec3) -> Vec3 {
        point - self.normal * (self.normal.dot(point) - self.height)
    }

    /// The distance along a ray; below 0 behind its origin, infinite or NaN of a parallel ray.
    #[inline(always)]
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        (self.height - self.normal.dot(origin)) / self.normal.dot(direction)
    }

    /// How far along the normal a ray must start from a point that was [projected](Self::project) onto the plane, so that the sign of
    /// its [distance](Self::distance) is certain.
    #[inline(always)]
    pub fn offset(&self, point: Vec3) -> f32 {
        LEAST_OFFSET + ROUNDING * self.normal.abs().dot(point.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream::{Independent, Stream};
    use crate::scene::{Bvh, Mesh, Ray, Shape, Surface};

    #[test]
    fn rays_meet_both_sides_and_no_more() {
        let r = Rectangle::new(Vec3::Y, Vec3::X, 2.0 * Vec3::Z).unwrap();
        let along = |x: f32, y: f32, down: f32| r.distance(Vec3::new(x, y, 1.5), Vec3::new(0.0, -down, 0.0));
        assert_eq!((along(0.5, 3.0, 1.0), along(0.5, -3.0, -1.0)), (2.0, 4.0));
        assert_eq!((along(0.5, 3.0, -1.0), along(1.5, 3.0, 1.0)), (f32::INFINITY, f32::INFINITY));
        assert_eq!(r.distance(Vec3::ZERO, Vec3::X), f32::INFINITY, "parallel");
        assert_eq!(r.distance(Vec3::Y, Vec3::X), f32::INFINITY, "in its plane");
    }

    #[test]
    fn corners_make_rectangles_or_nothing() {
        let corner = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        let r =
            Rectangle::from_corners([corner(0.0, 0.0), corner(0.0, 2.0), corner(4.0, 2.0), corner(4.0, 0.0)]).unwrap();
        assert_eq!((r.centre(), r.normal(), r.area()), (Vec3::new(2.0, 1.0, 1.0), Vec3::Y, 8.0));
        let skewed = [corner(0.0, 0.0), corner(1.0, 2.0), corner(5.0, 2.0), corner(4.0, 0.0)];
        assert!(Rectangle::from_corners(skewed).is_none(), "a parallelogram");
        let bent = [corner(0.0, 0.0), corner(0.0, 2.0), Vec3::new(4.0, 2.0, 2.0), corner(4.0, 0.0)];
        assert!(Rectangle::from_corners(bent).is_none(), "not flat");
        let thin = [(-5.0, 0.0), (5.0, 0.0), (5.0, 1e-6), (-5.0, 1e-3)].map(|(x, y)| Vec3::new(x, y, 0.0));
        assert!(Rectangle::from_corners(thin).is_none(), "a trapezoid that is much thinner than long");
        assert!(Rectangle::new(Vec3::ZERO, Vec3::X, Vec3::ZERO).is_none());
        assert!(Rectangle::new(Vec3::NAN, Vec3::X, Vec3::Y).is_none());
    }

    /// A triangle of a size from 10⁻⁶ to 10⁶, from plump to a sliver of one part in 10⁶, near or far from the origin; weights of a
    /// place on it, a direction, and its size.
    fn triangle(i: u64) -> Option<(Mesh, [f32; 2], Vec3, f32)> {
        let component = |j: u32| (2.0 * Independent::new(1, i, j).pair(0)[0] - 1.0) as f32;
        let vector = |j: u32| Vec3::new(component(3 * j), component(3 * j + 1), component(3 * j + 2));
        // Size, distance from the origin in sizes, and thinness, by the index
        let scale = 10f32.powi((i % 13) as i32 - 6);
        let away = [0.0, 3.0, 100.0][i as usize / 13 % 3] * vector(0);
        let thin = [1.0, 1e-2, 1e-4, 1e-6][i as usize / 39 % 4];
        let (p, q, r) = (vector(1), vector(2), vector(3));
        let corners = [p, q, p + 0.5 * (q - p) + thin * r].map(|corner| scale * (corner + away));
        let (u, v) = (component(12).abs(), component(13).abs());
        let inside = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let mesh = Mesh::new(corners.to_vec(), Vec::new(), vec![[0, 1, 2]]).ok()?;
        Some((mesh, inside, vector(5).try_normalize()?, scale))
    }

    #[test]
    fn rays_do_not_hit_the_triangle_that_they_leave() {
        let (mut again, mut again_with_fixed, mut farthest) = (0, 0, 0f32);
        for (mesh, [u, v], around, scale) in (0..5000).filter_map(triangle) {
            let Some(Surface { point, normal, .. }) = mesh.surface(0, u, v) else { continue };
            let plane = Plane::through(mesh.facet(0).unwrap().0[0], normal);
            let bvh = Bvh::build(&[&Shape::from(mesh)]);
            let tangent = around.cross(normal).normalize();
            // Along a random direction, the normal, and almost along the surface
            let directions = [around, normal, (tangent + 1e-4 * normal).normalize()];
            let hits = |point: Vec3, offset: f32| {
                let hits = directions.into_iter().filter(|direction| {
                    let origin = point + normal * offset.copysign(normal.dot(*direction));
                    bvh.nearest(&Ray { origin, direction: *direction }, f32::INFINITY).is_some()
                });
                hits.count()
            };
            again += hits(plane.project(point), plane.offset(point));
            // The offset of many textbooks
            again_with_fixed += hits(point, 1e-4);
            farthest = farthest.max(plane.offset(point) / scale);
        }
        assert_eq!(again, 0);
        assert!(again_with_fixed > 300, "{again_with_fixed}");
        // 8 ε times Σ |nᵢ pᵢ|, which is at most the distance from the origin, 177 sizes
        assert!(farthest < 1.7e-4, "{farthest}");
    }
}
