//! Smooth dielectric boundaries: refraction alone, and reflection and refraction shared by Fresnel's equations.
//!
//! Light that is refracted towards the viewer changes its radiance by (n_o/n_i)² = 1/η², η the index of the far side over
//! that of `wo`'s side, because the solid angle it fills changes. Entering and leaving cancel: a slab of glass
//! does not change radiance by this factor. Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.2.

use super::examples::{Example, Family, GLASS, REFLECTANCE, SHARE, TRANSMITTANCE};
use super::mirror::reflect;
use super::{Bsdf, BsdfSample, Lobe, Scatter};
use crate::errata::interface::schlick_incident_cosine;
use crate::math::Rgb;
use crate::optics::dielectric;
use etalon_stats::bsdf::Energy;
use glam::Vec3;

/// η relative to the side of `wo`: `eta` is the index inside (z < 0) over that outside.
#[inline]
fn eta_from(wo: Vec3, eta: f32) -> f32 {
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
    /// What transmitted light is multiplied by.
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
}

impl Scatter for Refraction {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::SpecularTransmission]
    }

    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let eta = eta_from(wo, self.eta);
        let g = dielectric::eta_cos_t(wo.z.abs(), eta)?;
        let weight = self.transmittance / (eta * eta);
        Some(BsdfSample::specular_transmission(refract(wo, eta, g), weight, 1.0, eta))
    }
}

/// The formula of a dielectric's reflectance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DielectricFresnel {
    /// Fresnel's equations.
    #[default]
    Exact,
    /// Schlick's approximation, with the cosine on the less dense side.
    Schlick,
    /// Schlick's polynomial of the incident cosine on both sides; see [`schlick_incident_cosine`](crate::errata::interface::schlick_incident_cosine).
    SingleCosineSchlick,
}

/// A smooth dielectric boundary, on either side. Reflection is sampled with the probability F of `fresnel`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    /// What reflected light is multiplied by, besides Fresnel's reflectance.
    pub reflectance: Rgb,
    /// What transmitted light is multiplied by, besides Fresnel's transmittance.
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
    /// The formula of F, the reflected share.
    pub fresnel: DielectricFresnel,
}

impl Dielectric {
    /// The probability of reflection, and the cosine of the refracted direction; `None` under total internal reflection.
    #[inline]
    fn reflection(&self, cos: f32, eta: f32) -> (f32, Option<f32>) {
        let cos_t = || dielectric::eta_cos_t(cos, eta).map(|g| g / eta);
        match self.fresnel {
            DielectricFresnel::Exact => {
                let r = dielectric::fresnel(cos, eta);
                (r.unpolarized(), r.cos_t)
            }
            DielectricFresnel::Schlick => (dielectric::schlick(cos, eta), cos_t()),
            DielectricFresnel::SingleCosineSchlick => (schlick_incident_cosine(cos, eta), cos_t()),
        }
    }
}

impl Scatter for Dielectric {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::SpecularReflection, Lobe::SpecularTransmission]
    }

    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        // Choose reflection or refraction by the reflectance.
        let eta = eta_from(wo, self.eta);
        Some(match self.reflection(wo.z.abs(), eta) {
            (reflected, Some(cos_t)) if uc >= reflected => {
                let wi = refract(wo, eta, cos_t * eta);
                BsdfSample::specular_transmission(wi, self.transmittance / (eta * eta), 1.0 - reflected, eta)
            }
            (reflected, Some(_)) => BsdfSample::specular_reflection(reflect(wo), self.reflectance, reflected),
            (_, None) => BsdfSample::specular_reflection(reflect(wo), self.reflectance, 1.0),
        })
    }

    fn lobe_probability(&self, wo: Vec3, lobe: Lobe) -> f32 {
        let (reflected, cos_t) = self.reflection(wo.z.abs(), eta_from(wo, self.eta));
        let reflected = if cos_t.is_some() { reflected } else { 1.0 };
        match lobe {
            Lobe::SpecularReflection => reflected,
            Lobe::SpecularTransmission => 1.0 - reflected,
            _ => 0.0,
        }
    }

    fn is_reciprocal(&self) -> bool {
        self.fresnel != DielectricFresnel::SingleCosineSchlick
    }
}

impl Dielectric {
    /// A boundary that absorbs nothing, with Fresnel's equations.
    pub(super) const fn clear(eta: f32) -> Self {
        Self { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta, fresnel: DielectricFresnel::Exact }
    }
}

pub(super) const REFRACTION: &[Family] = &[Family {
    name: "refraction",
    parameters: &[("transmittance", 0.8, SHARE), GLASS],
    energy: Energy::AtMostOne,
    bsdf: |v| Bsdf::Refraction(Refraction { transmittance: Rgb::splat(v[0]), eta: v[1] }),
    examples: |family| vec![family.example(family.name, [TRANSMITTANCE.x, 1.5])],
}];

pub(super) const DIELECTRIC: &[Family] = &[Family {
    name: "dielectric",
    parameters: &[GLASS],
    energy: Energy::Conserved(0.0),
    bsdf: |v| Bsdf::Dielectric(Dielectric::clear(v[0])),
    examples: |family| {
        let clear = Dielectric::clear(1.5);
        let schlick = Dielectric { fresnel: DielectricFresnel::Schlick, ..clear };
        let lossy = Dielectric { reflectance: REFLECTANCE, transmittance: TRANSMITTANCE, ..clear };
        vec![
            family.example("dielectric/1.5", [1.5]),
            family.example("dielectric/0.4", [0.4]),
            Example::new("dielectric/lossy", move || Bsdf::Dielectric(lossy)),
            Example { energy: family.energy, ..Example::new("dielectric/schlick", move || Bsdf::Dielectric(schlick)) },
        ]
    },
}];
