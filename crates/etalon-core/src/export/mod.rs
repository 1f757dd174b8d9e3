//! Scenes as files of other renderers, so that they can render what this one renders: pbrt-v4 and Mitsuba 3.
//!
//! | | pbrt-v4 (`.pbrt`) | Mitsuba 3 (`.xml`) |
//! |---|---|---|
//! | camera, box filter, depth, samples | all | all |
//! | shapes | all; meshes as PLY files | all; meshes as PLY files |
//! | diffuse, smooth glass without colour, thin slabs of it | yes | yes |
//! | mirror | of reflectance 1 | yes |
//! | conductor | GGX, on both sides or on a sphere | yes, rough ones with separable masking |
//! | area lights | yes | yes |
//! | environment map | resampled to a square equal-area map | resampled so that bilinear interpolation keeps its irradiance |
//!
//! All else is refused by name. What another renderer computes differently is a note.

mod aside;
mod mitsuba;
mod pbrt;
mod ply;

use crate::error::{Error, Result};
use crate::files;
use crate::raster::{self, Metadata};
use crate::scene::{Request, Scene};
use aside::{Aside, Content};
use std::path::{Path, PathBuf};

/// The formats by their extensions.
const FORMATS: [(&str, Format); 2] = [("pbrt", pbrt::text), ("xml", mitsuba::text)];

/// Makes the text of a scene file; meshes and maps go to files of their own.
type Format = fn(&Scene, &Request, &mut Aside) -> Result<String>;

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The scene file last, after those that it names.
    pub files: Vec<PathBuf>,
    /// Where the other renderer's image has another expectation.
    pub notes: Vec<String>,
}

/// Writes the scene to `path`, whose extension selects the format, with its meshes and its map in files beside it.
///
/// # Errors
/// [`Error::Parameter`] for an unknown extension; [`Error::Unsupported`] for what the format does not have; [`Error::Io`].
pub fn write(path: &Path, scene: &Scene, request: &Request) -> Result<Exported> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let Some((_, text)) = FORMATS.iter().find(|(known, _)| extension == *known) else {
        return Err(Error::parameter("export", format!("no scene format has the extension of {}", path.display()))
            .with_hint("known extensions: .pbrt (pbrt-v4), .xml (Mitsuba 3)"));
    };
    let mut aside = Aside::new(path, scene)?;
    let text = text(scene, request, &mut aside)?;
    // The scene file comes last: when it exists, so do the files that it names.
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    for (name, content) in aside.files {
        let file = folder.join(name);
        match content {
            Content::Mesh(mesh) => files::write_bytes(&file, &ply::encode(&mesh))?,
            Content::Map(image) => raster::write(&file, &image, &Metadata::default())?,
        }
        files.push(file);
    }
    files::write_bytes(path, text.as_bytes())?;
    files.push(path.to_path_buf());
    Ok(Exported { files, notes: aside.notes })
}

#[cfg(test)]
mod tests;
