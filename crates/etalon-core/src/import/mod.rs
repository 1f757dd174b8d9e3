//! Scene and mesh files of other programs, read as a [`Scene`](crate::scene::Scene) and a [`Request`](crate::scene::Request).

pub mod collada;
mod imported;
pub mod mesh;
pub mod number;
pub mod pbrt;
pub mod place;
mod shape;
mod transform;

pub use imported::{Imported, SceneOptions};

use crate::error::{Error, Result};
use std::path::Path;

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
