//! The build of the program that runs, which results carry. The program states it once, at its start.

use std::sync::OnceLock;

/// What the program is built from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    pub version: &'static str,
    /// A hash of all sources and of the versions of dependencies.
    pub sources: &'static str,
    /// The commit; empty where there was no repository.
    pub commit: &'static str,
}

static BUILD: OnceLock<Build> = OnceLock::new();

impl Build {
    /// States the build of this program; a second statement in one process changes nothing.
    pub fn state(self) {
        BUILD.get_or_init(|| self);
    }

    /// The build of this program; of a program that states none, the version of this crate alone.
    #[must_use]
    pub fn current() -> Self {
        let unknown = Self { version: env!("CARGO_PKG_VERSION"), sources: "", commit: "" };
        BUILD.get().copied().unwrap_or(unknown)
    }

    /// The version with the hash of the sources: parts of two builds are not merged, for one may draw other samples than the other.
    #[must_use]
    pub fn id(self) -> String {
        format!("{}+{}", self.version, self.sources)
    }
}
