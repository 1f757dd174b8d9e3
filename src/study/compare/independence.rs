//! Whether the images of a side are replicates: independent, with one expectation.
//!
//! Random numbers that two images share, and a fault that two of them have, make their residuals x − x̄ alike. Replicates are
//! exchangeable: the products of residuals, summed over the pixels of a block, have the same expectation for all pairs of images.
//! Student's t over the blocks tests each pair against the mean of all, at a level that is corrected for their number.

use super::functionals::Blocks;
use crate::raster::Image;
use etalon_stats::difference::Difference;
use etalon_stats::welch::Mean;
use rayon::prelude::*;

/// Two images of a side that are more alike, or less, than independent images of one expectation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Related {
    /// Their numbers, from 0.
    pub images: [usize; 2],
    /// The mean product of their residuals by the residuals' standard deviations, less that of all pairs: near 0 for replicates.
    pub correlation: f64,
    /// Corrected for the number of pairs.
    pub p: f64,
}

/// Images of which all pairs are tested; of more, neighbours are.
const ALL_PAIRS: usize = 64;

/// The pair of images that is least likely among replicates, if its corrected p is below `level`; nothing of two images.
pub fn related(images: &[Image], blocks: &Blocks, level: f64) -> Option<Related> {
    let n = images.len();
    let farthest = if n > ALL_PAIRS { 1 } else { n };
    let pairs: Vec<[usize; 2]> = (0..n).flat_map(|k| (k + 1..n.min(k + 1 + farthest)).map(move |l| [k, l])).collect();
    if n < 3 {
        return None;
    }
    let of_block = |pixels: &Vec<usize>| {
        let residuals = residuals(images, pixels);
        let count = residuals[0].len() as f64;
        // The residuals of a pixel add up to 0 and their squares to n: pairs have the mean −1/(n − 1).
        let product = |[k, l]: [usize; 2]| residuals[k].iter().zip(&residuals[l]).map(|(a, b)| a * b).sum::<f64>();
        let of_pair = |pair: &[usize; 2]| product(*pair) / count + 1.0 / (n as f64 - 1.0);
        (count > 0.0).then(|| pairs.iter().map(of_pair).collect::<Vec<f64>>())
    };
    let by_block: Vec<Vec<f64>> = blocks.pixels.par_iter().filter_map(of_block).collect();
    let test = |(i, images): (usize, &[usize; 2])| {
        let mean = Mean::of_replicates(&by_block.iter().map(|pairs| pairs[i]).collect::<Vec<f64>>())?;
        let p = Difference::of(mean, Mean::exact(0.0), 0.0).p() * pairs.len() as f64;
        Some(Related { images: *images, correlation: mean.value, p })
    };
    let least = pairs.iter().enumerate().filter_map(test).min_by(|a, b| a.p.total_cmp(&b.p));
    least.filter(|related| related.p < level)
}

/// By image, what the pixels and channels with noise differ from their means, by their standard deviations.
fn residuals(images: &[Image], pixels: &[usize]) -> Vec<Vec<f64>> {
    let n = images.len() as f64;
    let mut residuals = vec![Vec::new(); images.len()];
    for (pixel, channel) in pixels.iter().flat_map(|&pixel| (0..3).map(move |channel| (pixel, channel))) {
        let values = images.iter().map(|image| f64::from(image.pixels()[pixel][channel]));
        let mean = values.clone().sum::<f64>() / n;
        let deviation = (values.clone().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt();
        if deviation > 0.0 {
            residuals.iter_mut().zip(values).for_each(|(of, value)| of.push((value - mean) / deviation));
        }
    }
    residuals
}
