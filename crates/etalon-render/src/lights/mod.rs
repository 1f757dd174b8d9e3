//! Sampling lights: for each light of the scene a direction, the distance, the weight (radiance over pdf) and the pdf; and the directional
//! lights that replace a map: one for each region of a cut, with the region's flux, at its energy centroid.

mod rectangle;
mod sphere;
mod triangle;

use super::lanes::NONE;
use super::light_sample::{AreaLight, LightPoint, LightSample, SampleLight};
use super::light_tree::LightBounds;
use super::settings::{Sampling, Settings};
use etalon_core::envmap::samplers::FixedLight;
use etalon_core::error::{Error, Result};
use etalon_core::math::circular::Circular;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::scene::Ray;
use etalon_core::scene::{Emission, EmitterVisibility, Falloff, Light, Object, Rectangle, Scene, Shape};
use glam::Vec3;
use rectangle::RectangleLight;
use sphere::SphereLight;
use triangle::TriangleLight;

/// Factor on the length of a ray to a point, so that rounding does not move a surface there in its way.
pub const SHORT: f32 = 1.0 - 8.0 * f32::EPSILON;

#[derive(Debug, Clone)]
pub struct SampledLight {
    pub kind: LightKind,
    /// The object that emits, or [`super::lanes::NONE`].
    pub object: u32,
}

/// A light, by kind.
#[derive(Debug, Clone)]
pub enum LightKind {
    Rectangle(RectangleLight),
    Triangle(TriangleLight),
    Sphere(SphereLight),
    Point { position: Vec3, intensity: Rgb, falloff: Falloff },
    Directional { towards: Vec3, irradiance: Rgb },
    Hemisphere { radiance: Rgb },
}

impl SampledLight {
    /// All lights to sample: the emissive objects (only if the strategy samples lights), and the scene's other lights and
    /// `fixed`, which no ray can hit.
    pub fn all(scene: &Scene, settings: &Settings, fixed: &[Light]) -> Vec<Self> {
        let rectangle_light = |rectangle: &Rectangle, radiance, two_sided| {
            LightKind::Rectangle(RectangleLight::new(rectangle, radiance, two_sided))
        };
        let of_object = |(i, object): (usize, &Object)| {
            let emission =
                object.emission.filter(|e| e.visibility == EmitterVisibility::Sampled && e.radiance != Rgb::ZERO)?;
            let Emission { radiance, two_sided, .. } = emission;
            let kinds = match &object.shape {
                Shape::Rectangle(r) => vec![rectangle_light(r, radiance, two_sided)],
                Shape::Sphere(sphere) => vec![LightKind::Sphere(SphereLight::new(*sphere, radiance, two_sided))],
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
                Light::Rectangle { ref rectangle, radiance } => rectangle_light(rectangle, radiance, false),
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

    /// At least as many as [`SampledLight::all`] finds without fixed ones.
    pub fn most(scene: &Scene) -> usize {
        let emitters = scene.objects.iter().filter(|object| object.emission.is_some());
        scene.lights.len() + emitters.map(|object| object.shape.triangles().max(1)).sum::<usize>()
    }

    /// The light as a surface; `None` of one without.
    #[inline]
    fn surface(&self) -> Option<&dyn AreaLight> {
        match &self.kind {
            LightKind::Rectangle(light) => Some(light),
            LightKind::Triangle(light) => Some(light),
            LightKind::Sphere(light) => Some(light),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => None,
        }
    }

    /// The radiance and the area of an emissive object, if paths can start there.
    pub fn emitted(&self) -> Option<(Rgb, f32)> {
        self.surface().filter(|_| self.object != NONE).map(AreaLight::emitted)
    }

    /// A point of the light's surface, sampled uniformly by area.
    pub fn point(&self, u: [f32; 2]) -> Option<LightPoint> {
        self.surface().map(|light| light.point(u))
    }

    /// The absolute cosine between the light's normal at a point of it and a direction; 0 of a light without a surface.
    #[inline]
    pub fn cos_at(&self, point: Vec3, w: Vec3) -> f32 {
        self.surface().map_or(0.0, |light| light.normal(point).dot(w).abs())
    }

    /// How far off its surface rays must start near a point of it.
    #[inline]
    pub fn offset(&self, point: Vec3) -> f32 {
        self.surface().map_or(0.0, |light| light.offset(point))
    }

    /// The distance of the light along a ray in the direction of a sample that was taken from another point close by, where
    /// the distance was `sampled`; `None` if the light is not ahead, or does not emit towards the ray's origin.
    #[inline]
    pub fn ahead(&self, ray: Ray, sampled: f32) -> Option<f32> {
        let Some(light) = self.surface() else { return Some(sampled) };
        let (distance, emits) = light.seen_along(ray);
        (distance > 0.0 && distance.is_finite() && emits).then_some(distance)
    }

    /// Where it is and how it emits, for selecting one of many lights; `None` of lights at infinity.
    pub fn bounds(&self) -> Option<LightBounds> {
        match &self.kind {
            LightKind::Rectangle(_) | LightKind::Triangle(_) | LightKind::Sphere(_) => {
                self.surface().map(AreaLight::bounds)
            }
            LightKind::Point { position, intensity, .. } => {
                Some(LightBounds::sphere(*position, 0.0, mean_rgb(*intensity) as f32))
            }
            LightKind::Directional { .. } | LightKind::Hemisphere { .. } => None,
        }
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

impl SampleLight for SampledLight {
    #[inline(always)]
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample {
        match &self.kind {
            LightKind::Rectangle(light) => light.sample(point, u),
            LightKind::Triangle(light) => light.sample(point, u),
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
            LightKind::Rectangle(light) => light.t_max(ray, distance),
            LightKind::Triangle(light) => light.t_max(ray, distance),
            LightKind::Sphere(light) => light.t_max(ray, distance),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => distance * SHORT,
        }
    }

    #[inline(always)]
    fn pdf(&self, point: Vec3) -> f32 {
        match &self.kind {
            LightKind::Rectangle(light) => light.pdf(point),
            LightKind::Sphere(light) => light.pdf(point),
            LightKind::Triangle(light) => light.pdf(point),
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
}
