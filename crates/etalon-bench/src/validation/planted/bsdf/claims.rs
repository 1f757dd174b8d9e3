//! BSDFs that are consistent in themselves and not the model that they claim to be.

use super::super::fault::PlantedFault;
use super::faulty::{Change, Faulty};
use super::rough::{Facets, Rough};
use crate::likeness::Claim;
use crate::validation::case::Case;
use etalon_stats::bsdf::Bsdf;

const ALPHA: f64 = 0.3;

fn metal(alpha: f64) -> Rough {
    Rough { alpha: [alpha; 2], facets: Facets::Conductor(0.7) }
}

pub fn faults() -> Vec<PlantedFault> {
    let fault = |name: &'static str, wrong: Faulty<Rough>, mistake| {
        let case = |kind: &str, bsdf: Faulty<Rough>| {
            let claim = move || Claim::new("ggx", &[("alpha".to_owned(), ALPHA)])?.of_bsdf(&bsdf);
            Case::new(format!("{kind}/{name}"), move |_, _| claim())
        };
        let right = Faulty { right: metal(ALPHA), change: None };
        PlantedFault { name, mistake, faulty: case("planted", wrong), sound: case("sound", right) }
    };
    let separable =
        Change::ValueAndWeight(|m: &Rough, wo, wi| m.eval(wo, wi, &[])[0] * m.g1(wo) * m.g1(wi) / m.g2(wo, wi));
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
