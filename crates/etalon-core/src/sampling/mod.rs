//! Sampling: random number streams, warps, tables, pixel filters, normals of microfacets, rectangles, triangles.

pub mod filter;
pub mod normals;
pub mod prefetch;
pub mod rectangle;
pub mod spherical_triangle;
pub mod table;
pub mod warp;

pub use etalon_random::{hash, stream};
