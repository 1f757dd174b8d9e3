//! The studies of `etalon`, one file or folder per study: each computes a plain result and neither plots nor prints.
//! [`protocol`] has the samplers, BSDFs and renderers of other programs that they test.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]

pub mod albedo;
pub mod appearance;
pub mod audit;
pub mod claims;
pub mod compare;
pub mod converge;
pub mod depth;
pub mod fit;
pub mod fresnel;
pub mod likeness;
pub mod map_samples;
pub mod media;
pub mod median_cut;
pub mod metal;
pub mod object_ids;
pub mod proposal;
pub mod protocol;
pub mod roughness;
pub mod sampling_strategies;
pub mod sphere;
pub mod stability;
pub mod sweep;
pub mod table;
pub mod validation;
