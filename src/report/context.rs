//! What the figures of one run share: the map, the settings, and results that several of them show.

use crate::envmap::EnvMap;
use crate::envmap::info::Info;
use crate::error::Result;
use crate::render::{LightDensity, Sampling, Settings};
use crate::scene::builtin;
use crate::study::sphere::{Exact, Shot, shoot};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The environment map of a run.
#[derive(Debug, Clone)]
pub struct MapSource {
    pub map: Arc<EnvMap>,
    pub name: String,
}

/// Strategies that the error figure compares: label, sampling, density.
pub const STRATEGIES: [(&str, Sampling, LightDensity); 4] = [
    ("radiance × cosine (default)", Sampling::Mis, LightDensity::Cosine),
    ("MIS, compensated map", Sampling::Mis, LightDensity::Compensated),
    ("MIS, map", Sampling::Mis, LightDensity::Map),
    ("map alone, as the report", Sampling::Light, LightDensity::Map),
];

/// State of one `reproduce` run.
pub struct Context {
    pub source: MapSource,
    pub info: Info,
    pub seed: u64,
    /// Smaller pictures, for a quick check of everything.
    pub quick: bool,
    exact: OnceLock<Exact>,
    shots: Mutex<HashMap<(usize, u32), Arc<Shot>>>,
}

impl Context {
    #[must_use]
    pub fn new(source: MapSource, seed: u64, quick: bool) -> Self {
        let info = Info::of(&source.map);
        Self { source, info, seed, quick, exact: OnceLock::new(), shots: Mutex::default() }
    }

    /// The exact picture of the sphere.
    pub fn exact(&self) -> &Exact {
        let size = if self.quick { 127 } else { 511 };
        self.exact.get_or_init(|| Exact::new(&self.source.map, f64::from(builtin::SPHERE_ENV_SCALE), size))
    }

    /// The sphere at `spp` samples per pixel by a strategy of the error figure, by its number; rendered once.
    pub fn shot(&self, strategy: usize, spp: u32) -> Result<Arc<Shot>> {
        let exact = self.exact();
        let mut shots = self.shots.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(shot) = shots.get(&(strategy, spp)) {
            return Ok(shot.clone());
        }
        let (_, sampling, density) = STRATEGIES[strategy];
        let settings = Settings { sampling, density, seed: self.seed, ..Settings::default() };
        let shot = Arc::new(shoot(&self.source.map, &self.source.name, spp, exact, &settings)?);
        shots.insert((strategy, spp), shot.clone());
        Ok(shot)
    }
}
