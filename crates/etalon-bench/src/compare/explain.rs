//! What would explain most of the difference of two images: an exposure, a flip, a transfer function, swapped channels.

use etalon_core::math::Rgb;
use etalon_core::raster::{Image, linear_from_srgb, srgb_from_linear};
use serde::Serialize;

/// A change of image `a` after which little of its difference from `b` is left.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// What to do to `a`.
    pub change: String,
    /// Mean squared error after it, by that before.
    pub mse_left: f64,
}

/// A change must leave at most this share of the mean squared error: noise, which no change takes away, makes a tenth of the
/// difference at most, and so does any second error. (Of noise alone, an exposure fitted by least squares takes 1/n.)
const MOST_LEFT: f64 = 0.1;

/// The change of `a`, among a few that people make by mistake, that explains most of its difference from `b`; nothing if it
/// leaves more than a tenth of the mean squared error. The exposure is fitted by least squares. Images of one size.
#[must_use]
pub fn explain(a: &Image, b: &Image) -> Option<Explanation> {
    let (width, height) = (a.width(), a.height());
    let mse = |change: &dyn Fn(usize, usize) -> Rgb| {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let errors = pixels.map(|(x, y)| (change(x, y) - b.get(x, y)).as_dvec3().length_squared());
        errors.filter(|e| e.is_finite()).sum::<f64>()
    };
    let before = mse(&|x, y| a.get(x, y));
    let pairs = || a.pixels().iter().zip(b.pixels()).filter(|(p, q)| p.is_finite() && q.is_finite());
    let product = pairs().map(|(p, q)| p.as_dvec3().dot(q.as_dvec3())).sum::<f64>();
    let factor = product / pairs().map(|(p, _)| p.as_dvec3().length_squared()).sum::<f64>();
    let by = |f: fn(f32) -> f32, p: Rgb| Rgb::from_array(p.to_array().map(f));
    let candidates = [
        (format!("multiply A by {factor:.4}"), mse(&|x, y| a.get(x, y) * factor as f32)),
        ("flip A left to right".into(), mse(&|x, y| a.get(width - 1 - x, y))),
        ("flip A upside down".into(), mse(&|x, y| a.get(x, height - 1 - y))),
        ("rotate A by 180°".into(), mse(&|x, y| a.get(width - 1 - x, height - 1 - y))),
        ("swap red and blue of A".into(), mse(&|x, y| Rgb::from_array([2, 1, 0].map(|c| a.get(x, y)[c])))),
        ("swap red and green of A".into(), mse(&|x, y| Rgb::from_array([1, 0, 2].map(|c| a.get(x, y)[c])))),
        ("swap green and blue of A".into(), mse(&|x, y| Rgb::from_array([0, 2, 1].map(|c| a.get(x, y)[c])))),
        (
            "undo the sRGB curve in A: its values are encoded, those of B linear".into(),
            mse(&|x, y| by(linear_from_srgb, a.get(x, y))),
        ),
        (
            "apply the sRGB curve to A: its values are linear, those of B encoded".into(),
            mse(&|x, y| by(srgb_from_linear, a.get(x, y))),
        ),
    ];
    let (change, after) = candidates.into_iter().filter(|(_, e)| e.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mse_left = after / before;
    (mse_left <= MOST_LEFT).then_some(Explanation { change, mse_left })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_named_and_noise_is_not() {
        let image = Image::from_fn(24, 16, |x, y| {
            let (x, y) = (x as f32, y as f32);
            Rgb::new(0.1 + 0.03 * x, 0.2 + 0.02 * y, 0.9 - 0.001 * x * y)
        });
        let at = |f: &dyn Fn(usize, usize) -> Rgb| Image::from_fn(24, 16, f);
        for (other, expected) in [
            (image.map(|p| 1.21 * p), "multiply A by 1.2100"),
            (at(&|x, y| image.get(23 - x, y)), "left to right"),
            (at(&|x, y| image.get(x, 15 - y)), "upside down"),
            (image.map(|p| Rgb::new(p.z, p.y, p.x)), "red and blue"),
            (image.map(|p| Rgb::from_array(p.to_array().map(srgb_from_linear))), "apply the sRGB"),
            (image.map(|p| Rgb::from_array(p.to_array().map(linear_from_srgb))), "undo the sRGB"),
        ] {
            let found = explain(&image, &other).unwrap();
            assert!(found.change.contains(expected) && found.mse_left < 1e-6, "{found:?}");
        }
        let noisy = at(&|x, y| image.get(x, y) * if (7 * x + 3 * y) % 4 < 2 { 1.2 } else { 0.8 });
        assert_eq!(explain(&image, &noisy), None);
        assert_eq!(explain(&image, &image), None);
    }
}
