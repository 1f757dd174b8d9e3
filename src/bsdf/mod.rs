//! Materials: `eval`, `sample` and `pdf` under one contract, [`Scatter`].
//!
//! Directions are unit vectors in the local frame, the normal at +z, and point away from the surface: `wo` towards the
//! viewer, `wi` towards the light. Light is radiance. A BSDF that departs from
//! physics does so by [`Conventions`](crate::errata::Conventions).

mod conductor;
mod conventional;
pub mod diffuse;
mod glass;
mod metal;
mod mirror;

pub(crate) use conductor::Facet;
pub use conductor::{Conductor, Normals};
pub use conventional::{ConventionalConductor, pdf_without_cosine};
pub use diffuse::Diffuse;
pub use glass::{DielectricFresnel, Glass, Refraction};
pub use metal::MetalFresnel;
pub use mirror::{Mirror, SmoothConductor};

use crate::math::Rgb;
use crate::optics::microfacet::{Beckmann, Ggx};
use glam::Vec3;

/// A direction drawn by a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    pub wi: Vec3,
    /// f |cos θᵢ| over the density: what the light from `wi` is multiplied by.
    pub weight: Rgb,
    /// Density per solid angle, equal to [`Scatter::pdf`] to the last bit; 0 if `delta`.
    pub pdf: f32,
    /// Whether the direction is one of finitely many, which no other strategy can meet.
    pub delta: bool,
}

impl BsdfSample {
    fn delta(wi: Vec3, weight: Rgb) -> Option<Self> {
        Some(Self { wi, weight, pdf: 0.0, delta: true })
    }
}

/// How a surface scatters light. The default methods are those of a material with delta lobes only.
pub trait Scatter {
    /// The BSDF f(wo, wi), without the cosine (1/sr); 0 for delta lobes and where nothing is scattered.
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval_pdf(wo, wi).0
    }

    /// Density per solid angle of [`sample`](Self::sample) at `wi`; 0 for delta lobes. Its integral falls short of 1 by
    /// the probability of `None`.
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf(wo, wi).1
    }

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) for little more than the price of one.
    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    /// Draws a direction: `uc` in \[0, 1) chooses among lobes, `u` in \[0, 1)² the place within. `None` stands for a
    /// sample that carries no light.
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample>;
}

/// Any material, its constants computed once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bsdf {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Refraction(Refraction),
    Glass(Glass),
    SmoothConductor(SmoothConductor),
    Beckmann(Conductor<Beckmann<f32>>),
    Ggx(Conductor<Ggx<f32>>),
    ConventionalConductor(ConventionalConductor),
}

/// The same expression for the material of whichever kind.
macro_rules! each {
    ($bsdf:expr, $material:ident => $result:expr) => {
        match $bsdf {
            Bsdf::Diffuse($material) => $result,
            Bsdf::Mirror($material) => $result,
            Bsdf::Refraction($material) => $result,
            Bsdf::Glass($material) => $result,
            Bsdf::SmoothConductor($material) => $result,
            Bsdf::Beckmann($material) => $result,
            Bsdf::Ggx($material) => $result,
            Bsdf::ConventionalConductor($material) => $result,
        }
    };
}

impl Bsdf {
    /// Whether every direction it scatters to is one of finitely many, so that light sampling is in vain.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Mirror(_) | Self::Refraction(_) | Self::Glass(_) => true,
            Self::SmoothConductor(_) => true,
            Self::Diffuse(_) | Self::Beckmann(_) | Self::Ggx(_) | Self::ConventionalConductor(_) => false,
        }
    }

    /// Whether f(wi, wo) is f(wo, wi), refraction's η² apart, so that a path may be made from either end.
    #[must_use]
    pub fn is_reciprocal(&self) -> bool {
        match self {
            Self::ConventionalConductor(_) => false,
            Self::Glass(glass) => glass.fresnel != DielectricFresnel::SingleCosineSchlick,
            _ => true,
        }
    }

    /// [`Scatter::sample`] of the adjoint f(wi, wo): `wo` points to where the light comes from, `wi` is where it goes, and
    /// the weight is what its power is multiplied by. Only refraction tells the two apart: it changes the radiance by 1/η²
    /// but not the power.
    #[inline]
    #[must_use]
    pub fn sample_adjoint(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let sample = self.sample(wo, uc, u)?;
        let eta = match self {
            Self::Refraction(refraction) if wo.z * sample.wi.z < 0.0 => glass::eta_from(wo, refraction.eta),
            Self::Glass(glass) if wo.z * sample.wi.z < 0.0 => glass::eta_from(wo, glass.eta),
            _ => 1.0,
        };
        Some(BsdfSample { weight: sample.weight * (eta * eta), ..sample })
    }
}

impl Scatter for Bsdf {
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        each!(self, material => material.eval(wo, wi))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        each!(self, material => material.pdf(wo, wi))
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        each!(self, material => material.eval_pdf(wo, wi))
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        each!(self, material => material.sample(wo, uc, u))
    }
}

#[cfg(test)]
mod tests;
