//! Who is asked: what the protocol needs of a program, however that is reached.

use crate::error::{Error, Result};
use std::path::Path;

/// The other side of the protocol: a process, or a record of what one said.
pub trait Peer: Send {
    /// What messages call it.
    fn name(&self) -> &str;

    /// Sends `request`, whose first line says what is asked, and returns the lines of the answer: `most` at most.
    ///
    /// # Errors
    /// [`Error::Input`] with the peer's name, where the [`Answer`](super::Answer) does not come or is not one.
    fn ask(&mut self, request: String, most: usize) -> Result<String>;
}

/// Says what is wrong with a peer, naming it.
pub fn fault(name: &str, message: impl Into<String>) -> Error {
    Error::input(Path::new(name), message)
}
