//! Planted faults: frequent mistakes, each in a small sampler or pdf, which the suite must reject. The same test without
//! the mistake must be accepted, so that the mistake alone explains the rejection.

mod bsdf;
mod fault;
mod filters;
mod findings;
mod glass;
mod hemispheres;
mod light_paths;
mod lights;
mod maps;
mod normals;
mod numbers;
mod reflection;
mod renders;
mod tables;

pub use fault::PlantedFault;
pub use findings::{By, Finding, Findings, run, run_pair};

/// All planted faults, family by family.
pub fn all() -> Vec<PlantedFault> {
    [
        numbers::faults(),
        hemispheres::faults(),
        lights::faults(),
        light_paths::faults(),
        filters::faults(),
        tables::faults(),
        maps::faults(),
        normals::faults(),
        reflection::faults(),
        glass::faults(),
        renders::faults(),
        bsdf::faults(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
