//! The vertex before a ray, and the MIS weight of the light that the ray finds.

use super::lanes::{Hits, NONE, Rays, plain_items};
use super::light_sample::balance_heuristic;
use super::prepared::PreparedScene;
use super::settings::Sampling;
use super::shaders::Kind;
use etalon_core::math::Rgb;
use etalon_core::scene::EmitterVisibility;
use etalon_core::scene::Ray;
use glam::Vec3;

/// The vertex before a ray, as far as multiple importance sampling needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreviousVertex {
    /// Pdf of the ray's direction by BSDF sampling, unless the kind is delta.
    pub pdf: f32,
    /// Unit normal by which its light samples are chosen.
    pub normal: Vec3,
    /// The kind of surface: light samples of one that transmits come from both sides. Delta also for the camera and for delta lobes of
    /// other surfaces: light samples cannot find what the ray finds.
    pub kind: Kind,
    /// The density of light tracing over that of this camera path, except for the factors that the next vertices contribute; 0 where
    /// light tracing cannot find the path. Of a light path the same of all techniques of camera paths, summed. See
    /// [`super::light_tracing`].
    pub q: f32,
}

plain_items! { PreviousVertex = PreviousVertex::SPECULAR }

impl PreviousVertex {
    /// The camera, or a delta lobe; vertices of light paths, of which `q` alone is read, take the rest from it.
    pub const SPECULAR: Self = Self { pdf: 0.0, normal: Vec3::Z, kind: Kind::Delta, q: 0.0 };

    /// [`q`](Self::q) of the next vertex, from its value with the factor of the direction to the viewer and the pdf per
    /// projected solid angle of the new direction.
    #[inline]
    pub fn q_over_pdf(q: f32, projected_pdf: impl FnOnce() -> f32) -> f32 {
        let projected_pdf = if q > 0.0 { projected_pdf() } else { 0.0 };
        if projected_pdf > 0.0 { q / projected_pdf } else { 0.0 }
    }
}

impl PreparedScene<'_> {
    /// Whether a path that has scattered n times before this vertex may scatter at the next one.
    #[inline]
    pub fn may_continue(&self, scatterings: u32) -> bool {
        scatterings + 1 < self.request.max_depth && self.needs.occlusion
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

    /// The light that ray `i` finds, times its MIS weight, if it finds any. `previous` is the vertex before, the `depth`-th of
    /// the path; `None` if no other technique finds what the ray finds.
    #[inline]
    pub fn light_found(
        &self,
        rays: &Rays,
        hits: &Hits,
        i: usize,
        depth: u32,
        previous: Option<&PreviousVertex>,
    ) -> Option<Rgb> {
        let Ray { origin, direction } = rays.at(i);
        let Some(shader) = self.shaders.get(hits.object[i] as usize) else {
            let environment = self.scene.environment.as_ref()?;
            // Not worth a look into the map
            if previous.is_some_and(|previous| !self.rays_find_light(previous.kind)) {
                return None;
            }
            let texel = environment.texel(direction.as_dvec3());
            let by_light = |previous: &PreviousVertex| {
                let sampling = self.environment.as_ref();
                let pdf = sampling.map_or(0.0, |map| map.pdf_in_texel(texel, previous.normal, previous.kind) as f32);
                self.request.light_samples as f32 * pdf
            };
            let by_light_path = || self.light_path_density(NONE, origin, direction, 1.0);
            return Some(
                environment.radiance_in_texel(texel) * self.emission_weight(depth, previous, by_light, by_light_path),
            );
        };
        let emission = shader.emission.as_ref()?;
        let surface = self.geometry.surface(rays, hits, i);
        let is_specular = previous.is_some_and(|previous| previous.kind == Kind::Delta);
        let is_visible = is_specular || emission.visibility != EmitterVisibility::CameraOnly;
        if !is_visible || !emission.is_emitted(surface.normal, direction) {
            return None;
        }
        let light = shader.light.map(|first| first + self.geometry.triangle(hits, i));
        let by_light = |previous: &PreviousVertex| {
            light.map_or(0.0, |light| self.lights.density(light, origin, previous.kind.one_sided(previous.normal)))
        };
        let by_light_path = || {
            let cos = surface.normal.dot(direction).abs();
            light.map_or(0.0, |light| self.light_path_density(light, surface.position, direction, cos))
        };
        Some(emission.radiance * self.emission_weight(depth, previous, by_light, by_light_path))
    }

    /// The weight of light that a ray finds, by the balance heuristic over all techniques that find it. `by_light`
    /// is the density of light samples at the previous vertex, `by_light_path` what the light contributes to the density of light tracing.
    #[inline]
    fn emission_weight(
        &self,
        depth: u32,
        previous: Option<&PreviousVertex>,
        by_light: impl FnOnce(&PreviousVertex) -> f32,
        by_light_path: impl FnOnce() -> f32,
    ) -> f32 {
        let Some(previous) = previous else { return 1.0 };
        if !self.rays_find_light(previous.kind) {
            return 0.0;
        }
        let is_sampled = previous.kind != Kind::Delta && self.sampling.is_mis();
        let by_light = if is_sampled { by_light(previous) / previous.pdf } else { 0.0 };
        // Light paths start towards surfaces that are not diffuse, and are connected to the camera at the second vertex or later.
        let is_traced = depth >= 2 && !previous.kind.is_diffuse() && previous.q > 0.0;
        let by_light_path = if is_traced { previous.q * by_light_path() } else { 0.0 };
        balance_heuristic(1.0, [by_light, by_light_path])
    }

    /// What a light contributes to the density of light tracing for a ray in direction `wi` that meets it at a point, with this cosine;
    /// of the environment ([`NONE`]) the point is any of the ray.
    #[inline]
    pub fn light_path_density(&self, light: u32, point: Vec3, wi: Vec3, cos: f32) -> f32 {
        match (&self.light_tracing, light) {
            (None, _) => 0.0,
            (Some(tracing), NONE) => tracing.density_of_environment(self.environment.as_deref(), point, wi),
            (Some(tracing), light) => tracing.density(&self.lights, light, point, -wi, cos),
        }
    }
}
