//! Positions in a scene file or in one that it includes, and messages with them.

use crate::error::{Error, Place};
use std::fmt;
use std::path::Path;
use std::rc::Rc;

/// A place in one of the files of a scene.
#[derive(Debug, Clone)]
pub struct At {
    path: Rc<Path>,
    place: Place,
}

impl At {
    /// A line and a column, both counted from 1.
    pub fn new(path: Rc<Path>, line: usize, column: usize) -> Self {
        Self { path, place: Place::Text { line, column } }
    }

    pub fn file(path: Rc<Path>) -> Self {
        Self { path, place: Place::File }
    }

    pub fn input(&self, message: impl Into<String>) -> Error {
        Error::input(&self.path, message).at(self.place)
    }

    pub fn unsupported(&self, message: impl Into<String>) -> Error {
        Error::unsupported(&self.path, message).at(self.place)
    }

    pub fn limit(&self, message: impl Into<String>) -> Error {
        Error::limit(&self.path, message).at(self.place)
    }

    /// The error for another file, named here, that cannot be opened; other errors are passed on.
    pub fn cannot_read(&self, error: Error) -> Error {
        match error {
            Error::Io { path, source } => self.input(format!("cannot read {}: {source}", path.display())),
            other => other,
        }
    }

    /// A warning in the same format.
    pub fn warning(&self, message: &str) -> String {
        format!("{self}: {message}")
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.path.display(), self.place)
    }
}

/// Text of the user for a message: quoted, control characters escaped, and cut when long.
pub fn quote(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}
