//! What a test needs: `use etalon_stats::prelude::*;`.

pub use crate::diagnosis::{assert_samples_follow_pdf, assert_samples_follow_pdf_by, explain};
pub use crate::domain::{
    Directions, Discrete, Disk, Domain, HalfLine, Line, Plane, Point, Pole, RealLine, Rectangle, Square, chart, named,
};
pub use crate::examine::{Protocol, SampleCount, validate};
pub use crate::outcome::{Outcome, Verdict};
pub use crate::sampler::{Atom, Density, Mass, Sample, Sampler, density, sampler, target};
