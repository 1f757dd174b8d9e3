//! What can be chosen about a render: sampling, random numbers, conventions; and what is checked of a request.

use crate::envmap::samplers::MapSampling;
use crate::error::{Error, Result};
use crate::sampling::stream::StreamKind;
use crate::scene::Request;
use crate::scene::scattering::ScatterModel;

/// How directions towards the light are chosen at a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Light samples: the solid angle of area lights, the density of the environment's sampler.
    Light,
    /// BSDF samples.
    Bsdf,
    /// By both, combined by multiple importance sampling, as far as both are of use: at a diffuse surface the solid angle of
    /// an area light, or the environment's radiance × cosine, makes BSDF samples useless.
    /// Caustics on what the camera sees come from light tracing (`light_tracing/`).
    #[default]
    Mis,
    /// Uniformly over the hemisphere.
    Hemisphere,
}

impl Sampling {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Light, Self::Bsdf, Self::Mis, Self::Hemisphere];

    /// Its name at the command line and in metadata.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Bsdf => "bsdf",
            Self::Mis => "mis",
            Self::Hemisphere => "hemisphere",
        }
    }

    /// What it does, in a line.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Light => "by the lights: their solid angles, the environment's radiance",
            Self::Bsdf => "by the material",
            Self::Mis => "by both, combined by multiple importance sampling; caustics by light tracing",
            Self::Hemisphere => "uniformly over the hemisphere",
        }
    }

    /// Whether lights are sampled; otherwise only sampled directions that hit emitters find light.
    #[must_use]
    pub fn by_light(self) -> bool {
        matches!(self, Self::Light | Self::Mis)
    }
}

/// How to render, besides what the [`Request`] says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    /// How directions towards the light are chosen.
    pub sampling: Sampling,
    /// Where random numbers come from.
    pub stream: StreamKind,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How the environment map is sampled.
    pub density: MapSampling,
    /// Models of scattering, and conventions.
    pub model: ScatterModel,
    /// Separate the light by path class, up to this many scatterings.
    pub paths: Option<u32>,
    /// No light tracing: every sample then contributes to its own pixel only, and rows of an image can be rendered
    /// separately.
    pub camera_paths_only: bool,
    /// Run the kernel with nothing left out, for comparison.
    pub general: bool,
}

/// Most light samples at a hit, and most scatterings.
const MOST: u32 = 1 << 16;

/// Refuses a request that cannot be rendered.
///
/// # Errors
/// [`Error::Parameter`] with the name of the field.
pub fn check(request: &Request) -> Result<()> {
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
