//! Samples and a pdf from files, for samplers that cannot be called.
//!
//! Samples: CSV with a header, one point a row (see [`Space::names`](super::Space::names)) and perhaps its pdf in a column `pdf`. The pdf: a grid of
//! values, each constant over its part of the domain (see [`GridDensity`]).

mod grid;
mod lines;
mod samples;

pub use grid::GridDensity;
pub use samples::SampleFile;
