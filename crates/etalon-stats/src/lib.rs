//! Statistical tests of samplers against their pdfs, with stated power: a dev-dependency for whoever writes code that
//! importance-samples something.
//!
//! A [`Domain`] is the set in which samples lie: [`Directions`], the unit [`Square`], a [`Line`], a [`Discrete`] set, one of the others
//! in [`DOMAINS`], or one whose [`chart`] you write. A [`Sampler`] maps uniform random numbers to its points. A [`Density`] is the pdf with respect to the domain's measure (solid
//! angle, area, length, count); it may have atoms (the one direction of a mirror) and a mass below 1 ("no sample").
//! [`assert_samples_follow_pdf`] is for tests; [`validate`] returns an [`Outcome`], [`decide`] judges many.
//!
#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bounded;
pub mod bsdf;
mod causes;
mod counting;
pub mod cubature;
mod derivative;
mod diagnosis;
mod domain;
mod error;
pub mod estimate;
mod exact;
mod examine;
mod extremes;
mod grid;
mod leaves;
mod looks;
mod mass;
mod mistakes;
pub mod multiple;
mod named_mistake;
mod outcome;
mod parallel;
pub mod power;
pub mod prelude;
mod sampler;
mod scales;
mod serial;
mod structure;
pub mod sweep;
mod weights;
pub mod welch;

pub use causes::{Finding, causes, explanations};
pub use diagnosis::{UNSEEN, assert_samples_follow_pdf, assert_samples_follow_pdf_by, explain};
pub use domain::{
    Axis, Barycentric, Chart, ChartFunctions, Circle, Cube, DOMAINS, Directions, Discrete, Disk, Domain, Entry,
    HalfLine, Indexed, Line, Named, Place, Plane, Point, Pole, Product, RealLine, Rectangle, Simplex, Space, Square,
    Triangle, ball, chart, cuboid, known, named, place, rotations, simplex, space,
};
pub use error::{Error, Result};
pub use etalon_random::{hash, stream};
pub use examine::{Protocol, SampleCount, examine, validate};
pub use extremes::Extremes;
pub use grid::{Cell, Grid};
pub use mass::{Bound, Integral};
pub use mistakes::{Follows, Mistake, Variable};
pub use named_mistake::NamedMistake;
pub use outcome::{Compared, Counts, Finer, Outcome, Verdict, decide};
pub use sampler::{
    Atom, Density, DensityFn, Mass, NoInverse, SINGLE_PRECISION, Sample, Sampler, SamplerFn, density, sampler, target,
};
pub use scales::Scale;

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
