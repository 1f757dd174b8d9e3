//! One file per experiment: each computes a plain result and neither draws nor prints.

pub mod fresnel;
pub mod map_samples;
pub mod median_cut;
pub mod metal;
pub mod proposal;
pub mod sphere;
