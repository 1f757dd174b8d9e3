//! What the renderer of `etalon` and its tests are about: optics, sampling, BSDFs, environment maps, images, scenes and their files.
//!
//! Modules in layers, highest first; a module imports only from lines below its own.
//!
//! | modules | what they hold |
//! |---|---|
//! | [`import`], [`export`] | scene and mesh files; scenes as files of other renderers |
//! | [`scene`] | camera, shapes, BVH, materials, lights, built-in scenes |
//! | [`bsdf`], [`envmap`] | BSDFs; lat-long maps and their samplers |
//! | [`raster`] | float images and their files |
//! | [`errata`] | the formulas that are wrong in the two reports |
//! | [`sampling`] | warps, tables, normals of microfacets, solid angles of shapes |
//! | [`optics`] | Fresnel equations, metals, microfacet distributions |
//! | [`math`] | colours, local frames, the float trait, elementary functions |
//! | [`files`], [`memory`], [`interrupt`], [`build`], [`error`] | atomic files, the limit of memory, Ctrl-C, the program that runs, the error type |

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]

pub mod bsdf;
pub mod build;
pub mod envmap;
pub mod errata;
pub mod error;
pub mod export;
pub mod files;
pub mod import;
pub mod interrupt;
pub mod math;
pub mod memory;
pub mod optics;
pub mod raster;
pub mod sampling;
pub mod scene;

pub use error::{Error, Result};
