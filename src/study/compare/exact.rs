//! The noise of an image that is declared to have none.
//!
//! What a pixel differs from the mean of its four neighbours is little in a smooth image, and all of independent noise. Summed
//! over a block, the squares of this difference between both sides have the expectation Σ s²/n of the other side's n replicates
//! if the image has no noise; Student's t over the blocks tests it. The image is first brought to the other side's mean in each
//! block, so that a light that is too bright is not called noise. A difference in fine detail cannot be told from noise: one
//! image does not show which it is.

use super::functionals::Blocks;
use super::side::{PRECISION, Side};
use crate::raster::Image;
use etalon_stats::difference::Difference;
use etalon_stats::welch::Mean;
use glam::DVec3;

/// Values that a block needs: of fewer, a ratio of sums is too large on average.
const VALUES: usize = 64;

/// The variance of the noise of `exact`, by that of the mean of `noisy`; nothing if it is not above 0 at `level`.
pub fn noise(exact: &Image, noisy: &Side, blocks: &Blocks, level: f64) -> Option<f64> {
    let of_block = |pixels: &Vec<usize>| {
        let sum = |image: &Image| pixels.iter().map(|&pixel| image.pixels()[pixel].as_dvec3()).sum::<DVec3>();
        let gains = noisy.images.iter().map(sum).sum::<DVec3>() / noisy.images.len() as f64 / sum(exact);
        let inner = pixels.iter().filter_map(|&pixel| Some((pixel, blocks.neighbours(pixel)?)));
        let of_pixel =
            |at| [0, 1, 2].map(|c| if gains[c].is_finite() { detail(exact, noisy, at, c, gains[c]) } else { [0.0; 2] });
        let values: Vec<[f64; 2]> = inner.flat_map(of_pixel).collect();
        let [squares, variance] = values.iter().fold([0.0; 2], |sums, of| [sums[0] + of[0], sums[1] + of[1]]);
        // Each block counts alike, whether its noise is large or small.
        (variance > 0.0 && values.len() >= VALUES).then(|| squares / variance - 1.0)
    };
    let excess = Mean::of_replicates(&blocks.pixels.iter().filter_map(of_block).collect::<Vec<f64>>())?;
    let found = Difference::of(excess, Mean::exact(0.0), 0.0);
    (found.value > 0.0 && 0.5 * found.p() < level).then_some(found.value)
}

/// What a pixel of `noisy`, less `gain` times that of `exact`, differs from the mean of its neighbours: the square, and its
/// expectation if `exact` has no noise beyond its precision.
fn detail(exact: &Image, noisy: &Side, (pixel, near): (usize, [usize; 4]), channel: usize, gain: f64) -> [f64; 2] {
    let at = |image: &Image, pixel: usize| f64::from(image.pixels()[pixel][channel]);
    let detail = |image: &Image| at(image, pixel) - 0.25 * near.iter().map(|&i| at(image, i)).sum::<f64>();
    let values: Vec<f64> = noisy.images.iter().map(detail).collect();
    let mean = Mean::of_replicates(&values).unwrap_or(Mean::exact(values[0]));
    let variance = noisy.error().map_or(mean.variance, |error| {
        at(error, pixel).powi(2) + near.iter().map(|&i| at(error, i).powi(2)).sum::<f64>() / 16.0
    });
    // Of the pixel and of the mean of four.
    let rounding = 1.25 * (PRECISION * gain * at(exact, pixel)).powi(2);
    [(mean.value - gain * detail(exact)).powi(2), variance + rounding]
}
