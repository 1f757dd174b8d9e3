//! The noise of few replicates: the mean of the image and its low modes pool their estimates of it.
//!
//! The variance s² of n replicates has n − 1 degrees of freedom, and Student's t with one or two of them is exceeded at small
//! levels by differences of a hundred standard errors only. The image's mean and its cosine modes are nine weighted means of the
//! same pixels, and noise whose correlations are short beside the image (filters, paths that reach neighbouring pixels) has the same
//! factor in all nine: Var f = F Σ w²σ², with F = 1 for independent pixels. The pixels' own variances give Σ w²σ² for each,
//! the replicates of all nine give F. That correlations are short is a premise: noise that a whole image shares, such as an
//! exposure of its own, has fewer degrees of freedom. Where a functional's own variance is above the pooled one, it counts.

use super::functionals::{Layout, WAVES};
use super::side::Side;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_stats::Extremes;
use etalon_stats::welch::Mean;

/// The variance and the degrees of freedom of the mean and the modes of a side, from replicates; by functional and channel.
///
/// The nine estimates of F would have 9 (n − 1) degrees of freedom if they were independent. Where a few pixels have nearly all
/// of the noise, all functionals see the same of it: with the correlations R of the functionals, which follow from
/// the pixels' variances, F has (n − 1) 9²/Σ R² (Satterthwaite), and n − 1 in the worst case. A pixel counts with the larger of
/// both sides' variances: a few replicates may miss that it is noisy.
pub fn pool([side, other]: [&Side; 2], layout: &Layout, own: &[[Mean; 3]]) -> Vec<[Mean; 3]> {
    let n = side.images.len() as f64;
    let mut variances = variances(&side.images);
    if other.images.len() > 1 {
        for (variance, other) in variances.iter_mut().zip(self::variances(&other.images)) {
            *variance = std::array::from_fn(|channel| variance[channel].at_least(other[channel]));
        }
    }
    let covariances = layout.covariances(&variances);
    let mut pooled = own[..WAVES].to_vec();
    for (channel, covariance) in covariances.iter().enumerate() {
        let noisy: Vec<usize> = (0..WAVES).filter(|&i| covariance[i][i] > 0.0).collect();
        let count = noisy.len() as f64;
        let factor = noisy.iter().map(|&i| own[i][channel].variance * n / covariance[i][i]).sum::<f64>() / count;
        let correlation = |i: usize, j: usize| covariance[i][j].powi(2) / (covariance[i][i] * covariance[j][j]);
        let squares: f64 = noisy.iter().flat_map(|&i| noisy.iter().map(move |&j| correlation(i, j))).sum();
        for &i in &noisy {
            let mean = &mut pooled[i][channel];
            mean.variance = mean.variance.at_least(factor * covariance[i][i] / n);
            mean.dof = (n - 1.0) * count * count / squares;
        }
    }
    pooled
}

/// The variance of each pixel over the images.
pub fn variances(images: &[Image]) -> Vec<[f64; 3]> {
    let n = images.len() as f64;
    let variance = |pixel: usize, channel: usize| {
        let values = images.iter().map(|image| f64::from(image.pixels()[pixel][channel]));
        let mean = values.clone().sum::<f64>() / n;
        values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..images[0].pixels().len()).map(|pixel| [0, 1, 2].map(|channel| variance(pixel, channel))).collect()
}

/// The standard deviation of each pixel over the images.
pub fn deviations(images: &[Image]) -> Image {
    let deviations = variances(images).into_iter().map(|of| Rgb::from_array(of.map(|variance| variance.sqrt() as f32)));
    Image::from_pixels(images[0].width(), images[0].height(), deviations.collect())
}
