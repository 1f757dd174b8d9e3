//! How surfaces scatter light, and what light they emit.

use super::texture::Texture;
use crate::bsdf::{Bsdf, LEAST_DEVIATION, Scatter};
use crate::math::Rgb;
pub use crate::optics::microfacet::Distribution;
use glam::{Vec2, Vec3};
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
    /// Any isotropic BSDF, the same for every [`ScatterModel`](super::ScatterModel). Shared, because it is larger than most materials.
    Bsdf(Arc<Bsdf>),
    /// A weighted sum of materials: each with its weight, at most 1 together.
    Mixture(Arc<[(f32, Material)]>),
    /// One that varies over the surface.
    Textured(Arc<Textured>),
}

impl From<Bsdf> for Material {
    fn from(bsdf: Bsdf) -> Self {
        Self::Bsdf(Arc::new(bsdf))
    }
}

impl Material {
    /// Whether it looks the same from both sides: its normal is then turned towards the viewer. Mirrors need not be turned.
    /// A mixture looks the same from both sides unless light passes; where it does, conductors reflect on their front alone.
    pub fn is_two_sided(&self) -> bool {
        match self {
            Self::Diffuse { .. } => true,
            Self::Conductor(conductor) => conductor.two_sided,
            Self::Mirror { .. } | Self::Refraction { .. } | Self::Dielectric(_) => false,
            Self::Bsdf(_) | Self::Mixture(_) => !self.is_transmitting(),
            Self::Textured(textured) => textured.base.is_two_sided(),
        }
    }

    /// The number of materials that it mixes, 1 if it is no mixture.
    pub fn parts(&self) -> usize {
        match self {
            Self::Mixture(parts) => parts.iter().map(|(_, part)| part.parts()).sum(),
            _ => 1,
        }
    }

    /// Whether that holds of the material or, if it is a mixture, of any of its parts.
    fn any(&self, holds: fn(&Self) -> bool) -> bool {
        match self {
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.any(holds)),
            single => holds(single),
        }
    }

    /// Whether light passes through the surface.
    pub fn is_transmitting(&self) -> bool {
        self.any(|part| match part {
            Self::Refraction { .. } | Self::Dielectric(_) => true,
            Self::Bsdf(bsdf) => bsdf.lobes().iter().any(|lobe| lobe.is_transmission()),
            Self::Textured(textured) => textured.base.is_transmitting(),
            // `any` asks the parts of a mixture
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Conductor(_) | Self::Mixture(_) => false,
        })
    }

    /// Whether its normals are distributed differently along x and y of the surface's frame, so that the frame needs the
    /// tangent of the surface.
    pub fn is_anisotropic(&self) -> bool {
        self.any(|part| match part {
            Self::Dielectric(Dielectric { alpha, .. }) | Self::Conductor(Conductor { alpha, .. }) => {
                alpha[0] != alpha[1]
            }
            Self::Textured(textured) => match &textured.alpha {
                Some([x, y]) => x != y,
                None => textured.base.is_anisotropic(),
            },
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Refraction { .. } | Self::Bsdf(_) | Self::Mixture(_) => {
                false
            }
        })
    }

    /// Whether the width of a distribution of its normals varies over the surface.
    pub fn has_textured_alpha(&self) -> bool {
        self.any(|part| matches!(part, Self::Textured(textured) if textured.alpha.is_some()))
    }

    /// Whether it varies over the surface, so that it needs texture coordinates.
    pub fn is_textured(&self) -> bool {
        self.any(|part| matches!(part, Self::Textured(_)))
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
    pub distribution: Distribution,
}

impl Dielectric {
    /// A smooth boundary that absorbs nothing.
    pub const fn clear(eta: f32) -> Self {
        Self { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta, alpha: [0.0; 2], distribution: Distribution::Ggx }
    }

    /// A boundary of isotropic microfacets that absorbs nothing.
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
    pub distribution: Distribution,
    /// Whether the surface reflects on both sides, as in pbrt; otherwise its back is black, as in the course's renderer.
    pub two_sided: bool,
    /// Whether light that facets reflect more than once is added.
    pub multiple_scattering: bool,
}

impl Conductor {
    /// A metal of isotropic microfacets on one side, without multiple scattering.
    pub const fn new(eta: Rgb, k: Rgb, alpha: f32, distribution: Distribution) -> Self {
        Self { eta, k, alpha: [alpha; 2], distribution, two_sided: false, multiple_scattering: false }
    }
}

/// A material whose parameters vary over the surface. Textures change no lobe: a rough surface is rough everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Textured {
    /// The material, with its constant parameters, and values of the others that give it the same lobes: an α of a rough
    /// surface, if there are textures of α. Not a mixture: its parts may have textures.
    pub base: Material,
    /// In place of an albedo or a reflectance, from 0 to 1.
    pub reflectance: Option<Texture>,
    /// In place of a transmittance, from 0 to 1.
    pub transmittance: Option<Texture>,
    /// In place of the widths α along x and y. Where it is less, α is that of the smoothest rough surface: see
    /// [`least_alpha`].
    pub alpha: Option<[Texture; 2]>,
}

impl Textured {
    pub fn at(&self, uv: Vec2) -> Material {
        let mut material = self.base.clone();
        match &mut material {
            Material::Diffuse { albedo: reflectance } | Material::Mirror { reflectance } => {
                look_up(&self.reflectance, uv, reflectance);
            }
            Material::Bsdf(bsdf) => {
                if let Some(texture) = &self.reflectance {
                    *bsdf = Arc::new(bsdf.with_albedo(texture.at(uv)));
                }
            }
            Material::Refraction { transmittance, .. } => look_up(&self.transmittance, uv, transmittance),
            Material::Dielectric(dielectric) => {
                look_up(&self.reflectance, uv, &mut dielectric.reflectance);
                look_up(&self.transmittance, uv, &mut dielectric.transmittance);
                if let Some(alpha) = self.alpha_at(uv) {
                    let least = least_alpha(dielectric);
                    dielectric.alpha = alpha.map(|alpha| alpha.max(least));
                }
            }
            Material::Conductor(conductor) => {
                if let Some(alpha) = self.alpha_at(uv) {
                    conductor.alpha = alpha.map(|alpha| alpha.max(SMOOTH_ALPHA));
                }
            }
            Material::Mixture(_) | Material::Textured(_) => {}
        }
        material
    }

    fn alpha_at(&self, uv: Vec2) -> Option<[f32; 2]> {
        self.alpha.as_ref().map(|alpha| alpha.each_ref().map(|alpha| alpha.at(uv).x))
    }
}

/// Sets `value` to that of a texture, if there is one.
fn look_up(texture: &Option<Texture>, uv: Vec2, value: &mut Rgb) {
    if let Some(texture) = texture {
        *value = texture.at(uv);
    }
}

/// The least α of a dielectric that counts as rough: [`SMOOTH_ALPHA`], or what f32 directions resolve
/// ([`LEAST_DEVIATION`]), which for an index next to 1 may be more than 1.
pub fn least_alpha(dielectric: &Dielectric) -> f32 {
    let resolved = LEAST_DEVIATION * dielectric.eta.max(1.0) / (dielectric.eta - 1.0).abs();
    // Rounded up.
    SMOOTH_ALPHA.max(resolved * (1.0 + 4.0 * f32::EPSILON))
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
    /// Emission of the front, which light samples find.
    pub const fn of_front(radiance: Rgb) -> Self {
        Self { radiance, two_sided: false, visibility: EmitterVisibility::Sampled }
    }

    /// Whether a surface with this normal emits against the direction of a ray.
    #[inline]
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
