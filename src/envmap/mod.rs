//! Environment maps: geometry, statistics, importance sampling, median cut, exact irradiance, built-in maps.

pub mod batch;
pub mod cosine;
pub mod cut;
pub mod info;
pub mod irradiance;
pub mod latlong;
mod named;
mod range;
pub mod report_model;
mod request;
pub mod sampler;
pub(crate) mod sat;
pub mod strata;
pub mod synthetic;

pub use latlong::{Block, EnvMap, LatLong};
pub use named::NamedMap;
pub use range::{MAX_RADIANCE, check_range};
