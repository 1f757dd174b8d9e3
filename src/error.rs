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
    /// The file as a whole.
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
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The file's content is damaged or contradicts its own format.
    Input {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// A value given by the caller is out of range.
    Parameter {
        /// Of the field or argument of the library.
        name: String,
        /// What is wrong with its value.
        message: String,
        /// Which values can be used.
        hint: Option<String>,
    },
    /// The file may be valid, but uses a feature that this program does not implement.
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// The request needs more memory or time than allowed.
    Limit {
        /// The file that asks for it.
        path: PathBuf,
        /// What is too much.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// The operating system refused.
    Io {
        /// The file, or another name for what was written or read.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// This would need more memory than is allowed; see [`crate::memory`].
    Memory(Shortage),
    /// The process was asked to stop; see [`crate::interrupt`].
    Interrupted,
}

/// A request for memory beyond the limit. Sizes are in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shortage {
    /// What the memory is for.
    pub what: String,
    /// What it takes.
    pub needed: u64,
    /// What the process holds already.
    pub held: u64,
    /// What the process may hold.
    pub limit: u64,
    /// Where the limit comes from.
    pub source: &'static str,
}

impl Error {
    /// A damaged input file.
    pub fn input(path: &Path, message: impl Into<String>) -> Self {
        Error::Input { path: path.into(), place: Place::File, message: message.into(), hint: None }
    }

    /// A parameter out of its range; `name` is that of the field or argument, for example `max_depth`.
    pub fn parameter(name: impl Into<String>, message: impl Into<String>) -> Self {
        Error::Parameter { name: name.into(), message: message.into(), hint: None }
    }

    /// A feature that this program does not implement.
    pub fn unsupported(path: &Path, message: impl Into<String>) -> Self {
        Error::Unsupported { path: path.into(), place: Place::File, message: message.into(), hint: None }
    }

    /// A request larger than the limits of the program.
    pub fn limit(path: &Path, message: impl Into<String>) -> Self {
        Error::Limit { path: path.into(), message: message.into(), hint: None }
    }

    /// An error of the operating system, with the file that it concerns.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Error::Io { path: path.into(), source }
    }

    /// Sets the position in the file, for the variants that have one.
    #[must_use]
    pub fn at(mut self, at: Place) -> Self {
        if let Error::Input { place, .. } | Error::Unsupported { place, .. } = &mut self {
            *place = at;
        }
        self
    }

    /// Sets the hint: what the user can do about it. Variants without a hint stay unchanged.
    #[must_use]
    pub fn with_hint(mut self, text: impl Into<String>) -> Self {
        match &mut self {
            Error::Input { hint, .. }
            | Error::Parameter { hint, .. }
            | Error::Unsupported { hint, .. }
            | Error::Limit { hint, .. } => *hint = Some(text.into()),
            Error::Io { .. } | Error::Memory(_) | Error::Interrupted => {}
        }
        self
    }

    /// The error with other names for parameters, such as flags: `word` returns the new name, or `None` to keep the old.
    #[must_use]
    pub fn with_names<'a>(mut self, word: impl Fn(&str) -> Option<&'a str>) -> Self {
        if let Error::Parameter { name, .. } = &mut self
            && let Some(word) = word(name)
        {
            *name = word.to_owned();
        }
        match &mut self {
            Error::Input { message, hint, .. }
            | Error::Parameter { message, hint, .. }
            | Error::Unsupported { message, hint, .. }
            | Error::Limit { message, hint, .. } => {
                for text in std::iter::once(message).chain(hint) {
                    *text = renamed(text, &word);
                }
            }
            Error::Io { .. } | Error::Memory(_) | Error::Interrupted => {}
        }
        self
    }

    /// The hint: what the user can do about it.
    #[must_use]
    pub fn hint(&self) -> Option<&str> {
        match self {
            Error::Input { hint, .. }
            | Error::Parameter { hint, .. }
            | Error::Unsupported { hint, .. }
            | Error::Limit { hint, .. } => hint.as_deref(),
            Error::Io { .. } | Error::Memory(_) | Error::Interrupted => None,
        }
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

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Input { path, place, message, .. } | Error::Unsupported { path, place, message, .. } => {
                write!(f, "{}{place}: {message}", path.display())
            }
            Error::Parameter { name, message, .. } => write!(f, "{name}: {message}"),
            Error::Limit { path, message, .. } => write!(f, "{}: {message}", path.display()),
            Error::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Error::Memory(Shortage { what, needed, held, limit, source }) => {
                let [needed, held, limit] = [needed, held, limit].map(|bytes| Mebibytes(*bytes));
                write!(f, "{what}: this takes {needed} beside the {held} in use; the limit is {limit}, {source}")
            }
            Error::Interrupted => f.write_str("interrupted"),
        }
    }
}

/// A number of bytes as people read it.
struct Mebibytes(u64);

impl fmt::Display for Mebibytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = self.0 as f64 / f64::from(1 << 20);
        if mebibytes < 10.0 { write!(f, "{mebibytes:.1} MiB") } else { write!(f, "{mebibytes:.0} MiB") }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// The error of a test: one of the program's own, raised by a sampler or density of it, comes back as it was.
impl From<etalon_stats::Error> for Error {
    fn from(error: etalon_stats::Error) -> Self {
        match error {
            etalon_stats::Error::Parameter { name, message, hint } => {
                Error::Parameter { name: name.into(), message, hint: hint.map(str::to_owned) }
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
    fn errors_pass_through_a_test_unchanged() {
        let there_and_back = |e: Error| Error::from(etalon_stats::Error::from(e));
        let e = there_and_back(Error::input(Path::new("a.csv"), "no row").at(Place::Byte(3)).with_hint("add one"));
        assert_eq!((e.to_string(), e.hint()), ("a.csv, byte 3: no row".to_owned(), Some("add one")));
        assert!(matches!(there_and_back(Error::Interrupted), Error::Interrupted));
    }
}
