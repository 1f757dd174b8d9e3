//! Asking for the memory of a table over a map.

use super::EnvMap;
use crate::error::Result;
use crate::memory;

impl EnvMap {
    /// Asks for the memory of a table that takes so many bytes for each texel.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory).
    pub fn request(&self, bytes_per_texel: usize, table: &str) -> Result<()> {
        let (width, height) = (self.image().width(), self.image().height());
        memory::request(width * height * bytes_per_texel, || format!("{table} of a map of {width}x{height} texels"))
    }
}
