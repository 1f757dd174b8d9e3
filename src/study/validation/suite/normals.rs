//! Microfacet normals, in f64 and in f32.

use super::{ALPHAS, Case, DEGREES, DISTRIBUTIONS, short, towards};
use crate::optics::microfacet::{Beckmann, Distribution, Ggx};
use crate::sampling::normals::SampleNormals;
use etalon_stats::{Directions, Pole, Sample, density, sampler};
use glam::DVec3;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, distribution) in DISTRIBUTIONS {
        for alpha in ALPHAS {
            let both = |tail: String, wo: Option<DVec3>| match distribution {
                Distribution::Beckmann => [
                    double(format!("normals/{name}/{tail}"), Beckmann::new(alpha), wo),
                    single(format!("normals-f32/{name}/{tail}"), Beckmann::new(alpha as f32), wo),
                ],
                Distribution::Ggx => [
                    double(format!("normals/{name}/{tail}"), Ggx::new(alpha), wo),
                    single(format!("normals-f32/{name}/{tail}"), Ggx::new(alpha as f32), wo),
                ],
            };
            cases.extend(both(format!("all/{alpha}"), None));
            for degrees in DEGREES {
                cases.extend(both(format!("visible/{alpha}/{degrees}"), Some(towards(degrees))));
            }
        }
    }
    cases
}

/// NormalSampling of the full distribution (NDF), or visible from `wo` (VNDF).
fn double(name: String, d: impl SampleNormals<f64> + Send + Sync + 'static, wo: Option<DVec3>) -> Case {
    Case::of(name, Directions::hemisphere(Pole::Z), move || {
        let draw = move |u: &[f64]| {
            let u = [u[0], u[1]];
            let wm = wo.map_or_else(|| d.sample_ndf(u), |wo| d.sample_vndf(wo.to_array(), u));
            Some(Sample::new(wm))
        };
        let pdf = move |wm: [f64; 3]| wo.map_or_else(|| d.pdf_ndf(wm), |wo| d.pdf_vndf(wo.to_array(), wm));
        (sampler(2, draw), density(pdf))
    })
}

/// The same in single precision, with random numbers of 24 bits.
fn single(name: String, d: impl SampleNormals<f32> + Send + Sync + 'static, wo: Option<DVec3>) -> Case {
    let wo = wo.map(|wo| wo.as_vec3().to_array());
    Case::of(name, Directions::hemisphere(Pole::Z), move || {
        let draw = move |u: &[f64]| {
            let u = [short(u[0]), short(u[1])];
            let wm = wo.map_or_else(|| d.sample_ndf(u), |wo| d.sample_vndf(wo, u));
            Some(Sample::new(wm.map(f64::from)))
        };
        let pdf = move |wm: [f64; 3]| {
            let wm = wm.map(|x| x as f32);
            f64::from(wo.map_or_else(|| d.pdf_ndf(wm), |wo| d.pdf_vndf(wo, wm)))
        };
        (sampler(2, draw), density(pdf))
    })
}
