//! Files and programs of others: scene and mesh files, read as a [`Scene`](crate::scene::Scene) and a
//! [`Request`](crate::scene::Request); external samplers to be tested.

pub mod collada;
mod imported;
pub mod mesh;
pub(crate) mod number;
pub mod pbrt;
mod place;
pub mod sampler;
mod shape;
mod transform;

pub use imported::Imported;

use crate::envmap::EnvMap;
use crate::error::{Error, Result};
use crate::raster;
use crate::scene::Environment;
use collada::ColladaOptions;
use pbrt::PbrtOptions;
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

/// Extensions of the scene files that [`read_scene`] knows.
pub const SCENE_EXTENSIONS: [&str; 2] = ["pbrt", "dae"];

/// Options of [`read_scene`].
#[derive(Clone, Default)]
pub struct SceneOptions<'a> {
    /// Width and height of the image; without it, what the file asks for.
    pub resolution: Option<[usize; 2]>,
    /// A file of camera settings in place of the scene's own camera; COLLADA only.
    pub camera: Option<&'a Path>,
    /// A map, and what it is called: in place of the one that a pbrt file names, or with the lights of a COLLADA file, its
    /// zenith along +y of the world.
    pub environment: Option<(Arc<EnvMap>, String)>,
    /// Whether the file's own map may have 8 bits.
    pub allow_ldr: bool,
}

/// Reads the scene at `path`, whose extension (`.pbrt` or `.dae`) selects the format. The camera fits the request's size.
///
/// # Errors
/// Those of [`pbrt::read`] and [`collada::read`]; [`Error::Unsupported`] for another extension;
/// [`Error::Parameter`] for an option that the format has no use for.
pub fn read_scene(path: &Path, options: SceneOptions) -> Result<Imported> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let mut imported = match extension.to_str() {
        Some("pbrt") => {
            if options.camera.is_some() {
                return Err(Error::parameter("camera", "camera settings are for COLLADA scenes")
                    .with_hint("a .pbrt file has its camera in itself"));
            }
            let ldr = raster::ReadOptions { allow_ldr: options.allow_ldr };
            let (named, notes) = (RefCell::new(None), RefCell::new(Vec::new()));
            let load_map = |map: &Path| {
                let (image, said) = raster::read_lat_long(map, ldr)
                    .map_err(|e| e.with_hint("`environment` stands in for the map that the scene names"))?;
                notes.borrow_mut().extend(said);
                named.replace(Some(map.to_owned()));
                Ok(image)
            };
            let mut imported =
                pbrt::read(path, &PbrtOptions { environment: options.environment, load_map: &load_map })?;
            imported.warnings.extend(notes.take());
            imported.map = named.take();
            match options.resolution {
                Some(size) => {
                    let (scene, request) = imported.scene.resized(imported.request, size);
                    Imported { scene, request, ..imported }
                }
                None => imported,
            }
        }
        Some("dae") => {
            let settings = ColladaOptions { resolution: options.resolution, settings: options.camera };
            let mut imported = collada::read(path, &settings)?;
            imported.scene.environment = options.environment.map(|(map, name)| Environment::upright(map, name, 1.0));
            imported
        }
        _ => return Err(Error::unsupported(path, "not a scene file that is known").with_hint("supported: .pbrt, .dae")),
    };
    if !imported.scene.has_light() {
        let message = "no light source: the image is black but for surfaces that emit light themselves";
        imported.warnings.push(format!("{}: {message}", path.display()));
    }
    Ok(imported)
}
