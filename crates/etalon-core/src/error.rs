//! The error type: one variant per cause; messages describe the problem, hints the remedy.
//!
//! Messages and hints put the names of parameters between backquotes: [`Error::with_names`] replaces them by the words of
//! a user interface.

use std::fmt;
use std::path::{Path, PathBuf};

/// Shorthand used by every fallible function of the crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Position of an error in an input file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    File,
    /// Offset from the start of the file, in bytes.
    Byte(u64),
    /// Line and column of a text file, both counted from 1.
    Text {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
    },
}

/// An error of the library.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file's content is damaged or contradicts its own format.
    #[error("{0}")]
    Input(Fault),
    /// A value given by the caller, the field or argument that the fault names, is out of range.
    #[error("{0}")]
    Parameter(Fault),
    /// The file may be valid, but uses a feature that this program does not implement.
    #[error("{0}")]
    Unsupported(Fault),
    /// The file needs more memory or time than allowed.
    #[error("{0}")]
    Limit(Fault),
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file, or another name for what was written or read.
        path: PathBuf,
        source: std::io::Error,
    },
    /// This would need more memory than is allowed; see [`crate::memory`].
    #[error("{0}")]
    Memory(Shortage),
    /// The process was asked to stop; see [`crate::interrupt`].
    #[error("interrupted")]
    Interrupted,
}

/// What is wrong with a file or a parameter, and the remedy.
#[derive(Debug)]
pub struct Fault {
    /// The file, or the name of the parameter.
    name: String,
    place: Place,
    message: String,
    hint: Option<String>,
}

/// A request for memory beyond the limit. Sizes are in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shortage {
    pub what: String,
    /// What it takes.
    pub needed: u64,
    /// What the process holds already.
    pub held: u64,
    /// What the process may hold.
    pub limit: u64,
    pub source: &'static str,
}

impl Error {
    /// An [`Error::Input`] about the file as a whole.
    pub fn input(path: &Path, message: impl Into<String>) -> Self {
        Error::Input(Fault::new(path.display(), message))
    }

    pub fn parameter(name: impl fmt::Display, message: impl Into<String>) -> Self {
        Error::Parameter(Fault::new(name, message))
    }

    /// An [`Error::Unsupported`] about the file as a whole.
    pub fn unsupported(path: &Path, message: impl Into<String>) -> Self {
        Error::Unsupported(Fault::new(path.display(), message))
    }

    pub fn limit(path: &Path, message: impl Into<String>) -> Self {
        Error::Limit(Fault::new(path.display(), message))
    }

    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Error::Io { path: path.into(), source }
    }

    /// The fault, for the variants that have one.
    fn fault(&mut self) -> Option<&mut Fault> {
        match self {
            Error::Input(fault) | Error::Parameter(fault) | Error::Unsupported(fault) | Error::Limit(fault) => {
                Some(fault)
            }
            Error::Io { .. } | Error::Memory(_) | Error::Interrupted => None,
        }
    }

    /// Sets the position in the file, for the variants that have one.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        if let Some(fault) = self.fault() {
            fault.place = place;
        }
        self
    }

    /// Sets the hint: what the user can do about it. Variants without a hint stay unchanged.
    #[must_use]
    pub fn with_hint(mut self, text: impl Into<String>) -> Self {
        if let Some(fault) = self.fault() {
            fault.hint = Some(text.into());
        }
        self
    }

    /// One about a parameter as one about the file that gives it; others stay unchanged.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Error::Parameter(fault) => Error::Input(Fault { name: path.display().to_string(), ..fault }),
            other => other,
        }
    }

    /// The error with other names for parameters, such as flags: `word` returns the new name, or `None` to keep the old.
    #[must_use]
    pub fn with_names<'a>(mut self, word: impl Fn(&str) -> Option<&'a str>) -> Self {
        if let Error::Parameter(Fault { name, .. }) = &mut self
            && let Some(word) = word(name)
        {
            *name = word.to_owned();
        }
        if let Some(Fault { message, hint, .. }) = self.fault() {
            std::iter::once(message).chain(hint).for_each(|text| *text = renamed(text, &word));
        }
        self
    }

    /// The hint: what the user can do about it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Error::Input(fault) | Error::Parameter(fault) | Error::Unsupported(fault) | Error::Limit(fault) => {
                fault.hint.as_deref()
            }
            // The shell gives a pattern that matches nothing as it is
            Error::Io { path, source } => {
                let is_pattern = path.to_string_lossy().contains(['*', '?']);
                let is_missing = source.kind() == std::io::ErrorKind::NotFound;
                (is_pattern && is_missing).then_some("the pattern matches no file")
            }
            Error::Memory(_) | Error::Interrupted => None,
        }
    }
}

impl Fault {
    fn new(name: impl fmt::Display, message: impl Into<String>) -> Self {
        Self { name: name.to_string(), place: Place::File, message: message.into(), hint: None }
    }
}

/// `text` with `word` in place of every name between backquotes for which there is one.
fn renamed<'a>(text: &str, word: &impl Fn(&str) -> Option<&'a str>) -> String {
    let (mut done, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once('`') {
        done += before;
        match after.split_once('`').and_then(|(name, left)| Some((word(name)?, left))) {
            Some((word, left)) => {
                done += word;
                rest = left;
            }
            None => {
                done.push('`');
                rest = after;
            }
        }
    }
    done + rest
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Byte(offset) => write!(f, ", byte {offset}"),
            Place::Text { line, column } => write!(f, ":{line}:{column}"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, place, message, .. } = self;
        write!(f, "{name}{place}: {message}")
    }
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, source, .. } = self;
        let [needed, held, limit] = [self.needed, self.held, self.limit].map(mebibytes);
        write!(f, "{what}: this takes {needed} beside the {held} in use; the limit is {limit}, {source}")
    }
}

/// A number of bytes as people read it.
fn mebibytes(bytes: u64) -> String {
    let mebibytes = bytes as f64 / f64::from(1 << 20);
    if mebibytes < 10.0 { format!("{mebibytes:.1} MiB") } else { format!("{mebibytes:.0} MiB") }
}

/// The error of a test: one of the program's own, raised by a sampler or density of it, comes back as it was.
impl From<etalon_stats::Error> for Error {
    fn from(error: etalon_stats::Error) -> Self {
        match error {
            etalon_stats::Error::Parameter { name, message, hint } => {
                Error::Parameter(Fault { hint: hint.map(str::to_owned), ..Fault::new(name, message) })
            }
            etalon_stats::Error::Cancelled => Error::Interrupted,
            etalon_stats::Error::External(error) => match error.downcast::<Error>() {
                Ok(own) => *own,
                Err(other) => Error::input(Path::new("sampler"), other.to_string()),
            },
            other => Error::input(Path::new("sampler"), other.to_string()),
        }
    }
}

/// What a sampler or density of the program returns to the test that called it.
impl From<Error> for etalon_stats::Error {
    fn from(error: Error) -> Self {
        match error {
            Error::Interrupted => Self::Cancelled,
            error => Self::external(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_file_and_the_place() {
        let e = Error::input(Path::new("a.pbrt"), "unknown directive \"Foo\"").at(Place::Text { line: 3, column: 7 });
        assert_eq!(e.to_string(), "a.pbrt:3:7: unknown directive \"Foo\"");
        let e = Error::input(Path::new("a.pfm"), "file ends early").at(Place::Byte(12)).with_hint("download it again");
        assert_eq!(e.to_string(), "a.pfm, byte 12: file ends early");
        assert_eq!(e.hint(), Some("download it again"));
        let e = Error::parameter("mesh", "it is flat").with_hint("another").in_file(Path::new("a.obj"));
        assert_eq!((e.to_string(), e.hint()), ("a.obj: it is flat".to_owned(), Some("another")));
    }

    #[test]
    fn names_of_parameters_can_be_replaced() {
        let word = |name: &str| [("spp", "SPP"), ("ldr", "LDR")].into_iter().find(|w| w.0 == name).map(|w| w.1);
        let e = Error::parameter("spp", "0 (`spp`), a ` alone")
            .with_hint("`spp` or `ldr`, `git lfs pull`")
            .with_names(word);
        assert_eq!(e.to_string(), "SPP: 0 (SPP), a ` alone");
        assert_eq!(e.hint(), Some("SPP or LDR, `git lfs pull`"));
        let e = Error::input(Path::new("spp"), "`size` of ``spp`").with_names(word);
        assert_eq!(e.to_string(), "spp: `size` of `SPP");
    }

    #[test]
    fn a_pattern_without_a_match_is_told_so() {
        let of = |path: &str, kind: std::io::ErrorKind| Error::io(Path::new(path), kind.into());
        assert!(of("no-*.exr", std::io::ErrorKind::NotFound).hint().is_some_and(|hint| hint.contains("no file")));
        assert_eq!(of("a.exr", std::io::ErrorKind::NotFound).hint(), None);
        assert_eq!(of("a*.exr", std::io::ErrorKind::PermissionDenied).hint(), None);
    }

    #[test]
    fn errors_pass_through_a_test_unchanged() {
        let there_and_back = |e: Error| Error::from(etalon_stats::Error::from(e));
        let e = there_and_back(Error::input(Path::new("a.csv"), "no row").at(Place::Byte(3)).with_hint("add one"));
        assert_eq!((e.to_string(), e.hint()), ("a.csv, byte 3: no row".to_owned(), Some("add one")));
        assert!(matches!(there_and_back(Error::Interrupted), Error::Interrupted));
    }
}
