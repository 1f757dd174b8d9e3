//! Perfect mirrors: of a given reflectance, and of a polished metal.

use super::{BsdfSample, ConductorFresnel, Lobe, Scatter};
use crate::math::Rgb;
use glam::Vec3;

/// `wo` reflected by the surface.
#[inline]
pub(super) fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// A perfect mirror of constant reflectance, on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// Reflected share of each channel.
    pub reflectance: Rgb,
}

impl Scatter for Mirror {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::SpecularReflection]
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        Some(BsdfSample::specular_reflection(reflect(wo), self.reflectance, 1.0))
    }
}

/// A smooth conductor, visible from the side of the normal (z > 0): reflects the share that Fresnel's equations give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothConductor {
    /// Complex index of refraction of the metal.
    pub fresnel: ConductorFresnel,
}

impl Scatter for SmoothConductor {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::SpecularReflection]
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        Some(BsdfSample::specular_reflection(reflect(wo), self.fresnel.reflectance(wo.z), 1.0))
    }
}
