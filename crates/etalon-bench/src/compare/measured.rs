//! An image against a reference in numbers: metrics, and what would explain the difference; limits of metrics.

use super::explain::{Explanation, Reason, explain};
use etalon_core::error::Result;
use etalon_core::raster::{Comparison, DisplayMetrics, Image, compare, compare_shown};
use serde::Serialize;

/// Image A against the reference B.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    #[serde(flatten)]
    pub numbers: Comparison,
    /// Missing for images of more than 4 million pixels.
    #[serde(flatten)]
    pub shown: DisplayMetrics,
    pub explanation: Option<Explanation>,
    /// Whether A and B differ by more than noise; unknown for images of more than 4 million pixels.
    pub beyond_noise: Option<bool>,
    /// The mean of A over that of B with the half width of its interval of 95 %, where noise hides which mistake explains the difference.
    pub ratio_of_means: Option<[f64; 2]>,
    pub identical: bool,
}

/// Most pixels of an image for metrics of what is shown and for explanations: FLIP filters the images once for each exposure, which
/// takes minutes for the largest.
const LARGEST: usize = 1 << 22;

impl Measured {
    /// `stored` says which of the images are stored as integers, clipped at 1 and read by the sRGB curve.
    ///
    /// # Errors
    /// [`Error::Parameter`](etalon_core::error::Error::Parameter) for images of different sizes.
    pub fn of(a: &Image, b: &Image, stored: [bool; 2]) -> Result<Self> {
        let numbers = compare(a, b)?;
        let is_small = a.pixels().len() <= LARGEST;
        let unknown = DisplayMetrics { hdr_flip: None, psnr: f64::NAN, ssim: None };
        let reason = is_small.then(|| explain(a, b, stored));
        Ok(Self {
            numbers,
            shown: if is_small { compare_shown(a, b) } else { unknown },
            beyond_noise: reason.as_ref().map(|reason| *reason != Reason::Noise),
            ratio_of_means: if let Some(Reason::Hidden(ratio)) = reason { Some(ratio) } else { None },
            explanation: reason.and_then(Reason::explanation),
            identical: numbers.non_finite == 0 && numbers.max_abs == 0.0,
        })
    }
}

/// A metric by which images are sorted and limited.
#[derive(Debug)]
pub struct Metric {
    pub name: &'static str,
    /// What it is called in texts.
    pub title: &'static str,
    pub unit: &'static str,
    /// Whether it grows as images become alike.
    pub is_similarity: bool,
    of: fn(&Measured) -> f64,
}

impl Metric {
    const fn error(name: &'static str, title: &'static str, of: fn(&Measured) -> f64) -> Self {
        Self { name, title, unit: "", is_similarity: false, of }
    }

    /// By its name; `hdr_flip` is `flip`, too.
    pub fn named(name: &str) -> Option<&'static Self> {
        METRICS.iter().find(|metric| metric.name == name || name == "hdr_flip" && metric.name == "flip")
    }

    /// What it is called above a column: "PSNR (dB)".
    pub fn heading(&self) -> String {
        if self.unit.is_empty() { self.title.into() } else { format!("{} ({})", self.title, self.unit) }
    }

    /// Its value; NaN where it is not defined.
    pub fn of(&self, measured: &Measured) -> f64 {
        (self.of)(measured)
    }
}

pub const METRICS: [Metric; 9] = [
    Metric::error("mse", "MSE", |m| m.numbers.mse),
    Metric::error("rel_mse", "relative MSE", |m| m.numbers.rel_mse),
    Metric::error("flip", "FLIP", |m| m.shown.hdr_flip.unwrap_or(f64::NAN)),
    Metric { is_similarity: true, ..Metric::error("ssim", "SSIM", |m| m.shown.ssim.unwrap_or(f64::NAN)) },
    Metric { is_similarity: true, unit: "dB", ..Metric::error("psnr", "PSNR", |m| m.shown.psnr) },
    Metric::error("rmse", "RMSE", |m| m.numbers.rmse),
    Metric::error("mape", "MAPE", |m| m.numbers.mape),
    Metric::error("smape", "SMAPE", |m| m.numbers.smape),
    Metric::error("max_abs", "largest difference", |m| m.numbers.max_abs),
];

/// The most that a metric may be.
#[derive(Debug, Clone, Copy)]
pub struct Limit {
    pub metric: &'static Metric,
    pub most: f64,
}

impl Limit {
    /// Whether an image keeps it. It does not where the metric is not defined, or has left out pixels that are not finite.
    pub fn holds(&self, measured: &Measured) -> bool {
        measured.numbers.non_finite == 0 && self.holds_of_rest(measured)
    }

    /// Whether the pixels that are finite keep it, where the metric is defined.
    pub fn holds_of_rest(&self, measured: &Measured) -> bool {
        self.metric.of(measured) <= self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::math::Rgb;

    #[test]
    fn limits_hold_up_to_their_value_and_fail_where_nothing_is_known() {
        const FLOATS: [bool; 2] = [false; 2];
        let grey = |v: f32| Image::from_fn(16, 12, |_, _| Rgb::splat(v));
        let measured = Measured::of(&grey(0.75), &grey(0.5), FLOATS).unwrap();
        let limit = |name: &str, most: f64| Limit { metric: Metric::named(name).unwrap(), most }.holds(&measured);
        assert!(limit("mse", 0.0625) && !limit("mse", 0.0624) && limit("max_abs", 0.25) && !limit("flip", 1e-3));
        let black = Measured::of(&grey(0.75), &grey(0.0), FLOATS).unwrap();
        assert!(!Limit { metric: Metric::named("hdr_flip").unwrap(), most: 1.0 }.holds(&black), "FLIP is not defined");
        let holed = Image::from_fn(16, 12, |x, y| Rgb::splat(if x + y == 0 { f32::NAN } else { 0.5 }));
        let holed = Measured::of(&holed, &grey(0.5), FLOATS).unwrap();
        assert!(!Limit { metric: Metric::named("mse").unwrap(), most: 1.0 }.holds(&holed), "a pixel is left out");
        assert!(!measured.identical && Measured::of(&grey(0.5), &grey(0.5), FLOATS).unwrap().identical);
        assert!(Metric::named("fllip").is_none() && METRICS.iter().all(|m| Metric::named(m.name).is_some()));
    }
}
