//! Environment maps: geometry, statistics, importance sampling, median cut, exact irradiance, built-in maps.

pub mod cut;
pub mod equal_area;
mod grace;
pub mod info;
pub mod irradiance;
pub mod latlong;
mod map;
pub mod samplers;
pub mod synthetic;

pub use grace::Grace;
pub use latlong::{Block, LatLong};
pub use map::{EnvMap, Found, MAX_RADIANCE, NamedMap, check_range};
