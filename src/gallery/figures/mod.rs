//! One file for each figure, or for figures that differ by a parameter: study, view, checks and texts.
//!
//! A file has a function `figures` that [`registry`](super::registry()) calls.

pub mod audit;
pub mod depth;
pub mod depth_differences;
pub mod envmap_samples;
pub mod error_depth;
pub mod error_time;
pub mod error_time_roughness;
pub mod fresnel;
pub mod iron;
pub mod median_cut;
pub mod median_cut_error;
pub mod metals_table;
pub mod proposal;
pub mod roughness;
pub mod sampling;
pub mod sphere;
pub mod sphere_error;
pub mod stability;
pub mod validation;
