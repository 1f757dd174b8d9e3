//! Sampling an emissive sphere by the solid angle that it subtends.

use crate::light_sample::{AreaLight, LightPoint, LightSample, SampleLight};
use crate::light_tree::LightBounds;
use crate::solids;
use etalon_core::math::circular::Circular;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::scene::Ray;
use etalon_core::scene::Sphere;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

#[derive(Debug, Clone, Copy)]
pub struct SphereLight {
    sphere: Sphere,
    radiance: Rgb,
    two_sided: bool,
}

impl SphereLight {
    pub fn new(sphere: Sphere, radiance: Rgb, two_sided: bool) -> Self {
        Self { sphere, radiance, two_sided }
    }
}

impl SampleLight for SphereLight {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        let one_minus_cos_half_angle = solids::one_minus_cos_of_cone(&self.sphere, point);
        let to = self.sphere.centre - point;
        let axis = to.normalize_or(Vec3::Z);
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        let below = u[0] * one_minus_cos_half_angle;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let wi = (sin * cos_phi * x + sin * sin_phi * y + cos * axis).normalize();
        let solid_angle = TAU * one_minus_cos_half_angle;
        // Distance of the nearer point of the sphere in that direction, or of the only one from inside.
        let d = to.length();
        let half_chord = (self.sphere.radius * self.sphere.radius - (d * sin) * (d * sin)).max(0.0).sqrt();
        let is_outside = one_minus_cos_half_angle < 2.0;
        let distance = d * cos - if is_outside { half_chord } else { -half_chord };
        // A point of the sphere itself may by rounding be inside.
        let scale = if self.two_sided | is_outside { solid_angle } else { 0.0 };
        LightSample { wi, distance, weight: self.radiance * scale, pdf: 1.0 / solid_angle }
    }

    #[inline(always)]
    fn t_max(&self, Ray { origin, direction: wi }: Ray, distance: f32) -> f32 {
        solids::short_of(&self.sphere, [solids::offset_of_sphere(&self.sphere), 0.0], origin, wi, distance)
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        1.0 / (TAU * solids::one_minus_cos_of_cone(&self.sphere, point))
    }
}

impl AreaLight for SphereLight {
    fn emitted(&self) -> (Rgb, f32) {
        (self.radiance, 4.0 * PI * self.sphere.radius * self.sphere.radius)
    }

    fn point(&self, u: [f32; 2]) -> LightPoint {
        let (z, (sin_phi, cos_phi)) = (1.0 - 2.0 * u[0], f32::sin_cos_turns(u[1]));
        let sin = (1.0 - z * z).max(0.0).sqrt();
        let normal = Vec3::new(sin * cos_phi, sin * sin_phi, z);
        let position = self.sphere.centre + self.sphere.radius * normal;
        LightPoint { position, normal, two_sided: self.two_sided }
    }

    fn normal(&self, point: Vec3) -> Vec3 {
        (point - self.sphere.centre) / self.sphere.radius
    }

    fn offset(&self, _: Vec3) -> f32 {
        solids::offset_of_sphere(&self.sphere)
    }

    fn seen_along(&self, Ray { origin, direction }: Ray) -> (f32, bool) {
        let from_centre = (origin - self.sphere.centre).length_squared();
        let is_outside = from_centre > self.sphere.radius * self.sphere.radius;
        (self.sphere.distance(origin, direction), self.two_sided || is_outside)
    }

    fn bounds(&self) -> LightBounds {
        let intensity = mean_rgb(self.radiance) as f32 * PI * self.sphere.radius * self.sphere.radius;
        LightBounds::sphere(self.sphere.centre, self.sphere.radius, intensity)
    }
}
