//! Rendering: the integrator, what of it a scene needs, and the film.
//!
//! Files from the bottom up, each importing from those before it: settings, fingerprint, wide, mis, film, solids, lanes, geometry,
//! sample_lanes, lens, shading_normal, cut_lights, light_tree, light_sample, triangle_light, lights, light_lanes, light_selection, shaders, needs, environment, light_tracing,
//! prepared, departure, reference, kernel, adaptive, job, choice.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod adaptive;
mod choice;
mod departure;
pub(crate) mod environment;
pub mod film;
mod fingerprint;
pub(crate) mod geometry;
mod job;
pub(crate) mod kernel;
pub(crate) mod lanes;
pub(crate) mod lens;
pub(crate) mod light_lanes;
pub(crate) mod light_sample;
pub(crate) mod light_selection;
pub(crate) mod light_tracing;
pub mod light_tree;
pub(crate) mod lights;
mod needs;
pub(crate) mod prepared;
mod reference;
mod sample_lanes;
mod settings;
pub(crate) mod shaders;
mod solids;
mod triangle_light;

pub use film::Dropped;
pub use job::{Control, Job, Rendered, Silent, render};
pub(crate) use settings::check as check_request;
pub use settings::{Kernel, Sampling, Settings};

#[cfg(test)]
mod tests;
