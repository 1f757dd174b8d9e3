//! The project's own samplers, tested: cases, suites of them, and runs.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod case;
pub mod families;
// What is tested, and not what tests it.
#[allow(clippy::disallowed_methods)]
pub mod museum;
mod plain;
#[allow(clippy::disallowed_methods)]
pub mod planted;
mod run;
#[allow(clippy::disallowed_methods)]
pub mod suite;
#[cfg(test)]
mod tests;
mod whole;

pub use case::{Case, DirectionSampler, direction_density, direction_sampler, select};
pub use run::{Ranked, Tested, Validation, run};
pub use whole::WholeBsdf;
