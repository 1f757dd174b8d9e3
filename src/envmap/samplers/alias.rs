//! Radiance by an alias table.

use super::batch::{self, Batched};
use super::contract::{DirectionSampler, Entry, EnvSample, EnvSamples, Method};
use crate::envmap::EnvMap;
use crate::sampling::alias::AliasTable;
use crate::sampling::batch::Batch;
use glam::DVec3;
use std::sync::Arc;

/// Its entry in the registry.
pub const ENTRY: &Entry = &Entry {
    name: "alias",
    density: "map",
    doc: "radiance, by one alias table over all texels",
    has_regions: false,
    complete: true,
    invertible: false,
    bytes_per_texel: AliasTable::BYTES,
    method: Method::Directions(|map, _| Ok(Box::new(AliasSampler::new(map)))),
};

/// One alias table over all texels: constant time, but not monotone in the random numbers, so that stratification is lost.
#[derive(Debug, Clone)]
pub struct AliasSampler {
    map: Arc<EnvMap>,
    table: AliasTable,
}

impl AliasSampler {
    /// The table of a map.
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let width = map.geometry().width();
        let table = AliasTable::from_fn(map.image().pixels().len(), |i| map.energy(i % width, i / width));
        Self { map, table }
    }

    #[inline]
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        let g = self.map.geometry();
        self.table.probability(y * g.width() + x) * g.inverse_solid_angle(y)
    }
}

impl Batched for AliasSampler {
    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn total(&self) -> f64 {
        self.table.total()
    }

    #[inline(always)]
    fn sample_batch(&self, u: &[[f64; 2]], samples: &mut Batch) {
        self.table.sample_batch(u, self.map.geometry().width(), self.map.image().pixels(), samples);
    }
}

impl DirectionSampler for AliasSampler {
    #[inline]
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        let at = self.table.sample(u[0])?;
        let g = self.map.geometry();
        let (x, y) = (at.cell % g.width(), at.cell / g.width());
        let wi = g.direction_in_texel(x, y, at.offset, u[1].clamp(1e-9, 1.0 - 1e-9));
        Some(EnvSample { wi, pdf: self.texel_pdf(x, y), radiance: self.map.texel(x, y) })
    }

    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        batch::fill(self, u, out);
    }

    #[inline]
    fn pdf(&self, wi: DVec3) -> f64 {
        let (x, y) = self.map.geometry().texel(wi);
        self.texel_pdf(x, y)
    }
}
