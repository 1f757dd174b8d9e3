//! Radiance HDR pictures: three 8-bit mantissas that share an exponent, in run lengths.

mod decode;
mod encode;

pub(super) use self::decode::decode;
pub(super) use self::encode::encode;

use crate::math::Rgb;

/// Widths that the newer run lengths can have; others are stored flat.
const RUN_WIDTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// What a stored pixel stands for.
fn linear([r, g, b, e]: [u8; 4]) -> Rgb {
    if e == 0 {
        return Rgb::ZERO;
    }
    // In f64, since the smallest values are subnormal in f32 and the factor alone would vanish.
    let unit = f64::from(i32::from(e) - 136).exp2();
    Rgb::from_array([r, g, b].map(|m| (f64::from(m) * unit) as f32))
}

/// The stored pixel nearest to `p`.
fn shared_exponent(p: Rgb) -> [u8; 4] {
    let [r, g, b] = p.to_array().map(|v| if v > 0.0 { f64::from(v) } else { 0.0 });
    let largest = r.max(g).max(b);
    if largest < 2.0_f64.powi(-128) {
        return [0; 4];
    }
    // The exponent that brings the largest channel to [128, 256); one more if it then rounds to 256. In f64 log2 is
    // exact enough that only powers of two matter, and those it gives exactly.
    let mut exponent = (largest.log2().floor() as i32).min(126) + 1;
    if (largest * f64::from(8 - exponent).exp2()).round() > 255.0 && exponent < 127 {
        exponent += 1;
    }
    let unit = f64::from(8 - exponent).exp2();
    // The cast saturates: beyond the range of the format the value becomes its largest.
    let [r, g, b] = [r, g, b].map(|v| (v * unit).round() as u8);
    [r, g, b, (exponent + 128) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::{Image, Metadata};
    use std::path::Path;

    fn round_trip(image: &Image) -> Image {
        let mut bytes = Vec::new();
        encode(image, &Metadata::default().with("note", "two\nlines"), &mut bytes).unwrap();
        decode(Path::new("a.hdr"), &bytes).unwrap().image
    }

    #[test]
    fn mantissas_are_rounded() {
        // Widths on both sides of the run length limits, with runs, literals and values of every size.
        for width in [1, 7, 8, 200, 40_000] {
            let image = Image::from_fn(width, 2, |x, y| {
                let v = (1.0 + (x * x % 997) as f32 / 100.0) * ((x / 50 % 60) as f32 - 30.0).exp2();
                Rgb::new(v, v * 0.37, if y == 0 { 0.0 } else { 0.011 * v })
            });
            for (a, b) in image.pixels().iter().zip(round_trip(&image).pixels()) {
                let bound = a.max_element() / 256.0;
                assert!((*a - *b).abs().max_element() <= bound * 1.000_001, "{a} {b}");
            }
        }
    }

    #[test]
    fn rounding_is_unbiased() {
        let image = Image::from_fn(1000, 10, |x, y| {
            let i = (1000 * y + x) as f32;
            Rgb::new(1.0 + i / 10_000.0, 0.2 + i / 70_000.0, 0.1)
        });
        let c = crate::raster::compare(&round_trip(&image), &image).unwrap();
        assert!((c.mean_a / c.mean_b - 1.0).abs() < 1e-3, "{} {}", c.mean_a, c.mean_b);
    }

    #[test]
    fn the_ends_of_the_range() {
        let largest = (255.0 / 256.0 * 127.0_f64.exp2()) as f32;
        for (value, expected) in [
            (1.0, 1.0),
            (255.6, 256.0),
            (-1.0, 0.0),
            (f32::NAN, 0.0),
            (f32::INFINITY, largest),
            (f32::MAX, largest),
            (1e-45, 0.0),
            (2.0_f32.powi(-128), 2.0_f32.powi(-128)),
        ] {
            let image = Image::new(1, 1).map(|_| Rgb::splat(value));
            assert_eq!(round_trip(&image).get(0, 0), Rgb::splat(expected), "{value}");
        }
    }
}
