//! Tells whether two renders have the same samples, so that only such are merged.

use super::settings::Settings;
use etalon_core::build::Build;
use etalon_core::math::hash_words;
use etalon_core::scene::{Request, Scene, Shape};

/// A hash of all that a sample depends on: this build of the program, the scene to the last bit, the settings, and of the request all but the
/// number of samples.
pub fn of(scene: &Scene, request: &Request, settings: &Settings) -> String {
    let mut hash = Hash(0);
    hash.text(&Build::current().id());
    // What was left out changes no sample.
    let settings = Settings { general: false, ..*settings };
    let request = Request { spp: 0, ..*request };
    hash.text(&format!("{settings:?} {request:?} {:?} {:?}", scene.camera, scene.lights));
    for object in &scene.objects {
        // Texels print a hash of themselves.
        hash.text(&format!("{:?} {:?} {:?}", object.material, object.emission, object.axis));
        if object.material.is_textured() {
            hash.text(&format!("{:?}", object.meridians));
        }
        match &object.shape {
            Shape::Mesh(mesh) => {
                hash.words(mesh.positions.iter().chain(&mesh.normals).flat_map(|v| v.to_array().map(f32::to_bits)));
                hash.words(mesh.triangles.iter().flatten().copied());
                hash.words(mesh.uv.iter().flatten().flat_map(|uv| uv.to_array().map(f32::to_bits)));
            }
            other => hash.text(&format!("{other:?}")),
        }
    }
    if let Some(environment) = &scene.environment {
        hash.text(&format!("{:?} {:?} {:?}", environment.scale, environment.to_world, environment.map.hash()));
    }
    format!("{:016x}", hash.0)
}

struct Hash(u64);

impl Hash {
    fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        self.0 = hash_words(self.0, words);
    }

    fn text(&mut self, text: &str) {
        self.words(text.bytes().map(u32::from));
    }
}
