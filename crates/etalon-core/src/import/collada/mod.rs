//! Reads scenes in the COLLADA 1.4 dialect of the rendering course whose renderer the second report used.
//!
//! | element | what becomes of it |
//! |---|---|
//! | `asset/up_axis` | turned so that y is up |
//! | `node` with `matrix`, or `translate`, `rotate`, `scale`; `instance_node` | the product of the transforms |
//! | `camera` | the last one gives direction and field of view; its position follows from the scene's size, as in the course's renderer, unless a settings file gives it |
//! | `light`: `area`, `point`, `directional`, `ambient` | a rectangle; a point without falloff; a direction; the upper hemisphere, itself invisible |
//! | `light`: `spot` | left out with a warning: it is black in the course's renderer |
//! | `effect`: `phong/diffuse`; of the profile `CGL`: `emission`, `mirror`, `refraction`, `glass`, `microfacet` | the same, `microfacet` with Beckmann's distribution |
//! | `geometry`: `sphere` of the profile `CGL`, or the first `polylist` or `triangles` of a mesh | shaded smoothly across all edges; two triangles that make up a rectangle become one |
//!
//! Only lights illuminate; emitting meshes are merely visible. An area light that no emitting mesh overlaps is visible, too.
//!
//! Source: the format's specification (Khronos, COLLADA 1.4.1, 2008), and how the course's renderer reads it.

mod document;
mod geometry;
mod light;
mod material;
mod settings;
mod transform;
mod walk;

pub use transform::WINDOW;

use super::{Imported, SceneOptions};
use crate::error::{Error, Place, Result};
use crate::files::{read_bounded, without_bom};
use crate::scene::{Environment, Request, Scene};
use document::Document;
use std::path::Path;

/// Most bytes in a file.
const MAX_BYTES: u64 = 128 << 20;

/// Reads the scene at `path`. The file asks for no samples or depth: the request has the course renderer's defaults,
/// one of each. The camera fits the request's size only.
///
/// # Errors
/// What is wrong or not supported in the file or in the settings, with its place.
pub fn read(path: &Path, options: &SceneOptions) -> Result<Imported> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = std::str::from_utf8(without_bom(&bytes))
        .map_err(|e| Error::input(path, "not UTF-8").at(Place::Byte(e.valid_up_to() as u64)))?;
    let xml = document::parse(text, path)?;
    let document = Document::new(&xml, path)?;
    let mut found = walk::walk(&document)?;
    let (camera, size) = match options.camera {
        Some(path) => settings::read(path).map(|(camera, window)| (camera, options.resolution.unwrap_or(window)))?,
        None => {
            let size = options.resolution.unwrap_or(transform::WINDOW);
            let view = found.view.as_ref().ok_or_else(|| {
                Error::input(path, "the scene has no camera").with_hint("give a file of camera settings")
            })?;
            let bounds = found.bounds().ok_or_else(|| Error::input(path, "the scene has nothing to look at"))?;
            (view.place(&document, bounds, size)?, size)
        }
    };
    let lights = light::show_area_lights(found.lights, &mut found.objects);
    let environment = options.environment.clone().map(|(map, name)| Environment::upright(map, name, 1.0));
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let scene = Scene { name, camera, objects: found.objects, lights, environment };
    let request = Request { width: size[0], height: size[1], spp: 1, light_samples: 1, max_depth: 1 };
    Ok(Imported { scene, request, output: None, warnings: document.into_warnings() })
}
