//! The suite: every sampler of the project, families that belong together in one file.

pub mod adjoint;
mod bsdfs;
pub mod camera;
pub(super) mod inputs;
pub mod light_paths;
pub mod lights;
pub mod maps;
pub mod renders;
pub mod techniques;
mod warps;
mod whole_bsdfs;

use super::case::Case;

/// All cases, family by family.
pub fn cases() -> Vec<Case> {
    let bsdfs = bsdfs::cases().into_iter().map(|(_, case)| case).collect();
    let families = [warps::warps(), warps::tables(), maps::maps(), maps::cuts(), warps::normals(), bsdfs];
    families
        .into_iter()
        .chain([
            whole_bsdfs::cases(),
            lights::directions(),
            lights::selections(),
            light_paths::cases(),
            adjoint::cases(),
            camera::cameras(),
            camera::filters(),
            renders::cases(),
            techniques::cases(),
        ])
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::run;
    use super::*;
    use etalon_core::envmap::samplers::{self, Method};
    use etalon_stats::{Protocol, SampleCount};
    use std::collections::{BTreeMap, HashSet};

    #[test]
    fn there_are_many_cases_and_each_has_a_name_of_its_own() {
        let cases = cases();
        let names: HashSet<&str> = cases.iter().map(|case| case.name.as_str()).collect();
        assert!(cases.len() >= 200 && names.len() == cases.len(), "{} of {}", names.len(), cases.len());
    }

    #[test]
    fn every_bsdf_and_every_map_sampler_has_a_case() {
        let tested: HashSet<&str> = bsdfs::cases().into_iter().map(|(bsdf, _)| bsdf).collect();
        for (name, _) in etalon_core::bsdf::ALL {
            assert!(tested.contains(name), "{name}");
        }
        let cases = maps::maps();
        for entry in samplers::ALL.iter().filter(|entry| !matches!(entry.method, Method::FixedLights(_))) {
            let prefix = format!("map/nave/{}", entry.name);
            assert!(cases.iter().any(|case| case.name.starts_with(&prefix)), "{prefix}");
        }
    }

    /// All cases, but every third of the many configurations of a BSDF or of its normals. `etalon validate` runs all.
    fn chosen() -> Vec<Case> {
        let group = |case: &Case| case.name.split('/').take(2).collect::<Vec<_>>().join("/");
        let mut groups: BTreeMap<String, Vec<Case>> = BTreeMap::new();
        for case in cases() {
            groups.entry(group(&case)).or_default().push(case);
        }
        let of_group = |(name, cases): (String, Vec<Case>)| {
            let is_large =
                cases.len() > 6 && ["bsdf", "whole", "normals"].iter().any(|family| name.starts_with(family));
            cases.into_iter().step_by(if is_large { 3 } else { 1 })
        };
        groups.into_iter().flat_map(of_group).collect()
    }

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn right_samplers_are_accepted() {
        let cases = chosen();
        assert!(2 * cases.len() >= super::cases().len(), "{} cases", cases.len());
        let protocol = Protocol { samples: SampleCount::Detect(0.05), ..Protocol::default() };
        let found = run(&cases, &protocol, &|_| ()).unwrap();
        let others: Vec<_> = found.tests.iter().filter(|test| !test.outcome.is_accepted()).collect();
        assert!(others.is_empty(), "{others:?}");
        assert!(found.uniformity.p > 5e-4, "{:?}", found.uniformity);
    }
}
