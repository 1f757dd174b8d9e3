//! How directions towards the light are chosen: by the light, by the surface, or by both.

use super::needs::Needs;
use super::settings::{Sampling, Settings};
use crate::envmap::samplers::SurfaceSampler;
use crate::error::{Error, Result};
use crate::sampling::warp;
use crate::scene::Scene;
use glam::DVec3;

/// The sampling strategies for direct light of the environment.
pub enum Strategies {
    /// None: there is no light to sample.
    None,
    /// By the light alone: the sampler is complete.
    Light(Box<dyn SurfaceSampler>),
    /// By the BSDF or the hemisphere alone.
    Surface(BsdfOnly),
    /// Combined by multiple importance sampling.
    Both(Box<dyn SurfaceSampler>, BsdfOnly),
}

/// A strategy that chooses directions by the surface alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BsdfOnly {
    /// By the diffuse BSDF: cosine-weighted.
    Bsdf,
    /// Uniformly over the hemisphere.
    Hemisphere,
}

impl BsdfOnly {
    /// Samples a direction in the local frame.
    #[inline]
    pub fn sample(self, u: [f64; 2]) -> DVec3 {
        match self {
            BsdfOnly::Bsdf => warp::cosine_hemisphere(u),
            BsdfOnly::Hemisphere => warp::uniform_hemisphere(u),
        }
    }

    /// Pdf per solid angle for the cosine to the normal.
    #[inline]
    pub fn pdf(self, cos: f64) -> f64 {
        match self {
            BsdfOnly::Bsdf => warp::cosine_hemisphere_pdf(cos),
            BsdfOnly::Hemisphere => warp::UNIFORM_HEMISPHERE_PDF,
        }
    }
}

impl Strategies {
    /// Builds what the settings ask for, as far as the scene needs it.
    ///
    /// A sampler of radiance × cosine is already proportional to the integrand of a diffuse surface. BSDF samples beside it
    /// would only add variance (almost three times the error on the first report's scene), so MIS leaves them out there.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a sampler that misses part of the light and is used alone; those of the sampler.
    pub fn new(scene: &Scene, settings: &Settings, needs: &Needs) -> Result<Self> {
        let bsdf_only = if settings.sampling == Sampling::Hemisphere { BsdfOnly::Hemisphere } else { BsdfOnly::Bsdf };
        if !settings.sampling.by_light() {
            return Ok(Strategies::Surface(bsdf_only));
        }
        let Some(environment) = &scene.environment else { return Ok(Strategies::None) };
        if !needs.environment_table {
            return Ok(Strategies::None);
        }
        let by_light = settings.density;
        if by_light.has_fixed_lights() {
            // They are among the scene's lights.
            return Ok(Strategies::None);
        }
        let combined = settings.sampling == Sampling::Mis && !by_light.needs_normal();
        if !combined && !by_light.entry().complete {
            return Err(Error::parameter("density", format!("the density {by_light} misses part of the light"))
                .with_hint("it is correct only together with BSDF sampling: use `sampling` mis"));
        }
        let sampler = by_light.sampler(environment.map.clone())?;
        Ok(if combined { Strategies::Both(sampler, bsdf_only) } else { Strategies::Light(sampler) })
    }

    /// The environment sampler, if one is in use.
    #[inline]
    pub fn light(&self) -> Option<&dyn SurfaceSampler> {
        match self {
            Strategies::Light(sampler) => Some(&**sampler),
            Strategies::Both(sampler, _) => Some(&**sampler),
            Strategies::None | Strategies::Surface(_) => None,
        }
    }

    /// The strategy without regard to the light, if one is in use.
    #[inline]
    pub fn bsdf_only(&self) -> Option<BsdfOnly> {
        match self {
            Strategies::Surface(bsdf_only) | Strategies::Both(_, bsdf_only) => Some(*bsdf_only),
            Strategies::None | Strategies::Light(_) => None,
        }
    }
}
