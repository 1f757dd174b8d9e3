//! Smooth dielectric boundaries: refraction alone, and reflection and refraction shared by Fresnel's equations.
//!
//! Light that is refracted towards the viewer changes its radiance by (n_o/n_i)² = 1/η², η the index of the far side over
//! that of `wo`'s side, because the solid angle it fills changes. Entering and leaving cancel: a slab of glass dims
//! nothing by this factor. Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.2.

use super::mirror::reflect;
use super::{BsdfSample, Scatter};
use crate::errata::fresnel::schlick_incident_cosine;
use crate::math::Rgb;
use crate::optics::{dielectric, schlick};
use glam::Vec3;

/// η seen from `wo`: `eta` is the index inside (z < 0) over that outside.
#[inline]
pub(super) fn eta_from(wo: Vec3, eta: f32) -> f32 {
    if wo.z < 0.0 { eta.recip() } else { eta }
}

/// The direction refracted to the far side, for g = η cos θₜ (see [`dielectric::eta_cos_t`]).
#[inline]
fn refract(wo: Vec3, eta: f32, g: f32) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, if wo.z < 0.0 { g } else { -g }) / eta
}

/// Refraction without reflection, on either side; beyond the critical angle no light passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refraction {
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
}

impl Scatter for Refraction {
    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let eta = eta_from(wo, self.eta);
        let g = dielectric::eta_cos_t(wo.z.abs(), eta)?;
        BsdfSample::delta(refract(wo, eta, g), self.transmittance / (eta * eta))
    }
}

/// Which share of light a dielectric reflects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DielectricFresnel {
    /// Fresnel's equations.
    #[default]
    Exact,
    /// Schlick's approximation, with the cosine on the less dense side.
    Schlick,
    /// Schlick's polynomial of the incident cosine on both sides; see
    /// [`Conventions::single_cosine_schlick`](crate::errata::Conventions::single_cosine_schlick).
    SingleCosineSchlick,
}

/// A smooth dielectric boundary, on either side. Reflection is chosen as often as Fresnel's equations reflect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glass {
    pub reflectance: Rgb,
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
    pub fresnel: DielectricFresnel,
}

impl Scatter for Glass {
    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let (cos, eta) = (wo.z.abs(), eta_from(wo, self.eta));
        let (reflected, cos_t) = match self.fresnel {
            DielectricFresnel::Exact => {
                let r = dielectric::fresnel(cos, eta);
                (r.unpolarized(), r.cos_t)
            }
            DielectricFresnel::Schlick => {
                (schlick::schlick(cos, eta), dielectric::eta_cos_t(cos, eta).map(|g| g / eta))
            }
            DielectricFresnel::SingleCosineSchlick => {
                (schlick_incident_cosine(cos, eta), dielectric::eta_cos_t(cos, eta).map(|g| g / eta))
            }
        };
        split(wo, uc, eta, reflected, cos_t, self.reflectance, self.transmittance)
    }
}

/// Reflects with probability `reflected`, else refracts at cosine `cos_t`; without one all light is reflected.
#[inline]
pub(super) fn split(
    wo: Vec3,
    uc: f32,
    eta: f32,
    reflected: f32,
    cos_t: Option<f32>,
    reflectance: Rgb,
    transmittance: Rgb,
) -> Option<BsdfSample> {
    match cos_t {
        Some(cos_t) if uc >= reflected => BsdfSample::delta(refract(wo, eta, cos_t * eta), transmittance / (eta * eta)),
        _ => BsdfSample::delta(reflect(wo), reflectance),
    }
}
