//! Many samples at once: in small batches whose memory accesses overlap and whose arithmetic vectorizes.

use super::contract::EnvSamples;
use crate::envmap::EnvMap;
use crate::sampling::batch::{BATCH, Batch};

/// A sampler of texels by a table.
pub(super) trait Batched {
    fn map(&self) -> &EnvMap;

    /// Sum of the table's weights; 0 when nothing can be sampled.
    fn total(&self) -> f64;

    /// Samples a texel for each of up to [`BATCH`] pairs of random numbers. It must be inlined into [`fill`], which is
    /// compiled for each instruction set.
    fn sample_batch(&self, u: &[[f64; 2]], samples: &mut Batch);
}

/// Replaces `out` by the samples for all of `u`; by none when nothing can be sampled.
///
/// The code is compiled twice, once for AVX2. Both do the same operations in the same order, and none is contracted,
/// so every machine gets the same bits.
pub(super) fn fill<S: Batched>(sampler: &S, u: &[[f64; 2]], out: &mut EnvSamples) {
    if sampler.total() <= 0.0 {
        out.clear();
        return;
    }
    out.resize(u.len());
    pulp::Arch::new().dispatch(Fill { sampler, u, out });
}

struct Fill<'a, S> {
    sampler: &'a S,
    u: &'a [[f64; 2]],
    out: &'a mut EnvSamples,
}

impl<S: Batched> pulp::WithSimd for Fill<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<Simd: pulp::Simd>(self, _: Simd) {
        let Self { sampler, u, out } = self;
        let (geometry, pixels) = (sampler.map().geometry(), sampler.map().image().pixels());
        let mut samples = Batch::default();
        for (i, u) in u.chunks(BATCH).enumerate() {
            let part = i * BATCH..i * BATCH + u.len();
            sampler.sample_batch(u, &mut samples);
            let [x, y, z, pdf] = [&mut out.x, &mut out.y, &mut out.z, &mut out.pdf].map(|v| &mut v[part.clone()]);
            geometry.directions_in_texels(&samples, [x, y, z, pdf]);
            for (radiance, &cell) in out.radiance[part].iter_mut().zip(&samples.cell) {
                *radiance = pixels[cell];
            }
        }
    }
}
