//! Planted faults: mistakes that people make, each in a sampler or a pdf small enough to read, which the suite must
//! reject. Without its mistake each is a test of its own that must be accepted, so that the rejection is not due to the
//! setting.

mod fault;
mod findings;
mod glass;
mod hemispheres;
mod lights;
mod maps;
mod normals;
mod reflection;
mod renders;
mod tables;

pub use fault::PlantedFault;
pub use findings::{By, Finding, Findings, run};

/// All planted faults, family by family.
#[must_use]
pub fn all() -> Vec<PlantedFault> {
    [
        hemispheres::faults(),
        lights::faults(),
        tables::faults(),
        maps::faults(),
        normals::faults(),
        reflection::faults(),
        glass::faults(),
        renders::faults(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
