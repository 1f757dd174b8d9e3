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

mod mitsuba;
mod pbrt;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use crate::files;
use crate::math::Rgb;
use crate::raster::{self, Image, Metadata};
use crate::scene::{Emission, EmitterVisibility, Environment, Mesh, PixelFilter, Request, Scene};
use glam::{Vec2, Vec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FORMATS: [(&str, Format); 2] = [("pbrt", pbrt::text), ("xml", mitsuba::text)];

/// Makes the text of a scene file; meshes and maps go to files of their own.
type Format = fn(&Scene, &Request, &mut Aside) -> Result<String>;

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
            Content::Mesh(mesh) => files::write_bytes(&file, &encode_ply(&mesh))?,
            Content::Map(image) => raster::write(&file, &image, &Metadata::default())?,
        }
        files.push(file);
    }
    files::write_bytes(path, text.as_bytes())?;
    files.push(path.to_path_buf());
    Ok(Exported { files, notes: aside.notes })
}

/// What stands beside a scene file.
struct Aside {
    /// The name of the scene file without its extension.
    pub stem: String,
    /// Its extension: files of different formats stand beside each other.
    extension: String,
    pub files: Vec<(String, Content)>,
    /// Where the other renderer's image has another expectation.
    pub notes: Vec<String>,
}

/// The content of such a file.
enum Content {
    Mesh(Arc<Mesh>),
    Map(Image),
}

impl Aside {
    /// Refuses names that would have to be quoted in a scene file, and what neither format has.
    pub fn new(path: &Path, scene: &Scene) -> Result<Self> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !stem.chars().all(|c| c.is_alphanumeric() || "-_.+".contains(c)) {
            return Err(Error::parameter("export", format!("{} cannot name a scene file", path.display()))
                .with_hint("use letters, digits and -_.+"));
        }
        if !scene.lights.is_empty() {
            return Err(unsupported(scene, "a light without a surface"));
        }
        if scene.camera.filter != PixelFilter::default() {
            return Err(unsupported(scene, "a pixel filter other than the box of one pixel"));
        }
        let only_seen = |e: Emission| e.visibility == EmitterVisibility::CameraOnly;
        if scene.objects.iter().any(|object| object.emission.is_some_and(only_seen)) {
            return Err(unsupported(scene, "a surface that emits light only towards the camera"));
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        Ok(Self { stem, extension, files: Vec::new(), notes: Vec::new() })
    }

    /// The name of the file that holds a mesh.
    pub fn mesh(&mut self, mesh: &Arc<Mesh>) -> String {
        self.add("ply", Content::Mesh(Arc::clone(mesh)))
    }

    /// The name of the file that holds a map.
    pub fn map(&mut self, image: Image) -> String {
        self.add("exr", Content::Map(image))
    }

    fn add(&mut self, extension: &str, content: Content) -> String {
        let name = format!("{}-{}-{}.{extension}", self.stem, self.extension, self.files.len() + 1);
        self.files.push((name.clone(), content));
        name
    }

    /// Adds a note, once.
    pub fn note(&mut self, text: &str) {
        if !self.notes.iter().any(|note| note == text) {
            self.notes.push(text.to_owned());
        }
    }
}

/// What a format lacks.
fn unsupported(scene: &Scene, what: &str) -> Error {
    Error::unsupported(Path::new(&scene.name), format!("{what} cannot be exported in this format"))
}

/// Numbers with `separator` between them, each with as many digits as it takes to read the same number.
fn numbers<T: std::fmt::Display>(values: impl IntoIterator<Item = T>, separator: &str) -> String {
    values.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(separator)
}

/// What the first line of a file says of the environment's map beside it.
fn told_scale(scene: &Scene) -> String {
    let scale = scene.environment.as_ref().map_or(Rgb::ONE, |environment| environment.scale);
    let factor = if scale == Rgb::splat(scale.x) { scale.x.to_string() } else { numbers(scale.to_array(), ", ") };
    if scale == Rgb::ONE { String::new() } else { format!("; the map beside it is the environment map times {factor}") }
}

/// The environment's map with its scale.
fn scaled_map(environment: &Environment) -> Image {
    let geometry = environment.map.geometry();
    Image::from_fn(geometry.width(), geometry.height(), |x, y| environment.radiance_in_texel((x, y)))
}

/// The file of a mesh, with the normals and texture coordinates that it has. Corners with texture coordinates become
/// vertices of their own, as vertices have the coordinates in a PLY file.
fn encode_ply(mesh: &Mesh) -> Vec<u8> {
    let corners: Vec<(u32, Option<Vec2>)> = if mesh.uv.is_empty() {
        (0..mesh.positions.len() as u32).map(|i| (i, None)).collect()
    } else {
        let corners = mesh.triangles.iter().zip(&mesh.uv);
        corners.flat_map(|(triangle, uv)| (0..3).map(move |i| (triangle[i], Some(uv[i])))).collect()
    };
    let split = |i: usize| [0, 1, 2].map(|corner| (3 * i + corner) as u32);
    let triangles = mesh.triangles.iter().enumerate().map(|(i, t)| if mesh.uv.is_empty() { *t } else { split(i) });
    let property = |names: &[&str]| names.iter().map(|name| format!("property float {name}\n")).collect::<String>();
    let properties = [
        property(&["x", "y", "z"]),
        if mesh.normals.is_empty() { String::new() } else { property(&["nx", "ny", "nz"]) },
        if mesh.uv.is_empty() { String::new() } else { property(&["u", "v"]) },
    ];
    let (vertices, faces) = (corners.len(), mesh.triangles.len());
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{}element face {faces}\n\
         property list uchar int vertex_indices\nend_header\n",
        properties.concat()
    )
    .into_bytes();
    for (vertex, uv) in corners {
        let normal = mesh.normals.get(vertex as usize).map(Vec3::to_array);
        let values = mesh.positions[vertex as usize].to_array().into_iter();
        let values = values.chain(normal.into_iter().flatten()).chain(uv.map(|uv| uv.to_array()).into_iter().flatten());
        values.for_each(|value| file.extend(value.to_le_bytes()));
    }
    for triangle in triangles {
        file.push(3);
        triangle.iter().for_each(|i| file.extend(i.to_le_bytes()));
    }
    file
}
