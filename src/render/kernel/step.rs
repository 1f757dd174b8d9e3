//! What every stage reads while all paths of a batch scatter once.

use crate::bsdf::{Bsdf, Scatter};
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

impl Step<'_> {
    /// Whether MIS weights need the pdfs of reverse directions: for light tracing, which reaches the first vertex otherwise and
    /// does not scatter at a BSDF that is not reciprocal.
    pub fn needs_reverse_pdf(&self, bsdf: &Bsdf) -> bool {
        self.scene.light_tracing.is_some() && self.scatterings > 0 && bsdf.is_reciprocal()
    }
}
