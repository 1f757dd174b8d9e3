//! A mistake in sampling the regions of a median cut as strata.

use super::super::suite::strata::{ENERGY, Share, strata};
use super::fault::PlantedFault;
use etalon_core::envmap::cut::Split;

pub fn faults() -> Vec<PlantedFault> {
    let name = "strata/equal-shares";
    let equal: Share = |_| 1.0;
    let [faulty, sound] = [("planted", equal), ("sound", ENERGY)]
        .map(|(kind, share)| strata(format!("{kind}/{name}"), Split::Energy, 16, share));
    let mistake = "regions of a median cut drawn with equal probabilities: texels are not divided, so that cuts halve the energy only nearly";
    vec![PlantedFault { name, mistake, faulty, sound }]
}
