//! Perfect mirrors: of a given reflectance, and of a polished metal.

use super::examples::{ETA, Example, Family, K, REFLECTANCE, SHARE, gold, grey};
use super::{Bsdf, BsdfSample, ConductorFresnel, Lobe, Scatter};
use crate::math::Rgb;
use etalon_stats::bsdf::Energy;
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
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        Some(BsdfSample::specular_reflection(reflect(wo), self.reflectance, 1.0))
    }
}

/// A smooth conductor, visible from the side of the normal (z > 0): reflects the share that Fresnel's equations give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothConductor {
    pub fresnel: ConductorFresnel,
}

impl Scatter for SmoothConductor {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::SpecularReflection]
    }

    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        Some(BsdfSample::specular_reflection(reflect(wo), self.fresnel.reflectance(wo.z), 1.0))
    }
}

pub(super) const MIRROR: &[Family] = &[Family {
    name: "mirror",
    parameters: &[("reflectance", 0.9, SHARE)],
    energy: Energy::AtMostOne,
    bsdf: |v| Bsdf::Mirror(Mirror { reflectance: Rgb::splat(v[0]) }),
    examples: |family| vec![family.example(family.name, [REFLECTANCE.x])],
}];

pub(super) const SMOOTH_CONDUCTOR: &[Family] = &[Family {
    name: "smooth-conductor",
    parameters: &[ETA, K],
    energy: Energy::AtMostOne,
    bsdf: |v| Bsdf::SmoothConductor(SmoothConductor { fresnel: grey(v[0], v[1]) }),
    examples: |family| vec![Example::new(family.name, || Bsdf::SmoothConductor(SmoothConductor { fresnel: gold() }))],
}];
