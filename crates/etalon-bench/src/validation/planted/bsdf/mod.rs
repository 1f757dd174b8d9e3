//! Mistakes in whole BSDFs: a right one of the textbook in f64, and one thing changed.

mod coated;
mod compensated;
mod conductor;
mod dielectric;
mod faulty;
mod limits;
mod mixture;
mod resampled;
mod rough;
mod smooth;

use super::fault::PlantedFault;

/// All of them.
pub fn faults() -> Vec<PlantedFault> {
    [
        dielectric::faults(),
        conductor::faults(),
        smooth::faults(),
        mixture::faults(),
        compensated::faults(),
        coated::faults(),
        resampled::faults(),
        limits::faults(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
