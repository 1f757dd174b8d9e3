//! Mistakes in whole BSDFs, phase functions and lights: a right one of the textbook in f64, and one thing changed; and mistakes at limits, where a BSDF
//! should become another one.

mod coated;
pub(crate) mod compensated;
mod conductor;
mod dielectric;
mod emitters;
pub(crate) mod faulty;
pub(crate) mod mixture;
mod resampled;
pub(crate) mod rough;
pub(crate) mod smooth;

use super::super::case::Case;
use super::fault::PlantedFault;
use crate::likeness::Claim;
use compensated::Compensated;
use etalon_stats::bsdf::{BatchBsdf, Bsdf, same_light, same_values};
use etalon_stats::{Outcome, Protocol, Result};
use faulty::{Change, Faulty, towards};
use rough::{Facets, Rough};
use smooth::{Glass, Lambertian};

pub fn faults() -> Vec<PlantedFault> {
    [
        claims(),
        dielectric::faults(),
        conductor::faults(),
        smooth::faults(),
        mixture::faults(),
        compensated::faults(),
        coated::faults(),
        resampled::faults(),
        emitters::faults(),
        limits(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A comparison with the mistake (`true`) and without it.
fn limit(name: &'static str, compare: fn(bool, &Protocol) -> Result<Outcome>, mistake: &'static str) -> PlantedFault {
    let case = |kind: &str, faulty: bool| {
        Case::new(format!("{kind}/{name}"), move |protocol, _| Ok(compare(faulty, protocol)?))
    };
    PlantedFault { name, mistake, faulty: case("planted", true), sound: case("sound", false) }
}

fn limits() -> Vec<PlantedFault> {
    vec![
        limit(
            "whole/limit/alpha-clamped",
            |faulty, protocol| {
                let alpha = if faulty { 0.05 } else { 1e-4 };
                let rough = Rough { alpha: [alpha; 2], facets: Facets::Dielectric(1.5) };
                same_light(&rough, &Glass { index: 1.5 }, towards(50.0), 2e-3, protocol)
            },
            "α clamped to 0.05, where α → 0 should become a smooth surface",
        ),
        limit(
            "whole/limit/index-of-one",
            |faulty, protocol| {
                let index = if faulty { 1.0 + 0.1 } else { 1.0 + 1e-6 };
                let rough = Rough { alpha: [0.01; 2], facets: Facets::Dielectric(index) };
                same_light(&rough, &Glass { index: 1.0 + 1e-9 }, towards(50.0), 2e-3, protocol)
            },
            "η clamped to 1.1, where η → 1 should become no boundary",
        ),
        limit(
            "whole/limit/weight-of-zero",
            |faulty, protocol| {
                let paint = |albedo| Lambertian { albedo };
                same_values(&paint(if faulty { 1e-3 } else { 0.0 }), &paint(0.0), towards(50.0), protocol)
            },
            "a lobe of weight 0 that still reflects 0.1 %",
        ),
        limit(
            "whole/limit/compensation-not-switched-off",
            |faulty, protocol| {
                let rough = Rough { alpha: [0.8; 2], facets: Facets::Conductor(1.0) };
                let compensated = Compensated::new();
                let other: &dyn BatchBsdf = if faulty { &compensated } else { &rough };
                same_light(&rough, other, towards(50.0), 1e-9, protocol)
            },
            "compensation that stays on where it is switched off",
        ),
    ]
}

const ALPHA: f64 = 0.3;

fn metal(alpha: f64) -> Rough {
    Rough { alpha: [alpha; 2], facets: Facets::Conductor(0.7) }
}

/// BSDFs that are consistent in themselves and not the model that they claim to be.
fn claims() -> Vec<PlantedFault> {
    let fault = |name: &'static str, wrong: Faulty<Rough>, mistake| {
        let case = |kind: &str, bsdf: Faulty<Rough>| {
            let claim = move || Claim::new("ggx", &[("alpha".to_owned(), ALPHA)])?.of_bsdf(&bsdf);
            Case::new(format!("{kind}/{name}"), move |_, _| claim())
        };
        let right = Faulty { right: metal(ALPHA), change: None };
        PlantedFault { name, mistake, faulty: case("planted", wrong), sound: case("sound", right) }
    };
    let separable =
        Change::ValueAndWeight(|m: &Rough, wo, wi| Bsdf::eval(m, wo, wi, &[])[0] * m.g1(wo) * m.g1(wi) / m.g2(wo, wi));
    vec![
        fault(
            "whole/like/separable-masking",
            Faulty { right: metal(ALPHA), change: Some(separable) },
            "G₁ G₁ in values and weights for Smith's G₂ of correlated heights",
        ),
        fault(
            "whole/like/alpha-squared",
            Faulty { right: metal(ALPHA * ALPHA), change: None },
            "a roughness that is squared once more",
        ),
    ]
}
