//! Samplers as the kernel calls them: many samples at once, in lanes.

use super::inputs::short;
use etalon_render::probe::{LANES, Lane};
use etalon_stats::{Result, Sample, Sampler};

/// A [`Sampler`] of many samples at once; see [`in_lanes`].
pub struct InLanes<F, const N: usize>(F);

/// The sampler whose `sample` maps `N` pairs of random numbers for each of the first lanes, as many as it is told, to
/// the samples of these lanes.
pub fn in_lanes<F, const N: usize>(sample: F) -> InLanes<F, N>
where
    F: Fn(&[[Lane; 2]; N], usize) -> Vec<Option<Sample>> + Sync,
{
    InLanes(sample)
}

impl<F, const N: usize> Sampler for InLanes<F, N>
where
    F: Fn(&[[Lane; 2]; N], usize) -> Vec<Option<Sample>> + Sync,
{
    fn dimension(&self) -> usize {
        2 * N
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        for batch in u.chunks(2 * N * LANES) {
            let mut lanes = [[[0.0; LANES]; 2]; N];
            for (i, numbers) in batch.chunks_exact(2 * N).enumerate() {
                for (k, &u) in numbers.iter().enumerate() {
                    lanes[k / 2][k % 2][i] = short(u);
                }
            }
            out.extend((self.0)(&lanes, batch.len() / (2 * N)));
        }
        Ok(())
    }
}
