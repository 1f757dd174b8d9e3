//! Radiance HDR images: three 8-bit mantissas that share an exponent, run-length encoded.

mod decode;
mod encode;

pub(super) use self::decode::decode;
pub(super) use self::encode::encode;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
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
