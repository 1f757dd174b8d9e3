//! What every reader of scene files takes and returns.

use crate::envmap::EnvMap;
use crate::scene::{Request, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most warnings about a scene, without the one that more are left out.
pub(super) const MAX_WARNINGS: usize = 100;

/// The warning after [`MAX_WARNINGS`].
pub(super) fn further_warnings(path: &Path) -> String {
    format!("{}: further warnings are left out", path.display())
}

/// Options of [`read_scene`](super::read_scene).
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
    /// What the file describes.
    pub scene: Scene,
    /// Image size and sampling that it asks for, defaults filled in.
    pub request: Request,
    /// The image file that the scene names.
    pub output: Option<PathBuf>,
    /// What was left out or filled in without an effect on the image, each with its place, in the file's order.
    pub warnings: Vec<String>,
}
