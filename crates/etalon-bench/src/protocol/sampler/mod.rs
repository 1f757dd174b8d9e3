//! External samplers: their domains, and [`files`] with their samples and their pdf. A sampler that can be called is one of
//! [`program`](super::program).

mod domain;
pub mod files;
mod space;

pub use domain::Coordinates;
pub(crate) use domain::write_numbers;
pub use space::{Space, Visitor};
