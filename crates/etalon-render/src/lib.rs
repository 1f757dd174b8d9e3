//! Rendering: the integrator, what of it a scene needs, and the film.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]
#![expect(clippy::needless_range_loop, reason = "loops over lanes read and write several arrays at one index")]

mod adaptive;
mod bsdf_lanes;
mod camera;
mod choice;
mod environment;
pub mod film;
mod geometry;
mod job;
mod kernel;
mod lanes;
mod light_lanes;
mod light_sample;
mod light_selection;
mod light_tracing;
pub mod light_tree;
mod lights;
mod prepared;
mod previous;
pub mod probe;
mod radiance;
mod ray_samples;
mod reference;
mod settings;
mod shaders;
mod solids;

pub use film::Dropped;
pub use job::{Control, Job, Rendered, Silent, render};
pub use settings::check as check_request;
pub use settings::{Kernel, Sampling, Settings};

#[cfg(test)]
mod tests;
