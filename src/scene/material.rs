//! How surfaces scatter light, and what light they emit.

use crate::math::Rgb;
pub use crate::optics::microfacet::Distribution;
use glam::Vec3;

/// How a surface scatters light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// Lambertian reflection, f = albedo/π, on both sides.
    Diffuse {
        /// The part of the light that is reflected, per channel.
        albedo: Rgb,
    },
    /// A perfect mirror, on both sides.
    Mirror {
        /// The part of the light that is reflected, per channel.
        reflectance: Rgb,
    },
    /// Refraction without reflection; beyond the critical angle no light passes.
    Refraction {
        /// Factor on what passes, per channel.
        transmittance: Rgb,
        /// Index of refraction of the inside over that of the outside.
        eta: f32,
    },
    /// A smooth dielectric boundary: reflection and refraction shared by Fresnel's equations.
    Glass {
        /// Factor on what is reflected, per channel.
        reflectance: Rgb,
        /// Factor on what passes, per channel.
        transmittance: Rgb,
        /// Index of refraction of the inside over that of the outside.
        eta: f32,
    },
    /// A conductor: rough, or smooth below [`Conductor::SMOOTH_ALPHA`].
    Conductor(Conductor),
}

impl Material {
    /// Whether the surface scatters light differently along its tangent and across it.
    #[must_use]
    pub fn is_anisotropic(&self) -> bool {
        false
    }
}

/// A metal surface of microfacets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor {
    /// Real part of the complex index of refraction, per channel.
    pub eta: Rgb,
    /// Imaginary part, per channel.
    pub k: Rgb,
    /// Width of the distribution of normals; below [`Conductor::SMOOTH_ALPHA`] the surface is a perfect mirror.
    pub alpha: f32,
    /// The distribution of normals.
    pub distribution: Distribution,
    /// Whether the surface reflects on both sides, as in pbrt; otherwise its back is black, as in the course's renderer.
    pub two_sided: bool,
}

impl Conductor {
    /// Below this the lobe is narrower than the resolution of f32 directions.
    pub const SMOOTH_ALPHA: f32 = 1e-4;
}

/// Emission of a surface, the same in every direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emission {
    /// W/(m² sr).
    pub radiance: Rgb,
    /// Whether the back emits as well as the front (the side of the normal).
    pub two_sided: bool,
    /// Whether light samples find it.
    pub visibility: EmitterVisibility,
}

impl Emission {
    /// Whether a surface with this normal emits against the direction of a ray.
    #[inline]
    #[must_use]
    pub fn is_emitted(&self, normal: Vec3, direction: Vec3) -> bool {
        self.two_sided || normal.dot(direction) <= 0.0
    }
}

/// Which rays find an emitter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EmitterVisibility {
    /// An area light: sampled directly, and found by rays that hit it.
    #[default]
    Sampled,
    /// Visible directly and by way of mirrors and glass, without lighting other surfaces; a [`super::Light`] in the same
    /// place does that.
    CameraOnly,
}
