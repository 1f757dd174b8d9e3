//! What the two reports claim, each claim compared with what this program measures.
//!
//! A claim has findings: numbers with standard errors, each compared with a bound. The verdict follows from them alone.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod claim;
mod copper;
mod depths;
mod events;
mod feature;
mod features;
mod glass;
mod glazing;
mod gold;
mod map;
mod metal;
#[cfg(test)]
mod tests;

pub use claim::{Agreement, Bound, Claim, Finding, Unit, Verdict};
pub use copper::sampling_claims;
pub use depths::{DepthClaims, Effort, depth_claims};
pub use feature::{Place, PlacePicture};
pub use glass::glass_claims;
pub use gold::{StatueInputs, statue_claims};
pub use map::{MapInputs, map_claims, sampled_shares};
pub use metal::metal_claims;
