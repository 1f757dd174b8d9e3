//! What can be chosen about a render: sampling, random numbers, models; and what is checked of a request.

use super::film::PathClasses;
use etalon_core::envmap::samplers::MapSampling;
use etalon_core::error::{Error, Result};
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::Request;
use etalon_core::scene::scattering::ScatterModel;

/// Which techniques find the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Light sampling (next event estimation): by the solid angle of area lights and the pdf of the environment's sampler.
    Light,
    Bsdf,
    /// Light and BSDF sampling, combined by multiple importance sampling with the balance heuristic.
    Mis,
    /// [`Sampling::Mis`], and light tracing as a third technique of the combination: paths that start at lights and are
    /// connected to the camera.
    #[default]
    MisLt,
    Hemisphere,
}

impl Sampling {
    pub const ALL: [Self; 5] = [Self::Light, Self::Bsdf, Self::Mis, Self::MisLt, Self::Hemisphere];

    /// Its name at the command line, in tables and in metadata.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Bsdf => "bsdf",
            Self::Mis => "mis",
            Self::MisLt => "mis+lt",
            Self::Hemisphere => "hemisphere",
        }
    }

    /// What it does, in a line.
    pub fn about(self) -> &'static str {
        match self {
            Self::Light => "light sampling: solid angles of area lights, the environment's radiance",
            Self::Bsdf => "BSDF sampling",
            Self::Mis => "light and BSDF sampling, combined by multiple importance sampling",
            Self::MisLt => "mis with light tracing as a third technique",
            Self::Hemisphere => "uniform sampling of the hemisphere",
        }
    }

    /// Whether lights are sampled; otherwise only sampled directions that hit emitters find light.
    pub fn by_light(self) -> bool {
        matches!(self, Self::Light | Self::Mis | Self::MisLt)
    }

    /// Whether light and BSDF samples are combined.
    pub fn is_mis(self) -> bool {
        matches!(self, Self::Mis | Self::MisLt)
    }
}

/// Which implementation of the integrator renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// Many paths side by side, in loops that vectorize.
    #[default]
    Lanes,
    /// One path after the other: the reference that the other one is tested against. It has no light tracing.
    Reference,
}

/// How to render, besides what the [`Request`] says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    pub sampling: Sampling,
    pub stream: StreamKind,
    pub seed: u64,
    /// How the environment map is sampled; by default [`Settings::map_sampling`].
    pub density: Option<MapSampling>,
    pub model: ScatterModel,
    /// Choose `sampling` and `density` among the [candidates](Self::candidates) for the scene, by the variance of a few pixels.
    pub choose: bool,
    /// Average several paths in the samples of pixels with more noise than most.
    pub adaptive: bool,
    /// Separate the light by path class.
    pub paths: Option<PathClasses>,
    /// Prepare and run everything, also what the scene does not need, for comparison.
    pub general: bool,
    pub kernel: Kernel,
}

impl Settings {
    /// The settings by default: adaptive sampling, and the best of the [candidates](Self::candidates).
    pub fn usual() -> Self {
        Self { adaptive: true, choose: true, ..Self::default() }
    }

    /// How the environment map is sampled. Where BSDF samples are combined with light samples, these leave to them what is
    /// dimmer than the mean.
    pub fn map_sampling(&self) -> MapSampling {
        let usual = if self.sampling.is_mis() { MapSampling::COSINE_COMPENSATED } else { MapSampling::COSINE };
        self.density.unwrap_or(usual)
    }
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
