//! The transport of the protocol: a request, a response.

use crate::error::{Error, Result};
use std::path::Path;

/// The external program: a process, or recorded responses.
pub trait Connection: Send {
    /// The program's name in messages.
    fn name(&self) -> &str;

    /// Sends `request`, whose first line is the command, and returns the lines of the response, at most `most`.
    ///
    /// # Errors
    /// [`Error::Input`] with the program's name, where the [`Answer`](super::Answer) is late or malformed.
    fn ask(&mut self, request: String, most: usize) -> Result<String>;
}

/// An error of the program called `name`.
pub fn protocol_error(name: &str, message: impl Into<String>) -> Error {
    Error::input(Path::new(name), message)
}
