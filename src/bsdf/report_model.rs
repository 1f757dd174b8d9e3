//! What the two reports and their course compute where it differs from physics: each convention by a name of its own.
//!
//! None of this is in the default materials. A [`ReportConventions`] turns a material into one of the two types here.

use super::conductor::{Facet, reflect_at};
use super::glass::split;
use super::{BsdfSample, MetalFresnel, Scatter};
use crate::math::Rgb;
use crate::optics::conductor::fresnel_approximate;
use crate::optics::microfacet::variants::lambda_with_pi;
use crate::optics::microfacet::{Beckmann, Microfacet};
use crate::optics::{dielectric, schlick};
use crate::sampling::normals::SampleNormals;
use glam::Vec3;

/// Which of the reports' conventions to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReportConventions {
    /// Metal: Fresnel reflectance at the angle of `wi` with the surface's normal instead of the facet's.
    ///
    /// Not reciprocal: f(wo, wi) and f(wi, wo) differ by up to 2 % for the blue of silver, 13 % for that of aluminium,
    /// 82 % for copper, 105 % for iron and 148 % for gold (grazing against the least reflective angle).
    pub fresnel_at_normal: bool,
    /// Metal: [`fresnel_approximate`], which drops sin² against η² + k²: at most 0.007 off for gold and copper.
    pub approximate_fresnel: bool,
    /// Metal: [`lambda_with_pi`] in the shadowing term, which may then exceed 1.
    pub lambda_pi: bool,
    /// Glass: Schlick's polynomial of the cosine on `wo`'s side, whichever that is, and 1 under total reflection.
    ///
    /// Leaving glass of 1.5 it reflects 0.040 at 30° (true: 0.055), 0.041 at 40° (true: 0.245) and at 41.5° (true:
    /// 0.542); of even light from inside 0.573 (true: 0.596).
    pub single_cosine_schlick: bool,
}

impl ReportConventions {
    /// Everything as the reports have it.
    pub const ALL: Self =
        Self { fresnel_at_normal: true, approximate_fresnel: true, lambda_pi: true, single_cosine_schlick: true };

    /// Whether any convention for metal is followed.
    #[must_use]
    pub fn change_metal(&self) -> bool {
        self.fresnel_at_normal || self.approximate_fresnel || self.lambda_pi
    }
}

/// A rough metal of Beckmann's distribution by the second report's conventions, seen from the side of the normal (z > 0).
///
/// Directions are drawn by all normals, as there, but with the density that these have. The density that the report
/// prints is [`printed_pdf`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportConductor {
    pub distribution: Beckmann<f32>,
    pub fresnel: MetalFresnel,
    pub conventions: ReportConventions,
}

impl ReportConductor {
    /// F at the cosine that the conventions choose.
    #[inline]
    fn reflectance(&self, wi: Vec3, facet: &Facet) -> Rgb {
        let cos = if self.conventions.fresnel_at_normal { wi.z } else { facet.cos };
        if !self.conventions.approximate_fresnel {
            return self.fresnel.reflectance(cos);
        }
        let channel = |eta, k| fresnel_approximate(cos, eta, k).unpolarized();
        let MetalFresnel { eta, k, .. } = self.fresnel;
        Rgb::new(channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z))
    }

    #[inline]
    fn lambda(&self, w: Vec3) -> f32 {
        if !self.conventions.lambda_pi {
            return self.distribution.lambda(w.to_array());
        }
        lambda_with_pi(w.z / (self.distribution.alpha * w.truncate().length()))
    }

    #[inline]
    fn density(&self, facet: &Facet) -> f32 {
        0.25 * self.distribution.pdf_all(facet.wm) / facet.cos
    }
}

impl Scatter for ReportConductor {
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Facet::between(wo, wi).map_or(0.0, |facet| self.density(&facet))
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let Some(facet) = Facet::between(wo, wi) else { return (Rgb::ZERO, 0.0) };
        let g = (1.0 + self.lambda(wo) + self.lambda(wi)).recip();
        let f = 0.25 * self.distribution.d(facet.wm) / wo.z * g / wi.z;
        (self.reflectance(wi, &facet) * f, self.density(&facet))
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let wi = reflect_at(wo, self.distribution.sample_all(u))?;
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f * wi.z / pdf, pdf, delta: false })
    }
}

/// Glass with Schlick's polynomial of one cosine for both sides; see [`ReportConventions::single_cosine_schlick`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportGlass {
    pub reflectance: Rgb,
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    pub eta: f32,
}

impl Scatter for ReportGlass {
    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let (cos, eta) = (wo.z.abs(), if wo.z < 0.0 { self.eta.recip() } else { self.eta });
        let cos_t = dielectric::eta_cos_t(cos, eta).map(|g| g / eta);
        let reflected = schlick::schlick_incident_cosine(cos, eta);
        split(wo, uc, eta, reflected, cos_t, self.reflectance, self.transmittance)
    }
}

/// The density that the second report prints for its sampled direction, D(m)/(4 wo·m): without the factor cos θₘ.
///
/// It is not the density of the report's own routine: at α = 0.5 from above it integrates to 1.086.
#[must_use]
pub fn printed_pdf(distribution: Beckmann<f32>, wo: Vec3, wi: Vec3) -> f32 {
    Facet::between(wo, wi).map_or(0.0, |facet| 0.25 * distribution.d(facet.wm) / facet.cos)
}

/// Density of the normal as the course forms it, p_θ p_φ / sin θ with p_θ = 2 sin θ/(α² cos³θ) exp(−tan²θ/α²) and
/// p_φ = 1/2π: D cos θ, but 0/0 for the normal that u = 0 draws.
#[must_use]
pub fn normal_pdf_by_angles(alpha: f32, theta: f32) -> f32 {
    let (sin, cos) = theta.sin_cos();
    let tan = sin / cos;
    let p_theta = 2.0 * sin / (alpha * alpha * cos * cos * cos) * (-(tan * tan) / (alpha * alpha)).exp();
    p_theta * (0.5 * std::f32::consts::FRAC_1_PI) / sin
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductor;
    use crate::optics::metals::by_name;

    /// How far the two ways along a path differ at most under `fresnel_at_normal`, relative to the smaller.
    fn unequal(eta: f64, k: f64, fresnel: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let at = |degrees: i32| fresnel((f64::from(degrees) * 0.1).to_radians().cos(), eta, k);
        let (mut least, mut most) = (f64::INFINITY, 0f64);
        for f in (0..=900).map(at) {
            (least, most) = (least.min(f), most.max(f));
        }
        most / least - 1.0
    }

    #[test]
    fn fresnel_at_the_normal_is_not_reciprocal() {
        let known = [("Ag", 0.0228), ("Al", 0.1342), ("Au", 1.4800), ("Cu", 0.8167), ("Fe", 1.0490)];
        for (symbol, expected) in known {
            let metal = by_name(symbol).unwrap();
            let blue = unequal(metal.eta[2], metal.k[2], |c, e, k| conductor::fresnel(c, e, k).unpolarized());
            assert!((blue - expected).abs() < 1e-4, "{symbol}: {blue}");
        }
    }

    #[test]
    fn one_cosine_misses_internal_reflection() {
        let (eta, n) = (1.0 / 1.5f64, 100_000);
        let report = |c: f64| {
            if dielectric::eta_cos_t(c, eta).is_some() { schlick::schlick_incident_cosine(c, eta) } else { 1.0 }
        };
        let exact = |c: f64| dielectric::fresnel(c, eta).unpolarized();
        for (degrees, drawn, truth) in [(30f64, 0.040, 0.055), (40.0, 0.041, 0.245), (41.5, 0.041, 0.542)] {
            let c = degrees.to_radians().cos();
            assert!((report(c) - drawn).abs() < 5e-4 && (exact(c) - truth).abs() < 5e-4, "{degrees}");
        }
        // Of even light from inside: ∫ F 2c dc.
        let mean = |f: &dyn Fn(f64) -> f64| {
            (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).map(|c| 2.0 * c * f(c)).sum::<f64>() / f64::from(n)
        };
        assert!((mean(&report) - 0.5734).abs() < 1e-4 && (mean(&exact) - 0.5963).abs() < 1e-4);
    }

    #[test]
    fn the_density_by_angles_is_not_a_number_at_the_pole() {
        assert!(normal_pdf_by_angles(0.3, 0.0).is_nan());
        let (alpha, theta) = (0.3f32, 0.2f32);
        let wm = [theta.sin(), 0.0, theta.cos()];
        assert!((normal_pdf_by_angles(alpha, theta) / Beckmann::new(alpha).pdf_all(wm) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_printed_density_is_too_much() {
        let distribution = Beckmann::new(0.5);
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = [i / n, i % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
            let wi = crate::sampling::warp::uniform_hemisphere(u).as_vec3();
            sum += f64::from(printed_pdf(distribution, Vec3::Z, wi));
        }
        let mass = sum * std::f64::consts::TAU / f64::from(n * n);
        assert!((mass - 1.0857).abs() < 1e-3, "{mass}");
    }
}
