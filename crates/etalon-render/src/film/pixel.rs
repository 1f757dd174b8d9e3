//! One pixel of the film: how many samples it had, their sums and the sums of their squares; and samples that did not count: how
//! many, why, and where the first impossible one was.

use super::fixed::{Fixed, FixedRgb, LIMIT, spread};
use etalon_core::math::Rgb;
use serde::Serialize;
use std::fmt;

/// The samples of one pixel, as sums that lose nothing and hence depend on no order; 104 bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pixel {
    pub(super) n: u32,
    pub(super) camera_paths: u32,
    /// Σ x per channel, over the paths.
    pub(super) sum: FixedRgb,
    /// Σ x² per channel, over the paths.
    pub(super) square: FixedRgb,
}

impl Pixel {
    /// How many samples the pixel has had, dropped ones included.
    #[inline]
    pub fn samples(&self) -> u32 {
        self.n
    }

    /// How many camera paths its samples have had.
    #[inline]
    pub fn camera_paths(&self) -> u32 {
        self.camera_paths
    }

    /// Adds the light of a path, whose components lie in [0, [`LIMIT`](super::fixed::LIMIT)).
    #[inline]
    pub(super) fn add(&mut self, value: Rgb) {
        self.camera_paths += 1;
        self.sum += FixedRgb::of(value);
        self.square += FixedRgb::product_of(value, value);
    }

    /// Counts a path whose light was dropped: it is black.
    #[inline]
    pub(super) fn add_black(&mut self) {
        self.camera_paths += 1;
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.n = self.n.saturating_add(other.n);
        self.camera_paths = self.camera_paths.saturating_add(other.camera_paths);
        self.sum += other.sum;
        self.square += other.square;
    }

    /// The mean of the paths; black without a sample.
    pub fn mean(&self) -> Rgb {
        self.sum.mean(self.camera_paths.into())
    }

    /// The standard error of the mean, √((Σ² - (Σ)²/n) / (n(n-1))) for n paths, for each channel.
    ///
    /// 0 for equal paths. Infinite when it is not known: from fewer than two paths, and where Σ² has left its range
    /// (2^64). Squares are rounded down to 2^-64, so that the error of light below about 1e-8 is too small. The random
    /// numbers of a stratified stream are not independent: the true error is smaller, the figure is an upper estimate.
    pub fn standard_error(&self) -> Rgb {
        Rgb::from_array(std::array::from_fn(|c| {
            if self.camera_paths < 2 || self.square.0[c] == Fixed::MAX {
                return f32::INFINITY;
            }
            let n = f64::from(self.camera_paths);
            (spread(self.camera_paths, self.sum.0[c], self.square.0[c]) / (n * n * (n - 1.0))).sqrt() as f32
        }))
    }
}

/// Samples that did not count because their radiance was impossible or too faint.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// Infinite, not a number, or from 2^63 on.
    pub nonfinite: u64,
    pub negative: u64,
    /// Samples with light, but in every channel less than 2^-64, which is 0 on the film.
    pub faint: u64,
    /// The first pixel (column and row; in reading order) that lost a sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_pixel: Option<(usize, usize)>,
}

impl Dropped {
    /// One impossible value at a pixel.
    pub(super) fn one(value: Rgb, pixel: (usize, usize)) -> Self {
        let negative = value.is_finite() && value.max_element() < LIMIT;
        let (negative, nonfinite) = (u64::from(negative), u64::from(!negative));
        Self { nonfinite, negative, faint: 0, first_pixel: Some(pixel) }
    }

    /// A value that is too faint for the film.
    pub(super) const FAINT: Self = Self { nonfinite: 0, negative: 0, faint: 1, first_pixel: None };

    /// How many samples were dropped because their radiance was impossible.
    pub fn total(&self) -> u64 {
        self.nonfinite.saturating_add(self.negative)
    }

    /// Both together, in whatever order.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        let in_reading_order = |&(x, y): &(usize, usize)| (y, x);
        Self {
            nonfinite: self.nonfinite.saturating_add(other.nonfinite),
            negative: self.negative.saturating_add(other.negative),
            faint: self.faint.saturating_add(other.faint),
            first_pixel: self.first_pixel.into_iter().chain(other.first_pixel).min_by_key(in_reading_order),
        }
    }
}

impl fmt::Display for Dropped {
    /// The impossible samples in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { nonfinite, negative, first_pixel, .. } = self;
        write!(f, "{nonfinite} samples were not finite and {negative} negative; they count as black")?;
        match first_pixel {
            Some((x, y)) => write!(f, " (first at pixel ({x}, {y}))"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::sampling::stream::{Independent, Stream};

    fn pixel(values: impl IntoIterator<Item = f32>) -> Pixel {
        let mut pixel = Pixel::default();
        values.into_iter().for_each(|v| pixel.add(Rgb::splat(v)));
        pixel
    }

    #[test]
    fn a_pixel_takes_104_bytes() {
        assert_eq!(size_of::<Pixel>(), 104);
    }

    #[test]
    fn equal_samples_have_no_error() {
        for v in [0.0, 1e-30, 1e-12, 1e-6, 0.1, 1.0, 1234.567, 1e8] {
            for n in [2, 3, 7, 1000] {
                let p = pixel(std::iter::repeat_n(v, n));
                let mean = if v < 1e-19 { 0.0 } else { v };
                assert!((p.mean().x - mean).abs() <= 6e-20, "{v}");
                assert_eq!(p.standard_error(), Rgb::ZERO, "{v} {n}");
            }
        }
    }

    #[test]
    fn the_error_is_welfords() {
        for scale in [1e-4, 1.0, 1e3] {
            // A large offset with little noise, and none with much.
            for offset in [0.0, 1000.0] {
                let values =
                    (0..5000).map(|i| (scale * (offset + Independent::new(9, 0, i).pair(0)[0].powi(4))) as f32);
                let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
                for v in values.clone().map(f64::from) {
                    n += 1.0;
                    let difference = v - mean;
                    mean += difference / n;
                    squares += difference * (v - mean);
                }
                let (p, expected) = (pixel(values), (squares / (n * (n - 1.0))).sqrt());
                assert!((f64::from(p.mean().x) / mean - 1.0).abs() < 1e-7);
                assert!((f64::from(p.standard_error().y) / expected - 1.0).abs() < 1e-7, "{scale} {offset}");
            }
        }
    }

    #[test]
    fn what_is_not_known_is_infinite() {
        assert_eq!(pixel([]).mean(), Rgb::ZERO);
        for unknown in [pixel([]), pixel([1.0]), pixel([1.0, 5e9])] {
            assert_eq!(unknown.standard_error(), Rgb::INFINITY);
        }
        let largest = super::super::fixed::LIMIT.next_down();
        assert_eq!(pixel([largest; 2]).mean(), Rgb::splat(largest));
        // The sum stays at 2^64.
        assert_eq!(pixel([largest; 4]).mean(), Rgb::splat(largest.next_up() / 2.0));
    }
}
