//! What the figures of one run share: the map, the scenes, the settings, and results that several of them show.

use super::map::{Display, Look};
use super::originals::Originals;
use super::stability_entries::FIGURES;
use crate::envmap::EnvMap;
use crate::envmap::info::Info;
use crate::envmap::samplers::MapSampling;
use crate::error::Result;
use crate::optics::metals::{COPPER, Metal};
use crate::render::{Sampling, Settings};
use crate::scene::{Material, Request, Scene, builtin};
use crate::stats::{Protocol, Samples};
use crate::study::audit::{Erratum, audit};
use crate::study::converge::Convergence;
use crate::study::depth::{Depths, depths};
use crate::study::roughness::{self, Shot as Statue};
use crate::study::sampling_strategies::{Comparison, compare};
use crate::study::sphere::{Exact, Shot, shoot};
use crate::study::stability::{self, Effort, Stability};
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The environment map of a run.
#[derive(Debug, Clone)]
pub struct MapSource {
    pub map: Arc<EnvMap>,
    pub name: String,
}

/// Strategies that the error figure compares: label, sampling, density.
pub const STRATEGIES: [(&str, Sampling, MapSampling); 4] = [
    ("radiance × cosine (default)", Sampling::Mis, MapSampling::COSINE),
    ("MIS, compensated map", Sampling::Mis, MapSampling::COMPENSATED),
    ("MIS, map", Sampling::Mis, MapSampling::MAP),
    ("map alone, as the report", Sampling::Light, MapSampling::MAP),
];

/// Results by what they are of, each computed once.
pub(super) struct Memory<K, T>(Mutex<HashMap<K, Arc<T>>>);

impl<K: Eq + Hash, T> Memory<K, T> {
    fn new() -> Self {
        Self(Mutex::default())
    }

    pub(super) fn get(&self, key: K, make: impl FnOnce() -> Result<T>) -> Result<Arc<T>> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(result) = known.get(&key) {
            return Ok(result.clone());
        }
        let result = Arc::new(make()?);
        known.insert(key, result.clone());
        Ok(result)
    }
}

/// The lit sphere at one size: its exact picture, and the renders of it by strategy and samples per pixel.
struct Picture {
    size: usize,
    exact: OnceLock<Exact>,
    shots: Memory<(usize, u32), Shot>,
}

impl Picture {
    fn new(size: usize) -> Self {
        Self { size, exact: OnceLock::new(), shots: Memory::new() }
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
    quick: bool,
    originals: Option<Originals>,
    display: OnceLock<Display>,
    pictures: [Picture; 2],
    depths: Memory<(), Depths>,
    statues: Memory<(&'static str, u32), Statue>,
    comparison: Memory<(), Comparison>,
    pub(super) convergences: Memory<&'static str, Convergence>,
    stabilities: Memory<&'static str, Stability>,
    audits: Memory<(), Vec<Erratum>>,
}

impl Context {
    /// `quick` makes the pictures smaller; with `originals`, those scenes stand in for the built-in ones.
    #[must_use]
    pub fn new(source: MapSource, originals: Option<Originals>, seed: u64, quick: bool) -> Self {
        let info = Info::of(&source.map);
        let sizes = if quick { [127, 127] } else { [511, 255] };
        Self {
            source,
            info,
            seed,
            quick,
            originals,
            display: OnceLock::new(),
            pictures: sizes.map(Picture::new),
            depths: Memory::new(),
            statues: Memory::new(),
            comparison: Memory::new(),
            convergences: Memory::new(),
            stabilities: Memory::new(),
            audits: Memory::new(),
        }
    }

    /// The map, ready to be drawn on.
    pub fn display(&self) -> &Display {
        self.display.get_or_init(|| Display::new(&self.source.map, Look::default()))
    }

    /// The sphere at `spp` samples per pixel by a strategy of the error figure, by its number; rendered once.
    pub fn shot(&self, size: Size, strategy: usize, spp: u32) -> Result<Arc<Shot>> {
        // A quick run measures on the picture that it shows.
        let size = self.size(size, Size::Full);
        let picture = &self.pictures[usize::from(size == Size::Measuring)];
        let scale = f64::from(builtin::SPHERE_ENV_SCALE);
        let exact = picture.exact.get_or_init(|| Exact::new(&self.source.map, scale, picture.size));
        picture.shots.get((strategy, spp), || {
            let (_, sampling, density) = STRATEGIES[strategy];
            let settings = Settings { sampling, density, ..self.settings() };
            shoot(&self.source.map, &self.source.name, spp, exact, &settings)
        })
    }

    /// Default settings under the run's seed.
    #[must_use]
    pub fn settings(&self) -> Settings {
        Settings { seed: self.seed, ..Settings::default() }
    }

    /// `full`, or `quick` if the run is a quick one.
    #[must_use]
    pub fn size<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }

    /// How claims are tested: errors of 2 % are found, or of 5 % in a hurry.
    #[must_use]
    pub fn protocol(&self) -> Protocol {
        let samples = Samples::Detect(if self.quick { 0.05 } else { 0.02 });
        Protocol { seed: self.seed, samples, ..Protocol::default() }
    }

    /// Whether everything is to be made smaller.
    #[must_use]
    pub fn is_quick(&self) -> bool {
        self.quick
    }

    /// Whether the scenes are the report's own files.
    #[must_use]
    pub fn has_originals(&self) -> bool {
        self.originals.is_some()
    }

    /// Mirror and glass ball, and the request of the report's depth series.
    #[must_use]
    pub fn spheres(&self) -> (Scene, Request) {
        let (scene, request) = self.originals.as_ref().map_or_else(builtin::cornell_spheres, |o| o.spheres.clone());
        (scene, self.request(request, 64, 4))
    }

    /// A statue (in the report's files, its dragon) of `metal`, and the request of its material pictures.
    pub fn statue(&self, metal: &Metal, alpha: f32) -> Result<(Scene, Request)> {
        let Some(originals) = &self.originals else {
            let (scene, request) = builtin::cornell_statue(metal, alpha, None)?;
            return Ok((scene, self.request(request, 128, 1)));
        };
        let (mut scene, request) = originals.dragon.clone();
        for object in &mut scene.objects {
            if let Material::Conductor(conductor) = &mut object.material {
                (conductor.eta, conductor.k, conductor.alpha) = (metal.eta_rgb(), metal.k_rgb(), alpha);
            }
        }
        Ok((scene, self.request(request, 128, 1)))
    }

    /// The copper statue (in the report's files, its bunny), and the request of its sampling pictures.
    pub fn copper(&self) -> Result<(Scene, Request)> {
        let (scene, request) = match &self.originals {
            Some(originals) => originals.bunny.clone(),
            None => builtin::cornell_statue(COPPER, 0.05, None)?,
        };
        Ok((scene, self.request(request, 64, 1)))
    }

    fn request(&self, asked: Request, spp: u32, light_samples: u32) -> Request {
        let (side, spp) = if self.quick { (2, spp / 4) } else { (1, spp) };
        let (width, height) = (asked.width / side, asked.height / side);
        Request { width, height, spp, light_samples, max_depth: 5 }
    }

    /// The depth series.
    pub fn depths(&self) -> Result<Arc<Depths>> {
        self.depths.get((), || {
            let (scene, request) = self.spheres();
            depths(&scene, &request, &self.settings())
        })
    }

    /// A statue's picture.
    pub fn statue_shot(&self, metal: &'static Metal, alpha: f32) -> Result<Arc<Statue>> {
        self.statues.get((metal.symbol, alpha.to_bits()), || {
            let (scene, request) = self.statue(metal, alpha)?;
            roughness::shoot(&scene, &request, &self.settings())
        })
    }

    /// Importance and hemisphere sampling.
    pub fn comparison(&self) -> Result<Arc<Comparison>> {
        self.comparison.get((), || {
            let (scene, request) = self.copper()?;
            compare(&scene, &request, &self.settings())
        })
    }

    /// The reports' mistakes, tested once.
    pub fn audit(&self) -> Result<Arc<Vec<Erratum>>> {
        self.audits.get((), || audit(&self.protocol()))
    }

    /// What a figure of the stability study shows.
    pub fn stability(&self, figure: &'static str) -> Result<Arc<Stability>> {
        self.stabilities.get(figure, || {
            let effort = if self.quick { Effort::QUICK } else { Effort::FIGURES };
            let names = FIGURES.iter().find(|(id, ..)| *id == figure).map_or(&[][..], |(.., names)| names);
            stability::run(names, &effort, self.seed, &mut |_| {})
        })
    }
}
