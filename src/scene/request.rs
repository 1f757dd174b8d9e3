//! What a scene (a file or a built-in one) asks of a render; flags override it.

/// Image size and sampling that a scene asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// Camera samples per pixel.
    pub spp: u32,
    /// Light samples at each hit.
    pub light_samples: u32,
    /// 0: emission only; 1: direct light; n: light that arrives over at most n segments after the camera's.
    pub max_depth: u32,
}
