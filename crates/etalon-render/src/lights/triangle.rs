//! Sampling a triangle of an emissive mesh by the solid angle that it subtends.

use crate::light_sample::{AreaLight, LightPoint, LightSample, SampleLight};
use crate::light_tree::LightBounds;
use crate::solids;
use etalon_core::math::{Rgb, map_array, mean_rgb};
use etalon_core::sampling::spherical_triangle::SphericalTriangle;
use etalon_core::scene::Plane;
use etalon_core::scene::Ray;
use glam::Vec3;

#[derive(Debug, Clone, Copy)]
pub struct TriangleLight {
    corner: Vec3,
    /// From the corner to the other two.
    edges: [Vec3; 2],
    /// With the normal of the front.
    plane: Plane,
    /// Sum of the lengths of two sides: at least its largest extent.
    size: f32,
    radiance: Rgb,
    /// Whether the back emits, too.
    two_sided: bool,
}

impl TriangleLight {
    /// The triangle with these corners, whose front is where the normal points.
    pub fn new([a, b, c]: [Vec3; 3], normal: Vec3, radiance: Rgb, two_sided: bool) -> Self {
        let edges = [b - a, c - a];
        let size = edges[0].length() + edges[1].length();
        Self { corner: a, edges, plane: Plane::through(a, normal), size, radiance, two_sided }
    }

    #[inline(always)]
    fn seen_from(&self, point: Vec3) -> SphericalTriangle<f32> {
        SphericalTriangle::new((self.corner - point).to_array(), map_array(self.edges, |edge| edge.to_array()))
    }
}

impl SampleLight for TriangleLight {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        let seen = self.seen_from(point);
        let [b, c] = seen.sample(u);
        let from_corner = self.corner - point;
        let to = from_corner + b * self.edges[0] + c * self.edges[1];
        let distance = to.length();
        let side = -from_corner.dot(self.plane.normal);
        let lit = (side > 0.0) | (self.two_sided & (side < 0.0));
        let scale = if lit { seen.solid_angle() } else { 0.0 };
        LightSample { wi: to / distance, distance, weight: self.radiance * scale, pdf: 1.0 / seen.solid_angle() }
    }

    #[inline(always)]
    fn t_max(&self, Ray { origin, direction: wi }: Ray, distance: f32) -> f32 {
        solids::short_of(&self.plane, [self.plane.offset(origin + distance * wi), self.size], origin, wi, distance)
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        1.0 / self.seen_from(point).solid_angle()
    }
}

impl AreaLight for TriangleLight {
    fn emitted(&self) -> (Rgb, f32) {
        (self.radiance, 0.5 * self.edges[0].cross(self.edges[1]).length())
    }

    /// Source: Osada et al., "Shape Distributions", *ACM Trans. Graph.* 21(4), 2002.
    fn point(&self, u: [f32; 2]) -> LightPoint {
        let r = u[0].sqrt();
        let position = self.corner + r * (1.0 - u[1]) * self.edges[0] + r * u[1] * self.edges[1];
        LightPoint { position, normal: self.plane.normal, two_sided: self.two_sided }
    }

    fn normal(&self, _: Vec3) -> Vec3 {
        self.plane.normal
    }

    fn offset(&self, point: Vec3) -> f32 {
        self.plane.offset(point)
    }

    fn seen_along(&self, Ray { origin, direction }: Ray) -> (f32, bool) {
        (self.plane.distance(origin, direction), self.two_sided || self.plane.normal.dot(direction) < 0.0)
    }

    fn bounds(&self) -> LightBounds {
        let [ab, ac] = self.edges;
        let (radiance, area) = self.emitted();
        let corners = [self.corner, self.corner + ab, self.corner + ac];
        LightBounds::plane(corners, self.plane.normal, mean_rgb(radiance) as f32 * area, self.two_sided)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::new(-0.5, 1.0, -0.25), Vec3::new(0.5, 1.25, -0.5), Vec3::new(0.25, 1.0, 0.75)];

    fn light(two_sided: bool) -> TriangleLight {
        let [a, b, c] = CORNERS;
        // The front faces down.
        TriangleLight::new(CORNERS, (b - a).cross(c - a).normalize(), Rgb::new(1.0, 2.0, 3.0), two_sided)
    }

    #[test]
    fn only_the_front_emits() {
        let (front, back) = (Vec3::ZERO, 3.0 * Vec3::Y);
        let weight = |two_sided, point| light(two_sided).sample(point, [0.5; 2]).weight;
        assert!(weight(false, front) != Rgb::ZERO && weight(true, back) != Rgb::ZERO);
        assert_eq!(weight(false, back), Rgb::ZERO);
    }

    #[test]
    fn nothing_arrives_in_its_plane_and_at_its_corners() {
        let weight = |point| light(true).sample(point, [0.5; 2]).weight;
        assert_eq!(weight(CORNERS[0]), Rgb::ZERO);
        assert!(weight(2.0 * CORNERS[1] - CORNERS[0]).length() < 1e-8);
    }
}
