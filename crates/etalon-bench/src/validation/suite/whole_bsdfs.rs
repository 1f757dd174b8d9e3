//! Whole BSDFs: values, weights, pdfs and energy of every BSDF of the registry, each against the others.
//!
//! Exact checks for many parameters and angles; those that integrate, or take samples, for fewer. Samples against the pdf are
//! tested by the family `bsdf`.

use super::super::case::Case;
use super::super::families::Scattering;
use super::super::whole;
use super::{DISTRIBUTIONS, boundary, bsdf, metal, towards};
use etalon_core::bsdf::{Bsdf, Mixture, Scatter, examples};
use etalon_core::optics::metals::SILVER;
use etalon_stats::Outcome;
use etalon_stats::bsdf::{Direction, Energy, same_light, same_values};
use glam::Vec3;
use std::sync::Arc;

/// Angles in degrees, from both sides of the surface.
const DEGREES: [f64; 12] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99, 90.01, 91.0, 100.0, 120.0, 150.0, 180.0];
/// Those at which BSDFs are sampled and integrated.
const FEW_DEGREES: [f64; 3] = [25.0, 75.0, 140.0];

/// The directions at these angles, in no symmetric position to the tangents.
fn directions(degrees: &[f64]) -> Vec<Direction> {
    let turned = |&degrees: &f64| {
        let w = towards(degrees);
        glam::DVec3::new(0.8 * w.x, 0.6 * w.x, w.z).as_vec3().as_dvec3().to_array()
    };
    degrees.iter().map(turned).collect()
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for example in examples().into_iter().map(Arc::new) {
        let exact = Arc::clone(&example);
        cases.push(Case::new(format!("whole/{}/exact", example.name), move |protocol, round| {
            whole::exact(&Scattering::new((exact.bsdf)(), exact.energy), &directions(&DEGREES), protocol, round)
        }));
        if example.is_integrated {
            cases.push(Case::new(format!("whole/{}/light", example.name), move |protocol, round| {
                let bsdf = (example.bsdf)();
                // Conductors are black from below; a mixture of one with others is not.
                let is_black = [0.0, 0.5].into_iter().all(|uc| bsdf.sample(Vec3::NEG_Z, uc, [0.5; 2]).is_none());
                let degrees = if is_black { &FEW_DEGREES[..2] } else { &FEW_DEGREES };
                whole::light(&Scattering::new(bsdf, example.energy), &directions(degrees), protocol, round)
            }));
        }
    }
    cases.extend(limits());
    cases
}

/// Pairs that must agree: a rough boundary of α = 10⁻³ and a smooth one, to a few α; a lobe of weight 0 and none.
fn limits() -> Vec<Case> {
    const ALPHA: f32 = 1e-3;
    let (alpha, tolerance) = ([f64::from(ALPHA); 2], Some(f64::from(5.0 * ALPHA)));
    let mut cases = Vec::new();
    for (name, _) in DISTRIBUTIONS {
        let dielectrics = [boundary(name, alpha, 1.5), bsdf("dielectric", &[1.5])];
        let polished = bsdf("smooth-conductor", &[SILVER.eta[0], SILVER.k[0]]);
        let paint = bsdf("diffuse", &[0.5]);
        let mixture = Bsdf::Mixture(Mixture::new([(1.0, paint.clone()), (0.0, metal(name, [0.3; 2]))]));
        let metals = [metal(name, alpha), polished];
        cases.extend([
            limit(format!("whole/limit/smooth-dielectric/{name}"), dielectrics, tolerance),
            limit(format!("whole/limit/smooth-conductor/{name}"), metals, tolerance),
            limit(format!("whole/limit/weight-of-zero/{name}"), [mixture, paint], None),
        ]);
    }
    cases
}

/// Compares two BSDFs by what they do to smooth light, or value by value.
fn limit(name: String, pair: [Bsdf; 2], tolerance: Option<f64>) -> Case {
    Case::new(name, move |protocol, _| {
        let [a, b] = pair.clone().map(|bsdf| Scattering::new(bsdf, Energy::AtMostOne));
        let compare = |wo: Direction| match tolerance {
            Some(tolerance) => same_light(&a, &b, wo, tolerance, protocol),
            None => same_values(&a, &b, wo, protocol),
        };
        let all = directions(&[0.0, 30.0, 70.0, 150.0]).into_iter().map(compare);
        let all = all.collect::<etalon_stats::Result<Vec<Outcome>>>()?.into_iter();
        Ok(all.reduce(|first, next| if first.violation.is_some() { first } else { next }).unwrap_or_default())
    })
}
