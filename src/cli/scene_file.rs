//! The scene of a command: a built-in one or a file, with the changes that flags ask for.

use super::console::Console;
use super::map_file::{self, MapOptions};
use crate::envmap::NamedMap;
use crate::error::{Error, Result};
use crate::import::{self, SCENE_EXTENSIONS, SceneOptions};
use crate::scene::{Environment, Material, Request, Scene, builtin};
use clap::{ArgAction, Args};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The scene and its changes.
#[derive(Args)]
pub struct SceneArgs {
    /// A built-in scene (`etalon scenes` lists them), or a .pbrt or .dae file
    scene: OsString,
    /// Width and height in pixels. In a .dae scene they also set the field of view, as in the course's renderer: a pixel keeps
    /// its angle (that of an image of 800 by 600 with the file's field of view), so a smaller image shows less. All other
    /// scenes keep their field of view
    #[arg(short, num_args = 2, value_names = ["W", "H"], action = ArgAction::Set)]
    resolution: Option<Vec<usize>>,
    /// The environment map of sphere-env, of a .pbrt scene (in place of the file's mapname) or of a .dae scene (with the
    /// file's lights; row 0 is at +y, the file's up axis): a file or a built-in name
    #[arg(long, value_name = "MAP")]
    envmap: Option<OsString>,
    #[command(flatten)]
    map_options: MapOptions,
    /// Camera settings of the course's renderer (30 numbers) in place of the camera of a .dae scene
    #[arg(short, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// A .ply or .obj mesh in place of the statue of a cornell-statue scene, fitted to its place
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Width of the microfacet distribution of every metal, 0 to 10; below 0.0001 it is a perfect mirror
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    alpha: Option<f32>,
}

/// A scene, ready to render.
pub struct Loaded {
    /// With the changes that flags ask for.
    pub scene: Scene,
    /// Size, samples and depth that the scene asks for.
    pub request: Request,
    /// The map that the scene file names, where no argument does.
    pub map: Option<PathBuf>,
}

impl SceneArgs {
    /// Loads the scene; its camera fits the request's size.
    pub fn load(&self, console: &Console) -> Result<Loaded> {
        if let Some(alpha) = self.alpha.filter(|alpha| !(0.0..=10.0).contains(alpha)) {
            return Err(Error::parameter("alpha", format!("{alpha} is not from 0 to 10")));
        }
        let mut loaded = match self.file() {
            Some(path) => self.imported(path, console)?,
            None => self.builtin(console)?,
        };
        if let Some(alpha) = self.alpha {
            set_alpha(&mut loaded.scene, alpha)?;
        }
        Ok(loaded)
    }

    /// The scene file, if the argument is one by its extension.
    fn file(&self) -> Option<&Path> {
        let path = Path::new(&self.scene);
        let known = |e: &std::ffi::OsStr| SCENE_EXTENSIONS.iter().any(|known| e.eq_ignore_ascii_case(known));
        path.extension().is_some_and(known).then_some(path)
    }

    pub fn has_size(&self) -> bool {
        self.resolution.is_some()
    }

    fn resolution(&self) -> Option<[usize; 2]> {
        <[usize; 2]>::try_from(self.resolution.as_deref()?).ok()
    }

    fn map(&self, name: &OsStr, console: &Console) -> Result<NamedMap> {
        map_file::load(name, self.map_options, console)
    }

    fn imported(&self, path: &Path, console: &Console) -> Result<Loaded> {
        if self.mesh.is_some() {
            return Err(Error::parameter("mesh", "a scene file has no statue to replace")
                .with_hint("it takes the place of the statue in the cornell-statue scenes"));
        }
        let environment = self.envmap.as_deref().map(|name| self.map(name, console)).transpose()?;
        let is_collada = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dae"));
        if let Some(source) = environment.as_ref().filter(|_| is_collada) {
            map_file::warn_upside_down(source, console);
        }
        let options = SceneOptions {
            resolution: self.resolution(),
            camera: self.camera.as_deref(),
            environment: environment.map(|source| (source.map, source.name)),
            allow_ldr: self.map_options.ldr,
        };
        let imported = import::read_scene(path, &options)?;
        imported.warnings.iter().for_each(|warning| console.warn(warning));
        Ok(Loaded { scene: imported.scene, request: imported.request, map: imported.map })
    }

    fn builtin(&self, console: &Console) -> Result<Loaded> {
        let name = &*self.scene.to_string_lossy();
        let Some(entry) = builtin::find(name) else {
            let known: Vec<String> = builtin::scenes().into_iter().map(|scene| scene.name).collect();
            return Err(Error::parameter("scene", format!("\"{name}\" is neither a built-in scene nor a scene file"))
                .with_hint(format!("built-in scenes: {}; files: .pbrt, .dae", known.join(", "))));
        };
        if self.camera.is_some() {
            return Err(Error::parameter("camera", "camera settings are for COLLADA scenes")
                .with_hint("a built-in scene has its own camera"));
        }
        // A mesh in place of the statue
        let mut warnings = Vec::new();
        let mesh = self.mesh.as_deref().map(|path| import::mesh::read(path, &mut warnings)).transpose()?;
        warnings.iter().for_each(|warning| console.warn(warning));
        let mesh = mesh.map(|mut mesh| {
            if mesh.normals.is_empty() {
                mesh.smooth();
            }
            mesh
        });
        // The environment map, for scenes that have one
        let environment = match entry.map_scale() {
            Some(scale) if mesh.is_none() => {
                let source = self.map(self.envmap.as_deref().unwrap_or(OsStr::new("nave")), console)?;
                map_file::warn_upside_down(&source, console);
                Some(Environment::upright(source.map, source.name, scale))
            }
            _ => None,
        };
        let (scene, request) = entry.make(environment, mesh)?;
        if self.envmap.is_some() && entry.map_scale().is_none() {
            return Err(Error::parameter("envmap", format!("the scene {name} has no environment map to replace"))
                .with_hint("maps are for sphere-env, .pbrt and .dae scenes"));
        }
        let (scene, request) = match self.resolution() {
            Some(size) => scene.resized(request, size),
            None => (scene, request),
        };
        Ok(Loaded { scene, request, map: None })
    }
}

/// Gives all metals of a scene the same roughness.
fn set_alpha(scene: &mut Scene, alpha: f32) -> Result<()> {
    let mut found = false;
    for object in &mut scene.objects {
        if let Material::Conductor(metal) = &mut object.material {
            metal.alpha = [alpha; 2];
            found = true;
        }
    }
    if found {
        return Ok(());
    }
    Err(Error::parameter("alpha", format!("the scene {} has no rough metal", scene.name))
        .with_hint("the cornell-statue scenes and furnace have one"))
}
