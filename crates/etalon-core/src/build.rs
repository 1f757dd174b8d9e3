//! The build of the program that runs: its results name it. The program declares it once, at its start.

use std::sync::OnceLock;

/// What the program is built from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    pub version: &'static str,
    /// A hash of all sources and of the versions of dependencies.
    pub sources: &'static str,
    /// The first digits of the commit; empty where it is not known.
    pub commit: &'static str,
}

static BUILD: OnceLock<Build> = OnceLock::new();

impl Build {
    /// Declares the build of this program; only the first declaration in a process counts.
    pub fn declare(self) {
        BUILD.get_or_init(|| self);
    }

    /// The declared build of this program; without a declaration the version of this crate alone, so that two builds of such a
    /// program are not distinguished.
    pub fn current() -> Self {
        let unknown = Self { version: env!("CARGO_PKG_VERSION"), sources: "", commit: "" };
        BUILD.get().copied().unwrap_or(unknown)
    }

    /// The version with the hash of the sources. Parts whose ids differ are not merged: one build may draw other samples than another.
    pub fn id(self) -> String {
        format!("{}+{}", self.version, self.sources)
    }
}
