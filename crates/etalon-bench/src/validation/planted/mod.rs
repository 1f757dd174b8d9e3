//! Planted faults: frequent mistakes, each in a small sampler or pdf, which the suite must reject. The same test without
//! the mistake must be accepted, so that the mistake alone explains the rejection.

mod bsdf;
mod camera;
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
mod strata;
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
        camera::faults(),
        filters::faults(),
        tables::faults(),
        maps::faults(),
        strata::faults(),
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

#[cfg(test)]
mod tests {
    use super::super::suite;
    use super::all;
    use std::collections::BTreeSet;

    #[test]
    fn suite_and_faults_have_the_same_families() {
        let family = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
        let tested: BTreeSet<String> = suite::cases().iter().map(|case| family(&case.name)).collect();
        let planted: BTreeSet<String> = all().iter().map(|fault| family(fault.name)).collect();
        assert_eq!(tested, planted);
    }
}
