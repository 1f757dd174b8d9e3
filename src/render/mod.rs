//! Rendering: the integrator, what of it a scene needs, and the film.
//!
//! Files from the bottom up, each importing from those before it (but `integrator` holds the plan of `light_tracing`): settings, fingerprint, wide, mis, film, solids, lanes,
//! geometry, sample_lanes, lens, shading_normal, cut_lights, lights, shaders, needs, strategies, diffuse, caustic_cones,
//! rough, workspace, product_warp, integrator, scatter, light_tracing, direct, job.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod caustic_cones;
mod cut_lights;
mod diffuse;
mod direct;
pub mod film;
mod fingerprint;
mod geometry;
mod integrator;
mod job;
mod lanes;
mod lens;
mod light_tracing;
pub(crate) mod lights;
mod mis;
mod needs;
mod product_warp;
#[cfg(test)]
mod reference;
mod rough;
mod sample_lanes;
mod scatter;
mod settings;
mod shaders;
mod shading_normal;
mod solids;
mod strategies;
mod wide;
mod workspace;

pub use film::Dropped;
pub use job::{Control, Job, Rendered, Silent, render};
pub(crate) use settings::check as check_request;
pub use settings::{Sampling, Settings};

#[cfg(test)]
mod tests;
