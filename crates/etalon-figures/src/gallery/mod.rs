//! The gallery: every figure with its checks and its texts (`figures.json`), the run that makes them, and the page that shows them.
//!
//! A figure calls a study, a view and checks; it computes nothing itself. Its file in `figures` calls them, `figures.json` has its
//! texts, and [`registry()`] lists all.

mod check;
mod figure;
mod figures;
mod inputs;
pub mod page;
mod prelude;
mod reproduce;

pub use check::{Check, skipped};
pub use figure::FORMATS;
pub use figures::registry;
pub use inputs::{Effort, Inputs, Originals};
pub use reproduce::{Reproduced, Step, reproduce, selected};

#[cfg(test)]
mod readme;
#[cfg(test)]
mod tests;
