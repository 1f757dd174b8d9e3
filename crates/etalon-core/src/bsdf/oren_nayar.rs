//! A rough diffuse surface of Lambertian V-shaped grooves, by Oren and Nayar's qualitative model.
//!
//! The angles between the sides of the grooves and the surface have a Gaussian distribution of the standard deviation σ (radians).
//! With α the larger and β the smaller of θₒ and θᵢ,
//!
//! f = ρ/π (A + B max(0, cos(φₒ − φᵢ)) sin α tan β), A = 1 − σ²/(2 (σ² + 0.33)), B = 0.45 σ²/(σ² + 0.09).
//!
//! As sin α sin β = sin θₒ sin θᵢ, the term of B is max(0, xₒxᵢ + yₒyᵢ)/max(cos θₒ, cos θᵢ), without trigonometric functions and the
//! same to the last bit when the directions are exchanged. σ = 0 is Lambert's law. Light between grooves is left out, so that the
//! albedo from above is A ρ; the fit errs at the horizon, where the albedo is (A + B/2) ρ, up to 1.0152 ρ (σ = 11.4°).
//!
//! Directions are sampled by the cosine. Weights have no bound: sin α tan β is infinite where both directions are at the horizon.
//!
//! Source: Oren and Nayar, "Generalization of Lambert's Reflectance Model", SIGGRAPH 1994; in this form pbrt-v3's `matte`.

use super::compensated_conductor::cosine_direction;
use super::diffuse::reflects;
use super::examples::{ALBEDO, COLOUR, Example, Family};
use super::{Bsdf, BsdfSample, Lobe, Scatter, Vectorizable, VectorizedLoop};
use crate::math::Rgb;
use etalon_stats::bsdf::Energy;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A rough diffuse surface, on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrenNayar {
    albedo: Rgb,
    /// A and B.
    coefficients: [f32; 2],
}

impl OrenNayar {
    /// A surface whose grooves reflect the share `albedo` of each channel; `sigma` is the standard deviation of their angle in radians.
    pub fn new(albedo: Rgb, sigma: f32) -> Self {
        let sigma2 = sigma * sigma;
        Self { albedo, coefficients: [1.0 - sigma2 / (2.0 * (sigma2 + 0.33)), 0.45 * sigma2 / (sigma2 + 0.09)] }
    }
}

impl Vectorizable for OrenNayar {
    #[inline(always)]
    fn sample_lane(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> BsdfSample {
        let up = cosine_direction(u);
        let wi = Vec3::new(up.x, up.y, up.z.copysign(wo.z));
        let (f, pdf) = self.eval_pdf_lane(wo, wi);
        let (cos, divisor) = if pdf > 0.0 { (wi.z.abs(), pdf) } else { (0.0, 1.0) };
        BsdfSample::reflected(wi, f * (cos / divisor), pdf, Lobe::DiffuseReflection)
    }

    #[inline(always)]
    fn eval_pdf_lane(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let [a, b] = self.coefficients;
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let along = (wo.x * wi.x + wo.y * wi.y).max(0.0) / cos_o.max(cos_i).max(f32::MIN_POSITIVE);
        let exists = if reflects(wo, wi) { FRAC_1_PI } else { 0.0 };
        (self.albedo * ((a + b * along) * exists), cos_i * exists)
    }
}

impl Scatter for OrenNayar {
    fn lobes(&self) -> &[Lobe] {
        &[Lobe::DiffuseReflection]
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        self.eval_pdf_lane(wo, wi)
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.sample_lane(wo, uc, u).if_possible()
    }

    fn with_albedo(&self, albedo: Rgb) -> Self {
        Self { albedo, ..*self }
    }

    #[inline]
    fn vectorize(&self, work: impl VectorizedLoop) -> bool {
        work.over(*self);
        true
    }
}

pub(super) const FAMILIES: &[Family] = &[Family {
    name: "oren-nayar",
    parameters: &[ALBEDO, ("sigma_deg", 20.0, [0.0, 90.0])],
    energy: Energy::MayExceedOne("the fit at the horizon does, by up to 1.5 %"),
    bsdf: |v| Bsdf::OrenNayar(OrenNayar::new(Rgb::splat(v[0]), v[1].to_radians())),
    examples: |family| {
        let of = |degrees: f32| move || Bsdf::OrenNayar(OrenNayar::new(COLOUR, degrees.to_radians()));
        let example = |degrees| Example::new(format!("{}/{degrees}", family.name), of(degrees));
        [0.0, 11.4, 30.0, 90.0].map(|degrees| Example { energy: family.energy, ..example(degrees) }).into()
    },
}];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Diffuse;
    use std::f64::consts::{PI, TAU};

    fn towards(theta: f64, phi: f64) -> Vec3 {
        glam::DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).as_vec3()
    }

    #[test]
    fn values_are_those_of_the_published_formula() {
        for sigma in [0.1f64, 0.5, 1.5] {
            let bsdf = OrenNayar::new(Rgb::splat(0.6), sigma as f32);
            let s2 = sigma * sigma;
            let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
            for (theta_o, theta_i, phi) in
                [(0.0, 0.7, 0.0), (1.2, 0.4, 0.3), (0.4, 1.2, 6.0), (1.5, 1.5, 0.1), (0.9, 1.0, 2.0)]
            {
                let expected = 0.6 / PI
                    * (a + b
                        * f64::cos(phi).max(0.0)
                        * f64::max(theta_o, theta_i).sin()
                        * f64::min(theta_o, theta_i).tan());
                let (wo, wi) = (towards(theta_o, 0.5), towards(theta_i, 0.5 + phi));
                for f in [bsdf.eval(wo, wi), bsdf.eval(wi, wo), bsdf.eval(-wo, -wi)] {
                    assert!((f64::from(f.x) / expected - 1.0).abs() < 2e-5, "{sigma} {wo} {wi}: {f} {expected}");
                }
            }
        }
        let (flat, lambertian) = (OrenNayar::new(COLOUR, 0.0), Diffuse::new(COLOUR));
        let (wo, wi) = (towards(0.3, 0.0), towards(1.1, 2.0));
        assert!((flat.eval(wo, wi) - lambertian.eval(wo, wi)).abs().max_element() < 1e-7);
    }

    #[test]
    fn the_albedo_at_the_horizon_exceeds_one_by_what_the_fit_errs() {
        // The midpoint rule in θ and φ.
        let albedo = |sigma: f32, wo: Vec3| {
            let (bsdf, n) = (OrenNayar::new(Rgb::ONE, sigma), 400);
            let of = |i: i32| {
                let [u, v] = [i / n, i % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
                let theta = 0.5 * PI * u;
                f64::from(bsdf.eval(wo, towards(theta, TAU * v)).x) * theta.sin() * theta.cos() * PI * PI
            };
            (0..n * n).map(of).sum::<f64>() / f64::from(n * n)
        };
        for sigma in [0.1f32, 0.2, 1.0] {
            let [a, b] = OrenNayar::new(Rgb::ONE, sigma).coefficients.map(f64::from);
            for (wo, expected) in [(Vec3::Z, a), (Vec3::new(1.0, 0.0, 1e-6), a + 0.5 * b)] {
                let found = albedo(sigma, wo);
                assert!((found - expected).abs() < 1e-3 && found < 1.0153, "{sigma} {wo}: {found} {expected}");
            }
        }
        assert!(albedo(11.4f32.to_radians(), Vec3::new(1.0, 0.0, 1e-6)) > 1.0145);
    }
}
