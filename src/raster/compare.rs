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
    /// mean((a - b)² / (b² + 0.01)): the 0.01 keeps dark pixels from outweighing all others.
    pub rel_mse: f64,
    /// max |a - b|; 0 when nothing was compared.
    pub max_abs: f64,
}

/// Compares `a` with the reference `b`, see [`Comparison`] for the formulas.
///
/// # Errors
/// [`Error::Parameter`] when the sizes differ.
pub fn compare(a: &Image, b: &Image) -> Result<Comparison> {
    compare_with_halves(a, [b, b])
}

/// Compares `a` with a reference that is known by two independent estimates b₁ and b₂ of the same expectation b.
///
/// Each square (a - b)² becomes (a - b₁)(a - b₂), and b in the denominators (b₁ + b₂)/2. The errors of the halves are
/// independent, so they drop out on average: `mse` estimates the distance to the true image without bias, however
/// noisy the reference is, and may come out below 0 where its noise hides what is to be measured (`rmse` is NaN then).
///
/// # Errors
/// As [`compare`].
pub fn compare_with_halves(a: &Image, halves: [&Image; 2]) -> Result<Comparison> {
    for b in halves {
        if (a.width(), a.height()) != (b.width(), b.height()) {
            let sizes = format!("{}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
            return Err(Error::parameter("images", format!("their sizes differ: {sizes}"))
                .with_hint("only images of the same size can be compared"));
        }
    }
    let (mut pixels, mut max_abs) = (0, 0.0_f64);
    let (mut sum_a, mut sum_b, mut squares, mut relative) = (0.0, 0.0, 0.0, 0.0);
    let references = halves[0].pixels().iter().zip(halves[1].pixels());
    for (p, (q1, q2)) in a.pixels().iter().zip(references) {
        if !(p.is_finite() && q1.is_finite() && q2.is_finite()) {
            continue;
        }
        pixels += 1;
        for channel in 0..3 {
            let [x, y1, y2] = [p, q1, q2].map(|rgb| f64::from(rgb[channel]));
            let y = 0.5 * (y1 + y2);
            let square = (x - y1) * (x - y2);
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
    use crate::math::Rgb;

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
    fn noise_of_the_halves_drops_out() {
        // b = 1 ± 0.5, drawn with signs that are independent: every combination once. The true difference is 0.25.
        let [b1, b2] = [grey([1.5, 1.5, 0.5, 0.5]), grey([1.5, 0.5, 1.5, 0.5])];
        let c = compare_with_halves(&grey([1.25; 4]), [&b1, &b2]).unwrap();
        assert!((c.mse - 0.0625).abs() < 1e-15 && c.mean_b == 1.0);
        // (−0.25)² / 2.26, twice (−0.25)(0.75) / 1.01, 0.75² / 0.26.
        let expected = (0.0625 / 2.26 - 2.0 * 0.1875 / 1.01 + 0.5625 / 0.26) / 4.0;
        assert!((c.rel_mse - expected).abs() < 1e-15);
        assert!(compare_with_halves(&grey([1.0; 4]), [&b1, &grey([0.5, 0.5, 1.5, 1.5])]).unwrap().rmse.is_nan());
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
