//! A rough conductor with errors of the second report, as [`MetalErrors`] select them.

use super::examples::{ALPHA, ETA, Example, Family, K, gold, grey};
use super::rough_conductor::{Facet, reflect_at};
use super::{Bsdf, BsdfSample, ConductorFresnel, Lobe, Scatter};
use crate::errata::microfacet::{MetalErrors, direction_pdf_without_cosine, lambda_with_pi};
use crate::math::Rgb;
use crate::optics::conductor::fresnel_approximate;
use crate::optics::microfacet::{Beckmann, Microfacet};
use crate::sampling::normals::SampleNormals;
use etalon_stats::bsdf::Energy;
use glam::Vec3;

/// A rough conductor of Beckmann's distribution with errors, visible from the side of the
/// normal (z > 0).
///
/// Directions are sampled by the full distribution of normals, with their true pdf. The pdf that the second report prints
/// is [`pdf_without_cosine`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrataConductor {
    pub distribution: Beckmann<f32>,
    pub fresnel: ConductorFresnel,
    pub errors: MetalErrors,
}

impl ErrataConductor {
    /// F at the right cosine or at that of the surface, exact or approximate.
    #[inline]
    fn reflectance(&self, wi: Vec3, facet: &Facet) -> Rgb {
        let cos = if self.errors.fresnel_at_normal { wi.z } else { facet.cos };
        if !self.errors.approximate_fresnel {
            return self.fresnel.reflectance(cos);
        }
        let channel = |eta, k| fresnel_approximate(cos, eta, k).unpolarized();
        let ConductorFresnel { eta, k, .. } = self.fresnel;
        Rgb::new(channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z))
    }

    /// Smith's Λ, or what the report has in its place.
    #[inline]
    fn lambda(&self, w: Vec3) -> f32 {
        if !self.errors.lambda_with_pi {
            return self.distribution.lambda(w.to_array());
        }
        lambda_with_pi(w.z / (self.distribution.widths().along_x() * w.truncate().length()))
    }

    /// Pdf of the direction that `facet` reflects to, D cos θₘ / (4 wo·m).
    #[inline]
    fn density(&self, facet: &Facet) -> f32 {
        0.25 * self.distribution.pdf_ndf(facet.wm) / facet.cos
    }
}

impl Scatter for ErrataConductor {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::GlossyReflection]
    }

    fn is_reciprocal(&self) -> bool {
        false
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Facet::between(wo, wi).map_or(0.0, |facet| self.density(&facet))
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let Some(facet) = Facet::between(wo, wi) else { return (Rgb::ZERO, 0.0) };
        let g = (1.0 + self.lambda(wo) + self.lambda(wi)).recip();
        // Λ is infinite next to the horizon, where 1/cos overflows as well.
        let f = if g > 0.0 { 0.25 * self.distribution.d(facet.wm) / wo.z * g / wi.z } else { 0.0 };
        (self.reflectance(wi, &facet) * f, self.density(&facet))
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let wi = reflect_at(wo, self.distribution.sample_ndf(u))?;
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::reflected(wi, f * wi.z / pdf, pdf, Lobe::GlossyReflection))
    }
}

/// The pdf that the second report prints for its sampled direction: [`direction_pdf_without_cosine`].
pub fn pdf_without_cosine(distribution: Beckmann<f32>, wo: Vec3, wi: Vec3) -> f32 {
    Facet::between(wo, wi).map_or(0.0, |facet| direction_pdf_without_cosine(distribution.d(facet.wm), facet.cos))
}

pub(super) const FAMILIES: &[Family] = &[Family {
    name: "errata-conductor",
    parameters: &[ALPHA, ETA, K],
    energy: Energy::MayExceedOne("its shadowing term does"),
    bsdf: |v| with_all_errors(v[0], grey(v[1], v[2])),
    examples: |family| {
        vec![Example { energy: family.energy, ..Example::new(family.name, || with_all_errors(0.3, gold())) }]
    },
}];

fn with_all_errors(alpha: f32, fresnel: ConductorFresnel) -> Bsdf {
    let distribution = Beckmann::new(alpha);
    Bsdf::ErrataConductor(ErrataConductor { distribution, fresnel, errors: MetalErrors::ALL })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductor;
    use crate::optics::metals::by_name;

    /// The largest relative difference between f(wo, wi) and f(wi, wo) under `fresnel_at_normal`.
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
    fn the_printed_pdf_integrates_to_more_than_one() {
        let distribution = Beckmann::new(0.5);
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = [i / n, i % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
            let wi = crate::sampling::warp::uniform_hemisphere(u).as_vec3();
            sum += f64::from(pdf_without_cosine(distribution, Vec3::Z, wi));
        }
        let mass = sum * std::f64::consts::TAU / f64::from(n * n);
        assert!((mass - 1.0857).abs() < 1e-3, "{mass}");
    }
}
