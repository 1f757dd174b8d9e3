//! What every stage reads while all paths of a batch scatter once.

use crate::render::prepared::PreparedScene;
use crate::render::sample_lanes::SampleLanes;

/// What every stage of a step reads.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// What is rendered.
    pub scene: &'a PreparedScene<'a>,
    /// Random numbers by slot.
    pub numbers: &'a SampleLanes,
    /// Scatterings before this one.
    pub scatterings: u32,
}
