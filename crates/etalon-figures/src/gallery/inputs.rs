//! The inputs of a run of the gallery: the map, the scenes or the second report's own files of them, the seed and the effort.
//!
//! Results of studies that several figures show are computed once per run, when they are first needed.

use crate::figure::Style;
use crate::view::map::{Display, Look};
use etalon_core::envmap::info::Info;
use etalon_core::envmap::{Grace, NamedMap};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_core::import::{SceneOptions, collada};
use etalon_core::optics::metals;
use etalon_core::scene::{Material, Request, Scene, builtin};
use etalon_render::Settings;
use etalon_stats::{Protocol, SampleCount};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// How much work the figures take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// The sizes of the reports.
    Full,
    /// Smaller images and fewer samples.
    Quick,
}

impl Effort {
    pub fn of<T>(self, full: T, quick: T) -> T {
        match self {
            Self::Full => full,
            Self::Quick => quick,
        }
    }
}

/// The input of a run that a figure shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shown {
    /// None: formulas, or scenes of its own.
    #[default]
    Nothing,
    Map,
    /// The box with a mirror and a glass sphere.
    Spheres,
    /// The box with a statue of gold or iron.
    Statue,
    /// The box with a statue of copper.
    Copper,
}

pub struct Inputs {
    pub map: NamedMap,
    /// The second report's own scenes; without them, the built-in ones.
    pub originals: Option<Originals>,
    pub seed: u64,
    pub effort: Effort,
    pub style: Style,
    /// PNG files have this many times the pixels along each side.
    pub scale: u32,
}

impl Inputs {
    /// Why what holds for the first report's map need not hold in this run, if the map is another one.
    pub fn other_map(&self) -> Option<String> {
        let is_graces = Grace::of(self.map.map.image()) == Some(Grace::Upright);
        (!is_graces).then(|| format!("the map is {}, not the first report's", self.map.file_name()))
    }

    /// Whether the run has this scene of the second report, recognised by its content.
    pub fn is_original(&self, name: &str) -> bool {
        self.originals.as_ref().is_some_and(|originals| originals.recognised.contains(&name))
    }

    /// The files of the reports that the run has, recognised by their content, by name.
    pub fn recognised(&self) -> Vec<String> {
        let map = self.other_map().is_none().then(|| format!("{} (Grace Cathedral)", self.map.file_name()));
        let scenes = self.originals.iter().flat_map(|originals| &originals.recognised);
        map.into_iter().chain(scenes.map(|name| (*name).to_owned())).collect()
    }

    /// The input that a figure shows, by its name; empty for `Shown::Nothing`.
    ///
    /// # Errors
    /// Those of the built-in scenes.
    pub fn name_of(&self, shown: Shown) -> Result<String> {
        Ok(match shown {
            Shown::Nothing => String::new(),
            Shown::Map => format!("the map {}", self.map.file_name()),
            Shown::Spheres => format!("the scene {}", self.spheres().0.name),
            Shown::Statue => format!("the scene {}", self.statue("Au", 0.25)?.0.name),
            Shown::Copper => format!("the scene {}", self.copper()?.0.name),
        })
    }

    pub fn settings(&self) -> Settings {
        Settings { seed: self.seed, ..Settings::default() }
    }

    /// How claims are tested: with samples that detect errors of 3 %, or of 5 % in a quick run.
    pub fn protocol(&self) -> Protocol {
        Protocol { seed: self.seed, samples: SampleCount::Detect(self.effort.of(0.04, 0.05)), ..Protocol::default() }
    }

    /// A mirror and a glass sphere in a Cornell box, and the request of the report's depth series.
    pub fn spheres(&self) -> (Scene, Request) {
        let (scene, request) = self.originals.as_ref().map_or_else(builtin::cornell_spheres, |o| o.spheres.clone());
        (scene, self.request(request, 64, 4))
    }

    /// A statue (in the report's files, its dragon) of the metal of that symbol, and the request of the report's material
    /// images.
    ///
    /// # Errors
    /// An unknown metal, and those of [`builtin::cornell_statue`].
    pub fn statue(&self, metal: &str, alpha: f32) -> Result<(Scene, Request)> {
        let metal = metals::by_name(metal)
            .ok_or_else(|| Error::parameter("metal", format!("\"{metal}\" is not in the table")))?;
        let Some(originals) = &self.originals else {
            let (scene, request) = builtin::cornell_statue(metal, alpha, None)?;
            return Ok((scene, self.request(request, 128, 1)));
        };
        // Replace the metal of the report's scene
        let (mut scene, request) = originals.dragon.clone();
        for object in &mut scene.objects {
            if let Material::Conductor(conductor) = &mut object.material {
                (conductor.eta, conductor.k, conductor.alpha) = (metal.eta_rgb(), metal.k_rgb(), [alpha; 2]);
            }
        }
        Ok((scene, self.request(request, 128, 1)))
    }

    /// The copper statue (in the report's files, its bunny) of the sampling figures, and their request.
    pub fn copper(&self) -> Result<(Scene, Request)> {
        let (scene, request) = match &self.originals {
            Some(originals) => originals.bunny.clone(),
            None => builtin::cornell_statue(metals::COPPER, 0.05, None)?,
        };
        Ok((scene, self.request(request, 64, 1)))
    }

    /// A quick run has half the width and height, and a quarter of the samples.
    fn request(&self, asked: Request, spp: u32, light_samples: u32) -> Request {
        let side = self.effort.of(1, 2);
        let (width, height) = (asked.width / side, asked.height / side);
        Request { width, height, spp: self.effort.of(spp, spp / 4), light_samples, max_depth: 5 }
    }
}

/// The scenes of one folder, at the report's size.
#[derive(Debug, Clone)]
pub struct Originals {
    pub spheres: (Scene, Request),
    pub dragon: (Scene, Request),
    pub bunny: (Scene, Request),
    /// Names of the files that are known by their checksums.
    pub recognised: Vec<&'static str>,
}

/// SHA-256 of the report's own files; the book's page on them lists these, too. Its dragon is not published: any other may stand in
/// its place.
const CHECKSUMS: [(&str, &str); 2] = [
    ("CBspheres.dae", "8611bc4cde82f2b75ed3d92ce385b541a41b23f8522b3590d01d1712db102429"),
    ("CBbunny_microfacet_cu.dae", "711089ea5bf08a7c79a1165d81068aeec8da2ef28f4ce30ef2f4a43a88d91760"),
];
/// Most bytes of a scene file.
const LIMIT: u64 = 1 << 30;

/// Width and height of the report's images.
const SIZE: [usize; 2] = [480, 360];

impl Originals {
    /// Reads `CBspheres.dae`, `CBdragon_microfacet_au.dae` and `CBbunny_microfacet_cu.dae`; also returns the readers'
    /// warnings.
    pub fn read(folder: &Path) -> Result<(Self, Vec<String>)> {
        let mut warnings = Vec::new();
        let mut scene = |name: &str| -> Result<(Scene, Request)> {
            let options = SceneOptions { resolution: Some(SIZE), ..SceneOptions::default() };
            let imported = collada::read(&folder.join(name), &options)?;
            warnings.extend(imported.warnings);
            Ok((imported.scene, imported.request))
        };
        let spheres = scene("CBspheres.dae")?;
        let dragon = scene("CBdragon_microfacet_au.dae")?;
        let bunny = scene("CBbunny_microfacet_cu.dae")?;
        let mut recognised = Vec::new();
        for (name, checksum) in CHECKSUMS {
            let bytes = files::read_bounded(&folder.join(name), LIMIT)?;
            let found: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
            recognised.extend((found == checksum).then_some(name));
        }
        Ok((Self { spheres, dragon, bunny, recognised }, warnings))
    }
}

/// The results so far, by type and name.
#[derive(Default)]
pub struct Studies(HashMap<(TypeId, String), Rc<dyn Any>>);

impl Studies {
    /// The result called `name`, computed by `run` if it is not yet known. Names distinguish results of one type.
    pub fn get<T: 'static>(&mut self, name: impl Into<String>, run: impl FnOnce() -> Result<T>) -> Result<Rc<T>> {
        let key = (TypeId::of::<T>(), name.into());
        if let Some(Ok(known)) = self.0.get(&key).map(|known| known.clone().downcast()) {
            return Ok(known);
        }
        let result = Rc::new(run()?);
        self.0.insert(key, result.clone());
        Ok(result)
    }

    pub fn map_info(&mut self, inputs: &Inputs) -> Result<Rc<Info>> {
        self.get("map", || Ok(Info::of(&inputs.map.map)))
    }

    /// The run's environment map, tone-mapped to draw on.
    pub fn map_display(&mut self, inputs: &Inputs) -> Result<Rc<Display>> {
        self.get("map", || Ok(Display::new(&inputs.map.map, Look::default())))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::inputs;
    use super::*;

    #[test]
    fn quick_renders_are_smaller() {
        let quick = inputs();
        let full = Inputs { effort: Effort::Full, ..inputs() };
        let (quick, full) = (quick.spheres().1, full.spheres().1);
        assert_eq!((full.width, full.height, full.spp), (480, 360, 64));
        assert_eq!((quick.width, quick.height, quick.spp), (240, 180, 16));
    }

    #[test]
    fn the_book_has_the_checksums() {
        // A package has no book
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/originals.md");
        let Ok(text) = std::fs::read_to_string(book) else { return };
        for (name, checksum) in CHECKSUMS {
            assert!(text.contains(&format!("{checksum}  {name}\n")), "{name}");
        }
    }

    #[test]
    fn a_study_runs_once_for_each_name() {
        let (mut studies, mut runs) = (Studies::default(), 0);
        let results = [3, 4, 3, 3].map(|n: u32| {
            let square = studies.get(n.to_string(), || {
                runs += 1;
                Ok(n * n)
            });
            *square.unwrap()
        });
        assert_eq!((results, runs), ([9, 16, 9, 9], 2));
    }
}
