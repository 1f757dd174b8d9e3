//! Image metrics: MSE, relative MSE, MAPE and SMAPE by their formulas, summed in f64; metrics of images as they are shown.

mod display;

pub use self::display::{DisplayMetrics, compare_shown};

use super::Image;
use crate::error::{Error, Result};

/// Keeps dark pixels from outweighing all others in the relative metrics.
const EPSILON: f64 = 0.01;
/// One channel value in this number is left out of the metrics without the worst 0.1 %.
const WORST: usize = 1000;

/// How image `a` differs from the reference `b`.
///
/// Means run over the n = 3·[`pixels`](Self::pixels) channel values of the pixels that are finite in both images. With
/// no such pixel at all every mean is NaN. The metrics called *trimmed* are means without the ⌊n/1000⌋ channel values of
/// the largest error, each by its own formula: what remains is divided by its own number, as SimpleImageIO does it.
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
    pub rmse: f64,
    /// mean((a - b)² / (b² + ε)) with ε = 0.01.
    pub rel_mse: f64,
    /// mean(|a - b| / (|b| + ε)).
    pub mape: f64,
    /// mean(|a - b| / ((|a| + |b|)/2 + ε)).
    pub smape: f64,
    pub mse_trimmed: f64,
    pub rel_mse_trimmed: f64,
    pub mape_trimmed: f64,
    pub smape_trimmed: f64,
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
/// So does `rel_mse`, up to the noise of its denominators. The other metrics have no such estimate: an absolute value is no
/// product, and trimming chooses by the errors themselves. MAPE and SMAPE take (b₁ + b₂)/2 for b.
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
    let references = halves[0].pixels().iter().zip(halves[1].pixels());
    let triples = a.pixels().iter().zip(references).map(|(p, (q1, q2))| [p, q1, q2]);
    let finite = triples.filter(|triple| triple.iter().all(|p| p.is_finite()));
    let pixels = finite.clone().count();
    let (mut max_abs, mut sum_a, mut sum_b) = (0.0_f64, 0.0, 0.0);
    // The errors of all channel values by the four formulas.
    let mut errors: [Errors; 4] = std::array::from_fn(|_| Errors::new(3 * pixels / WORST));
    for triple in finite {
        for channel in 0..3 {
            let [x, y1, y2] = triple.map(|rgb| f64::from(rgb[channel]));
            let y = 0.5 * (y1 + y2);
            let (square, absolute) = ((x - y1) * (x - y2), (x - y).abs());
            sum_a += x;
            sum_b += y;
            max_abs = max_abs.max(absolute);
            errors[0].push(square);
            errors[1].push(square / (y * y + EPSILON));
            errors[2].push(absolute / (y.abs() + EPSILON));
            errors[3].push(absolute / (0.5 * (x.abs() + y.abs()) + EPSILON));
        }
    }
    let count = 3.0 * pixels as f64;
    let [mse, rel_mse, mape, smape] = errors.each_ref().map(|errors| errors.sum / count);
    let [mse_trimmed, rel_mse_trimmed, mape_trimmed, smape_trimmed] = errors.map(|errors| errors.trimmed(count));
    Ok(Comparison {
        pixels,
        non_finite: a.pixels().len() - pixels,
        mean_a: sum_a / count,
        mean_b: sum_b / count,
        mse,
        rmse: mse.sqrt(),
        rel_mse,
        mape,
        smape,
        mse_trimmed,
        rel_mse_trimmed,
        mape_trimmed,
        smape_trimmed,
        max_abs,
    })
}

/// The sum of errors, and that without the largest ones.
struct Errors {
    sum: f64,
    /// How many errors are left out.
    worst: usize,
    /// The sum of those that are not among the largest.
    kept: f64,
    /// The `worst` largest so far, and those since they were last chosen.
    largest: Vec<f64>,
}

impl Errors {
    fn new(worst: usize) -> Self {
        Self { sum: 0.0, worst, kept: 0.0, largest: Vec::with_capacity(2 * worst + 1) }
    }

    fn push(&mut self, error: f64) {
        self.sum += error;
        self.largest.push(error);
        if self.largest.len() > 2 * self.worst {
            self.choose();
        }
    }

    /// Adds all but the largest to the sum of those kept.
    fn choose(&mut self) {
        if self.largest.len() > self.worst {
            self.largest.select_nth_unstable_by(self.worst, |a, b| b.total_cmp(a));
            self.kept += self.largest.drain(self.worst..).sum::<f64>();
        }
    }

    /// The mean without the largest of `count` errors.
    fn trimmed(mut self, count: f64) -> f64 {
        self.choose();
        self.kept / (count - self.worst as f64)
    }
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
        // |a - b| by |b| + 0.01, and by the mean of |a| and |b| plus 0.01.
        assert!((c.mape - (1.0 / 1.01 + 0.5 / 0.01 + 2.0 / 2.01) / 4.0).abs() < 1e-13, "{}", c.mape);
        assert!((c.smape - (1.0 / 1.51 + 0.5 / 0.26 + 2.0 / 1.01) / 4.0).abs() < 1e-13, "{}", c.smape);
        // A thousandth of 12 values is none.
        assert!((c.mse_trimmed - c.mse).abs() < 1e-15 && (c.mape_trimmed - c.mape).abs() < 1e-13);
    }

    #[test]
    fn the_worst_thousandth_is_left_out() {
        // 3000 values off by 0.5, except for one pixel: its two largest and one more value are the worst three.
        let mut a = Image::from_fn(50, 20, |_, _| Rgb::splat(1.5));
        a.pixels_mut()[77] = Rgb::new(101.0, 3.0, 1.25);
        a.pixels_mut()[78] = Rgb::new(1.5, 2.0, 1.5);
        let c = compare(&a, &Image::from_fn(50, 20, |_, _| Rgb::ONE)).unwrap();
        let of = |usual: f64, small: f64| (2996.0 * usual + small) / 2997.0;
        assert!((c.mse_trimmed - of(0.25, 0.0625)).abs() < 1e-14, "{c:?}");
        assert!((c.rel_mse_trimmed - of(0.25, 0.0625) / 1.01).abs() < 1e-14);
        assert!((c.mape_trimmed - of(0.5, 0.25) / 1.01).abs() < 1e-14);
        assert!((c.smape_trimmed - of(0.5 / 1.26, 0.25 / 1.135)).abs() < 1e-14);
        assert!(c.mse > 3.0 && c.mape > c.mape_trimmed);
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
