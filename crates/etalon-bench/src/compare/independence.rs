//! Whether the images of a side are independent and have one expectation.
//!
//! Random numbers that two images share, and a fault that two of them have, make their residuals x − x̄ alike. Of n independent
//! images with the variances vₖ, the product of two residuals has the expectation −(vₖ + vₗ)/n + Σv/n², and the square of one
//! vₖ (1 − 2/n) + Σv/n²; images may have different numbers of samples. What the products exceed that by is summed over blocks of the
//! image, and Student's t over the blocks tests each pair, at a level that is corrected for the number of pairs. Blocks must be
//! independent: noise that a whole image shares, such as an exposure of its own, looks like another expectation.

use super::functionals::Blocks;
use etalon_core::raster::Image;
use etalon_stats::estimate::Difference;
use etalon_stats::welch::Mean;
use rayon::prelude::*;

/// Two images of a side that are more alike, or less, than independent images of one expectation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Related {
    /// Their numbers, from 0.
    pub images: [usize; 2],
    /// The correlation of their noise: near 0 for independent images of one expectation.
    pub correlation: f64,
    /// Corrected for the number of pairs.
    pub p: f64,
}

/// Images of which all pairs are tested; of more, neighbours are.
const ALL_PAIRS: usize = 64;
/// The products of fewer images follow from their variances.
const FEWEST: usize = 4;
/// A correlation of neighbours that changes the standard error of the mean by a twentieth: smaller ones do not matter.
const MATTERS: f64 = 0.05;
/// Values with noise that a block needs, for each image.
const VALUES: usize = 4;

/// The pair of images that is least likely among independent ones, if its corrected p is below `level`; nothing of three images.
pub fn related(images: &[Image], blocks: &Blocks, level: f64) -> Option<Related> {
    let n = images.len();
    let farthest = if n > ALL_PAIRS { 1 } else { n };
    let pairs: Vec<[usize; 2]> = (0..n).flat_map(|k| (k + 1..n.min(k + 1 + farthest)).map(move |l| [k, l])).collect();
    if n < FEWEST {
        return None;
    }
    let of_block = |pixels: &Vec<usize>| {
        let residuals = residuals(images, pixels);
        let (count, images) = (residuals[0].len(), n as f64);
        let product = |k: usize, l: usize| residuals[k].iter().zip(&residuals[l]).map(|(a, b)| a * b).sum::<f64>();
        let squares: Vec<f64> = (0..n).map(|k| product(k, k) / count as f64).collect();
        let all = squares.iter().sum::<f64>() / (1.0 - 1.0 / images) / (images * images);
        let variance = |k: usize| (squares[k] - all) / (1.0 - 2.0 / images);
        let of_pair = |&[k, l]: &[usize; 2]| {
            let expected = all - (variance(k) + variance(l)) / images;
            product(k, l) / count as f64 - expected
        };
        (count >= VALUES * n).then(|| pairs.iter().map(of_pair).collect::<Vec<f64>>())
    };
    let by_block: Vec<Vec<f64>> = blocks.pixels.par_iter().filter_map(of_block).collect();
    let test = |(i, images): (usize, &[usize; 2])| {
        let mean = Mean::of_replicates(&by_block.iter().map(|pairs| pairs[i]).collect::<Vec<f64>>())?;
        let p = Difference::of(mean, Mean::exact(0.0), 0.0).p() * pairs.len() as f64;
        Some(Related { images: *images, correlation: mean.value, p }).filter(|_| mean.value.abs() > MATTERS)
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
        let deviation = (values.clone().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        if deviation > 0.0 {
            residuals.iter_mut().zip(values).for_each(|(of, value)| of.push((value - mean) / deviation));
        }
    }
    residuals
}
