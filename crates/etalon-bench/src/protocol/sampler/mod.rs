//! External samplers: their domains, and [`files`] with their samples and their pdf. A sampler that can be called is one of
//! [`program`](super::program).

mod domain;
pub mod files;

pub use domain::{HINT, Space};
pub(crate) use domain::{write_numbers, write_point};
