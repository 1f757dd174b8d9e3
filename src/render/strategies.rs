//! How directions towards the light are chosen: by the light, by the surface, or by both.

use super::needs::Needs;
use super::settings::{LightDensity, Sampling, Settings};
use crate::bsdf::diffuse;
use crate::envmap::cosine::CosineSampler;
use crate::envmap::sampler::{CdfSampler, CompensatedSampler, Complete, SurfaceSampler};
use crate::envmap::strata::StrataSampler;
use crate::error::{Error, Result};
use crate::sampling::table::Table2;
use crate::sampling::warp;
use crate::scene::Scene;
use glam::DVec3;

/// The strategies of a render. That a light density which misses part of the light is never used alone is a matter of
/// types: [`Strategies::Light`] takes only a [`Complete`] sampler.
pub enum Strategies {
    /// Neither: there is no light to look for.
    None,
    Light(Box<dyn Complete>),
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
            Scatter::Bsdf => diffuse::sample(u),
            Scatter::Hemisphere => warp::uniform_hemisphere(u),
        }
    }

    #[inline]
    pub fn pdf(self, cos: f64) -> f64 {
        match self {
            Scatter::Bsdf => diffuse::pdf(cos),
            Scatter::Hemisphere => warp::UNIFORM_HEMISPHERE_PDF,
        }
    }
}

impl Strategies {
    /// Builds what the settings ask for, as far as the scene needs it.
    ///
    /// The density radiance × cosine already holds all of a diffuse surface's integrand. BSDF samples beside it would
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
        let map = environment.map.clone();
        if matches!(settings.density, LightDensity::Map | LightDensity::Compensated) {
            map.request(Table2::BYTES, "the sampling table")?;
        }
        Ok(match (settings.sampling, settings.density) {
            // They are among the scene's lights.
            (_, LightDensity::CutLights(..)) => Strategies::None,
            (Sampling::Mis, LightDensity::Strata(n)) => {
                Strategies::Both(Box::new(StrataSampler::new(map, n as usize)?), scatter)
            }
            (_, LightDensity::Strata(n)) => Strategies::Light(Box::new(StrataSampler::new(map, n as usize)?)),
            (_, LightDensity::Cosine) => Strategies::Light(Box::new(CosineSampler::new(map))),
            (Sampling::Light, LightDensity::Map) => Strategies::Light(Box::new(CdfSampler::new(map))),
            (Sampling::Light, LightDensity::Compensated) => {
                return Err(Error::parameter("density", "the compensated density is 0 where the map is dim")
                    .with_hint("it is correct only together with BSDF sampling: use `sampling` mis"));
            }
            (_, LightDensity::Map) => Strategies::Both(Box::new(CdfSampler::new(map)), scatter),
            (_, LightDensity::Compensated) => Strategies::Both(Box::new(CompensatedSampler::new(map)), scatter),
        })
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
