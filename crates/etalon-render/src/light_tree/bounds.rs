//! Bounds of a light, and of groups of lights: where they are, how much they emit and in which directions.

use etalon_core::math::circular::Circular;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// What the light tree knows of a light. All numbers are finite, and coordinates below 10¹⁸.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightBounds {
    /// Corner of the bounding box with the least coordinates.
    pub min: Vec3,
    /// Corner of the bounding box with the greatest coordinates.
    pub max: Vec3,
    /// Radiant intensity (power per solid angle) where it is greatest, as one number: radiance times area for a plane
    /// light. A light of intensity 0 is never sampled.
    pub intensity: f32,
    /// Unit axis of a cone that contains the normals of the emitting surface.
    pub axis: Vec3,
    /// Cosine of the angle between the axis and the farthest normal: 1 for a plane light, −1 for a sphere or a point.
    pub cos_o: f32,
    /// Cosine of the greatest angle between a normal and the directions of emission, from 0 to 1: 0 for an area light.
    pub cos_e: f32,
    /// Whether the back of the surface emits, too.
    pub two_sided: bool,
}

impl LightBounds {
    /// Those of a light that is never sampled.
    pub const NONE: Self = Self {
        min: Vec3::ZERO,
        max: Vec3::ZERO,
        intensity: 0.0,
        axis: Vec3::Z,
        cos_o: 1.0,
        cos_e: 0.0,
        two_sided: false,
    };

    /// The bounds of a plane polygon with these corners.
    pub fn plane<const N: usize>(corners: [Vec3; N], normal: Vec3, intensity: f32, two_sided: bool) -> Self {
        let min = corners.into_iter().fold(Vec3::INFINITY, Vec3::min);
        let max = corners.into_iter().fold(Vec3::NEG_INFINITY, Vec3::max);
        Self { min, max, intensity, axis: normal, cos_o: 1.0, cos_e: 0.0, two_sided }
    }

    /// The bounds of a sphere that emits in all directions.
    pub fn sphere(centre: Vec3, radius: f32, intensity: f32) -> Self {
        let (min, max) = (centre - radius, centre + radius);
        Self { min, max, intensity, axis: Vec3::Z, cos_o: -1.0, cos_e: 0.0, two_sided: false }
    }
}

/// Bounds of a group of lights, for choosing how to split it.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    pub min: Vec3,
    pub max: Vec3,
    pub intensity: f64,
    /// Bounding box of the lights' axes.
    axes: [Vec3; 2],
    /// Least over the lights.
    cos_o: f32,
}

impl Group {
    /// No lights.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
        intensity: 0.0,
        axes: [Vec3::INFINITY, Vec3::NEG_INFINITY],
        cos_o: 1.0,
    };

    /// This group and one more light.
    #[must_use]
    pub fn with(self, light: &LightBounds) -> Self {
        Self {
            min: self.min.min(light.min),
            max: self.max.max(light.max),
            intensity: self.intensity + f64::from(light.intensity),
            axes: [self.axes[0].min(light.axis), self.axes[1].max(light.axis)],
            cos_o: self.cos_o.min(light.cos_o),
        }
    }

    /// Both groups.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            intensity: self.intensity + other.intensity,
            axes: [self.axes[0].min(other.axes[0]), self.axes[1].max(other.axes[1])],
            cos_o: self.cos_o.min(other.cos_o),
        }
    }

    /// The direction in the middle of the lights' axes.
    pub fn axis(&self) -> Vec3 {
        (self.axes[0] + self.axes[1]).normalize_or(Vec3::Z)
    }

    /// The surface area orientation heuristic: intensity, times extent, times solid angle of emission. The extent is
    /// the area of the bounding sphere, on which the importance at a point depends, so that groups in a plane or on a
    /// line need no exception. Source: Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree
    /// Splitting", *Proc. ACM Comput. Graph. Interact. Tech.* 1(2), 2018, section 4.4.
    pub fn cost(&self) -> f64 {
        let diagonal = (self.max - self.min).as_dvec3().length_squared();
        self.intensity * diagonal * f64::from(self.solid_angle())
    }

    /// Solid angle of the directions of emission, weighted by their cosine beyond the cone of normals, over π: 1 to 4.
    fn solid_angle(&self) -> f32 {
        // A sphere around the middle of the axes' box contains the axes, and bounds their angle with the middle.
        let middle = 0.5 * (self.axes[0] + self.axes[1]);
        let (length, radius2) = (middle.length(), 0.25 * (self.axes[1] - self.axes[0]).length_squared());
        let cos_axes = ((1.0 + length * length - radius2) / (2.0 * length).max(f32::MIN_POSITIVE)).clamp(-1.0, 1.0);
        let cos = cos_of_sum(cos_axes, self.cos_o);
        let sin = sine(cos);
        // The paper's formula for lights that emit up to 90° from their normals.
        if cos > 0.0 { 2.0 - cos + FRAC_PI_2 * sin } else { 2.0 - 2.0 * cos + (PI - f32::angle(sin, cos)) * sin }
    }
}

/// The sine of an angle from 0 to π.
pub fn sine(cos: f32) -> f32 {
    ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt()
}

/// The cosine of the sum of two angles from 0 to π, or −1 if that is more than π.
pub fn cos_of_sum(a: f32, b: f32) -> f32 {
    if a <= -b { -1.0 } else { (a * b - sine(a) * sine(b)).max(-1.0) }
}
