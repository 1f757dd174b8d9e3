//! Rendering: the integrator, what of it a scene needs, and the film.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod casters;
mod cut_lights;
mod diffuse;
mod direct;
pub mod exposure;
mod faces;
mod fingerprint;
mod geometry;
mod integrator;
mod job;
mod lanes;
mod lens;
mod light_tracing;
pub(crate) mod lights;
mod needs;
mod numbers;
mod rough;
mod shine;
mod solids;
mod strategies;
mod wide;
mod workspace;

pub use exposure::Dropped;
pub use job::{Control, Job, Silent};

use crate::envmap::samplers::MapSampling;
use crate::error::{Error, Result};
use crate::raster::{Image, Metadata};
use crate::sampling::stream::StreamKind;
use crate::scene::scattering::ScatterModel;
use crate::scene::{Request, Scene};
use exposure::Part;

/// How directions towards the light are chosen at a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// By the light's own density.
    Light,
    /// By the material's density.
    Bsdf,
    /// By both, combined by multiple importance sampling, as far as both are of use: at a diffuse surface a lamp's
    /// solid angle, or the environment's radiance × cosine, leaves nothing to the material's directions but noise. Caustics
    /// on what the camera sees are brought by paths from the lamps (`light_tracing.rs`).
    #[default]
    Mis,
    /// Uniformly over the hemisphere.
    Hemisphere,
}

impl Sampling {
    /// Whether light is looked for where the lights are; otherwise rays in search of it find it by chance.
    #[must_use]
    pub fn by_light(self) -> bool {
        matches!(self, Self::Light | Self::Mis)
    }
}

/// How to render, besides what the [`Request`] says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    pub sampling: Sampling,
    pub stream: StreamKind,
    pub seed: u64,
    /// How the environment map is sampled.
    pub density: MapSampling,
    /// What light does at surfaces and on its way.
    pub model: ScatterModel,
    /// Keep the light apart by the class of its path, up to this many scatterings.
    pub paths: Option<u32>,
    /// Leave caustics to camera paths, too: every sample then belongs to its pixel alone, and some rows of a picture can be
    /// rendered without the others.
    pub camera_paths_only: bool,
    /// Run the kernel with nothing left out, for comparison.
    pub general: bool,
}

/// A finished picture and how it came about.
#[derive(Debug, Clone)]
pub struct Rendered {
    pub image: Image,
    /// The film: every pixel's samples, their standard error, and the light by path class.
    pub part: Part,
    pub request: Request,
    /// Wall-clock time of preparation and rendering, without reading or writing files.
    pub seconds: f64,
    pub dropped: Dropped,
    /// What the scene did not need and the kernel hence does not have.
    pub left_out: Vec<&'static str>,
}

/// Renders a scene on rayon's current thread pool.
///
/// The picture depends on the scene, the request and the settings alone, to the last bit: not on the number of
/// threads, and not on what was left out.
///
/// # Errors
/// [`Error::Parameter`] for an impossible request and for settings that exclude each other, [`Error::Interrupted`] if
/// `control` stopped it.
pub fn render(scene: &Scene, request: &Request, settings: &Settings, control: &dyn Control) -> Result<Rendered> {
    let job = Job::new(scene, request, settings)?;
    let mut part = job.part(Metadata::default())?;
    job.run(&mut part, 0..request.spp, control);
    if !part.is_complete() {
        return Err(Error::Interrupted);
    }
    Ok(Rendered {
        image: part.exposure.image(),
        dropped: part.exposure.dropped(),
        part,
        request: *request,
        seconds: job.seconds(),
        left_out: job.left_out(),
    })
}

/// Most light samples at a hit, and most scatterings.
const MOST: u32 = 1 << 16;

fn check(request: &Request) -> Result<()> {
    let Request { width, height, spp, light_samples, max_depth } = *request;
    if width == 0 || height == 0 {
        return Err(Error::parameter("width", format!("cannot render {width}x{height} pixels"))
            .with_hint("at least 1x1 pixels"));
    }
    if spp == 0 || light_samples == 0 {
        return Err(Error::parameter(if spp == 0 { "spp" } else { "light_samples" }, "must be at least 1"));
    }
    if u64::from(spp) * u64::from(light_samples) > 1 << 32 {
        return Err(Error::parameter(
            "spp",
            format!("{spp} samples with {light_samples} light samples each are too many"),
        )
        .with_hint("the random sequences repeat after 2^32 draws per pixel"));
    }
    for (name, value) in [("light_samples", light_samples), ("max_depth", max_depth)] {
        if value > MOST {
            return Err(Error::parameter(name, format!("{value} is too large")).with_hint(format!("at most {MOST}")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
