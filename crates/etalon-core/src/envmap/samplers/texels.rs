//! Sampling texels in proportion to radiance, by inversion.

use super::contract::{Entry, EnvSample, Method, SurfaceSampler};
use crate::envmap::EnvMap;
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

pub const ENTRY: &Entry = &Entry {
    name: "cdf",
    density: "map",
    doc: "radiance, by inversion: a row, then a column of it",
    complete: true,
    invertible: true,
    bytes_per_texel: Table2::BYTES,
    method: Method::Directions(|map| Box::new(TexelSampler::new(map))),
};

/// Samples a texel by a table, and a uniform position inside it.
#[derive(Debug, Clone)]
pub struct TexelSampler {
    map: Arc<EnvMap>,
    /// The row by the marginal table, the column by the row's own: monotone in both random numbers, hence invertible and suited to
    /// stratified ones.
    table: Table2,
}

impl TexelSampler {
    pub fn new(map: Arc<EnvMap>) -> Self {
        let g = map.geometry();
        let table = Table2::new(g.width(), g.height(), |x, y| map.energy(x, y));
        Self { map, table }
    }
}

impl SurfaceSampler for TexelSampler {
    #[inline]
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        let (g, at) = (self.map.geometry(), self.table.sample(u)?);
        let (x, y) = (at.x.cell, at.y.cell);
        let wi = g.direction_in_texel(x, y, at.x.offset, at.y.offset);
        Some(EnvSample { wi, pdf: at.probability() * g.inverse_solid_angle(y), radiance: self.map.texel(x, y) })
    }

    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn has_samples(&self) -> bool {
        self.table.total() > 0.0
    }

    fn invert_for(&self, wi: DVec3, _normal: DVec3) -> Option<[f64; 2]> {
        let (x, y, fx, fy) = self.map.geometry().texel_position(wi);
        Some(self.table.invert((x, y), (fx, fy)))
    }

    #[inline]
    fn pdf_in_texel(&self, (x, y): (usize, usize), _normal: DVec3) -> f64 {
        self.table.probability(x, y) * self.map.geometry().inverse_solid_angle(y)
    }
}
