//! Directions that BSDFs scatter into: diffuse ones, rough conductors by every way to sample their normals and by other
//! conventions.
//!
//! Everything in f32 as renders do it, with random numbers of 24 bits; the pdfs are those by which renders divide.

use super::super::case::Case;
use super::inputs::{ALPHAS, DEGREES, DISTRIBUTIONS, short, towards};
use crate::bsdf::{Bsdf, NormalSampling, Scatter};
use crate::errata::Conventions;
use crate::math::Rgb;
use crate::optics::metals::SILVER;
use crate::optics::microfacet::Distribution;
use crate::sampling::direction_density;
use crate::scene::{Conductor, Material, ScatterModel};
use etalon_stats::{Directions, Mass, Pole, Sample, sampler};
use glam::{DVec3, Vec3};

/// A rough metal; its directions do not depend on η and k.
fn metal(alpha: f64, distribution: Distribution) -> Material {
    let (eta, k) = (SILVER.eta_rgb(), SILVER.k_rgb());
    Material::Conductor(Conductor { eta, k, alpha: alpha as f32, distribution, two_sided: false })
}

/// The cases, each with its BSDF's name in the registry.
pub fn cases() -> Vec<(&'static str, Case)> {
    let mut cases = Vec::new();
    let half = Directions::hemisphere(Pole::Z);
    for (name, distribution) in DISTRIBUTIONS {
        for alpha in ALPHAS {
            for degrees in DEGREES {
                for (how, normals) in [("visible", NormalSampling::Vndf), ("all", NormalSampling::Ndf)] {
                    let bsdf = metal(alpha, distribution).bsdf(ScatterModel { normals, ..ScatterModel::default() });
                    let name = format!("bsdf/{name}/{how}/{alpha}/{degrees}");
                    cases.push(scattered(name, half, bsdf, towards(degrees), Mass::AtMostOne));
                }
            }
        }
        // Uniform over the hemisphere for every roughness.
        let uniform = ScatterModel { normals: NormalSampling::Hemisphere, ..ScatterModel::default() };
        for degrees in DEGREES {
            let bsdf = metal(0.25, distribution).bsdf(uniform);
            let name = format!("bsdf/{name}/hemisphere/0.25/{degrees}");
            cases.push(scattered(name, half, bsdf, towards(degrees), Mass::Exactly(1.0)));
        }
    }
    let erroneous = ScatterModel { conventions: Conventions::SECOND_REPORT, ..ScatterModel::default() };
    for alpha in [0.005, 0.05, 0.25, 0.5] {
        for degrees in [0.0, 40.0, 80.0] {
            let bsdf = metal(alpha, Distribution::Beckmann).bsdf(erroneous);
            let name = format!("bsdf/report-metal/{alpha}/{degrees}");
            cases.push(scattered(name, half, bsdf, towards(degrees), Mass::AtMostOne));
        }
    }
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) }.bsdf(ScatterModel::default());
    for (side, wo) in [("outside", towards(60.0)), ("inside", -towards(60.0))] {
        let sphere = Directions::sphere(Pole::Z);
        cases.push(scattered(format!("bsdf/diffuse/{side}"), sphere, diffuse, wo, Mass::Exactly(1.0)));
    }
    cases
}

/// The directions that `bsdf` samples for `wo`.
fn scattered(name: String, domain: Directions, bsdf: Bsdf, wo: DVec3, mass: Mass) -> (&'static str, Case) {
    let wo: Vec3 = wo.as_vec3();
    let case = Case::of(name, domain, move || {
        let draw = move |u: &[f64]| {
            let sample = bsdf.sample(wo, 0.0, [short(u[0]), short(u[1])])?;
            Some(Sample::with_pdf(sample.wi.as_dvec3().to_array(), f64::from(sample.pdf)))
        };
        let pdf = move |wi: DVec3| f64::from(bsdf.pdf(wo, wi.as_vec3()));
        (sampler(2, draw), direction_density(pdf).with_mass(mass))
    });
    (bsdf.name(), case)
}
