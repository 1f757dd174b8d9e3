//! The scene of a command: a built-in one or a file, with the changes that flags ask for.

use super::console::Console;
use super::global::SCENE;
use super::map_file::{self, MapOptions};
use super::values::filter;
use clap::{ArgAction, Args};
use etalon_core::error::{Error, Result};
use etalon_core::import::{self, SCENE_EXTENSIONS, SceneOptions, collada};
use etalon_core::memory;
use etalon_core::scene::{Environment, Material, Mesh, PixelFilter, Request, Scene, builtin};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The scene and its changes.
#[derive(Args)]
#[command(next_help_heading = SCENE)]
pub struct SceneArgs {
    /// A built-in scene (`etalon scenes` lists them), or a .pbrt or .dae file
    #[arg(help_heading = None::<&str>, required = true)]
    scene: Option<OsString>,
    /// Width and height in pixels [default: the scene's]
    ///
    /// `etalon scenes` lists the sizes of built-in scenes. In a .dae scene they also set the field of view, as in the course's
    /// renderer: a pixel keeps its angle (that of an image of 800 by 600 with the file's field of view), so a smaller image
    /// shows less, unless --fit is given. All other scenes keep their field of view.
    #[arg(short, long = "size", num_args = 2, value_names = ["W", "H"], action = ArgAction::Set)]
    resolution: Option<Vec<usize>>,
    /// Show all of a .dae scene's view at the size that -r gives
    #[arg(long)]
    fit: bool,
    /// Environment map, a file or a built-in name [default: the scene's]
    #[arg(long, value_name = "MAP", long_help = envmap_help())]
    envmap: Option<OsString>,
    #[command(flatten)]
    map_options: MapOptions,
    /// Camera settings in place of a .dae scene's camera
    ///
    /// The 30 numbers of the course's renderer.
    #[arg(short, long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Pixel filter: box, triangle or gaussian [default: the file's or box]
    ///
    /// NAME[:RADIUS[,SIGMA]]: RADIUS is in pixels, or RXxRY for one along x and another along y (triangle:2x1); SIGMA is a Gaussian's. Without them
    /// box:0.5, triangle:2, gaussian:1.5,0.5, as in pbrt-v4.
    #[arg(long, value_name = "FILTER", value_parser = filter)]
    filter: Option<PixelFilter>,
    /// A .ply or .obj mesh in place of the statue of cornell-statue-*
    ///
    /// It is scaled to fit.
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Microfacet width α of all metal and glass, 0 to 10 [default: the scene's]
    ///
    /// The width alpha of the microfacet distribution; below 0.0001 the surface is smooth. Two widths, with a comma between
    /// them: along the surface's tangent and across it.
    #[arg(long, value_name = "A,...", value_delimiter = ',', action = ArgAction::Set, allow_negative_numbers = true)]
    alpha: Option<Vec<f32>>,
    /// Rough metal also reflects light that meets several facets
    #[arg(long)]
    multiple_scattering: bool,
}

/// A scene, ready to render.
pub struct Loaded {
    /// With the changes that flags ask for.
    pub scene: Scene,
    /// Size, samples and depth that the scene asks for.
    pub request: Request,
}

fn is_collada(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dae"))
}

/// Says so if an image of this size crops the view of a COLLADA scene.
fn note_crop([width, height]: [usize; 2], console: &Console) {
    let [all_width, all_height] = collada::WINDOW;
    if width < all_width || height < all_height {
        console.note(&format!(
            "{width}x{height} pixels show the middle of a view of {all_width}x{all_height}, as in the course's renderer; with --fit, all of it"
        ));
    }
}

fn envmap_help() -> String {
    format!(
        "Environment map, a file or a built-in name [default: the scene's]\n\nBuilt-in scenes that have one have nave, and multiply its \
         radiance, and that of a map in its place: {}. It takes the place of the map of a built-in scene that has one or of a .pbrt file. \
         To a .dae scene it is added; row 0 is at +y, the file's up axis.",
        builtin::map_scales()
    )
}

impl SceneArgs {
    /// A built-in scene as it is, under its own map or another.
    pub fn built_in(scene: OsString, envmap: Option<OsString>, map_options: MapOptions) -> Self {
        let (resolution, camera, mesh, alpha, filter) = (None, None, None, None, None);
        let (fit, multiple_scattering) = (false, false);
        Self {
            scene: Some(scene),
            resolution,
            fit,
            envmap,
            map_options,
            camera,
            mesh,
            alpha,
            filter,
            multiple_scattering,
        }
    }

    /// Loads the scene; its camera fits the request's size.
    pub fn load(&self, console: &Console) -> Result<Loaded> {
        if self.fit && !(self.file().is_some_and(is_collada) && self.resolution.is_some()) {
            return Err(Error::parameter("fit", "it is for a .dae scene and the size that `resolution` gives")
                .with_hint("all other scenes show all of their view at every size"));
        }
        let alpha = self.alpha.as_deref().map(widths).transpose()?;
        let mut loaded = match self.file() {
            Some(path) => self.imported(path, console)?,
            None => self.builtin(console)?,
        };
        if let Some(filter) = self.filter {
            loaded.scene.camera.filter = filter;
        }
        if let Some(alpha) = alpha {
            change(&mut loaded.scene, "alpha", "metal or glass", |material| {
                match material {
                    Material::Conductor(metal) => metal.alpha = alpha,
                    Material::Dielectric(glass) => glass.alpha = alpha,
                    _ => return false,
                }
                true
            })?;
        }
        if self.multiple_scattering {
            change(&mut loaded.scene, "multiple_scattering", "metal", |material| {
                let Material::Conductor(metal) = material else { return false };
                metal.multiple_scattering = true;
                true
            })?;
        }
        Ok(loaded)
    }

    /// Whether there is a scene; a command may do without.
    pub fn is_given(&self) -> bool {
        self.scene.is_some()
    }

    /// Without a scene: the size that is asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for anything else that is asked of a scene.
    pub fn size_alone(&self) -> Result<Option<[usize; 2]>> {
        let size = self.resolution();
        let Self { fit, envmap, camera, filter, mesh, alpha, multiple_scattering, .. } = self;
        let changes = [
            ("fit", *fit),
            ("envmap", envmap.is_some()),
            ("camera", camera.is_some()),
            ("filter", filter.is_some()),
            ("mesh", mesh.is_some()),
            ("alpha", alpha.is_some()),
            ("multiple_scattering", *multiple_scattering),
        ];
        match changes.into_iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => Err(Error::parameter(name, "it changes a scene, and none is given")),
            None => self.map_options.check_unused().map(|()| size),
        }
    }

    /// The scene file, if the argument is one by its extension.
    pub fn file(&self) -> Option<&Path> {
        let path = Path::new(self.scene.as_deref()?);
        let known = |e: &std::ffi::OsStr| SCENE_EXTENSIONS.iter().any(|known| e.eq_ignore_ascii_case(known));
        path.extension().is_some_and(known).then_some(path)
    }

    /// Whether rough metal has multiple scattering.
    pub fn has_multiple_scattering(&self) -> bool {
        self.multiple_scattering
    }

    pub fn has_size(&self) -> bool {
        self.resolution.is_some()
    }

    fn resolution(&self) -> Option<[usize; 2]> {
        <[usize; 2]>::try_from(self.resolution.as_deref()?).ok()
    }

    fn imported(&self, path: &Path, console: &Console) -> Result<Loaded> {
        if self.mesh.is_some() {
            return Err(Error::parameter("mesh", "a scene file has no statue to replace")
                .with_hint("it takes the place of the statue in the cornell-statue scenes"));
        }
        // A .pbrt file says how its map stands: the given one takes its place as it is stored.
        let is_collada = is_collada(path);
        let load = if is_collada { map_file::load } else { map_file::load_as_stored };
        let environment = self.envmap.as_deref().map(|name| load(name, self.map_options, console)).transpose()?;
        // `allow_ldr` is also for the map that the file names.
        if environment.is_none() {
            MapOptions { ldr: false, ..self.map_options }.check_unused()?;
        }
        let resolution = self.resolution();
        let options = SceneOptions {
            resolution: if self.fit { None } else { resolution },
            camera: self.camera.as_deref(),
            environment: environment.map(|source| (source.map, source.name)),
            allow_ldr: self.map_options.ldr,
        };
        let imported = import::read_scene(path, &options)?;
        imported.warnings.iter().for_each(|warning| console.warn(warning));
        let (scene, request) = match resolution {
            Some(size) if self.fit => imported.scene.resized(imported.request, size),
            _ => (imported.scene, imported.request),
        };
        if is_collada && !self.fit && self.camera.is_none() {
            note_crop([request.width, request.height], console);
        }
        Ok(Loaded { scene, request })
    }

    fn builtin(&self, console: &Console) -> Result<Loaded> {
        let name = &*self.scene.as_deref().unwrap_or_default().to_string_lossy();
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
        let mesh = self.mesh.as_deref().map(|path| read_mesh(path, console)).transpose()?;
        // The environment map, for scenes that have one
        let environment = match entry.map_scale() {
            Some(scale) if mesh.is_none() => {
                let name = self.envmap.as_deref().unwrap_or(OsStr::new("nave"));
                let source = map_file::load(name, self.map_options, console)?;
                Some(Environment::upright(source.map, source.name, scale))
            }
            _ => None,
        };
        if environment.is_none() && self.envmap.is_none() {
            self.map_options.check_unused()?;
        }
        let made = entry.make(environment, mesh);
        let (scene, request) = match &self.mesh {
            Some(path) if entry.takes_mesh() => made.map_err(|e| e.in_file(path))?,
            _ => made?,
        };
        if self.envmap.is_some() && entry.map_scale().is_none() {
            return Err(Error::parameter("envmap", format!("the scene {name} has no environment map to replace"))
                .with_hint("maps are for sphere-env, .pbrt and .dae scenes"));
        }
        let (scene, request) = match self.resolution() {
            Some(size) => scene.resized(request, size),
            None => (scene, request),
        };
        Ok(Loaded { scene, request })
    }
}

/// A mesh with normals.
fn read_mesh(path: &Path, console: &Console) -> Result<Mesh> {
    let mut warnings = Vec::new();
    let mut mesh = import::mesh::read(path, &mut warnings)?;
    warnings.iter().for_each(|warning| console.warn(warning));
    if mesh.normals.is_empty() {
        memory::grow(size_of_val(&mesh.positions[..]), || path.display().to_string())?;
        mesh.smooth();
    }
    Ok(mesh)
}

/// Whether a surface of the scene has a material for which `is_kind` holds, alone or in a mixture.
pub fn has_material(scene: &Scene, is_kind: impl Fn(&Material) -> bool + Copy) -> bool {
    fn has(material: &Material, is_kind: impl Fn(&Material) -> bool + Copy) -> bool {
        match material {
            Material::Mixture(parts) => parts.iter().any(|(_, part)| has(part, is_kind)),
            Material::Textured(textured) => has(&textured.base, is_kind),
            plain => is_kind(plain),
        }
    }
    scene.objects.iter().any(|object| has(&object.material, is_kind))
}

pub fn is_metal(material: &Material) -> bool {
    matches!(material, Material::Conductor(_))
}

pub fn is_glass(material: &Material) -> bool {
    matches!(material, Material::Dielectric(_))
}

/// The options of `render` that this built-in scene accepts and others refuse.
pub fn accepted(entry: &builtin::BuiltIn, scene: &Scene) -> Vec<&'static str> {
    let (metal, glass) = (has_material(scene, is_metal), has_material(scene, is_glass));
    let options = [
        (scene.environment.is_some(), "--light-density"),
        (entry.map_scale().is_some(), "--envmap"),
        (entry.takes_mesh(), "--mesh"),
        (metal || glass, "--alpha"),
        (metal, "--normals --multiple-scattering"),
        (glass, "--fresnel"),
    ];
    options.into_iter().filter(|(accepts, _)| *accepts).map(|(_, option)| option).collect()
}

/// The widths of a distribution of normals along x and y.
fn widths(values: &[f32]) -> Result<[f32; 2]> {
    if let Some(bad) = values.iter().find(|alpha| !(0.0..=10.0).contains(*alpha)) {
        return Err(Error::parameter("alpha", format!("{bad} is not from 0 to 10")));
    }
    match *values {
        [both] => Ok([both; 2]),
        [x, y] => Ok([x, y]),
        _ => Err(Error::parameter("alpha", format!("{} widths: at most two are needed", values.len()))),
    }
}

/// Changes the materials of a scene, those inside mixtures, too. `set` returns whether it changed one; an error if it
/// changed none.
fn change(scene: &mut Scene, parameter: &str, what: &str, set: impl Fn(&mut Material) -> bool + Copy) -> Result<()> {
    fn count(material: &mut Material, set: impl Fn(&mut Material) -> bool + Copy) -> usize {
        match material {
            Material::Mixture(parts) => Arc::make_mut(parts).iter_mut().map(|(_, part)| count(part, set)).sum(),
            Material::Textured(textured) => count(&mut Arc::make_mut(textured).base, set),
            plain => usize::from(set(plain)),
        }
    }
    if scene.objects.iter().any(|object| object.material.has_textured_alpha()) {
        return Err(Error::parameter(
            parameter,
            format!("a texture sets the roughness of a surface in {}", scene.name),
        ));
    }
    let changed: usize = scene.objects.iter_mut().map(|object| count(&mut object.material, set)).sum();
    if changed > 0 {
        return Ok(());
    }
    Err(Error::parameter(parameter, format!("the scene {} has no {what}", scene.name))
        .with_hint("furnace has both, the cornell-statue scenes and brushed-metal have metal"))
}
