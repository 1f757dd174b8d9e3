//! Samples that did not count: how many, why, and where the first impossible one was.

use super::fixed::LIMIT;
use crate::math::Rgb;
use serde::Serialize;
use std::fmt;

/// Samples that did not count because their radiance was impossible or too faint.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// Infinite, not a number, or from 2^63 on.
    pub nonfinite: u64,
    /// Samples with a negative channel.
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
    #[must_use]
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
