//! The vertex before a ray, and the MIS weight of the light that the ray finds.

use super::lanes::plain_items;
use super::light_sample::balance_heuristic;
use super::prepared::PreparedScene;
use super::settings::Sampling;
use super::shaders::Kind;
use etalon_core::math::Rgb;
use etalon_core::scene::EmitterVisibility;
use glam::Vec3;

/// The vertex before a ray, as far as multiple importance sampling needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreviousVertex {
    /// Whether it is the camera or a delta lobe: light samples cannot find what the ray finds.
    pub specular: bool,
    /// Pdf of the ray's direction by BSDF sampling, unless it is specular.
    pub pdf: f32,
    /// Unit normal by which its light samples are chosen.
    pub normal: Vec3,
    /// The kind of surface: light samples of one that transmits come from both sides.
    pub kind: Kind,
    /// The density of light tracing over that of this path, except for the factors that the next vertices contribute; 0 where light
    /// tracing cannot find the path. See [`super::light_tracing`].
    pub q: f32,
    /// Whether light tracing finds light that is found next: its paths start towards surfaces that are not diffuse, and are
    /// connected to the camera at the second vertex or later.
    pub is_caustic: bool,
}

plain_items! { PreviousVertex = PreviousVertex::CAMERA }

impl PreviousVertex {
    pub const CAMERA: Self =
        Self { specular: true, pdf: 0.0, normal: Vec3::Z, kind: Kind::Delta, q: 0.0, is_caustic: false };

    /// [`q`](Self::q) of the next vertex, from its value with the factor of the direction to the viewer and the pdf per
    /// projected solid angle of the new direction.
    #[inline]
    pub fn q_over_pdf(q: f32, projected_pdf: impl FnOnce() -> f32) -> f32 {
        let projected_pdf = if q > 0.0 { projected_pdf() } else { 0.0 };
        if projected_pdf > 0.0 { q / projected_pdf } else { 0.0 }
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
    /// Whether a path may scatter again at the next surface, after n scatterings and one more.
    #[inline]
    pub fn may_continue(&self, scatterings: u32) -> bool {
        scatterings + 1 < self.request.max_depth && !self.is_lone_convex
    }

    /// Whether light is left to the rays that leave a surface of this kind: other techniques may find all of it.
    #[inline]
    pub fn rays_find_light(&self, kind: Kind) -> bool {
        let is_left = match self.sampling {
            _ if kind == Kind::Delta => true,
            Sampling::Light | Sampling::Hemisphere => false,
            // At diffuse surfaces other BSDF samples have found it.
            Sampling::Bsdf => !kind.is_diffuse(),
            Sampling::Mis | Sampling::MisLt => true,
        };
        is_left && (self.has_emitters || self.scene.environment.is_some())
    }

    /// The weight of light that a ray finds, by the balance heuristic over all techniques that find it. `by_light`
    /// is the density of light samples at the previous vertex, `by_light_path` what the light contributes to the density of light tracing.
    #[inline]
    fn emission_weight(
        &self,
        previous: &PreviousVertex,
        by_light: impl FnOnce() -> f32,
        by_light_path: impl FnOnce() -> f32,
    ) -> f32 {
        if !previous.specular && !self.rays_find_light(previous.kind) {
            return 0.0;
        }
        let is_sampled = !previous.specular && self.sampling.is_mis();
        let by_light = if is_sampled { by_light() / previous.pdf } else { 0.0 };
        let is_traced = previous.is_caustic && previous.q > 0.0;
        let by_light_path = if is_traced { previous.q * by_light_path() } else { 0.0 };
        balance_heuristic(1.0, [by_light, by_light_path])
    }

    /// The MIS weight of an emitter's light on a ray from `origin`.
    #[inline]
    pub fn emitter_weight(&self, previous: &PreviousVertex, origin: Vec3, direction: Vec3, hit: &EmitterHit) -> f32 {
        if hit.visibility == EmitterVisibility::CameraOnly && !previous.specular {
            return 0.0;
        }
        let towards = previous.kind.one_sided(previous.normal);
        let by_light = || hit.light.map_or(0.0, |light| self.lights.density(light, origin, towards));
        let by_light_path = || match (&self.light_tracing, hit.light) {
            (Some(tracing), Some(light)) => tracing.density(&self.lights, light, hit.position, -direction, hit.cos),
            _ => 0.0,
        };
        self.emission_weight(previous, by_light, by_light_path)
    }

    /// What the environment contributes to the density of light tracing at a point, in direction `wi`.
    pub fn density_of_light_paths(&self, point: Vec3, wi: Vec3) -> f32 {
        let tracing = self.light_tracing.as_ref();
        tracing.map_or(0.0, |tracing| tracing.density_of_environment(self.environment.as_deref(), point, wi))
    }

    /// The environment's light on a ray from `origin`, times its MIS weight.
    #[inline]
    pub fn environment_light(&self, previous: &PreviousVertex, origin: Vec3, direction: Vec3) -> Rgb {
        let Some(environment) = &self.scene.environment else { return Rgb::ZERO };
        // Not worth a look into the map
        if !previous.specular && !self.rays_find_light(previous.kind) {
            return Rgb::ZERO;
        }
        let texel = environment.texel(direction.as_dvec3());
        let by_light = || {
            let sampling = self.environment.as_ref();
            let pdf = sampling.map_or(0.0, |map| map.pdf_in_texel(texel, previous.normal, previous.kind) as f32);
            self.request.light_samples as f32 * pdf
        };
        let weight = self.emission_weight(previous, by_light, || self.density_of_light_paths(origin, direction));
        environment.radiance_in_texel(texel) * weight
    }
}
