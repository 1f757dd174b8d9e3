//! Faults in how an image is put together from its paths, which no render by itself can have.

use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{Projection, Request, Scene};
use etalon_render::film::{Film, Pixel, PixelEstimate};
use etalon_render::{Settings, Silent, render};

/// A fault in how an image is put together.
#[derive(Debug, Clone, Copy)]
pub enum Plant {
    /// Camera paths and light paths are weighted against others than these.
    Split(Split),
    /// The sum of a pixel's paths is divided by the mean number of paths, not by its own.
    MeanNumber,
}

impl Plant {
    /// The first channel of the image of `film` with the fault.
    pub fn image(&self, film: &Film, scene: &Scene, request: &Request, seed: u64) -> Result<Vec<f64>> {
        match self {
            Self::Split(split) => split.with_light_paths_of(film, scene, request, seed),
            Self::MeanNumber => {
                let paths: Vec<f64> = film.pixels().iter().map(|pixel| f64::from(pixel.camera_paths())).collect();
                let mean = paths.iter().sum::<f64>() / paths.len() as f64;
                let sum = |(pixel, paths): (&Rgb, f64)| f64::from(pixel.x) * paths / mean;
                Ok(film.image().pixels().iter().zip(paths).map(sum).collect())
            }
        }
    }
}

/// Camera paths from another render than light paths: each render alone weights both consistently.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// Settings of the camera paths.
    pub settings: Settings,
    /// Light samples of the camera paths.
    pub light_samples: u32,
    /// Width of their film over that of the image, which is in its middle.
    pub widths: usize,
    /// Factor on the contributions of light paths.
    pub factor: f64,
}

impl Split {
    /// The first channel of another render of the scene, with the light paths of `film`.
    fn with_light_paths_of(&self, film: &Film, scene: &Scene, request: &Request, seed: u64) -> Result<Vec<f64>> {
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
