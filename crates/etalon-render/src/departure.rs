//! How a camera path left its last vertex, and the MIS weight of the light that its ray finds.

use super::light_sample::balance_heuristic;
use super::prepared::PreparedScene;
use super::settings::Sampling;
use super::shaders::Kind;
use etalon_core::math::Rgb;
use etalon_core::scene::EmitterVisibility;
use glam::Vec3;

/// What light samples at the last vertex know of the light that the path's ray finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightSamples {
    /// Nothing: they cannot find it. The ray comes from the camera or from a delta lobe.
    Impossible,
    /// Nothing: they are not taken.
    NotTaken,
    /// All of it.
    Complete,
    /// A part of it, which MIS weights.
    Combined {
        /// Pdf of the ray's direction by BSDF sampling.
        pdf: f32,
        /// Normal at the vertex by which light samples are chosen.
        normal: Vec3,
        /// The kind of surface: light samples of one that transmits come from both sides.
        surface: Kind,
    },
}

/// How a camera path left its last vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// What light samples know of the light that is found next.
    pub light_samples: LightSamples,
    /// The density of light tracing over that of this path, except for the factors that the next vertices contribute; 0 where light
    /// tracing cannot find the path. See [`super::light_tracing`].
    pub light_tracing: f32,
    /// Whether light tracing finds light that is found next: its paths start towards surfaces that are not diffuse, and are
    /// connected to the camera at the second vertex or later.
    pub is_caustic: bool,
}

impl Departure {
    /// From the camera.
    pub const CAMERA: Self = Self { light_samples: LightSamples::Impossible, light_tracing: 0.0, is_caustic: false };

    /// `light_tracing` of the next departure, from its value with the factor of the direction to the viewer and the pdf per
    /// projected solid angle of the new direction.
    #[inline]
    pub fn continued(light_tracing: f32, projected_pdf: impl FnOnce() -> f32) -> f32 {
        let projected_pdf = if light_tracing > 0.0 { projected_pdf() } else { 0.0 };
        if projected_pdf > 0.0 { light_tracing / projected_pdf } else { 0.0 }
    }

    /// The density of light tracing, whose light paths have the density `emission` at their start, over that of this path.
    #[inline]
    pub fn light_tracing_ratio(&self, emission: impl FnOnce() -> f32) -> f32 {
        if self.is_caustic && self.light_tracing > 0.0 { self.light_tracing * emission() } else { 0.0 }
    }
}

/// A point on an emitter that a ray has hit.
pub struct EmitterHit {
    /// Who sees it.
    pub visibility: EmitterVisibility,
    /// The light that samples it.
    pub light: Option<u32>,
    /// Cosine between the ray and the emitter's normal, above 0.
    pub cos: f32,
    /// In the world.
    pub position: Vec3,
}

impl PreparedScene<'_> {
    /// Whether paths go on to other surfaces after n scatterings and one more.
    #[inline]
    pub fn goes_on(&self, scatterings: u32) -> bool {
        scatterings + 1 < self.request.max_depth && !self.is_lone_convex
    }

    /// What light samples know of the light that is found in a direction of this pdf, sampled by the BSDF of a surface
    /// whose light samples are chosen by `normal`.
    #[inline]
    pub fn light_samples(&self, pdf: f32, normal: Vec3, surface: Kind) -> LightSamples {
        match self.sampling {
            Sampling::Light | Sampling::Hemisphere => LightSamples::Complete,
            // At diffuse surfaces other BSDF samples have found it.
            Sampling::Bsdf if surface.is_diffuse() => LightSamples::Complete,
            Sampling::Bsdf => LightSamples::NotTaken,
            Sampling::Mis | Sampling::MisLt => LightSamples::Combined { pdf, normal, surface },
        }
    }

    /// Whether light is left to rays of such directions.
    pub fn finds_light(&self, light_samples: &LightSamples) -> bool {
        match light_samples {
            LightSamples::Complete => false,
            LightSamples::Combined { .. } | LightSamples::Impossible | LightSamples::NotTaken => {
                self.has_emitters || self.scene.environment.is_some()
            }
        }
    }

    /// The MIS weight of an emitter's light on a ray from `origin`.
    #[inline]
    pub fn emitter_weight(&self, departure: &Departure, origin: Vec3, direction: Vec3, hit: &EmitterHit) -> f32 {
        let by_light = match (departure.light_samples, hit.visibility, hit.light) {
            (LightSamples::Impossible, ..) => 0.0,
            (_, EmitterVisibility::CameraOnly, _) | (LightSamples::Complete, ..) => return 0.0,
            (LightSamples::NotTaken, ..) | (LightSamples::Combined { .. }, _, None) => 0.0,
            (LightSamples::Combined { pdf, normal, surface }, _, Some(light)) => {
                self.lights.density(light, origin, surface.one_sided(normal)) / pdf
            }
        };
        let emission = || match (&self.light_tracing, hit.light) {
            (Some(tracing), Some(light)) => tracing.density(&self.lights, light, hit.position, -direction, hit.cos),
            _ => 0.0,
        };
        balance_heuristic(1.0, [by_light, departure.light_tracing_ratio(emission)])
    }

    /// What the environment contributes to the density of light tracing at a point, in direction `wi`.
    pub fn density_of_light_paths(&self, point: Vec3, wi: Vec3) -> f32 {
        let tracing = self.light_tracing.as_ref();
        tracing.map_or(0.0, |tracing| tracing.density_of_environment(self.environment.as_deref(), point, wi))
    }

    /// The environment's light on a ray from `origin`, times its MIS weight.
    #[inline]
    pub fn environment_light(&self, departure: &Departure, origin: Vec3, direction: Vec3) -> Rgb {
        let Some(environment) = &self.scene.environment else { return Rgb::ZERO };
        if departure.light_samples == LightSamples::Complete {
            return Rgb::ZERO;
        }
        let texel = environment.texel(direction.as_dvec3());
        let by_light = match (departure.light_samples, &self.environment) {
            (LightSamples::Combined { pdf, normal, surface }, Some(sampling)) => {
                self.request.light_samples as f32 * sampling.pdf_in_texel(texel, normal, surface) as f32 / pdf
            }
            _ => 0.0,
        };
        let emission = || self.density_of_light_paths(origin, direction);
        environment.radiance_in_texel(texel)
            * balance_heuristic(1.0, [by_light, departure.light_tracing_ratio(emission)])
    }
}
