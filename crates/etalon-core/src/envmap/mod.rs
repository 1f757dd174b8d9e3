//! Environment maps: geometry, statistics, importance sampling, median cut, exact irradiance, built-in maps.

pub mod cut;
pub mod equal_area;
pub mod info;
pub mod irradiance;
pub mod latlong;
mod map;
pub mod samplers;
pub mod synthetic;

pub use latlong::{Block, LatLong};
pub use map::{EnvMap, Found, Grace, MAX_RADIANCE, NamedMap, check_range};
