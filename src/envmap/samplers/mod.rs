//! The registry of environment-map samplers: the ways to turn a map into samples of its light, one file each.
//!
//! The command line, `validate`, `converge` and the benchmarks take their lists from [`ALL`]. A new sampler is a file with an
//! [`Entry`], and its lines here.

pub mod alias;
pub mod batch;
pub mod cdf;
pub mod compensated;
pub mod conventional;
pub mod cosine;
pub mod cut_lights;
pub mod strata;
#[cfg(test)]
mod tests;

pub use alias::AliasSampler;
pub use batch::EnvSamples;
pub use cdf::CdfSampler;
pub use compensated::CompensatedSampler;
pub use conventional::ConventionalSampler;
pub use cosine::CosineSampler;
pub use strata::StrataSampler;

use super::EnvMap;
use crate::error::{Error, Result};
use crate::math::Rgb;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// Every sampler. Where a density has several, the first one stands for it.
pub const ALL: &[&Entry] = &[
    cdf::ENTRY,
    alias::ENTRY,
    compensated::ENTRY,
    cosine::ENTRY,
    strata::ENTRY,
    cut_lights::MEDIAN_CUT,
    cut_lights::VARIANCE_CUT,
];

/// What the registry knows of a sampler.
pub struct Entry {
    /// Name at the command line; where [`Entry::has_regions`], a number follows it: `strata-64`.
    pub name: &'static str,
    /// Name of what the pdf is proportional to, which is a name of the sampler, too.
    pub density: &'static str,
    /// What it samples in proportion to, and how, in one line.
    pub doc: &'static str,
    /// Whether it takes a number of regions that the map is cut into.
    pub has_regions: bool,
    /// Whether the pdf is positive wherever radiance comes from, so that it may be used without another strategy.
    pub complete: bool,
    /// Whether samples have an inverse; see [`SurfaceSampler::invert_for`].
    pub invertible: bool,
    /// Memory of its tables.
    pub bytes_per_texel: usize,
    /// How it is made.
    pub method: Method,
}

/// Makes a sampler of a map and a number of regions.
type Build = fn(Arc<EnvMap>, RegionCount) -> Result<Box<dyn SurfaceSampler>>;

/// The kinds of samplers, each with what makes it.
pub enum Method {
    /// Directions by the map alone.
    Directions(Build),
    /// Directions for a surface, by its normal.
    ForNormal(Build),
    /// No directions: fixed lights that stand for the map.
    FixedLights(fn(&EnvMap, RegionCount) -> Result<Vec<FixedLight>>),
}

/// Number of regions that a map is cut into.
pub type RegionCount = u32;

/// A direction sampled from a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvSample {
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Density per solid angle: the value that the sampler's `pdf(wi)` returns, to the last bit.
    pub pdf: f64,
    /// The map's radiance from there.
    pub radiance: Rgb,
}

/// A directional light that stands for a region of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedLight {
    /// Unit direction towards the light, in the map's frame.
    pub towards: DVec3,
    /// ∫ L dω over the region: what a surface that faces the light receives.
    pub irradiance: DVec3,
}

/// Samples directions towards a map's light.
pub trait DirectionSampler: Send + Sync {
    /// The direction for `u` in \[0, 1)²; `None` when the map is black.
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample>;

    /// Replaces `out` by the samples for all of `u`, which are none when the map is black.
    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        out.clear();
        u.iter().filter_map(|&u| self.sample(u)).for_each(|s| out.push(s));
    }

    /// Density of [`DirectionSampler::sample`] per solid angle.
    fn pdf(&self, wi: DVec3) -> f64;

    /// The `u` that [`DirectionSampler::sample`] maps to `wi`, if the sampler has an inverse.
    fn invert(&self, _wi: DVec3) -> Option<[f64; 2]> {
        None
    }
}

/// Samples directions towards the light that falls on a surface, whose normal it may take into account.
pub trait SurfaceSampler: Send + Sync {
    /// The direction for `u` in \[0, 1)² and a unit normal in the map's frame; `None` when there is no sample.
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample>;

    /// Replaces `out` by the samples that there are for all of `u`.
    fn sample_many_for(&self, u: &[[f64; 2]], normal: DVec3, out: &mut EnvSamples) {
        out.clear();
        u.iter().filter_map(|&u| self.sample_for(u, normal)).for_each(|s| out.push(s));
    }

    /// Density of [`SurfaceSampler::sample_for`] per solid angle.
    fn pdf_for(&self, wi: DVec3, normal: DVec3) -> f64;

    /// The `u` that [`SurfaceSampler::sample_for`] maps to `wi`, if the sampler has an inverse.
    fn invert_for(&self, _wi: DVec3, _normal: DVec3) -> Option<[f64; 2]> {
        None
    }
}

impl<T: DirectionSampler> SurfaceSampler for T {
    #[inline]
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        self.sample(u)
    }

    fn sample_many_for(&self, u: &[[f64; 2]], _normal: DVec3, out: &mut EnvSamples) {
        self.sample_many(u, out);
    }

    #[inline]
    fn pdf_for(&self, wi: DVec3, _normal: DVec3) -> f64 {
        self.pdf(wi)
    }

    fn invert_for(&self, wi: DVec3, _normal: DVec3) -> Option<[f64; 2]> {
        self.invert(wi)
    }
}

/// A sampler of the registry with its number of regions: what users name, `cosine` or `strata-64`.
#[derive(Clone, Copy)]
pub struct MapSampling {
    entry: &'static Entry,
    /// 0 where there are no regions.
    regions: RegionCount,
}

impl MapSampling {
    /// Radiance, by inversion.
    pub const MAP: Self = Self::new(cdf::ENTRY);
    /// Radiance times the cosine at the surface.
    pub const COSINE: Self = Self::new(cosine::ENTRY);
    /// Radiance less its mean.
    pub const COMPENSATED: Self = Self::new(compensated::ENTRY);

    /// A sampler that takes no number of regions (or, if it does, cannot be built).
    #[must_use]
    pub const fn new(entry: &'static Entry) -> Self {
        Self { entry, regions: 0 }
    }

    /// A sampler of so many regions, if it takes a number of them.
    #[must_use]
    pub const fn with_regions(entry: &'static Entry, regions: RegionCount) -> Self {
        Self { entry, regions: if entry.has_regions { regions } else { 0 } }
    }

    /// Its entry in the registry.
    #[must_use]
    pub const fn entry(self) -> &'static Entry {
        self.entry
    }

    /// Whether it looks at the surface's normal.
    #[must_use]
    pub fn needs_normal(self) -> bool {
        matches!(self.entry.method, Method::ForNormal(_))
    }

    /// Whether fixed lights stand for the map.
    #[must_use]
    pub fn has_fixed_lights(self) -> bool {
        matches!(self.entry.method, Method::FixedLights(_))
    }

    /// The name of its density, with the number of regions.
    #[must_use]
    pub fn density(self) -> String {
        self.numbered(self.entry.density)
    }

    fn numbered(self, name: &str) -> String {
        if self.entry.has_regions { format!("{name}-{}", self.regions) } else { name.to_owned() }
    }

    /// Builds the sampler's tables.
    ///
    /// # Errors
    /// [`Error::Memory`] for tables that do not fit, [`Error::Parameter`] for a number of regions that the map does not
    /// allow, and where there are no samples but [`MapSampling::fixed_lights`].
    pub fn sampler(self, map: Arc<EnvMap>) -> Result<Box<dyn SurfaceSampler>> {
        let (Method::Directions(build) | Method::ForNormal(build)) = self.entry.method else {
            return Err(Error::parameter("sampler", format!("{self} are fixed lights, which are not sampled")));
        };
        self.request(&map)?;
        build(map, self.regions)
    }

    /// The lights that stand for the map, if this is such a sampler.
    ///
    /// # Errors
    /// As [`MapSampling::sampler`].
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
        let table = if self.entry.has_regions { "the table of regions" } else { "the sampling table" };
        map.request(self.entry.bytes_per_texel, table)
    }

    /// The names of all samplers, `K` standing for a number of regions.
    #[must_use]
    pub fn names() -> Vec<String> {
        ALL.iter()
            .map(|entry| if entry.has_regions { format!("{}-K", entry.name) } else { entry.name.into() })
            .collect()
    }
}

impl Default for MapSampling {
    fn default() -> Self {
        Self::COSINE
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

    /// The sampler of that name, or the first one of that density.
    fn from_str(text: &str) -> Result<Self> {
        let of = |name: fn(&Entry) -> &'static str| {
            ALL.iter().find_map(|entry| {
                if !entry.has_regions {
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
