//! The textures that a file has named so far, and the images that they share.

use crate::scene::{Texels, Texture};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Most pixels in a scene's images for textures, all together: 3 GiB.
pub const MAX_TEXTURE_PIXELS: u64 = 1 << 28;

/// The textures so far.
pub struct Textures {
    pub named: HashMap<(Values, String), Named>,
    /// The images that have been read.
    pub texels: HashMap<TexelsKey, Arc<Texels>>,
    /// How many more pixels may be read.
    pub pixels: u64,
}

/// A texture, and how many textures it is made of.
#[derive(Clone)]
pub struct Named {
    pub texture: Texture,
    pub parts: usize,
}

/// Whether a texture is of colours or of numbers; a name may stand for one of each.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Values {
    Spectrum,
    Float,
}

/// What identifies the texels of an image: its file, what they are, and whether its codes are linear.
pub type TexelsKey = (PathBuf, Values, bool);

impl Default for Textures {
    fn default() -> Self {
        Self { named: HashMap::new(), texels: HashMap::new(), pixels: MAX_TEXTURE_PIXELS }
    }
}
