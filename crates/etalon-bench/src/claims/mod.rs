//! What the two reports claim, each claim compared with what this program measures.
//!
//! A claim has findings: numbers with standard errors, each compared with a bound. The verdict follows from them alone.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod claim;
mod depths;
mod formulas;
mod map;
mod paths;
mod statues;
mod texts;

pub use claim::{Bound, Claim, Finding, Text, Unit, Verdict};
pub use depths::{Agreement, DepthClaims, PlacePicture, depth_claims};
pub use formulas::{glass_claims, metal_claims};
pub use map::{MapInputs, map_claims};
pub use paths::Place;
pub use statues::{StatueInputs, sampling_claims, statue_claims};
