//! The suite: every sampler of the project, each family in a file of its own.

pub mod renders;
mod warps;

use super::Case;

/// All cases, in the order of their names' families.
#[must_use]
pub fn cases() -> Vec<Case> {
    [warps::cases(), renders::cases()].into_iter().flatten().collect()
}
