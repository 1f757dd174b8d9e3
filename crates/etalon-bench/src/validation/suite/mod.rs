//! The suite: every sampler of the project, families that belong together in one file; and what cases share: BSDFs of the list, roughnesses,
//! angles, directions, random numbers of 24 bits; samplers as the kernel calls them, many samples at once in lanes.

pub mod adjoint;
mod bsdfs;
pub mod camera;
pub mod light_paths;
pub mod lights;
pub mod maps;
pub mod renders;
pub mod techniques;
mod warps;
mod whole_bsdfs;

use super::case::Case;
use etalon_core::bsdf::{Bsdf, Family};
use etalon_core::optics::metals::SILVER;
use etalon_core::optics::microfacet::Distribution;
use etalon_render::probe::{LANES, Lane};
use etalon_stats::{Result, Sample, Sampler};
use glam::DVec3;

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

/// Roughnesses α at which microfacets are tested.
pub const ALPHAS: [f64; 7] = [1e-4, 1e-3, 0.01, 0.05, 0.25, 0.5, 1.0];
/// Angles of incidence in degrees at which microfacets are tested.
pub const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99];
/// The distributions of normals, by their names in the names of tests.
pub const DISTRIBUTIONS: [(&str, Distribution); 2] = [("beckmann", Distribution::Beckmann), ("ggx", Distribution::Ggx)];

pub fn bsdf(family: &str, values: &[f64]) -> Bsdf {
    Family::named(family).expect("a family of the list").with(values)
}

/// A rough metal of the distribution of this name, like silver in red light; its directions do not depend on η and k.
pub fn metal(distribution: &str, [x, y]: [f64; 2]) -> Bsdf {
    bsdf(distribution, &[x, y, SILVER.eta[0], SILVER.k[0]])
}

/// A rough dielectric of the distribution of this name.
pub fn boundary(distribution: &str, [x, y]: [f64; 2], eta: f64) -> Bsdf {
    bsdf(&format!("{distribution}-dielectric"), &[x, y, eta])
}

/// The direction at that angle in degrees with +z, at azimuth 0: a lobe is then not cut by the edge of the chart.
pub fn towards(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// A random number as renders use it in f32: rounded down to 24 bits.
pub fn short(u: f64) -> f32 {
    const LEVELS: f64 = 16_777_216.0;
    ((u * LEVELS).floor() / LEVELS) as f32
}

/// A [`Sampler`] of many samples at once; see [`in_lanes`].
pub struct InLanes<F, const N: usize>(F);

/// The sampler whose `sample` maps `N` pairs of random numbers for each of the first lanes, as many as it is told, to
/// the samples of these lanes.
pub fn in_lanes<F, const N: usize>(sample: F) -> InLanes<F, N>
where
    F: Fn(&[[Lane; 2]; N], usize) -> Vec<Option<Sample>> + Sync,
{
    InLanes(sample)
}

impl<F, const N: usize> Sampler for InLanes<F, N>
where
    F: Fn(&[[Lane; 2]; N], usize) -> Vec<Option<Sample>> + Sync,
{
    fn dimension(&self) -> usize {
        2 * N
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        for batch in u.chunks(2 * N * LANES) {
            let mut lanes = [[[0.0; LANES]; 2]; N];
            for (i, numbers) in batch.chunks_exact(2 * N).enumerate() {
                for (k, &u) in numbers.iter().enumerate() {
                    lanes[k / 2][k % 2][i] = short(u);
                }
            }
            out.extend((self.0)(&lanes, batch.len() / (2 * N)));
        }
        Ok(())
    }
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
