//! The mean radiance of an image over some of its pixels, with its standard error.

use etalon_render::film::{Film, PixelEstimate};

/// A mean over pixels with its standard error, for each channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Mean of each channel.
    pub value: [f64; 3],
    /// Standard error of each mean.
    pub error: [f64; 3],
    pub pixels: usize,
}

/// The values at the pixels of `mask`.
pub fn inside<T>(values: impl IntoIterator<Item = T>, mask: &[bool]) -> impl Iterator<Item = T> {
    values.into_iter().zip(mask).filter(|(_, inside)| **inside).map(|(value, _)| value)
}

impl Mean {
    /// The mean over the pixels of `mask`, and the root of the sum of their squared standard errors over their number.
    pub fn of(film: &Film, mask: &[bool]) -> Self {
        let (mut sum, mut square, mut pixels) = ([0.0; 3], [0.0; 3], 0);
        for PixelEstimate { mean, error } in inside(film.estimates(), mask) {
            for c in 0..3 {
                sum[c] += f64::from(mean[c]);
                square[c] += f64::from(error[c]).powi(2);
            }
            pixels += 1;
        }
        let n = pixels.max(1) as f64;
        Self { value: sum.map(|s| s / n), error: square.map(|s| s.sqrt() / n), pixels }
    }

    /// (R + G + B) / 3.
    pub fn mean_rgb(&self) -> f64 {
        self.value.iter().sum::<f64>() / 3.0
    }

    /// The largest of the channels' differences in units of their standard errors, with its sign.
    pub fn z(&self, other: &Self) -> f64 {
        (0..3)
            .map(|c| (self.value[c] - other.value[c]) / self.error[c].hypot(other.error[c]))
            .fold(0.0, |worst: f64, z| if z.abs() > worst.abs() || z.is_nan() { z } else { worst })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn z_is_the_worst_channels() {
        let mean = |value: [f64; 3]| Mean { value, error: [3.0, 3.0, 3.0], pixels: 1 };
        let other = Mean { error: [4.0; 3], ..mean([0.0; 3]) };
        assert_eq!(mean([5.0, -10.0, 0.0]).z(&other), -2.0);
        assert!(mean([f64::NAN, 0.0, 0.0]).z(&other).is_nan());
        assert_eq!(mean([1.0, 2.0, 3.0]).mean_rgb(), 2.0);
    }
}
