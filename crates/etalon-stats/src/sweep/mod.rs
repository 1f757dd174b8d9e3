//! Sweeps: all checks of a family of BSDFs over its parameters and directions, on one machine or on many.
//!
//! A [`Space`] numbers the configurations that a [`Strategy`] visits, so that any of them can be made again from its number alone.
//! [`screen`] runs every check on one of them, cheaply. [`Survivors`] collects what looks suspicious, and [`decide`] tests that
//! again with fresh random numbers: these alone decide. [`shrink()`] looks for the simplest configuration that still fails.

mod configuration;
mod decide;
mod screen;
mod shrink;
mod space;

pub use configuration::Configuration;
pub use decide::{Decided, Survivor, Survivors, decide};
pub use screen::{CONFIRM_LEVEL, Finding, SCREEN_LEVEL, State, confirm, screen};
pub use shrink::{Shrunk, fails, shrink};
pub use space::{Space, Strategy};

#[cfg(test)]
mod tests;
