//! Random numbers and what they are turned into: streams, warps, tables.

pub mod alias;
pub mod batch;
mod direction;
pub mod normals;
pub(crate) mod prefetch;
pub mod rectangle;
pub mod table;
pub mod warp;

pub use direction::direction_density;
pub use etalon_stats::{hash, stream};
