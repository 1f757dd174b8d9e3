//! A thin slab of a dielectric, whose two interfaces are one surface.
//!
//! Each interface reflects the share R by Fresnel's equations and transmits T = 1 − R. Light that is reflected any number of times
//! between them leaves on either side; without interference the series sums to
//!
//! R' = R + T² R/(1 − R²) = 2R/(1 + R), T' = 1 − R'.
//!
//! The interfaces are parallel, so that transmitted light keeps its direction, and the media on both sides are the same, so that it
//! keeps its radiance. The slab absorbs nothing, and is as thin as to shift no ray.
//!
//! Source: Stokes, "On the Intensity of the Light Reflected from or Transmitted through a Pile of Plates", 1862; as a BSDF Pharr, Jakob
//! and Humphreys, "Physically Based Rendering", 4th edition, 2023, section 9.5.1.

use super::examples::{Family, GLASS};
use super::mirror::reflect;
use super::{Bsdf, BsdfSample, Lobe, Scatter};
use crate::math::Rgb;
use crate::optics::dielectric;
use etalon_stats::bsdf::Energy;
use glam::Vec3;

/// A thin slab, on either side. Reflection is sampled with the probability R'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinDielectric {
    /// Index of refraction of the slab over that of the medium around it.
    pub eta: f32,
}

impl ThinDielectric {
    /// R' and T'.
    #[inline]
    fn shares(&self, w: Vec3) -> [f32; 2] {
        let r = dielectric::fresnel(w.z.abs(), self.eta).unpolarized();
        let reflected = 2.0 * r / (1.0 + r);
        [reflected, 1.0 - reflected]
    }
}

impl Scatter for ThinDielectric {
    fn lobes(&self) -> &[Lobe] {
        &[Lobe::SpecularReflection, Lobe::SpecularTransmission]
    }

    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, _u: [f32; 2]) -> Option<BsdfSample> {
        let [reflected, transmitted] = self.shares(wo);
        Some(if uc < reflected {
            BsdfSample::specular_reflection(reflect(wo), Rgb::ONE, reflected)
        } else {
            BsdfSample::specular_transmission(-wo, Rgb::ONE, transmitted, 1.0)
        })
    }

    fn lobe_probability(&self, wo: Vec3, lobe: Lobe) -> f32 {
        let [reflected, transmitted] = self.shares(wo);
        match lobe {
            Lobe::SpecularReflection => reflected,
            Lobe::SpecularTransmission => transmitted,
            _ => 0.0,
        }
    }
}

pub(super) const FAMILIES: &[Family] = &[Family {
    name: "thin-dielectric",
    parameters: &[GLASS],
    energy: Energy::Conserved(0.0),
    bsdf: |v| Bsdf::ThinDielectric(ThinDielectric { eta: v[0] }),
    examples: |family| [1.5, 0.4].map(|eta| family.example(format!("{}/{eta}", family.name), [eta])).into(),
}];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_all_reflections_between_the_interfaces() {
        for eta in [1.0f32, 1.2, 1.5, 2.4, 1.0 / 1.5] {
            for degrees in [0.0f64, 30.0, 60.0, 85.0] {
                let wo = Vec3::new(degrees.to_radians().sin() as f32, 0.0, degrees.to_radians().cos() as f32);
                let slab = ThinDielectric { eta };
                // Light inside is reflected k times before it leaves: on this side for odd k, on the other for even k.
                let r = dielectric::fresnel(f64::from(wo.z), f64::from(eta)).unpolarized();
                let leaves = |k: i32| (1.0 - r).powi(2) * r.powi(k);
                let back: f64 = r + (0..2000).map(|k| leaves(2 * k + 1)).sum::<f64>();
                let through: f64 = (0..2000).map(|k| leaves(2 * k)).sum();
                for (lobe, expected) in [(Lobe::SpecularReflection, back), (Lobe::SpecularTransmission, through)] {
                    for side in [wo, -wo] {
                        let found = f64::from(slab.lobe_probability(side, lobe));
                        assert!((found - expected).abs() < 1e-6, "{eta} {degrees}: {found} {expected}");
                    }
                }
                let samples = [0.0, 1.0 - f32::EPSILON].map(|uc| slab.sample(wo, uc, [0.5; 2]).unwrap());
                assert!(r == 0.0 || samples[0].wi == reflect(wo));
                assert!(r == 1.0 || samples[1].wi == -wo && samples[1].eta == 1.0);
            }
        }
    }
}
