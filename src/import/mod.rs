//! Scene and mesh files of other programs: scene readers give a [`Scene`] and what the file asks of a render.

pub mod collada;
pub mod mesh;
pub mod pbrt;
mod place;
mod shape;
mod transform;

use crate::scene::{Request, Scene};
use std::path::PathBuf;

/// What a scene file holds.
#[derive(Debug, Clone)]
pub struct Imported {
    pub scene: Scene,
    pub request: Request,
    /// Where the file wants its picture, as written there.
    pub output: Option<PathBuf>,
    /// What was left out or filled in without harm to the picture, each with its place, in the file's order.
    pub warnings: Vec<String>,
}
