//! Planted faults: frequent mistakes, each in a small sampler or pdf, which the suite must reject. The same test without
//! the mistake must be accepted, so that the mistake alone explains the rejection.

pub(super) mod bsdf;
mod fault;
mod lights;
pub(super) mod maps;
mod renders;
mod surfaces;
pub(super) mod warps;

#[cfg(test)]
pub(crate) use bsdf::{faulty, rough};
pub use fault::PlantedFault;
pub use fault::{By, Finding, Findings, run, run_pair};

pub fn all() -> Vec<PlantedFault> {
    [
        warps::numbers(),
        warps::hemispheres(),
        warps::domains(),
        warps::weights(),
        lights::lights(),
        lights::light_paths(),
        renders::importance(),
        renders::filters(),
        warps::tables(),
        maps::maps(),
        maps::cuts(),
        surfaces::normals(),
        surfaces::reflection(),
        surfaces::glass(),
        renders::images(),
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
