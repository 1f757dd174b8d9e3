//! Scene and mesh files of other programs, read as a [`Scene`] and a [`Request`].

pub mod collada;
pub mod mesh;
pub mod pbrt;
pub mod place;
mod shape;
mod transform;

use crate::envmap::EnvMap;
use crate::error::{Error, Result};
use crate::scene::{Request, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Extensions of the scene files that [`read_scene`] knows.
pub const SCENE_EXTENSIONS: [&str; 2] = ["pbrt", "dae"];

/// Reads the scene at `path`, whose extension (`.pbrt` or `.dae`) selects the format. The camera fits the request's size. A scene
/// far from the origin is moved there: [`Scene::near_origin`](crate::scene::Scene::near_origin).
///
/// # Errors
/// Those of [`pbrt::read`] and [`collada::read`]; [`Error::Unsupported`] for another extension.
pub fn read_scene(path: &Path, options: &SceneOptions) -> Result<Imported> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let mut imported = match extension.to_str() {
        Some("pbrt") => pbrt::read(path, options)?,
        Some("dae") => collada::read(path, options)?,
        _ => return Err(Error::unsupported(path, "not a scene file that is known").with_hint("supported: .pbrt, .dae")),
    };
    imported.scene = imported.scene.near_origin();
    if !imported.scene.has_light() {
        let message = "no light source: the image is black but for surfaces that emit light themselves";
        imported.warnings.push(format!("{}: {message}", path.display()));
    }
    Ok(imported)
}

/// Most warnings about a scene, without the one that more are left out.
const MAX_WARNINGS: usize = 100;

/// The warning after [`MAX_WARNINGS`].
fn further_warnings(path: &Path) -> String {
    format!("{}: further warnings are left out", path.display())
}

#[derive(Clone, Default)]
pub struct SceneOptions<'a> {
    /// Width and height of the image; without it, what the file asks for.
    pub resolution: Option<[usize; 2]>,
    /// A file of camera settings in place of the scene's own camera; COLLADA only.
    pub camera: Option<&'a Path>,
    /// A map, and what it is called: in place of the one that a pbrt file names, which is then not opened, or with the
    /// lights of a COLLADA file, its zenith along +y of the world.
    pub environment: Option<(Arc<EnvMap>, String)>,
    /// Whether the file's own map may have 8 bits.
    pub allow_ldr: bool,
}

/// The content of a scene file.
#[derive(Debug, Clone)]
pub struct Imported {
    pub scene: Scene,
    /// Image size and sampling that it asks for, defaults filled in.
    pub request: Request,
    /// The image file that the scene names.
    pub output: Option<PathBuf>,
    /// What was left out or filled in without an effect on the image, each with its place, in the file's order.
    pub warnings: Vec<String>,
}
