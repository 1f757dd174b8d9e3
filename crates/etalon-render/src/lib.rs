//! Rendering: the integrator, what of it a scene needs, and the film.
//!
//! Files from the bottom up, each importing from those before it: settings, fingerprint, wide, mis, film, solids, lanes, geometry,
//! sample_lanes, lens, shading_normal, cut_lights, light_tree, light_sample, triangle_light, lights, light_lanes, light_selection, shaders, needs, environment, light_tracing,
//! prepared, departure, reference, kernel, adaptive, job, choice.

#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod adaptive;
mod choice;
mod departure;
mod environment;
pub mod film;
mod fingerprint;
mod geometry;
mod job;
mod kernel;
mod lanes;
mod lens;
mod light_lanes;
mod light_sample;
mod light_selection;
mod light_tracing;
pub mod light_tree;
mod lights;
mod needs;
mod prepared;
pub mod probe;
mod reference;
mod sample_lanes;
mod settings;
mod shaders;
mod solids;
mod triangle_light;

pub use film::Dropped;
pub use job::{Control, Job, Rendered, Silent, render};
pub use settings::check as check_request;
pub use settings::{Kernel, Sampling, Settings};

#[cfg(test)]
mod tests;
