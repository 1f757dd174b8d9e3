//! Sweeps of BSDFs over their parameters and directions: plans, what is computed of them, and the decision.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod computed;
mod conclude;
mod plan;

pub use computed::{Computed, run};
pub use conclude::{Conclusion, Failure, Group, SurvivorRow, conclude};
pub use plan::{Description, Families, Plan, replay};

#[cfg(test)]
mod tests;
