//! x

mod bounded;
pub mod chi_square;
mod counting;
pub mod cubature;
mod density;
mod domain;
mod error;
pub mod estimate;
mod exact;
mod examine;
mod fixed;
mod grid;
pub mod hash;
pub mod kolmogorov;
mod mass;
pub mod multiple;
mod outcome;
pub mod power;
mod sampler;
pub mod stream;
mod tally;
pub mod warp;
pub mod welch;

pub use density::{Atom, Density, DensityFn, Mass, density};
pub use domain::{Directions, Discrete, Domain, Line, Pole, Square};
pub use error::{Error, Result};
pub use examine::{Protocol, SampleCount, examine, validate};
pub use grid::{Cell, Grid};
pub use mass::{Bound, Integral};
pub use outcome::{Counts, Outcome, Verdict, decide};
pub use sampler::{Sample, Sampler, SamplerFn, sampler};

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
