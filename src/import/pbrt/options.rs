//! Options of the reader of pbrt files.

use crate::envmap::EnvMap;
use crate::error::Result;
use crate::raster::Image;
use std::path::Path;
use std::sync::Arc;

/// Options of [`read`](super::read).
pub struct PbrtOptions<'a> {
    /// A map, and what it is called, that stands in for the one that the file names (which is then not opened).
    pub environment: Option<(Arc<EnvMap>, String)>,
    /// Reads an image file, row 0 at the top as stored.
    pub load_map: &'a dyn Fn(&Path) -> Result<Image>,
}
