//! From linear light to 8-bit values for display.

use super::Image;
use crate::errata;
use crate::math::Rgb;

/// How linear values become 8-bit ones. Every map sends NaN and negative values to 0 and +∞ to 255.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ToneMap {
    /// v = 2^stops · L, then the sRGB transfer function (IEC 61966-2-1): 12.92 v up to v = 0.0031308, else
    /// 1.055 v^(1/2.4) - 0.055; times 255, rounded to nearest.
    Srgb {
        /// Exposure: log₂ of a factor.
        stops: f32,
    },
    /// (2^stops · L)^(1/gamma), times 255, rounded to nearest.
    Gamma {
        /// Above 0; 2.2 is common.
        gamma: f32,
        /// Exposure: log₂ of a factor.
        stops: f32,
    },
    /// As in the second report: [`errata::images::display_value`].
    SecondReport,
    /// L / max · 255, truncated as a C cast does, where max is the largest finite channel value of the image: the
    /// first report's PPM, as far as it is known (division first, in single precision). An image without a positive
    /// value is black.
    LinearMax,
}

impl Default for ToneMap {
    fn default() -> Self {
        ToneMap::Srgb { stops: 0.0 }
    }
}

impl ToneMap {
    /// The 8-bit value of one channel; `max` is the image's maximum, used by [`ToneMap::LinearMax`] only.
    fn encode(&self, value: f32, max: f32) -> u8 {
        // Casting a float to u8 saturates: NaN and negative values give 0, large ones and +∞ give 255.
        let round = |v: f32| (v * 255.0 + 0.5) as u8;
        let value = if value > 0.0 { value } else { 0.0 };
        match *self {
            ToneMap::Srgb { stops } => round(srgb_from_linear(value * stops.exp2())),
            ToneMap::Gamma { gamma, stops } => round((value * stops.exp2()).powf(1.0 / gamma)),
            ToneMap::SecondReport => errata::images::display_value(value),
            // Without a positive value this is 0/0, NaN, and so black.
            ToneMap::LinearMax => (value / max * 255.0) as u8,
        }
    }
}

/// The image as 8-bit RGB, 3 bytes a pixel, row by row from the top.
pub fn to_rgb8(image: &Image, tone: &ToneMap) -> Vec<u8> {
    let finite = image.pixels().iter().flat_map(|p| p.to_array()).filter(|v| v.is_finite());
    let max = finite.fold(0.0, f32::max);
    image.pixels().iter().flat_map(|p| p.to_array().map(|v| tone.encode(v, max))).collect()
}

/// An exposure for displaying a high-dynamic-range image, in stops.
///
/// The finite, positive pixels are ordered by luminance 0.2126 R + 0.7152 G + 0.0722 B, and the geometric mean of the middle
/// four fifths is brought to 0.18, so that neither a sun nor a black border counts; but not so far that more than the
/// brightest tenth exceeds 1. 0 when there is no such pixel.
pub fn auto_exposure(image: &Image) -> f32 {
    let weights = Rgb::new(0.2126, 0.7152, 0.0722);
    let mut luminances: Vec<f32> =
        image.pixels().iter().map(|p| p.dot(weights)).filter(|l| l.is_finite() && *l > 0.0).collect();
    if luminances.is_empty() {
        return 0.0;
    }
    // Drop the darkest and the brightest tenth.
    let tail = luminances.len() / 10;
    luminances.select_nth_unstable_by(tail, f32::total_cmp);
    let above = &mut luminances[tail..];
    let last = above.len() - tail - 1;
    let (_, &mut brightest, _) = above.select_nth_unstable_by(last, f32::total_cmp);
    let middle = &above[..=last];
    let mean_log2 = middle.iter().map(|&l| f64::from(l).log2()).sum::<f64>() / middle.len() as f64;
    (0.18_f64.log2() - mean_log2).min(-f64::from(brightest).log2()) as f32
}

/// The sRGB transfer function, linear to encoded.
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(value: f32, tone: ToneMap) -> u8 {
        to_rgb8(&Image::from_pixels(1, 1, vec![Rgb::splat(value)]), &tone)[0]
    }

    #[test]
    fn known_values() {
        assert_eq!(one(0.214_041_14, ToneMap::default()), 128, "128/255 - 0.5 of sRGB");
        assert_eq!(one(0.001, ToneMap::default()), 3, "12.92 · 0.001 · 255 = 3.29");
        assert_eq!(one(0.25, ToneMap::Srgb { stops: 2.0 }), 255);
        assert_eq!(one(0.25, ToneMap::Gamma { gamma: 2.0, stops: 0.0 }), 128, "127.5 rounds up");
        assert_eq!(one(0.25, ToneMap::Gamma { gamma: 1.0, stops: 1.0 }), 128);
        // (√2 · 0.384)^(1/2.2) · 255 = 193.2: cut, not rounded.
        assert_eq!(one(0.38, ToneMap::SecondReport), 192, "192.26");
    }

    #[test]
    fn linear_max_divides_by_the_largest_finite_value() {
        let pixels = vec![Rgb::new(0.0, 1.0, 3.999), Rgb::new(f32::INFINITY, f32::NAN, 4.0)];
        let bytes = to_rgb8(&Image::from_pixels(2, 1, pixels), &ToneMap::LinearMax);
        assert_eq!(bytes, [0, 63, 254, 255, 0, 255]);
        assert_eq!(one(0.0, ToneMap::LinearMax), 0);
        assert_eq!(one(-1.0, ToneMap::LinearMax), 0);
    }

    #[test]
    fn nan_and_infinities_are_black_or_white() {
        for tone in [ToneMap::default(), ToneMap::Gamma { gamma: 2.2, stops: -1.0 }, ToneMap::SecondReport] {
            assert_eq!(one(f32::NAN, tone), 0);
            assert_eq!(one(-3.0, tone), 0);
            assert_eq!(one(f32::NEG_INFINITY, tone), 0);
            assert_eq!(one(f32::INFINITY, tone), 255);
        }
    }

    #[test]
    fn srgb_round_trip() {
        for code in 0..=255_u8 {
            assert_eq!(one(linear_from_srgb(f32::from(code) / 255.0), ToneMap::default()), code);
        }
    }

    #[test]
    fn exposure_is_robust() {
        assert_eq!(auto_exposure(&Image::new(4, 4)), 0.0);
        assert!((auto_exposure(&Image::new(4, 4).map(|_| Rgb::splat(0.18)))).abs() < 1e-6);
        assert!((auto_exposure(&Image::new(1, 1).map(|_| Rgb::splat(0.72))) + 2.0).abs() < 1e-6);
        let sun = Image::from_fn(10, 10, |x, y| match (x, y) {
            (3, 3) => Rgb::splat(1e6),
            (4, 3) => Rgb::splat(f32::NAN),
            (_, 9) => Rgb::ZERO,
            _ => Rgb::splat(0.045),
        });
        assert!((auto_exposure(&sun) - 2.0).abs() < 1e-5, "{}", auto_exposure(&sun));
        // Half near black, half at 0.5: the bright half must not be washed out.
        let halves = Image::from_fn(10, 10, |x, _| Rgb::splat(if x < 5 { 1e-5 } else { 0.5 }));
        assert!((auto_exposure(&halves) - 1.0).abs() < 1e-5, "{}", auto_exposure(&halves));
    }
}
