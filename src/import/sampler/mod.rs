//! Samplers of others, as [`Sampler`](crate::stats::Sampler) and [`Density`](crate::stats::Density): a [`program`] that is
//! called over its standard input and output, or [`files`] with its samples and its density.

mod coordinates;
pub mod files;
mod number;
pub mod program;
mod space;

pub use coordinates::Coordinates;
pub use number::Words;
pub use space::{Space, Visitor};
