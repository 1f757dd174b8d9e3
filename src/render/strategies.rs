//! How directions towards the light are chosen: by the light, by the surface, or by both.

use super::needs::Needs;
use super::settings::{Sampling, Settings};
use crate::envmap::samplers::SurfaceSampler;
use crate::error::{Error, Result};
use crate::sampling::warp;
use crate::scene::Scene;
use glam::DVec3;

/// The strategies of a render.
pub enum Strategies {
    /// Neither: there is no light to look for.
    None,
    /// By the light alone: the sampler is complete.
    Light(Box<dyn SurfaceSampler>),
    Surface(Scatter),
    /// Combined by multiple importance sampling.
    Both(Box<dyn SurfaceSampler>, Scatter),
}

/// A strategy that chooses directions by the surface alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatter {
    /// By the material's density.
    Bsdf,
    /// Uniformly over the hemisphere.
    Hemisphere,
}

impl Scatter {
    #[inline]
    pub fn sample(self, u: [f64; 2]) -> DVec3 {
        match self {
            Scatter::Bsdf => warp::cosine_hemisphere(u),
            Scatter::Hemisphere => warp::uniform_hemisphere(u),
        }
    }

    #[inline]
    pub fn pdf(self, cos: f64) -> f64 {
        match self {
            Scatter::Bsdf => warp::cosine_hemisphere_pdf(cos),
            Scatter::Hemisphere => warp::UNIFORM_HEMISPHERE_PDF,
        }
    }
}

impl Strategies {
    /// Builds what the settings ask for, as far as the scene needs it.
    ///
    /// A density that looks at the normal, radiance × cosine, already holds all of a diffuse surface's integrand. BSDF samples beside it would
    /// only add noise (almost three times the error on the first report's scene), so combining then means leaving
    /// them out.
    pub fn new(scene: &Scene, settings: &Settings, needs: &Needs) -> Result<Self> {
        let scatter = if settings.sampling == Sampling::Hemisphere { Scatter::Hemisphere } else { Scatter::Bsdf };
        if !settings.sampling.by_light() {
            return Ok(Strategies::Surface(scatter));
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
        Ok(if combined { Strategies::Both(sampler, scatter) } else { Strategies::Light(sampler) })
    }

    /// The strategy that draws by the light, if it is in use.
    #[inline]
    pub fn light(&self) -> Option<&dyn SurfaceSampler> {
        match self {
            Strategies::Light(sampler) => Some(&**sampler),
            Strategies::Both(sampler, _) => Some(&**sampler),
            Strategies::None | Strategies::Surface(_) => None,
        }
    }

    /// The strategy that draws without regard to the light, if one is in use.
    #[inline]
    pub fn scatter(&self) -> Option<Scatter> {
        match self {
            Strategies::Surface(scatter) | Strategies::Both(_, scatter) => Some(*scatter),
            Strategies::None | Strategies::Light(_) => None,
        }
    }
}
