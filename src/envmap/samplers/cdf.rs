//! Radiance by inversion: the row by its marginal distribution, then the column by the row's own.

use super::batch::{self, Batched};
use super::contract::{DirectionSampler, Entry, EnvSample, EnvSamples, Method};
use crate::envmap::EnvMap;
use crate::sampling::batch::Batch;
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

/// Its entry in the registry.
pub const ENTRY: &Entry = &Entry {
    name: "cdf",
    density: "map",
    doc: "radiance, by inversion: a row, then a column of it",
    has_regions: false,
    complete: true,
    invertible: true,
    bytes_per_texel: Table2::BYTES,
    method: Method::Directions(|map, _| Ok(Box::new(CdfSampler::new(map)))),
};

/// Inversion: the row by the marginal table, the column by the row's own, a uniform position inside the texel. It is monotone
/// in both random numbers, hence invertible and suited to stratified ones.
#[derive(Debug, Clone)]
pub struct CdfSampler {
    /// The map that is sampled.
    pub(super) map: Arc<EnvMap>,
    /// Its rows and columns, by energy.
    pub(super) table: Table2,
}

impl CdfSampler {
    /// The tables of a map.
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let m = &map;
        let table = Table2::new(m.geometry().width(), m.geometry().height(), |x, y| m.energy(x, y));
        Self { map, table }
    }

    #[inline]
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        self.table.probability(x, y) * self.map.geometry().inverse_solid_angle(y)
    }
}

impl Batched for CdfSampler {
    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn total(&self) -> f64 {
        self.table.total()
    }

    #[inline(always)]
    fn sample_batch(&self, u: &[[f64; 2]], samples: &mut Batch) {
        self.table.sample_batch(u, self.map.image().pixels(), samples);
    }
}

impl DirectionSampler for CdfSampler {
    #[inline]
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        let at = self.table.sample(u)?;
        let (x, y) = (at.x.cell, at.y.cell);
        let g = self.map.geometry();
        let wi = g.direction_in_texel(x, y, at.x.offset, at.y.offset);
        Some(EnvSample { wi, pdf: at.probability() * g.inverse_solid_angle(y), radiance: self.map.texel(x, y) })
    }

    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        batch::fill(self, u, out);
    }

    fn invert(&self, wi: DVec3) -> Option<[f64; 2]> {
        let (x, y, fx, fy) = self.map.geometry().texel_position(wi);
        Some(self.table.invert((x, y), (fx, fy)))
    }

    #[inline]
    fn pdf(&self, wi: DVec3) -> f64 {
        let (x, y) = self.map.geometry().texel(wi);
        self.texel_pdf(x, y)
    }
}
