//! Samplers of others, as [`Sampler`](crate::stats::Sampler) and [`Density`](crate::stats::Density): a [`Program`] that is
//! called over its standard input and output.

mod coordinates;
mod number;
mod program;
mod space;

pub use coordinates::Coordinates;
pub use program::{Client, Program};
pub use space::Space;
