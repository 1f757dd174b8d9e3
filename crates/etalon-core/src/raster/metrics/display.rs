//! Metrics of what a viewer sees: HDR-FLIP of linear radiance over exposures; PSNR and SSIM of values clipped to 0..1 and encoded by
//! the sRGB curve.
//!
//! Sources: Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021; Wang et al., "Image
//! Quality Assessment: From Error Visibility to Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004.

use crate::raster::{Image, srgb_from_linear};
use flip_rs::{HdrOptions, RgbImage};
use glam::Vec3;
use rayon::prelude::*;

/// How different an image and its reference look. A pixel that is not finite in one of them is black, and so equal, in both.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct DisplayMetrics {
    /// Mean HDR-FLIP over all pixels, from 0 (the same) to 1, at 67 pixels per degree; `None` where it is not defined, as for
    /// a black reference.
    pub hdr_flip: Option<f64>,
    /// Peak signal-to-noise ratio in dB, −10 log₁₀ of the mean squared error of the shown values; infinite for equal ones.
    pub psnr: f64,
    /// Structural similarity, up to 1 for equal images: the mean over channels and windows of 11 × 11 pixels with Gaussian weights
    /// (σ = 1.5 pixels); `None` for images that hold no window.
    pub ssim: Option<f64>,
}

/// The metrics of `image` against `reference`, which has the same size.
pub fn compare_shown(image: &Image, reference: &Image) -> DisplayMetrics {
    let [a, b] = [shown(image, reference), shown(reference, image)];
    let squares = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    let mse = squares.sum::<f64>() / (3 * image.pixels().len()) as f64;
    let ssim = ssim(&a, &b, [image.width(), image.height()]);
    DisplayMetrics { hdr_flip: hdr_flip(image, reference), psnr: -10.0 * mse.log10(), ssim }
}

/// The values of each channel of `image` on a display, black where it or `other` is not finite.
fn shown(image: &Image, other: &Image) -> [Vec<f32>; 3] {
    let of_channel = |channel: usize| {
        let value = |(p, q): (&Vec3, &Vec3)| {
            if p.is_finite() && q.is_finite() { srgb_from_linear(p[channel].clamp(0.0, 1.0)) } else { 0.0 }
        };
        image.pixels().iter().zip(other.pixels()).map(value).collect()
    };
    [0, 1, 2].map(of_channel)
}

/// Side of a window, and the standard deviation of its weights, in pixels.
const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;
/// What keeps the quotients of dark or smooth windows finite: (0.01 L)² and (0.03 L)² for values from 0 to L = 1.
const STABILIZERS: [f64; 2] = [1e-4, 9e-4];

/// Mean over channels and windows of (2 μa μb + C₁)(2 σab + C₂) / ((μa² + μb² + C₁)(σa² + σb² + C₂)), with the C of [`STABILIZERS`].
fn ssim(a: &[Vec<f32>; 3], b: &[Vec<f32>; 3], [width, height]: [usize; 2]) -> Option<f64> {
    let (columns, rows) = (width.checked_sub(WINDOW - 1)?, height.checked_sub(WINDOW - 1)?);
    let weights: [f64; WINDOW] = std::array::from_fn(|i| {
        let x = i as f64 - (WINDOW / 2) as f64;
        (-0.5 * (x / SIGMA).powi(2)).exp()
    });
    let sum: f64 = weights.iter().sum();
    let weights = weights.map(|weight| weight / sum);
    let of_row = |y: usize, a: &[f32], b: &[f32]| -> f64 {
        // Moments a, b, a², b², ab of each column, then of each window
        let of_column = |x: usize| {
            let mut moments = [0.0; 5];
            for (i, weight) in weights.iter().enumerate() {
                let at = (y + i) * width + x;
                add(&mut moments, *weight, products(f64::from(a[at]), f64::from(b[at])));
            }
            moments
        };
        let moments: Vec<[f64; 5]> = (0..width).map(of_column).collect();
        let of_window = |window: &[[f64; 5]]| {
            let mut sums = [0.0; 5];
            window.iter().zip(weights).for_each(|(moments, weight)| add(&mut sums, weight, *moments));
            similarity(sums)
        };
        moments.windows(WINDOW).map(of_window).sum()
    };
    let pairs: Vec<_> = a.iter().zip(b).collect();
    let of_rows = (0..rows).into_par_iter().map(|y| pairs.iter().map(|(a, b)| of_row(y, a, b)).sum());
    // Added in order, so that the sum is the same on any number of threads
    let total: f64 = of_rows.collect::<Vec<f64>>().iter().sum();
    (columns * rows > 0).then(|| total / (3 * columns * rows) as f64)
}

fn products(a: f64, b: f64) -> [f64; 5] {
    [a, b, a * a, b * b, a * b]
}

fn add(sums: &mut [f64; 5], weight: f64, moments: [f64; 5]) {
    sums.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += weight * moment);
}

/// The similarity of a window with these moments.
fn similarity([a, b, aa, bb, ab]: [f64; 5]) -> f64 {
    let [c1, c2] = STABILIZERS;
    let luminance = (2.0 * a * b + c1) / (a * a + b * b + c1);
    let structure = (2.0 * (ab - a * b) + c2) / (aa - a * a + bb - b * b + c2);
    luminance * structure
}

/// [`DisplayMetrics::hdr_flip`], at the default of 67 pixels per degree.
fn hdr_flip(image: &Image, reference: &Image) -> Option<f64> {
    let pairs = || image.pixels().iter().zip(reference.pixels());
    let usable = |pair: &(&Vec3, &Vec3)| pair.0.is_finite() && pair.1.is_finite();
    let rgb = |which: fn((&Vec3, &Vec3)) -> [f32; 3]| {
        let values = pairs().flat_map(|pair| if usable(&pair) { which(pair) } else { [0.0; 3] }).collect();
        RgbImage::new(image.width(), image.height(), values).ok()
    };
    let mut options = HdrOptions::default();
    options.return_exposure_map = false;
    let result = flip_rs::hdr_flip(&rgb(|p| p.1.to_array())?, &rgb(|p| p.0.to_array())?, options).ok()?;
    let errors = result.error_map.pixels();
    Some(errors.iter().map(|e| f64::from(*e)).sum::<f64>() / errors.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn flip_is_zero_for_equal_images_and_grows_with_noise() {
        let noisy = |noise: f32| {
            Image::from_fn(32, 24, |x, y| {
                let sign = if (x * 7 + y * 13) % 5 < 2 { 1.0 } else { -0.66 };
                Rgb::new(0.5, 0.3 + 0.01 * x as f32, 0.2) * (1.0 + noise * sign)
            })
        };
        let of = |noise| hdr_flip(&noisy(noise), &noisy(0.0)).unwrap();
        assert_eq!(of(0.0), 0.0);
        assert!(of(0.3) > 2.0 * of(0.1) && of(0.1) > 0.0 && of(0.3) < 1.0, "{} {}", of(0.1), of(0.3));
        // Pixels that are not finite do not count.
        let image = Image::from_fn(16, 16, |_, _| Rgb::splat(0.4));
        let mut holed = image.clone();
        holed.pixels_mut()[20] = Rgb::NAN;
        assert_eq!(hdr_flip(&image, &holed), Some(0.0));
        assert_eq!(hdr_flip(&image, &Image::new(16, 16)), None);
    }

    #[test]
    fn constant_and_inverted_images_have_their_closed_forms() {
        // Constants have no structure to compare, the luminance term alone.
        let grey = |v: f32| Image::from_fn(16, 12, |_, _| Rgb::splat(v));
        let [a, b] = [0.2, 0.5].map(|v| f64::from(srgb_from_linear(v)));
        let metrics = compare_shown(&grey(0.2), &grey(0.5));
        assert!((metrics.psnr + 20.0 * (b - a).log10()).abs() < 1e-5, "{metrics:?}");
        assert!((metrics.ssim.unwrap() - (2.0 * a * b + 1e-4) / (a * a + b * b + 1e-4)).abs() < 1e-6, "{metrics:?}");
        let equal = compare_shown(&grey(0.2), &grey(0.2));
        assert_eq!((equal.psnr, equal.ssim), (f64::INFINITY, Some(1.0)));
        // A pattern and its negative have the structure term −1 except for the stabilizer.
        let pattern = |sign: f32| {
            let value = |x: usize, y: usize| if (x + y).is_multiple_of(2) { sign } else { -sign };
            Image::from_fn(24, 24, |x, y| Rgb::splat(if value(x, y) > 0.0 { 1.0 } else { 0.0 }))
        };
        assert!(compare_shown(&pattern(1.0), &pattern(-1.0)).ssim.unwrap() < -0.98);
        assert_eq!(compare_shown(&Image::new(10, 40), &Image::new(10, 40)).ssim, None);
    }
}
