//! The project's own samplers, tested: cases, suites of them, and runs.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod case;
mod external;
pub mod families;
// What is tested, and not what tests it.
#[allow(clippy::disallowed_methods)]
pub mod planted;
mod run;
pub mod scattering;
#[allow(clippy::disallowed_methods)]
pub mod suite;
#[cfg(test)]
mod tests;
mod whole;

pub use case::select;
pub use case::{Case, DirectionSampler, direction_density, direction_sampler};
pub use external::WholeBsdf;
pub use run::{Ranked, Tested, Validation, run};
