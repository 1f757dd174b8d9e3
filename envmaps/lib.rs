//! The default environment map of `etalon`, embedded. `README.md` says where it comes from.

#![warn(missing_docs)]

/// `nave.exr`: the inside of a Gothic church, 1024 × 512 texels.
pub const NAVE: &[u8] = include_bytes!("nave.exr");
