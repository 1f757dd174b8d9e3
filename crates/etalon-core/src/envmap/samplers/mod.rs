//! The registry of environment-map samplers: the ways to turn a map into samples of its light, one file each.
//!
//! The command line, `validate`, `converge` and the benchmarks take their lists from [`ALL`]. A new sampler is a file with an
//! [`Entry`], and its lines here.

mod contract;
pub mod cosine;
pub mod cut_lights;
pub mod errata;
#[cfg(test)]
mod tests;
pub mod texels;

pub use contract::{BATCH, Entry, EnvSample, FixedLight, Method, RegionCount, SurfaceSampler};
pub use cosine::CosineSampler;
pub use errata::ErrataSampler;
pub use texels::TexelSampler;

use super::EnvMap;
use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

pub const ALL: &[&Entry] =
    &[texels::ENTRY, cosine::ENTRY, cosine::COMPENSATED, cut_lights::MEDIAN_CUT, cut_lights::VARIANCE_CUT];

/// A sampler of the registry with its number of regions: what users name, `cosine` or `median-cut-64`.
#[derive(Clone, Copy)]
pub struct MapSampling {
    entry: &'static Entry,
    /// 0 where there are no regions.
    regions: RegionCount,
}

impl MapSampling {
    /// Radiance, by inversion.
    pub const MAP: Self = Self::new(texels::ENTRY);
    /// Radiance times the cosine at the surface.
    pub const COSINE: Self = Self::new(cosine::ENTRY);
    /// Radiance minus its mean, times the cosine at the surface.
    pub const COSINE_COMPENSATED: Self = Self::new(cosine::COMPENSATED);

    /// A sampler that takes no number of regions (or, if it does, cannot be built).
    pub const fn new(entry: &'static Entry) -> Self {
        Self { entry, regions: 0 }
    }

    /// A sampler of n regions, if it takes a number of them.
    pub const fn with_regions(entry: &'static Entry, regions: RegionCount) -> Self {
        Self { entry, regions: if entry.has_fixed_lights() { regions } else { 0 } }
    }

    pub const fn entry(self) -> &'static Entry {
        self.entry
    }

    /// The number of its regions; 0 where there are none.
    pub const fn regions(self) -> RegionCount {
        self.regions
    }

    /// Whether it looks at the surface's normal.
    pub fn needs_normal(self) -> bool {
        matches!(self.entry.method, Method::ForNormal(_))
    }

    pub fn has_fixed_lights(self) -> bool {
        self.entry.has_fixed_lights()
    }

    /// The name of its density, with the number of regions.
    pub fn density(self) -> String {
        self.numbered(self.entry.density)
    }

    fn numbered(self, name: &str) -> String {
        if self.has_fixed_lights() { format!("{name}-{}", self.regions) } else { name.to_owned() }
    }

    /// Builds the sampler's tables.
    ///
    /// # Errors
    /// [`Error::Memory`] for tables that do not fit, [`Error::Parameter`] where there are no samples but
    /// [`MapSampling::fixed_lights`].
    pub fn sampler(self, map: Arc<EnvMap>) -> Result<Box<dyn SurfaceSampler>> {
        let (Method::Directions(build) | Method::ForNormal(build)) = self.entry.method else {
            return Err(Error::parameter("sampler", format!("{self} are fixed lights, which are not sampled")));
        };
        self.request(&map)?;
        Ok(build(map))
    }

    /// The lights that stand for the map, if this is such a sampler.
    ///
    /// # Errors
    /// [`Error::Memory`] for tables that do not fit, [`Error::Parameter`] for a number of regions that the map does not allow.
    pub fn fixed_lights(self, map: &EnvMap) -> Result<Option<Vec<FixedLight>>> {
        let Method::FixedLights(build) = self.entry.method else { return Ok(None) };
        self.request(map)?;
        build(map, self.regions).map(Some)
    }

    /// Asks for the memory of its tables.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn request(self, map: &EnvMap) -> Result<()> {
        let table = if self.has_fixed_lights() { "the table of regions" } else { "the sampling table" };
        map.request(self.entry.bytes_per_texel, table)
    }

    /// The names of all samplers, `K` standing for a number of regions.
    pub fn names() -> Vec<String> {
        ALL.iter().map(|entry| entry.name_with_k()).collect()
    }
}

impl PartialEq for MapSampling {
    fn eq(&self, other: &Self) -> bool {
        (self.entry.name, self.regions) == (other.entry.name, other.regions)
    }
}

impl Eq for MapSampling {}

impl fmt::Display for MapSampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.numbered(self.entry.name))
    }
}

impl fmt::Debug for MapSampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl FromStr for MapSampling {
    type Err = Error;

    /// The sampler of that name, or of that density.
    fn from_str(text: &str) -> Result<Self> {
        let of = |name: fn(&Entry) -> &'static str| {
            ALL.iter().find_map(|entry| {
                if !entry.has_fixed_lights() {
                    return (name(entry) == text).then_some(Self::new(entry));
                }
                let regions = text.strip_prefix(name(entry))?.strip_prefix('-')?;
                regions.parse().ok().map(|regions| Self::with_regions(entry, regions))
            })
        };
        of(|entry| entry.name).or_else(|| of(|entry| entry.density)).ok_or_else(|| {
            Error::parameter("sampler", format!("there is no sampler \"{text}\""))
                .with_hint(format!("samplers: {}", Self::names().join(", ")))
        })
    }
}
