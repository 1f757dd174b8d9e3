//! Samples that did not count: how many, why, and where the first one was.

use super::fixed::LIMIT;
use crate::math::Rgb;
use serde::Serialize;

/// Samples that did not count because their radiance was impossible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// Infinite, not a number, or from 2^63 on.
    pub nonfinite: u64,
    /// Samples with a negative channel.
    pub negative: u64,
    /// The first pixel (column and row; in reading order) that lost a sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_pixel: Option<(usize, usize)>,
}

impl Dropped {
    /// One impossible value at a pixel.
    pub(super) fn one(value: Rgb, pixel: (usize, usize)) -> Self {
        let negative = value.is_finite() && value.max_element() < LIMIT;
        let (negative, nonfinite) = (u64::from(negative), u64::from(!negative));
        Self { nonfinite, negative, first_pixel: Some(pixel) }
    }

    /// How many samples were dropped in all.
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
            first_pixel: self.first_pixel.into_iter().chain(other.first_pixel).min_by_key(in_reading_order),
        }
    }
}
