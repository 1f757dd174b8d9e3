//! Differences of two images, each defined by its formula and summed in f64.

use super::Image;
use crate::error::{Error, Result};

/// How image `a` differs from the reference `b`.
///
/// Means run over the 3·[`pixels`](Self::pixels) channel values of the pixels that are finite in both images. With no
/// such pixel at all every mean is NaN.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Pixels compared: those with all channels finite in both images.
    pub pixels: usize,
    /// Pixels left out, because a channel of `a` or `b` is infinite or not a number.
    pub non_finite: usize,
    /// Mean of the channel values of `a`.
    pub mean_a: f64,
    /// Mean of the channel values of `b`.
    pub mean_b: f64,
    /// mean((a - b)²).
    pub mse: f64,
    /// √mse.
    pub rmse: f64,
    /// mean((a - b)² / (b² + 0.01)).
    pub rel_mse: f64,
    /// max |a - b|; 0 when nothing was compared.
    pub max_abs: f64,
}

/// Compares `a` with the reference `b`, see [`Comparison`] for the formulas.
///
/// # Errors
/// [`Error::Parameter`] when the sizes differ.
pub fn compare(a: &Image, b: &Image) -> Result<Comparison> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        let sizes = format!("{}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
        return Err(Error::parameter("images", format!("their sizes differ: {sizes}"))
            .with_hint("only images of the same size can be compared"));
    }
    let (mut pixels, mut max_abs) = (0, 0.0_f64);
    let (mut sum_a, mut sum_b, mut squares, mut relative) = (0.0, 0.0, 0.0, 0.0);
    for (p, q) in a.pixels().iter().zip(b.pixels()) {
        if !(p.is_finite() && q.is_finite()) {
            continue;
        }
        pixels += 1;
        for (x, y) in p.to_array().into_iter().zip(q.to_array()) {
            let (x, y) = (f64::from(x), f64::from(y));
            let square = (x - y) * (x - y);
            sum_a += x;
            sum_b += y;
            squares += square;
            relative += square / (y * y + 0.01);
            max_abs = max_abs.max((x - y).abs());
        }
    }
    let count = 3.0 * pixels as f64;
    let mse = squares / count;
    Ok(Comparison {
        pixels,
        non_finite: a.pixels().len() - pixels,
        mean_a: sum_a / count,
        mean_b: sum_b / count,
        mse,
        rmse: mse.sqrt(),
        rel_mse: relative / count,
        max_abs,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Rgb;

    fn grey(values: [f32; 4]) -> Image {
        Image::from_pixels(2, 2, values.map(Rgb::splat).to_vec())
    }

    #[test]
    fn two_by_two_by_hand() {
        let c = compare(&grey([1.0, 2.0, 0.5, 0.0]), &grey([1.0, 1.0, 0.0, 2.0])).unwrap();
        // Differences 0, 1, 0.5, -2; squares 0, 1, 0.25, 4; denominators 1.01, 1.01, 0.01, 4.01.
        assert_eq!((c.pixels, c.non_finite, c.max_abs), (4, 0, 2.0));
        assert_eq!((c.mean_a, c.mean_b), (0.875, 1.0));
        assert!((c.mse - 1.3125).abs() < 1e-15 && (c.rmse - 1.3125_f64.sqrt()).abs() < 1e-15);
        let expected = (1.0 / 1.01 + 25.0 + 4.0 / 4.01) / 4.0;
        assert!((c.rel_mse - expected).abs() < 1e-13, "{}", c.rel_mse);
    }

    #[test]
    fn channels_count_separately() {
        let a = Image::from_pixels(1, 1, vec![Rgb::new(3.0, 0.0, 0.0)]);
        let c = compare(&a, &Image::new(1, 1)).unwrap();
        assert_eq!((c.mse, c.mean_a), (3.0, 1.0));
        assert!((c.rel_mse - 300.0).abs() < 1e-12);
    }

    #[test]
    fn non_finite_pixels_are_left_out_and_counted() {
        let c = compare(&grey([f32::NAN, 2.0, 3.0, 4.0]), &grey([1.0, f32::INFINITY, 3.0, 3.0])).unwrap();
        assert_eq!((c.pixels, c.non_finite, c.mse, c.max_abs), (2, 2, 0.5, 1.0));
        let nothing = compare(&grey([f32::NAN; 4]), &grey([0.0; 4])).unwrap();
        assert!(nothing.mse.is_nan() && nothing.non_finite == 4);
    }

    #[test]
    fn sizes_must_agree() {
        assert!(compare(&Image::new(2, 1), &Image::new(1, 2)).is_err());
    }
}
