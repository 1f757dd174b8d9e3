//! Inputs that cases share: roughnesses, angles, directions, random numbers of 24 bits.

use etalon_core::optics::microfacet::Distribution;
use glam::DVec3;

/// Roughnesses α at which microfacets are tested.
pub const ALPHAS: [f64; 7] = [1e-4, 1e-3, 0.01, 0.05, 0.25, 0.5, 1.0];
/// Angles of incidence in degrees at which microfacets are tested.
pub const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99];
/// The distributions of normals, by their names in the names of tests.
pub const DISTRIBUTIONS: [(&str, Distribution); 2] = [("beckmann", Distribution::Beckmann), ("ggx", Distribution::Ggx)];

/// The direction at that angle in degrees with +z, at azimuth 0: a lobe is then not cut by the edge of the chart.
pub fn towards(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// A random number as renders use it in f32: rounded down to 24 bits.
pub fn short(u: f64) -> f32 {
    const LEVELS: f64 = 16_777_216.0;
    ((u * LEVELS).floor() / LEVELS) as f32
}
