//! Sampling texels in proportion to radiance, by inversion, singly or many at once: in small batches whose memory accesses
//! overlap and whose arithmetic vectorizes.

use super::contract::{Entry, EnvSample, EnvSamples, Method, SurfaceSampler};
use crate::envmap::EnvMap;
use crate::sampling::batch::{BATCH, Batch};
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

/// Its entry in the registry.
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
    /// The sampler of a map.
    #[must_use]
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
            table.sample_batch(u, pixels, &mut samples);
            let [x, y, z, pdf] = [&mut out.x, &mut out.y, &mut out.z, &mut out.pdf].map(|v| &mut v[part.clone()]);
            geometry.directions_in_texels(&samples, [x, y, z, pdf]);
            for (radiance, &cell) in out.radiance[part].iter_mut().zip(&samples.cell) {
                *radiance = pixels[cell];
            }
        }
    }
}
