//! The project's own samplers, tested: cases, suites of them, and runs.

mod calibrate;
mod case;
mod external;
pub mod families;
pub mod planted;
mod run;
mod scattering;
mod select;
mod shared;
pub mod suite;
mod whole;

pub use calibrate::{Calibrated, Calibration, calibrate};
pub use case::{Case, DirectionSampler, direction_sampler};
pub use external::WholeBsdf;
pub use run::{Ranked, Tested, Validation, run};
pub use select::select;
