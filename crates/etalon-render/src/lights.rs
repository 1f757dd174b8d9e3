//! Sampling lights: for each light of the scene a direction, its distance, the radiance from there, and the pdf; and the directional
//! lights that replace a map: one for each region of a cut, with the region's flux, at its energy centroid.

use super::lanes::{NONE, Ray};
use super::light_sample::{LightPoint, LightSample, SampleLight};
use super::light_tree::LightBounds;
use super::settings::{Sampling, Settings};
use super::solids;
use super::triangle_light::TriangleLight;
use etalon_core::envmap::samplers::FixedLight;
use etalon_core::error::{Error, Result};
use etalon_core::math::circular::Circular;
use etalon_core::math::{Rgb, map_array, mean_rgb};
use etalon_core::sampling::rectangle::{SphericalRectangle, solid_angle};
use etalon_core::scene::{Emission, EmitterVisibility, Falloff, Light, Object, Plane, Rectangle, Scene, Shape, Sphere};
use glam::Vec3;
use std::f32::consts::PI;

/// Factor on the length of a ray to a point, so that rounding does not move a surface there in its way.
pub const SHORT: f32 = 1.0 - 8.0 * f32::EPSILON;

/// A light that can be sampled.
#[derive(Debug, Clone)]
pub struct Sampled {
    pub kind: LightKind,
    /// The object that emits, or [`super::lanes::NONE`].
    pub object: u32,
}

/// A light by its shape.
#[derive(Debug, Clone)]
pub enum LightKind {
    Rectangle(RectangleLight),
    Triangle(TriangleLight),
    Sphere(SphereLight),
    Point { position: Vec3, intensity: Rgb, falloff: Falloff },
    Directional { towards: Vec3, irradiance: Rgb },
    Hemisphere { radiance: Rgb },
}

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

/// An emissive sphere.
#[derive(Debug, Clone, Copy)]
pub struct SphereLight {
    sphere: Sphere,
    radiance: Rgb,
    two_sided: bool,
}

impl RectangleLight {
    fn new(rectangle: &Rectangle, radiance: Rgb, two_sided: bool) -> Self {
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
    pub fn place(&self, x: f32, y: f32) -> Vec3 {
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
        let solid_angle = std::f32::consts::TAU * one_minus_cos_half_angle;
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
        1.0 / (std::f32::consts::TAU * solids::one_minus_cos_of_cone(&self.sphere, point))
    }
}

impl Sampled {
    /// All lights to sample: the emissive objects (only if the strategy samples lights), and the scene's other lights and
    /// `fixed`, which no ray can hit.
    pub fn all(scene: &Scene, settings: &Settings, fixed: &[Light]) -> Vec<Self> {
        let panel = |rectangle: &Rectangle, radiance, two_sided| {
            LightKind::Rectangle(RectangleLight::new(rectangle, radiance, two_sided))
        };
        let of_object = |(i, object): (usize, &Object)| {
            let emission =
                object.emission.filter(|e| e.visibility == EmitterVisibility::Sampled && e.radiance != Rgb::ZERO)?;
            let Emission { radiance, two_sided, .. } = emission;
            let kinds = match &object.shape {
                Shape::Rectangle(r) => vec![panel(r, radiance, two_sided)],
                Shape::Sphere(sphere) => vec![LightKind::Sphere(SphereLight { sphere: *sphere, radiance, two_sided })],
                Shape::Mesh(mesh) => {
                    // A triangle without an area keeps its number and is never sampled.
                    let triangle = |i| {
                        let (corners, normal) = mesh.facet(i).unwrap_or_default();
                        LightKind::Triangle(TriangleLight::new(corners, normal, radiance, two_sided))
                    };
                    (0..mesh.triangles.len() as u32).map(triangle).collect()
                }
            };
            Some(kinds.into_iter().map(move |kind| Self { kind, object: i as u32 }))
        };
        let emitters = scene.objects.iter().enumerate().filter_map(of_object).flatten();
        let emitters = emitters.filter(|_| settings.sampling.by_light());
        let others = scene.lights.iter().chain(fixed).map(|light| {
            let kind = match *light {
                Light::Rectangle { ref rectangle, radiance } => panel(rectangle, radiance, false),
                Light::Point { position, intensity, falloff } => LightKind::Point { position, intensity, falloff },
                Light::Directional { direction, irradiance } => {
                    LightKind::Directional { towards: -direction, irradiance }
                }
                Light::Hemisphere { radiance } => LightKind::Hemisphere { radiance },
            };
            Self { kind, object: NONE }
        });
        emitters.chain(others).collect()
    }

    /// At least as many as [`Sampled::all`] finds without fixed ones.
    pub fn most(scene: &Scene) -> usize {
        let of_object = |object: &Object| match &object.shape {
            Shape::Mesh(mesh) => mesh.triangles.len(),
            Shape::Rectangle(_) | Shape::Sphere(_) => 1,
        };
        let emitters = scene.objects.iter().filter(|object| object.emission.is_some());
        scene.lights.len() + emitters.map(of_object).sum::<usize>()
    }

    /// The radiance and the area of an emissive object, if paths can start there.
    pub fn emitted(&self) -> Option<(Rgb, f32)> {
        match &self.kind {
            _ if self.object == NONE => None,
            LightKind::Rectangle(panel) => Some((panel.radiance, 4.0 * panel.half[0] * panel.half[1])),
            LightKind::Triangle(triangle) => Some(triangle.emitted()),
            LightKind::Sphere(light) => Some((light.radiance, 4.0 * PI * light.sphere.radius * light.sphere.radius)),
            _ => None,
        }
    }

    /// A point of an emissive object, sampled uniformly by area.
    pub fn point(&self, u: [f32; 2]) -> Option<LightPoint> {
        match &self.kind {
            LightKind::Rectangle(panel) => Some(LightPoint {
                position: panel.place(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0),
                normal: panel.axes[2],
                two_sided: panel.two_sided,
            }),
            LightKind::Triangle(triangle) => Some(triangle.point(u)),
            LightKind::Sphere(light) => {
                let (z, (sin_phi, cos_phi)) = (1.0 - 2.0 * u[0], f32::sin_cos_turns(u[1]));
                let sin = (1.0 - z * z).max(0.0).sqrt();
                let normal = Vec3::new(sin * cos_phi, sin * sin_phi, z);
                let position = light.sphere.centre + light.sphere.radius * normal;
                Some(LightPoint { position, normal, two_sided: light.two_sided })
            }
            _ => None,
        }
    }

    /// The absolute cosine between the light's normal at a point of it and a direction; 0 of a light without a surface.
    #[inline]
    pub fn cos_at(&self, point: Vec3, w: Vec3) -> f32 {
        match &self.kind {
            LightKind::Rectangle(panel) => panel.axes[2].dot(w).abs(),
            LightKind::Triangle(triangle) => triangle.plane.normal.dot(w).abs(),
            LightKind::Sphere(light) => ((point - light.sphere.centre) / light.sphere.radius).dot(w).abs(),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => 0.0,
        }
    }

    /// How far off its surface rays must start near a point of it.
    #[inline(always)]
    pub fn offset(&self, point: Vec3) -> f32 {
        match &self.kind {
            LightKind::Rectangle(panel) => panel.plane.offset(point),
            LightKind::Triangle(triangle) => triangle.plane.offset(point),
            LightKind::Sphere(light) => solids::offset_of_sphere(&light.sphere),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => 0.0,
        }
    }

    /// The distance of the light along a ray in the direction of a sample that was taken from another point close by, where
    /// the distance was `sampled`; `None` if the light is not ahead, or does not emit towards the ray's origin.
    #[inline]
    pub fn ahead(&self, Ray { origin, direction: wi }: Ray, sampled: f32) -> Option<f32> {
        let (distance, is_front, two_sided) = match &self.kind {
            LightKind::Rectangle(RectangleLight { plane, two_sided, .. })
            | LightKind::Triangle(TriangleLight { plane, two_sided, .. }) => {
                (plane.distance(origin, wi), plane.normal.dot(wi) < 0.0, *two_sided)
            }
            LightKind::Sphere(SphereLight { sphere, two_sided, .. }) => {
                let from_centre = (origin - sphere.centre).length_squared();
                (sphere.distance(origin, wi), from_centre > sphere.radius * sphere.radius, *two_sided)
            }
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => {
                return Some(sampled);
            }
        };
        (distance > 0.0 && distance.is_finite() && (two_sided || is_front)).then_some(distance)
    }

    /// Where it is and how it emits, for selecting one of many lights; `None` of lights at infinity.
    pub fn bounds(&self) -> Option<LightBounds> {
        Some(match &self.kind {
            LightKind::Rectangle(panel) => {
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| panel.place(x, y));
                let intensity = mean_rgb(panel.radiance) as f32 * 4.0 * panel.half[0] * panel.half[1];
                LightBounds::plane(corners, panel.axes[2], intensity, panel.two_sided)
            }
            LightKind::Triangle(triangle) => triangle.bounds(),
            LightKind::Sphere(SphereLight { sphere, radiance, .. }) => {
                let intensity = mean_rgb(*radiance) as f32 * PI * sphere.radius * sphere.radius;
                LightBounds::sphere(sphere.centre, sphere.radius, intensity)
            }
            LightKind::Point { position, intensity, .. } => {
                LightBounds::sphere(*position, 0.0, mean_rgb(*intensity) as f32)
            }
            LightKind::Directional { .. } | LightKind::Hemisphere { .. } => return None,
        })
    }

    /// Whether its light comes from more than one direction.
    pub fn has_extent(&self) -> bool {
        match self.kind {
            LightKind::Rectangle(_) | LightKind::Triangle(_) | LightKind::Sphere(_) | LightKind::Hemisphere { .. } => {
                true
            }
            LightKind::Point { .. } | LightKind::Directional { .. } => false,
        }
    }
}

impl SampleLight for Sampled {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        match &self.kind {
            LightKind::Rectangle(panel) => panel.sample(point, u),
            LightKind::Triangle(triangle) => triangle.sample(point, u),
            LightKind::Sphere(light) => light.sample(point, u),
            LightKind::Point { position, intensity, falloff } => {
                let to = *position - point;
                let distance = to.length();
                let scale = match falloff {
                    Falloff::InverseSquare => 1.0 / (distance * distance),
                    Falloff::None => 1.0,
                };
                LightSample { wi: to / distance, distance, weight: *intensity * scale, pdf: f32::INFINITY }
            }
            LightKind::Directional { towards, irradiance } => {
                LightSample { wi: *towards, distance: f32::INFINITY, weight: *irradiance, pdf: f32::INFINITY }
            }
            LightKind::Hemisphere { radiance } => {
                let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
                let sin = (u[0] * (2.0 - u[0])).sqrt();
                let wi = Vec3::new(sin * cos_phi, 1.0 - u[0], sin * sin_phi);
                let pdf = 0.5 * std::f32::consts::FRAC_1_PI;
                LightSample { wi, distance: f32::INFINITY, weight: *radiance / pdf, pdf }
            }
        }
    }

    #[inline(always)]
    fn t_max(&self, ray: Ray, distance: f32) -> f32 {
        match &self.kind {
            LightKind::Rectangle(panel) => panel.t_max(ray, distance),
            LightKind::Triangle(triangle) => triangle.t_max(ray, distance),
            LightKind::Sphere(light) => light.t_max(ray, distance),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => distance * SHORT,
        }
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        match &self.kind {
            LightKind::Rectangle(panel) => panel.pdf(point),
            LightKind::Sphere(light) => light.pdf(point),
            LightKind::Triangle(triangle) => triangle.pdf(point),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => 0.0,
        }
    }
}

/// The directional lights that the settings put in the place of the scene's environment, if they do.
///
/// # Errors
/// [`Error::Parameter`] for a cut that the map does not allow, and for strategies that would find the map's light once
/// more by the material's directions.
pub fn of_cut(scene: &Scene, settings: &Settings) -> Result<Vec<Light>> {
    let Some(environment) = &scene.environment else { return Ok(Vec::new()) };
    if settings.map_sampling().has_fixed_lights() && settings.sampling != Sampling::Light {
        return Err(Error::parameter("density", "lights that stand for the map hold all of its light")
            .with_hint("light sampling only: the material's directions would find the map a second time"));
    }
    let light = |FixedLight { towards, irradiance }| Light::Directional {
        direction: -(environment.to_world * towards).as_vec3(),
        irradiance: irradiance.as_vec3() * environment.scale,
    };
    let lights = settings.map_sampling().fixed_lights(&environment.map)?;
    Ok(lights.unwrap_or_default().into_iter().map(light).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::sphere;
    use crate::{Silent, render};
    use etalon_core::envmap::samplers::MapSampling;
    use etalon_core::envmap::samplers::cut_lights::MEDIAN_CUT;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::scene::Request;

    #[test]
    fn many_lights_are_the_map_and_few_are_not() {
        let (scene, request) = sphere(Synthetic::Sun.make());
        let image = |density, spp| {
            let settings = Settings { sampling: Sampling::Light, density: Some(density), ..Settings::default() };
            render(&scene, &Request { spp, light_samples: 1, ..request }, &settings, &Silent).unwrap().image
        };
        let map = image(MapSampling::COSINE, 512);
        let off = |count| {
            let lights = image(MapSampling::with_regions(MEDIAN_CUT, count), 16);
            etalon_core::raster::compare(&lights, &map).unwrap().rmse
        };
        let (few, many) = (off(4), off(1024));
        assert!(many < 0.01 && few > 10.0 * many, "{few} {many}");
    }

    #[test]
    fn the_maps_light_is_not_brought_twice() {
        let (scene, request) = sphere(Synthetic::Sun.make());
        for sampling in [Sampling::Mis, Sampling::Bsdf] {
            let density = MapSampling::with_regions(MEDIAN_CUT, 16);
            let settings = Settings { sampling, density: Some(density), ..Settings::default() };
            assert!(render(&scene, &request, &settings, &Silent).is_err());
        }
        for regions in [0, u32::MAX] {
            let density = MapSampling::with_regions(MEDIAN_CUT, regions);
            let settings = Settings { sampling: Sampling::Light, density: Some(density), ..Settings::default() };
            assert!(render(&scene, &request, &settings, &Silent).is_err(), "{density}");
        }
    }
}
