//! All integration tests: one binary, because each one links the whole crate.

mod appearance;
mod architecture;
mod assets;
mod bad_input;
mod book;
mod collada_files;
mod command_line;
mod compare;
mod converge;
mod exec;
mod exr_layers;
mod furnace;
mod glass_furnaces;
#[cfg(unix)]
mod kill;
mod limits;
mod merge;
mod mesh_files;
mod not_a_number;
mod odd_images;
mod outputs;
mod page;
mod pbrt_files;
mod program;
mod raster_files;
mod render;
mod stability;
#[cfg(unix)]
mod streams;
mod validate;
