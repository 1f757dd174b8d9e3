//! Pdfs of unit vectors, for tests over [`Directions`](etalon_stats::Directions), whose points are arrays.

use etalon_stats::{DensityFn, density};
use glam::DVec3;

/// The [`density`] of directions whose pdf per solid angle is `pdf`.
pub fn direction_density<F: Fn(DVec3) -> f64 + Sync>(
    pdf: F,
) -> DensityFn<[f64; 3], impl Fn([f64; 3]) -> f64 + Sync + use<F>> {
    density(move |w| pdf(DVec3::from_array(w)))
}
