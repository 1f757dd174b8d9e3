//! How much light the film's unit may have taken.

use super::accumulate::Film;
use super::fixed::UNIT;
use super::splats::Splats;

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
