//! The contract of every sampler of a map: its entry in the registry, its samples, the traits that generate them.

use crate::envmap::EnvMap;
use crate::error::Result;
use crate::math::Rgb;
use glam::DVec3;
use std::sync::Arc;

pub struct Entry {
    /// Name at the command line; the number of regions follows that of fixed lights: `median-cut-64`.
    pub name: &'static str,
    /// Name of what the pdf is proportional to, which is a name of the sampler, too.
    pub density: &'static str,
    /// What it samples in proportion to, and how, in one line.
    pub doc: &'static str,
    /// Whether the pdf is positive wherever radiance comes from, so that it may be used without another strategy.
    pub complete: bool,
    /// Whether samples have an inverse; see [`SurfaceSampler::invert_for`].
    pub invertible: bool,
    /// Memory of its tables.
    pub bytes_per_texel: usize,
    pub method: Method,
}

impl Entry {
    /// Whether fixed lights stand for the map, one for each region of a cut.
    pub const fn has_fixed_lights(&self) -> bool {
        matches!(self.method, Method::FixedLights(_))
    }

    /// The name, with `K` for the number of regions.
    pub fn name_with_k(&self) -> String {
        format!("{}{}", self.name, if self.has_fixed_lights() { "-K" } else { "" })
    }
}

type Build = fn(Arc<EnvMap>) -> Box<dyn SurfaceSampler>;

/// The kinds of samplers, each with what makes it.
pub enum Method {
    /// Directions by the map alone.
    Directions(Build),
    /// Directions for a surface, by its normal.
    ForNormal(Build),
    /// No directions: fixed lights that stand for the map.
    FixedLights(fn(&EnvMap, RegionCount) -> Result<Vec<FixedLight>>),
}

/// Samples that are worth asking for at once, by [`SurfaceSampler::sample_each`]: enough to overlap their look-ups.
pub const BATCH: usize = 64;

/// Number of regions that a map is cut into.
pub type RegionCount = u32;

/// A direction sampled from a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvSample {
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Pdf per solid angle: the value that the sampler's `pdf(wi)` returns, to the last bit.
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

/// Samples directions towards the light that falls on a surface, whose normal it may take into account; samplers of the map
/// alone ignore it.
pub trait SurfaceSampler: Send + Sync {
    /// The direction for `u` in \[0, 1)² and a unit normal in the map's frame; `None` when there is no sample.
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample>;

    /// Sets `out` to the sample of each pair of random numbers and its normal; all parts have the same length.
    fn sample_each(&self, u: &[[f64; 2]], normals: &[DVec3], out: &mut [Option<EnvSample>]) {
        for ((out, &u), &normal) in out.iter_mut().zip(u).zip(normals) {
            *out = self.sample_for(u, normal);
        }
    }

    fn map(&self) -> &EnvMap;

    /// Pdf of [`SurfaceSampler::sample_for`] per solid angle.
    fn pdf_for(&self, wi: DVec3, normal: DVec3) -> f64 {
        self.pdf_in_texel(self.map().geometry().texel(wi), normal)
    }

    /// [`SurfaceSampler::pdf_for`] of the directions in a texel (x, y), over which it is constant.
    fn pdf_in_texel(&self, texel: (usize, usize), normal: DVec3) -> f64;

    /// Whether there are samples for any normal.
    fn has_samples(&self) -> bool;

    /// The `u` that [`SurfaceSampler::sample_for`] maps to `wi`, if the sampler has an inverse.
    fn invert_for(&self, _wi: DVec3, _normal: DVec3) -> Option<[f64; 2]> {
        None
    }
}
