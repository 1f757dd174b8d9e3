//! What the protocol needs of a program, however it is reached.

use crate::error::{Error, Result};
use std::path::Path;

/// The program at the other end: a process, or a record of what one said.
pub trait Connection: Send {
    /// The program's name in messages.
    fn name(&self) -> &str;

    /// Sends `request`, whose first line says what is asked, and returns the lines of the answer: `most` at most.
    ///
    /// # Errors
    /// [`Error::Input`] with the program's name, where the [`Answer`](super::Answer) does not come or is not one.
    fn ask(&mut self, request: String, most: usize) -> Result<String>;
}

/// What is wrong with the program of that name.
pub fn fault(name: &str, message: impl Into<String>) -> Error {
    Error::input(Path::new(name), message)
}
