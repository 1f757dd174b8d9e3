//! Environment maps: geometry, statistics, importance sampling, median cut, exact irradiance, built-in maps.

pub mod cut;
pub mod info;
pub mod irradiance;
pub mod latlong;
mod named;
mod range;
mod request;
pub mod samplers;
pub(crate) mod sat;
pub mod synthetic;

pub use latlong::{Block, EnvMap, LatLong};
pub use named::NamedMap;
pub use range::{MAX_RADIANCE, check_range};
