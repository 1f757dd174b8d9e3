//! HDR-FLIP: the visible difference of two images in alternation.
//!
//! Source: Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021.

use crate::raster::Image;
use flip_rs::{HdrOptions, RgbImage};

/// The mean over all pixels, from 0 (the same) to 1, at 67 pixels per degree; `None` where it is not defined, as for
/// a black reference. Pixels that are not finite in either image are black in both.
pub fn hdr_flip(image: &Image, reference: &Image) -> Option<f64> {
    let pairs = || image.pixels().iter().zip(reference.pixels());
    let usable = |pair: &(&glam::Vec3, &glam::Vec3)| pair.0.is_finite() && pair.1.is_finite();
    let rgb = |which: fn((&glam::Vec3, &glam::Vec3)) -> [f32; 3]| {
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
    fn it_is_zero_for_equal_images_and_grows_with_noise() {
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
}
