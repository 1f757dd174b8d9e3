//! What stands beside an exported scene file, and what both formats write alike.

use crate::error::{Error, Result};
use crate::raster::Image;
use crate::scene::{Emission, EmitterVisibility, Environment, Mesh, PixelFilter, Scene};
use std::path::Path;
use std::sync::Arc;

/// What stands beside a scene file.
pub struct Aside {
    /// The name of the scene file without its extension.
    pub stem: String,
    /// Its extension: files of different formats stand beside each other.
    extension: String,
    /// Their names and contents.
    pub files: Vec<(String, Content)>,
    /// Where the other renderer's image has another expectation.
    pub notes: Vec<String>,
}

/// The content of such a file.
pub enum Content {
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
pub fn unsupported(scene: &Scene, what: &str) -> Error {
    Error::unsupported(Path::new(&scene.name), format!("{what} cannot be exported in this format"))
}

/// Numbers with `separator` between them, each with as many digits as it takes to read the same number.
pub fn numbers<T: std::fmt::Display>(values: impl IntoIterator<Item = T>, separator: &str) -> String {
    values.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(separator)
}

/// The environment's map with its scale.
pub fn scaled_map(environment: &Environment) -> Image {
    let geometry = environment.map.geometry();
    Image::from_fn(geometry.width(), geometry.height(), |x, y| environment.radiance_in_texel((x, y)))
}
