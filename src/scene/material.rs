//! How surfaces scatter light, and what light they emit.

use crate::math::Rgb;
pub use crate::optics::microfacet::Distribution;
use glam::Vec3;
use std::sync::Arc;

/// How a surface scatters light.
#[derive(Debug, Clone, PartialEq)]
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
    /// A dielectric boundary, rough or smooth: reflection and refraction shared by Fresnel's equations.
    Dielectric(Dielectric),
    /// A conductor, rough or smooth.
    Conductor(Conductor),
    /// A Lambertian surface under a smooth dielectric coat, on both sides.
    CoatedDiffuse {
        /// The part of the light that the base reflects, per channel.
        albedo: Rgb,
        /// Index of refraction of the coat over that of the outside.
        eta: f32,
    },
    /// A weighted sum of materials: each with its weight, at most 1 together.
    Mixture(Arc<[(f32, Material)]>),
}

impl Material {
    /// Whether it looks the same from both sides: its normal is then turned towards the viewer. Mirrors need not be turned.
    /// A mixture looks the same from both sides unless light passes; where it does, conductors reflect on their front alone.
    #[must_use]
    pub fn is_two_sided(&self) -> bool {
        match self {
            Self::Diffuse { .. } | Self::CoatedDiffuse { .. } => true,
            Self::Conductor(conductor) => conductor.two_sided,
            Self::Mirror { .. } | Self::Refraction { .. } | Self::Dielectric(_) => false,
            Self::Mixture(_) => !self.is_transmitting(),
        }
    }

    /// Whether light passes through the surface.
    fn is_transmitting(&self) -> bool {
        match self {
            Self::Refraction { .. } | Self::Dielectric(_) => true,
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.is_transmitting()),
            _ => false,
        }
    }

    /// Whether its normals are distributed differently along x and y of the surface's frame, so that the frame needs the
    /// tangent of the surface.
    #[must_use]
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Self::Dielectric(Dielectric { alpha, .. }) | Self::Conductor(Conductor { alpha, .. }) => {
                alpha[0] != alpha[1]
            }
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.is_anisotropic()),
            _ => false,
        }
    }
}

/// Surfaces with a smaller α along either axis are treated as perfectly smooth.
pub const SMOOTH_ALPHA: f32 = 1e-4;

/// A dielectric boundary, smooth or of microfacets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    /// Factor on what is reflected, per channel.
    pub reflectance: Rgb,
    /// Factor on what passes, per channel.
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
    /// Widths of the distribution of normals along x and y of the surface's frame; with either below [`SMOOTH_ALPHA`] the
    /// boundary is smooth.
    pub alpha: [f32; 2],
    /// The distribution of normals.
    pub distribution: Distribution,
}

impl Dielectric {
    /// A smooth boundary that absorbs nothing.
    #[must_use]
    pub const fn clear(eta: f32) -> Self {
        Self { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta, alpha: [0.0; 2], distribution: Distribution::Ggx }
    }

    /// A boundary of isotropic microfacets that absorbs nothing.
    #[must_use]
    pub const fn rough(eta: f32, alpha: f32, distribution: Distribution) -> Self {
        Self { alpha: [alpha; 2], distribution, ..Self::clear(eta) }
    }
}

/// A metal surface, smooth or of microfacets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor {
    /// Real part of the complex index of refraction, per channel.
    pub eta: Rgb,
    /// Imaginary part, per channel.
    pub k: Rgb,
    /// Widths of the distribution of normals along x and y of the surface's frame; with either below [`SMOOTH_ALPHA`] the
    /// surface is a perfect mirror.
    pub alpha: [f32; 2],
    /// The distribution of normals.
    pub distribution: Distribution,
    /// Whether the surface reflects on both sides, as in pbrt; otherwise its back is black, as in the course's renderer.
    pub two_sided: bool,
    /// Whether light that facets reflect more than once is added.
    pub multiple_scattering: bool,
}

impl Conductor {
    /// A metal of isotropic microfacets on one side, without multiple scattering.
    #[must_use]
    pub const fn new(eta: Rgb, k: Rgb, alpha: f32, distribution: Distribution) -> Self {
        Self { eta, k, alpha: [alpha; 2], distribution, two_sided: false, multiple_scattering: false }
    }
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
