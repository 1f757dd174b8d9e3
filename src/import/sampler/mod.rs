//! Samplers of others, as [`Sampler`](crate::stats::Sampler) and [`Density`](crate::stats::Density): a [`Program`] that is
//! called over its standard input and output, or a [`SampleFile`] with a [`GridDensity`].

mod coordinates;
mod files;
mod number;
mod program;
mod space;

pub use coordinates::Coordinates;
pub use files::{GridDensity, Gridded, Row, SampleFile};
pub use program::{Client, Program};
pub use space::Space;
