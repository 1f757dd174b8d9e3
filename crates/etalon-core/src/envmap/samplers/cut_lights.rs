//! Fixed directional lights in place of sampling, one for each region of a median cut.
//!
//! The estimate has bias but no noise. Source: Debevec, "A Median Cut Algorithm for Light
//! Probe Sampling", SIGGRAPH 2005 posters; by variance: Viriyothai & Debevec, "Variance Minimization Light Probe
//! Sampling", SIGGRAPH 2009 posters.

use super::contract::{Entry, FixedLight, Method};
use crate::envmap::EnvMap;
use crate::envmap::cut::{MedianCut, SideRule, Split};
use crate::error::Result;

/// The entry in the registry of lights by energy.
pub const MEDIAN_CUT: &Entry = &Entry {
    name: "median-cut",
    density: "median-cut",
    doc: "fixed lights in place of the map, one for each region of a cut by energy: with bias",
    complete: false,
    invertible: false,
    bytes_per_texel: MedianCut::bytes(Split::Energy),
    method: Method::FixedLights(|map, regions| lights(map, Split::Energy, regions)),
};

/// The entry in the registry of lights by variance.
pub const VARIANCE_CUT: &Entry = &Entry {
    name: "variance-cut",
    density: "variance-cut",
    doc: "fixed lights in place of the map, one for each region of a cut by variance: with bias",
    bytes_per_texel: MedianCut::bytes(Split::Variance),
    method: Method::FixedLights(|map, regions| lights(map, Split::Variance, regions)),
    ..*MEDIAN_CUT
};

fn lights(map: &EnvMap, split: Split, regions: u32) -> Result<Vec<FixedLight>> {
    let regions = MedianCut::new(map, split, SideRule::default()).regions(regions as usize)?;
    let light = |(x, y), irradiance| FixedLight { towards: map.geometry().direction(x, y), irradiance };
    Ok(regions.into_iter().map(|region| light(region.centroid, region.flux)).collect())
}
