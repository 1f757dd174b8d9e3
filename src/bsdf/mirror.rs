//! Perfect mirrors: of a given reflectance, and of a polished metal.

use super::{BsdfSample, MetalFresnel, Scatter};
use crate::math::Rgb;
use glam::Vec3;

/// `wo` reflected by the surface.
#[inline]
pub(super) fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// Reflects the given share of light, on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    pub reflectance: Rgb,
}

impl Scatter for Mirror {
    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        BsdfSample::delta(reflect(wo), self.reflectance)
    }
}

/// A smooth conductor, seen from the side of the normal (z > 0): reflects what Fresnel's equations say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothConductor {
    pub fresnel: MetalFresnel,
}

impl Scatter for SmoothConductor {
    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        BsdfSample::delta(reflect(wo), self.fresnel.reflectance(wo.z))
    }
}
