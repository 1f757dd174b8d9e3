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

/// The lit sphere at one size: its exact picture, and the renders of it by strategy and samples per pixel.
struct Picture {
    size: usize,
    exact: OnceLock<Exact>,
    shots: Mutex<HashMap<(usize, u32), Arc<Shot>>>,
}

impl Picture {
    fn new(size: usize) -> Self {
        Self { size, exact: OnceLock::new(), shots: Mutex::default() }
    }
}

/// Which picture of the lit sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// The report's 511×511.
    Full,
    /// A quarter of the pixels, enough to measure errors on.
    Measuring,
}

/// State of one `reproduce` run.
pub struct Context {
    pub source: MapSource,
    pub info: Info,
    pub seed: u64,
    pictures: [Picture; 2],
}

impl Context {
    /// `quick` makes the pictures smaller.
    #[must_use]
    pub fn new(source: MapSource, seed: u64, quick: bool) -> Self {
        let info = Info::of(&source.map);
        let sizes = if quick { [127, 127] } else { [511, 255] };
        Self { source, info, seed, pictures: sizes.map(Picture::new) }
    }

    /// The sphere at `spp` samples per pixel by a strategy of the error figure, by its number; rendered once.
    pub fn shot(&self, size: Size, strategy: usize, spp: u32) -> Result<Arc<Shot>> {
        let picture = &self.pictures[usize::from(size == Size::Measuring)];
        let scale = f64::from(builtin::SPHERE_ENV_SCALE);
        let exact = picture.exact.get_or_init(|| Exact::new(&self.source.map, scale, picture.size));
        let mut shots = picture.shots.lock().unwrap_or_else(PoisonError::into_inner);
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
