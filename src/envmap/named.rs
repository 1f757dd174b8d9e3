//! An environment map and the name under which a user knows it.

use super::EnvMap;
use std::sync::Arc;

/// A map with the name of its file or of the built-in map.
#[derive(Debug, Clone)]
pub struct NamedMap {
    /// The map.
    pub map: Arc<EnvMap>,
    /// A path as it was given, or a built-in name.
    pub name: String,
}
