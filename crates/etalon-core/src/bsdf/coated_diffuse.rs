//! A Lambertian surface under a smooth dielectric coat, with all reflections between the two.
//!
//! Light that enters the coat at θᵢ (share 1 − F(θᵢ)) is reflected by the base with albedo ρ. The coat's
//! boundary reflects the share F̄_in of diffuse light from inside back to the base; the series of these reflections sums to
//! 1/(1 − ρ F̄_in). The rest is refracted towards θₒ (share 1 − F(θₒ)), and its radiance is divided by η²:
//!
//! f = (1 − F(θᵢ)) (1 − F(θₒ)) ρ / (π η² (1 − ρ F̄_in)), besides the mirror direction of reflectance F(θₒ).
//!
//! With F̄_out = ∫₀¹ F(μ) 2μ dμ from outside, 1 − F̄_in = (1 − F̄_out)/η², since a boundary passes diffuse light equally in both
//! directions. So a white base reflects everything, F + (1 − F) = 1. Source: Jakob et al., plastic of "Mitsuba", 2010; the
//! relation of both means: Egan and Hilgeman, "Optical Properties of Inhomogeneous Materials", 1979.

use super::diffuse::reflects;
use super::examples::{ALBEDO, COLOUR, Example, Family};
use super::mirror::reflect;
use super::{Bsdf, BsdfSample, Lobe, Scatter};
use crate::math::Rgb;
use crate::optics::dielectric::fresnel;
use crate::sampling::warp;
use etalon_stats::bsdf::Energy;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// A diffuse surface under a smooth coat, on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoatedDiffuse {
    /// Index of refraction of the coat over that of the outside.
    eta: f32,
    /// ρ / (π η² (1 − ρ F̄_in)).
    strength: Rgb,
    /// The largest albedo of the base under light that has entered the coat.
    entered: f32,
    /// F̄_out.
    outside: f64,
}

impl CoatedDiffuse {
    /// A base that reflects the share `albedo` of each channel under a coat of index `eta` > 0.
    pub fn new(albedo: Rgb, eta: f32) -> Self {
        let wide = f64::from(eta);
        // ∫ F(μ) 2μ dμ by the midpoint rule in √μ, which resolves grazing angles.
        const STEPS: u32 = 4096;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let term = |v: f64| fresnel(v * v, wide).unpolarized() * 4.0 * v.powi(3);
        let outside: f64 = (0..STEPS).map(|i| term(place(i))).sum::<f64>() / f64::from(STEPS);
        Self { eta, strength: Rgb::ZERO, entered: 0.0, outside }.with_albedo(albedo)
    }

    /// The reflected share F at `w`, and the probability with which the mirror direction is sampled.
    #[inline]
    fn reflection(&self, w: Vec3) -> (f32, f32) {
        let f = fresnel(w.z.abs(), self.eta).unpolarized();
        let all = f + (1.0 - f) * self.entered;
        (f, if all > 0.0 { f / all } else { 0.0 })
    }
}

impl Scatter for CoatedDiffuse {
    fn lobes(&self) -> &[Lobe] {
        &[Lobe::SpecularReflection, Lobe::DiffuseReflection]
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        if !reflects(wo, wi) {
            return (Rgb::ZERO, 0.0);
        }
        let ((fo, mirror), (fi, _)) = (self.reflection(wo), self.reflection(wi));
        (self.strength * ((1.0 - fo) * (1.0 - fi)), (1.0 - mirror) * (wi.z.abs() * FRAC_1_PI))
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        // Choose by the power of the two.
        let (f, mirror) = self.reflection(wo);
        if uc < mirror {
            return Some(BsdfSample::specular_reflection(reflect(wo), Rgb::splat(f / mirror), mirror));
        }
        let mut wi = warp::cosine_hemisphere(u.map(f64::from)).as_vec3();
        wi.z = wi.z.copysign(wo.z);
        let (f, pdf) = self.eval_pdf(wo, wi);
        let weight = f * wi.z.abs() / pdf;
        BsdfSample { wi, weight, pdf, lobe: Lobe::DiffuseReflection, probability: 1.0 - mirror, eta: 1.0 }.if_possible()
    }

    fn lobe_probability(&self, wo: Vec3, lobe: Lobe) -> f32 {
        if lobe == Lobe::SpecularReflection { self.reflection(wo).1 } else { 0.0 }
    }

    /// The same coat over a base of another albedo.
    fn with_albedo(&self, albedo: Rgb) -> Self {
        let (wide, outside) = (f64::from(self.eta), self.outside);
        let leaves = (1.0 - outside) / (wide * wide);
        let channel = |rho: f32| {
            let rho = f64::from(rho);
            rho / (wide * wide * (1.0 - rho * (1.0 - leaves)))
        };
        let diffuse = [albedo.x, albedo.y, albedo.z].map(channel);
        let strength = diffuse.map(|diffuse| (diffuse * std::f64::consts::FRAC_1_PI) as f32);
        let entered = diffuse.into_iter().fold(0.0, f64::max) * (1.0 - outside);
        Self { strength: Rgb::from_array(strength), entered: entered as f32, ..*self }
    }

    /// That of a coat which reflects nothing.
    fn largest_weight(&self) -> Option<f32> {
        Some(self.strength.max_element() * PI)
    }
}

pub(super) const FAMILIES: &[Family] = &[Family {
    name: "coated-diffuse",
    parameters: &[ALBEDO, ("eta", 1.5, [1.0, 2.4])],
    energy: Energy::AtMostOne,
    bsdf: |v| Bsdf::CoatedDiffuse(CoatedDiffuse::new(Rgb::splat(v[0]), v[1])),
    examples: |family| {
        let coat = |eta| move || Bsdf::CoatedDiffuse(CoatedDiffuse::new(COLOUR, eta));
        [1.5, 2.4].map(|eta| Example::new(format!("{}/{eta}", family.name), coat(eta))).into()
    },
}];
