//! Sampling texels in proportion to radiance, by inversion or by an alias table, singly or many at once: in small batches
//! whose memory accesses overlap and whose arithmetic vectorizes.

use super::contract::{Entry, EnvSample, EnvSamples, Method, SurfaceSampler};
use crate::envmap::EnvMap;
use crate::sampling::alias::AliasTable;
use crate::sampling::batch::{BATCH, Batch};
use crate::sampling::table::{Table2, inside};
use glam::DVec3;
use std::sync::Arc;

/// The entry in the registry of sampling by inversion.
pub const CDF: &Entry = &Entry {
    name: "cdf",
    density: "map",
    doc: "radiance, by inversion: a row, then a column of it",
    complete: true,
    invertible: true,
    bytes_per_texel: Table2::BYTES,
    method: Method::Directions(|map| Box::new(TexelSampler::by_inversion(map))),
};

/// The entry in the registry of sampling by an alias table.
pub const ALIAS: &Entry = &Entry {
    name: "alias",
    doc: "radiance, by one alias table over all texels",
    invertible: false,
    bytes_per_texel: AliasTable::BYTES,
    method: Method::Directions(|map| Box::new(TexelSampler::by_alias(map))),
    ..*CDF
};

/// Samples a texel by a table, and a uniform position inside it.
#[derive(Debug, Clone)]
pub struct TexelSampler {
    map: Arc<EnvMap>,
    table: Table,
}

#[derive(Debug, Clone)]
enum Table {
    /// The row by the marginal table, the column by the row's own. It is monotone in both random numbers, hence invertible
    /// and suited to stratified ones.
    Rows(Table2),
    /// All texels in one table: constant time, but not monotone, so that stratification is lost.
    Alias(AliasTable),
}

impl TexelSampler {
    /// By radiance, by inversion.
    #[must_use]
    pub fn by_inversion(map: Arc<EnvMap>) -> Self {
        let g = map.geometry();
        let table = Table2::new(g.width(), g.height(), |x, y| map.energy(x, y));
        Self { map, table: Table::Rows(table) }
    }

    /// By radiance, by an alias table.
    #[must_use]
    pub fn by_alias(map: Arc<EnvMap>) -> Self {
        let width = map.geometry().width();
        let table = AliasTable::from_fn(map.image().pixels().len(), |i| map.energy(i % width, i / width));
        Self { map, table: Table::Alias(table) }
    }
}

impl SurfaceSampler for TexelSampler {
    #[inline]
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        let g = self.map.geometry();
        let (x, y, fx, fy, probability) = match &self.table {
            Table::Rows(table) => {
                let at = table.sample(u)?;
                (at.x.cell, at.y.cell, at.x.offset, at.y.offset, at.probability())
            }
            Table::Alias(table) => {
                let at = table.sample(u[0])?;
                (at.cell % g.width(), at.cell / g.width(), at.offset, inside(u[1]), at.probability)
            }
        };
        let wi = g.direction_in_texel(x, y, fx, fy);
        Some(EnvSample { wi, pdf: probability * g.inverse_solid_angle(y), radiance: self.map.texel(x, y) })
    }

    /// The code is compiled twice, once for AVX2. Both do the same operations in the same order, and none is contracted,
    /// so every machine gets the same bits.
    fn sample_many_for(&self, u: &[[f64; 2]], _normal: DVec3, out: &mut EnvSamples) {
        out.resize(if self.has_samples() { u.len() } else { 0 });
        pulp::Arch::new().dispatch(Fill { sampler: self, u, out });
    }

    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn has_samples(&self) -> bool {
        let total = match &self.table {
            Table::Rows(table) => table.total(),
            Table::Alias(table) => table.total(),
        };
        total > 0.0
    }

    fn invert_for(&self, wi: DVec3, _normal: DVec3) -> Option<[f64; 2]> {
        let Table::Rows(table) = &self.table else { return None };
        let (x, y, fx, fy) = self.map.geometry().texel_position(wi);
        Some(table.invert((x, y), (fx, fy)))
    }

    #[inline]
    fn pdf_in_texel(&self, (x, y): (usize, usize), _normal: DVec3) -> f64 {
        let g = self.map.geometry();
        let probability = match &self.table {
            Table::Rows(table) => table.probability(x, y),
            Table::Alias(table) => table.probability(y * g.width() + x),
        };
        probability * g.inverse_solid_angle(y)
    }
}

/// Many samples of a map, as many as `out` has room for.
struct Fill<'a> {
    sampler: &'a TexelSampler,
    u: &'a [[f64; 2]],
    out: &'a mut EnvSamples,
}

impl pulp::WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<Simd: pulp::Simd>(self, _: Simd) {
        let Self { sampler: TexelSampler { map, table }, u, out } = self;
        let (geometry, pixels) = (map.geometry(), map.image().pixels());
        let mut samples = Batch::default();
        for (i, u) in u[..out.len()].chunks(BATCH).enumerate() {
            let part = i * BATCH..i * BATCH + u.len();
            match table {
                Table::Rows(table) => table.sample_batch(u, pixels, &mut samples),
                Table::Alias(table) => table.sample_batch(u, geometry.width(), pixels, &mut samples),
            }
            let [x, y, z, pdf] = [&mut out.x, &mut out.y, &mut out.z, &mut out.pdf].map(|v| &mut v[part.clone()]);
            geometry.directions_in_texels(&samples, [x, y, z, pdf]);
            for (radiance, &cell) in out.radiance[part].iter_mut().zip(&samples.cell) {
                *radiance = pixels[cell];
            }
        }
    }
}
