//! Rendering: the integrator, what of it a scene needs, and the film.
//!
//! Files from the bottom up, each importing from those before it: settings, fingerprint, wide, film, solids, lanes,
//! geometry, sample_lanes, lens, cut_lights, lights, shaders, needs, strategies, diffuse, caustic_cones, rough, workspace, product_warp,
//! integrator, light_tracing, direct, job. Three imports run the other way: of geometry in lanes, of integrator in product_warp,
//! of light_tracing in integrator.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod caustic_cones;
mod cut_lights;
mod diffuse;
mod direct;
mod shaders;
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
mod rough;
mod sample_lanes;
mod settings;
mod shading_normal;
mod product_warp;
mod solids;
mod strategies;
mod wide;
mod workspace;

pub use film::Dropped;
pub use job::{Control, Job, Rendered, Silent, render};
pub use settings::{Sampling, Settings};

#[cfg(test)]
mod tests;
