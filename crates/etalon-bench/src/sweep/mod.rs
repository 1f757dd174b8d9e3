//! Sweeps of BSDFs over their parameters and directions: plans, what is computed of them, and the decision.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod conclude;
mod part;
mod plan;

pub use conclude::{Conclusion, Failure, Group, SurvivorRow, conclude};
pub use part::{Part, run};
pub use plan::{Description, Families, Plan, replay};

#[cfg(test)]
mod tests;
