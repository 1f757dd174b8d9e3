//! Fixed lights in place of an environment: their bias, which no number of samples reduces, over the number of lights.

use super::reference::Reference;
use super::strategy::Strategy;
use super::{Convergence, Plan, measure};
use crate::envmap::samplers::cut_lights;
use crate::error::Result;
use crate::scene::{Request, Scene};

/// The ways of cutting a map, by the beginning of their strategies' names.
pub const CUTS: [&str; 2] = [cut_lights::MEDIAN_CUT.name, cut_lights::VARIANCE_CUT.name];

/// Samples per pixel: some, because radiance varies within a pixel.
const SPP: u32 = 4;

/// Measures both cuts into each of the numbers of lights; a curve each, the cuts one after the other.
pub fn cuts(
    scene: &Scene,
    request: &Request,
    counts: &[u32],
    plan: &Plan,
    known: Option<&Reference>,
) -> Result<Convergence> {
    let name = |cut: &'static str| counts.iter().map(move |k| format!("{cut}-{k}").parse());
    let strategies = CUTS.into_iter().flat_map(name).collect::<Result<Vec<Strategy>>>()?;
    measure(scene, request, &strategies, &Plan { max_spp: SPP, ..*plan }, known)
}
