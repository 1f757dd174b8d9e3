//! The project's own samplers, tested: cases, suites of them, and runs.

mod calibrate;
mod case;
pub mod planted;
mod ranks;
mod run;
mod select;
mod shared;
pub mod suite;

pub use calibrate::{Calibrated, Calibration, calibrate};
pub use case::{Case, DirectionSampler, direction_sampler};
pub use ranks::Ranked;
pub use run::{Tested, Validation, run};
pub use select::select;
