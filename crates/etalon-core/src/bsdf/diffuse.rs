//! Lambert's law: the same radiance in every direction.
//!
//! Directions are in the local frame, the normal at +z. `f` is the BSDF value without the cosine.

use super::examples::{ALBEDO, COLOUR, Example, Family};
use super::{Bsdf, BsdfSample, Lobe, Scatter};
use crate::math::Rgb;
use crate::sampling::warp;
use etalon_stats::bsdf::Energy;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Diffuse reflection on either side, sampled by the cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diffuse {
    f: Rgb,
    albedo: Rgb,
}

impl Diffuse {
    /// Reflects the share `albedo` of each channel.
    pub fn new(albedo: Rgb) -> Self {
        Self { f: albedo * FRAC_1_PI, albedo }
    }

    /// The reflected share of each channel.
    #[inline]
    pub fn albedo(&self) -> Rgb {
        self.albedo
    }
}

/// Whether both directions are on one side of the surface and neither along it.
#[inline(always)]
pub(super) fn reflects(wo: Vec3, wi: Vec3) -> bool {
    (wo.z > 0.0 && wi.z > 0.0) || (wo.z < 0.0 && wi.z < 0.0)
}

impl Scatter for Diffuse {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::DiffuseReflection]
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        if reflects(wo, wi) { (self.f, wi.z.abs() * FRAC_1_PI) } else { (Rgb::ZERO, 0.0) }
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let mut wi = warp::cosine_hemisphere(u.map(f64::from)).as_vec3();
        wi.z = wi.z.copysign(wo.z);
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::reflected(wi, self.albedo, pdf, Lobe::DiffuseReflection))
    }

    fn largest_weight(&self) -> Option<f32> {
        Some(1.0)
    }
}

pub(super) const FAMILIES: &[Family] = &[Family {
    name: "diffuse",
    parameters: &[ALBEDO],
    energy: Energy::AtMostOne,
    bsdf: |v| Bsdf::Diffuse(Diffuse::new(Rgb::splat(v[0]))),
    examples: |family| vec![Example::new(family.name, || Bsdf::Diffuse(Diffuse::new(COLOUR)))],
}];
