//! Environment maps: geometry, statistics, importance sampling, median cut, exact irradiance.

pub mod cosine;
pub mod cut;
pub mod info;
pub mod irradiance;
pub mod latlong;
pub mod report_model;
pub mod sampler;
mod sat;

pub use latlong::{Block, EnvMap, LatLong};
