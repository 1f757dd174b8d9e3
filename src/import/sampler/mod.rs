//! External samplers, as [`Sampler`](etalon_stats::Sampler) and [`Density`](etalon_stats::Density): a [`program`] that is
//! called over its standard input and output, or [`files`] with its samples and their pdf.

mod coordinates;
pub mod files;
mod number;
pub mod program;
mod space;

pub use coordinates::Coordinates;
pub use number::Words;
pub use space::{Space, Visitor};
