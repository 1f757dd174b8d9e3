//! What an image file says about how its image was made.

/// Value of the `software` attribute.
pub const SOFTWARE: &str = concat!("etalon ", env!("CARGO_PKG_VERSION"));

/// The attribute of a part with the program's [`Build`](crate::build::Build).
pub const BUILD_NAME: &str = "build";

/// What a file says about how its image was made: names and values, in order.
///
/// OpenEXR keeps them as text attributes, Radiance HDR as comment lines; the other formats cannot hold them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

impl Metadata {
    /// Adds an entry after those that are there, for example `.with("spp", 64)`.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.entries.push((name.into(), value.to_string()));
        self
    }

    /// All entries, in the order in which they were added.
    #[must_use]
    pub fn entries(&self) -> &[(String, String)] {
        &self.entries
    }

    /// The value of an entry.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}
