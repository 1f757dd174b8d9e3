//! Samplers, BSDFs and renderers of other programs: files of samples, protocols, commands.

pub mod program;
pub mod renderer;
pub mod sampler;
