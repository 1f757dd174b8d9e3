//! The project's own samplers, tested: cases, suites of them, and runs.

mod case;
pub mod planted;
mod run;
pub mod suite;

pub use case::Case;
pub use run::{Tested, Validation, run};
