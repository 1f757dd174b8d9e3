//! Sampling lights: for each light of the scene a direction, its distance, the radiance from there, and the pdf.

use super::cut_lights;
use super::lanes::{BLOCK, LANES, Lane, Lane3, ZERO_BLOCK3, ZERO3, at, block, blocks, put, set};
use super::settings::Settings;
use super::solids;
use super::wide::{Wide, wide};
use crate::errata::light::falloff_error;
use crate::error::Result;
use crate::math::circular::Circular;
use crate::math::{Rgb, map_array};
use crate::sampling::rectangle::{SphericalRectangle, solid_angle};
use crate::scene::{EmitterVisibility, Falloff, Light, Rectangle, Scene, Shape, Sphere};
use glam::Vec3;
use pulp::Arch;
use std::array::from_mut;
use std::f32::consts::PI;

/// A direction towards a light.
#[derive(Debug, Clone, Copy)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// To the light; infinite for lights at infinity.
    pub distance: f32,
    /// What arrives, divided by the pdf: radiance over pdf per solid angle, or irradiance where the light has
    /// no extent. Black where the light does not reach.
    pub weight: Rgb,
    /// Density per solid angle; infinite where the light has no extent.
    pub pdf: f32,
}

/// Samples directions towards a light.
pub trait SampleLight {
    /// A direction towards the light from a point.
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample;

    /// Density per solid angle of [`SampleLight::sample`] from a point, for a direction that meets the light.
    fn pdf(&self, point: Vec3) -> f32;
}

/// Directions towards a light from many points.
pub struct LightSamples {
    /// Unit directions towards the light.
    pub wi: Lane3,
    /// To the light.
    pub distance: Lane,
    /// As [`LightSample::weight`].
    pub weight: Lane3,
    /// As [`LightSample::pdf`].
    pub pdf: Lane,
}

impl Default for LightSamples {
    fn default() -> Self {
        Self { wi: ZERO3, distance: [0.0; LANES], weight: ZERO3, pdf: [0.0; LANES] }
    }
}

/// A direction towards a light from each of the first `count` positions.
pub fn sample_many(
    arch: Arch,
    light: &Sampled,
    positions: &Lane3,
    count: usize,
    u: &[Lane; 2],
    out: &mut LightSamples,
) {
    match &light.kind {
        // A loop without a case distinction inside, which vectorizes.
        Kind::Rectangle(panel) => wide(arch, SampleMany { light: panel, positions, count, u, out }),
        _ => SampleMany { light, positions, count, u, out }.run(),
    }
}

struct SampleMany<'a, L> {
    light: &'a L,
    positions: &'a Lane3,
    count: usize,
    u: &'a [Lane; 2],
    out: &'a mut LightSamples,
}

impl<L: SampleLight> Wide for SampleMany<'_, L> {
    #[inline(always)]
    fn run(self) {
        let Self { light, positions, count, u, out } = self;
        for number in 0..blocks(count) {
            let (positions, u) = (block(positions, number), block(u, number));
            let (mut wi, mut weight) = (ZERO_BLOCK3, ZERO_BLOCK3);
            let (mut distance, mut pdf) = ([0.0; BLOCK], [0.0; BLOCK]);
            for i in 0..BLOCK {
                let sample = light.sample(at(&positions, i), [u[0][i], u[1][i]]);
                set(&mut wi, i, sample.wi);
                set(&mut weight, i, sample.weight);
                (distance[i], pdf[i]) = (sample.distance, sample.pdf);
            }
            put(&mut out.wi, number, &wi);
            put(&mut out.weight, number, &weight);
            put(from_mut(&mut out.distance), number, &[distance]);
            put(from_mut(&mut out.pdf), number, &[pdf]);
        }
    }
}

/// A light that can be sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sampled {
    /// Shape and emission.
    pub kind: Kind,
    /// The object that emits, or [`super::lanes::NOTHING`].
    pub object: u32,
}

/// A light by its shape.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    Rectangle(RectangleLight),
    /// By [`Conventions::inverse_distance`](crate::errata::Conventions::inverse_distance).
    InverseDistanceRectangle(RectangleLight),
    Sphere(SphereLight),
    Point {
        position: Vec3,
        intensity: Rgb,
        falloff: Falloff,
    },
    Directional {
        towards: Vec3,
        irradiance: Rgb,
    },
    Hemisphere {
        radiance: Rgb,
    },
}

/// A place on a light, sampled with equal density per area.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// In the world.
    pub position: Vec3,
    /// Unit normal on the side that emits.
    pub normal: Vec3,
    /// Whether the back emits, too.
    pub two_sided: bool,
}

/// An emissive rectangle in its own axes.
#[derive(Debug, Clone, Copy)]
pub struct RectangleLight {
    centre: Vec3,
    axes: [Vec3; 3],
    half: [f32; 2],
    radiance: Rgb,
    two_sided: bool,
}

/// An emissive sphere.
#[derive(Debug, Clone, Copy)]
pub struct SphereLight {
    sphere: Sphere,
    radiance: Rgb,
}

impl RectangleLight {
    fn new(rectangle: &Rectangle, radiance: Rgb, two_sided: bool) -> Self {
        let [x, y] = rectangle.half_sides();
        let half = [x.length(), y.length()];
        Self {
            centre: rectangle.centre(),
            axes: [x / half[0], y / half[1], rectangle.normal()],
            half,
            radiance,
            two_sided,
        }
    }

    /// A point of the rectangle; −1 and 1 are its edges.
    #[inline(always)]
    pub fn place(&self, x: f32, y: f32) -> Vec3 {
        self.centre + self.axes[0] * (x * self.half[0]) + self.axes[1] * (y * self.half[1])
    }

    /// [`SampleLight::pdf`] as it would be if all of the rectangle were where its centre is: shorter to say.
    #[inline(always)]
    pub fn pdf_from_afar(&self, point: Vec3) -> f32 {
        let to = self.centre - point;
        let d2 = to.length_squared();
        d2 * d2.sqrt() / (4.0 * self.half[0] * self.half[1] * self.axes[2].dot(to).abs())
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
    fn pdf(&self, point: Vec3) -> f32 {
        let ([xs, ys], depth, _) = self.seen_from(point);
        1.0 / solid_angle(xs, ys, depth)
    }
}

impl SphereLight {
    /// 1 − cos of half the angle that the sphere fills, seen from outside; 2 (all directions) from inside.
    #[inline(always)]
    fn one_minus_cos_half_angle(&self, point: Vec3) -> f32 {
        let d2 = (self.sphere.centre - point).length_squared();
        let sin2 = self.sphere.radius * self.sphere.radius / d2;
        if sin2 < 1.0 { solids::one_minus_cos_half_angle(sin2) } else { 2.0 }
    }
}

impl SampleLight for SphereLight {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        let one_minus_cos_half_angle = self.one_minus_cos_half_angle(point);
        let axis = (self.sphere.centre - point).normalize_or(Vec3::Z);
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        let below = u[0] * one_minus_cos_half_angle;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let wi = (sin * cos_phi * x + sin * sin_phi * y + cos * axis).normalize();
        let solid_angle = std::f32::consts::TAU * one_minus_cos_half_angle;
        // Where rounding at the rim makes it miss, the nearest point of the sphere is meant.
        let found = self.sphere.distance(point, wi);
        let nearest = axis.dot(self.sphere.centre - point).max(0.0);
        let distance = if found.is_finite() { found } else { nearest };
        // Only the outside emits. A point of the sphere itself may by rounding be inside.
        let scale = if one_minus_cos_half_angle < 2.0 { solid_angle } else { 0.0 };
        LightSample { wi, distance, weight: self.radiance * scale, pdf: 1.0 / solid_angle }
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        1.0 / (std::f32::consts::TAU * self.one_minus_cos_half_angle(point))
    }
}

impl Sampled {
    /// All lights of a scene that are sampled at every hit.
    ///
    /// # Errors
    /// As [`cut_lights::of`].
    pub fn all(scene: &Scene, settings: &Settings) -> Result<Vec<Self>> {
        let panel = |rectangle: &Rectangle, radiance, two_sided| {
            let panel = RectangleLight::new(rectangle, radiance, two_sided);
            if settings.model.conventions.inverse_distance {
                Kind::InverseDistanceRectangle(panel)
            } else {
                Kind::Rectangle(panel)
            }
        };
        let emitters = scene.objects.iter().enumerate().filter_map(|(i, object)| {
            let emission =
                object.emission.filter(|e| e.visibility == EmitterVisibility::Sampled && e.radiance != Rgb::ZERO)?;
            let kind = match &object.shape {
                Shape::Rectangle(r) => panel(r, emission.radiance, emission.two_sided),
                // From inside a sphere only its back is seen.
                Shape::Sphere(s) if !emission.two_sided => {
                    Kind::Sphere(SphereLight { sphere: *s, radiance: emission.radiance })
                }
                _ => return None,
            };
            Some(Self { kind, object: i as u32 })
        });
        let from_map = cut_lights::of(scene, settings)?;
        let others = scene.lights.iter().chain(&from_map).map(|light| {
            let kind = match *light {
                Light::Rectangle { ref rectangle, radiance } => panel(rectangle, radiance, false),
                Light::Point { position, intensity, falloff } => Kind::Point { position, intensity, falloff },
                Light::Directional { direction, irradiance } => Kind::Directional { towards: -direction, irradiance },
                Light::Hemisphere { radiance } => Kind::Hemisphere { radiance },
            };
            Self { kind, object: super::lanes::NOTHING }
        });
        Ok(emitters.chain(others).collect())
    }

    /// The radiance and the area of an emissive object, if paths can start there.
    pub fn emitted(&self) -> Option<(Rgb, f32)> {
        match &self.kind {
            _ if self.object == super::lanes::NOTHING => None,
            Kind::Rectangle(panel) => Some((panel.radiance, 4.0 * panel.half[0] * panel.half[1])),
            Kind::Sphere(light) => Some((light.radiance, 4.0 * PI * light.sphere.radius * light.sphere.radius)),
            _ => None,
        }
    }

    /// A point on an emissive object.
    pub fn start(&self, u: [f32; 2]) -> Option<Start> {
        match &self.kind {
            Kind::Rectangle(panel) => Some(Start {
                position: panel.place(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0),
                normal: panel.axes[2],
                two_sided: panel.two_sided,
            }),
            Kind::Sphere(light) => {
                let (z, (sin_phi, cos_phi)) = (1.0 - 2.0 * u[0], f32::sin_cos_turns(u[1]));
                let sin = (1.0 - z * z).max(0.0).sqrt();
                let normal = Vec3::new(sin * cos_phi, sin * sin_phi, z);
                let position = light.sphere.centre + light.sphere.radius * normal;
                Some(Start { position, normal, two_sided: false })
            }
            _ => None,
        }
    }

    /// Whether its light comes from more than one direction.
    pub fn has_extent(&self) -> bool {
        !matches!(self.kind, Kind::Point { .. } | Kind::Directional { .. })
    }
}

impl SampleLight for Sampled {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        match &self.kind {
            Kind::Rectangle(panel) => panel.sample(point, u),
            Kind::InverseDistanceRectangle(panel) => {
                let sample = panel.sample(point, u);
                LightSample { weight: sample.weight * falloff_error(sample.distance), ..sample }
            }
            Kind::Sphere(light) => light.sample(point, u),
            Kind::Point { position, intensity, falloff } => {
                let to = *position - point;
                let distance = to.length();
                let scale = match falloff {
                    Falloff::InverseSquare => 1.0 / (distance * distance),
                    Falloff::None => 1.0,
                };
                LightSample { wi: to / distance, distance, weight: *intensity * scale, pdf: f32::INFINITY }
            }
            Kind::Directional { towards, irradiance } => {
                LightSample { wi: *towards, distance: f32::INFINITY, weight: *irradiance, pdf: f32::INFINITY }
            }
            Kind::Hemisphere { radiance } => {
                let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
                let sin = (u[0] * (2.0 - u[0])).sqrt();
                let wi = Vec3::new(sin * cos_phi, 1.0 - u[0], sin * sin_phi);
                let pdf = 0.5 * std::f32::consts::FRAC_1_PI;
                LightSample { wi, distance: f32::INFINITY, weight: *radiance / pdf, pdf }
            }
        }
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        match &self.kind {
            Kind::Rectangle(panel) | Kind::InverseDistanceRectangle(panel) => panel.pdf(point),
            Kind::Sphere(light) => light.pdf(point),
            Kind::Point { .. } | Kind::Directional { .. } | Kind::Hemisphere { .. } => 0.0,
        }
    }
}
