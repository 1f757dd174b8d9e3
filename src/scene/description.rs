//! The scene as a whole: camera, objects, lights, environment.

use super::{Camera, EmitterVisibility, Environment, Light, Object, Request};

/// A scene. World space is right-handed with y up; lengths are in the scene's own unit.
#[derive(Debug, Clone)]
pub struct Scene {
    /// What results and messages call it.
    pub name: String,
    /// Position, orientation and projection.
    pub camera: Camera,
    /// What rays can hit.
    pub objects: Vec<Object>,
    /// Lights that are not objects.
    pub lights: Vec<Light>,
    /// The light from infinity, if there is any.
    pub environment: Option<Environment>,
}

impl Scene {
    /// Whether anything lights surfaces. Emission of [`EmitterVisibility::CameraOnly`] does not.
    #[must_use]
    pub fn has_light(&self) -> bool {
        let emits =
            |object: &Object| object.emission.is_some_and(|emission| emission.visibility == EmitterVisibility::Sampled);
        self.environment.is_some() || !self.lights.is_empty() || self.objects.iter().any(emits)
    }

    /// The scene for an image of another size than `request` has; see [`Camera::fitted`].
    #[must_use]
    pub fn resized(self, request: Request, [width, height]: [usize; 2]) -> (Self, Request) {
        let camera = self.camera.fitted([request.width, request.height], [width, height]);
        (Self { camera, ..self }, Request { width, height, ..request })
    }
}
