//! Random numbers and what they are turned into: streams, warps, tables.

pub mod alias;
pub mod batch;
pub(crate) mod hash;
pub mod normals;
pub(crate) mod prefetch;
pub mod rectangle;
pub mod stream;
pub mod table;
pub mod warp;
