//! Random numbers and what they are turned into: streams, warps, tables.

mod hash;
pub mod stream;
pub mod table;
pub mod warp;
