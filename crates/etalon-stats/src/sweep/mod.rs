//! Sweeps: all checks of a family of BSDFs over its parameters and directions, on one machine or on many.
//!
//! A [`Space`] numbers the configurations that a [`Strategy`] visits, so that any of them can be made again from its number alone.
//! [`screen`] runs every check on one of them, cheaply. [`Survivors`] collects what looks suspicious, and [`decide`] tests that
//! again with fresh random numbers: these alone decide. [`shrink()`] looks for the simplest configuration that still fails.
//!
//! [`over_ranges`] makes one test of a sampler over the ranges of its parameters.

mod decide;
mod ranges;
mod shrink;
mod space;

pub use decide::{CONFIRM_LEVEL, Decided, Finding, SCREEN_LEVEL, State, Survivor, Survivors, confirm, decide, screen};
pub use ranges::over_ranges;
pub use shrink::{Shrunk, fails, shrink};
pub use space::{Configuration, Space, Strategy};

#[cfg(test)]
mod tests;
