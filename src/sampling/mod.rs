//! Sampling: random number streams, warps, tables, pixel filters, normals of microfacets, rectangles, triangles.

pub mod alias;
pub mod batch;
mod direction;
pub mod filter;
pub mod normals;
pub(crate) mod prefetch;
pub mod rectangle;
pub mod spherical_triangle;
pub mod table;
pub mod warp;

pub use direction::direction_density;
pub use etalon_stats::{hash, stream};
