//! Light that did not count: impossible and faint samples, and what rounding may have taken.

use super::accumulate::Film;
use super::fixed::{LIMIT, UNIT};
use super::splats::Splats;
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

impl Film {
    /// An upper bound of the share of the light that rounding to the film's unit has taken: 2^-64 of each camera path and channel,
    /// and of light that is too faint for it. 0 where all is black.
    #[must_use]
    pub fn lost_to_rounding(&self) -> f64 {
        let paths: f64 = self.pixels.iter().map(|pixel| f64::from(pixel.camera_paths)).sum();
        let channels = self.pixels.iter().flat_map(|pixel| pixel.sum).map(|sum| sum.to_f64());
        let light = channels.sum::<f64>() + self.splats.as_ref().map_or(0.0, Splats::total);
        let lost = 3.0 * paths * f64::from(UNIT);
        match () {
            _ if light > 0.0 => (lost / light).min(1.0),
            _ if self.dropped.faint > 0 => 1.0,
            _ => 0.0,
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
