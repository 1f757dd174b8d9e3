//! MIS compensation: radiance minus its mean, for use beside BSDF sampling.

use super::contract::{Entry, Method};
use super::texels::{CDF, TexelSampler};
use crate::envmap::EnvMap;
use crate::sampling::table::Table2;
use std::sync::Arc;

/// Its entry in the registry.
pub const ENTRY: &Entry = &Entry {
    name: "compensated",
    density: "compensated",
    doc: "radiance minus its mean (0 where the map is dimmer: for MIS only)",
    complete: false,
    method: Method::Directions(|map, _| Ok(Box::new(compensated(map)))),
    ..*CDF
};

/// The sampler of MIS compensation: by inversion of radiance minus its solid-angle mean, because BSDF sampling covers the
/// uniform part well. The pdf is 0 where the map is dimmer than its mean, so that it must be combined with another strategy.
/// A map without contrast is sampled by its radiance, because the difference would vanish.
///
/// Source: Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling", 2019.
#[must_use]
pub fn compensated(map: Arc<EnvMap>) -> TexelSampler {
    let g = map.geometry();
    let (width, height) = (g.width(), g.height());
    let mean = map.mean();
    // In a constant map rounding leaves texels slightly above the mean; they do not count.
    let floor = mean * (1.0 + 1e-6);
    let table = Table2::new(width, height, |x, y| {
        let above = map.mean_rgb(x, y) - mean;
        if map.mean_rgb(x, y) > floor { above * g.solid_angle(y) } else { 0.0 }
    });
    if table.total() > 0.0 { TexelSampler::by_rows(map, table) } else { TexelSampler::by_inversion(map) }
}
