//! Sampling an emissive rectangle by the solid angle that it subtends.

use crate::light_sample::{AreaLight, LightPoint, LightSample, SampleLight};
use crate::light_tree::LightBounds;
use crate::solids;
use etalon_core::math::{Rgb, map_array, mean_rgb};
use etalon_core::sampling::rectangle::{SphericalRectangle, solid_angle};
use etalon_core::scene::Ray;
use etalon_core::scene::{Plane, Rectangle};
use glam::Vec3;

/// An emissive rectangle in its own axes.
#[derive(Debug, Clone, Copy)]
pub struct RectangleLight {
    centre: Vec3,
    axes: [Vec3; 3],
    plane: Plane,
    half: [f32; 2],
    radiance: Rgb,
    two_sided: bool,
}

impl RectangleLight {
    pub fn new(rectangle: &Rectangle, radiance: Rgb, two_sided: bool) -> Self {
        let [x, y] = rectangle.half_sides();
        let half = [x.length(), y.length()];
        Self {
            centre: rectangle.centre(),
            axes: [x / half[0], y / half[1], rectangle.normal()],
            plane: rectangle.plane(),
            half,
            radiance,
            two_sided,
        }
    }

    /// A point of the rectangle; −1 and 1 are its edges.
    #[inline(always)]
    fn place(&self, x: f32, y: f32) -> Vec3 {
        self.centre + self.axes[0] * (x * self.half[0]) + self.axes[1] * (y * self.half[1])
    }

    /// The rectangle's extent along its axes as seen from a point, its distance, and on which side the point is.
    #[inline(always)]
    fn seen_from(&self, point: Vec3) -> ([[f32; 2]; 2], f32, f32) {
        let to = self.centre - point;
        let [x, y, height] = map_array(self.axes, |axis| axis.dot(to));
        let [hx, hy] = self.half;
        ([[x - hx, x + hx], [y - hy, y + hy]], height.abs(), -height)
    }
}

impl SampleLight for RectangleLight {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        let ([xs, ys], depth, side) = self.seen_from(point);
        let seen = SphericalRectangle::new(xs, ys, depth);
        let [x, y] = seen.sample(u);
        let back = if side > 0.0 { -depth } else { depth };
        let to = x * self.axes[0] + y * self.axes[1] + back * self.axes[2];
        let distance = to.length();
        let lit = (side > 0.0) | (self.two_sided & (side < 0.0));
        let scale = if lit { seen.solid_angle() } else { 0.0 };
        LightSample { wi: to / distance, distance, weight: self.radiance * scale, pdf: 1.0 / seen.solid_angle() }
    }

    #[inline(always)]
    fn t_max(&self, Ray { origin, direction: wi }: Ray, distance: f32) -> f32 {
        let (offset, size) = (self.plane.offset(origin + distance * wi), self.half[0] + self.half[1]);
        solids::short_of(&self.plane, [offset, size], origin, wi, distance)
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        let ([xs, ys], depth, _) = self.seen_from(point);
        1.0 / solid_angle(xs, ys, depth)
    }
}

impl AreaLight for RectangleLight {
    fn emitted(&self) -> (Rgb, f32) {
        (self.radiance, 4.0 * self.half[0] * self.half[1])
    }

    fn point(&self, u: [f32; 2]) -> LightPoint {
        let position = self.place(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
        LightPoint { position, normal: self.axes[2], two_sided: self.two_sided }
    }

    fn normal(&self, _: Vec3) -> Vec3 {
        self.axes[2]
    }

    fn offset(&self, point: Vec3) -> f32 {
        self.plane.offset(point)
    }

    fn seen_along(&self, Ray { origin, direction }: Ray) -> (f32, bool) {
        (self.plane.distance(origin, direction), self.two_sided || self.plane.normal.dot(direction) < 0.0)
    }

    fn bounds(&self) -> LightBounds {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| self.place(x, y));
        let intensity = mean_rgb(self.radiance) as f32 * 4.0 * self.half[0] * self.half[1];
        LightBounds::plane(corners, self.axes[2], intensity, self.two_sided)
    }
}
