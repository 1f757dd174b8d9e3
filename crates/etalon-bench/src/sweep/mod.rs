//! Sweeps of BSDFs over their parameters and directions: plans, parts that are computed anywhere, and the decision on all of them.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod conclude;
mod part;
mod plan;

pub use conclude::{Conclusion, Failure, Group, SurvivorRow, conclude};
pub use part::{Part, merge, run};
pub use plan::{Description, Families, Plan, Shard, replay};

#[cfg(test)]
mod tests;
