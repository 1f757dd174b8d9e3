//! What every reader of scene files returns.

use crate::scene::{Request, Scene};
use std::path::PathBuf;

/// The content of a scene file.
#[derive(Debug, Clone)]
pub struct Imported {
    /// What the file describes.
    pub scene: Scene,
    /// Image size and sampling that it asks for, defaults filled in.
    pub request: Request,
    /// The image file that the scene names.
    pub output: Option<PathBuf>,
    /// What was left out or filled in without an effect on the image, each with its place, in the file's order.
    pub warnings: Vec<String>,
    /// The environment map that was read because the file names it.
    pub map: Option<PathBuf>,
}
