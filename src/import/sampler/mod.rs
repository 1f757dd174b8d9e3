//! External samplers, as [`Sampler`](etalon_stats::Sampler) and [`Density`](etalon_stats::Density): a [`program`] that is
//! called over its standard input and output, or [`files`] with its samples and their pdf.

mod domain;
pub mod files;
pub mod program;
mod space;

pub use domain::Coordinates;
pub use space::{Space, Visitor};
