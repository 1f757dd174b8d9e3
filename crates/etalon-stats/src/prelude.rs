//! What a test needs: `use etalon_stats::prelude::*;`.

pub use crate::assertion::{assert_samples_follow_pdf, assert_samples_follow_pdf_by, explain};
pub use crate::density::{Atom, Density, Mass, density};
pub use crate::domain::{Directions, Discrete, Domain, Line, Pole, Square};
pub use crate::examine::{Protocol, SampleCount, validate};
pub use crate::outcome::{Outcome, Verdict};
pub use crate::point::Point;
pub use crate::sampler::{Sample, Sampler, sampler};
