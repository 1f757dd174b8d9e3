//! Images whose camera paths and light paths come from different renders, which plants faults in the weights that combine
//! them: each render alone weights both consistently.

use crate::error::Result;
use crate::render::film::{Film, Pixel, PixelEstimate};
use crate::render::{Settings, Silent, render};
use crate::sampling::stream::StreamKind;
use crate::scene::{Projection, Request, Scene};

/// Camera paths from another render than light paths.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// Of the camera paths.
    pub settings: Settings,
    /// Of the camera paths.
    pub light_samples: u32,
    /// Their film is so many times as wide as the image, which is in its middle.
    pub widths: usize,
    /// Factor on the contributions of light paths.
    pub factor: f64,
}

impl Split {
    /// The first channel of another render of the scene, with the light paths of `film`.
    pub fn with_light_paths_of(&self, film: &Film, scene: &Scene, request: &Request, seed: u64) -> Result<Vec<f64>> {
        let (width, wide) = (request.width, request.width * self.widths);
        let mut scene = scene.clone();
        if let Projection::Perspective { tan_half_width, .. } = &mut scene.camera.projection {
            *tan_half_width *= self.widths as f64;
        }
        let settings = Settings { seed, stream: StreamKind::Independent, ..self.settings };
        let request = Request { width: wide, light_samples: self.light_samples, ..*request };
        let camera = render(&scene, &request, &settings, &Silent)?.part.film;
        let sum = |(i, (pixel, estimate)): (usize, (&Pixel, PixelEstimate))| {
            let seen = &camera.pixels()[i / width * wide + (wide - width) / 2 + i % width];
            f64::from(seen.mean().x) + self.factor * f64::from(estimate.mean.x - pixel.mean().x)
        };
        Ok(film.pixels().iter().zip(film.estimates()).enumerate().map(sum).collect())
    }
}
