//! Test cases: microfacet normals, in f64 and in f32.

use super::super::case::Case;
use super::inputs::{ALPHAS, DEGREES, DISTRIBUTIONS, short, towards};
use etalon_core::math::Real;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx};
use etalon_core::sampling::normals::SampleNormals;
use etalon_stats::{Directions, Pole, Sample, density, sampler};
use glam::DVec3;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, distribution) in DISTRIBUTIONS {
        for alpha in ALPHAS {
            let mut both = |tail: String, wo: Option<DVec3>| {
                let [double, single] = ["normals", "normals/f32"].map(|kind| format!("{kind}/{name}/{tail}"));
                let of_24_bits = |u| f64::from(short(u));
                cases.extend(match distribution {
                    Distribution::Beckmann => [
                        case::<f64>(double, Beckmann::new(alpha), wo, |u| u),
                        case::<f32>(single, Beckmann::new(alpha as f32), wo, of_24_bits),
                    ],
                    Distribution::Ggx => [
                        case::<f64>(double, Ggx::new(alpha), wo, |u| u),
                        case::<f32>(single, Ggx::new(alpha as f32), wo, of_24_bits),
                    ],
                });
            };
            both(format!("all/{alpha}"), None);
            for degrees in DEGREES {
                both(format!("visible/{alpha}/{degrees}"), Some(towards(degrees)));
            }
        }
    }
    cases
}

/// Samples of the full distribution (NDF), or of the normals visible from `wo` (VNDF), with random numbers by `random`.
fn case<T: Real + Send + Sync + 'static>(
    name: String,
    d: impl SampleNormals<T> + Send + Sync + 'static,
    wo: Option<DVec3>,
    random: fn(f64) -> f64,
) -> Case {
    let wo = wo.map(|wo| wo.to_array().map(T::from_f64));
    Case::of(name, Directions::hemisphere(Pole::Z), move || {
        let draw = move |u: &[f64]| {
            let u = [u[0], u[1]].map(|u| T::from_f64(random(u)));
            let wm = wo.map_or_else(|| d.sample_ndf(u), |wo| d.sample_vndf(wo, u));
            Some(Sample::new(wm.map(Real::to_f64)))
        };
        let pdf = move |wm: [f64; 3]| {
            let wm = wm.map(T::from_f64);
            wo.map_or_else(|| d.pdf_ndf(wm), |wo| d.pdf_vndf(wo, wm)).to_f64()
        };
        (sampler(2, draw), density(pdf))
    })
}
