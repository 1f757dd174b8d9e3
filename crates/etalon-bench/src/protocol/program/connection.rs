//! The transport of the protocol: a request, a response.

use etalon_core::error::{Error, Result};
use etalon_core::import::place::quote;
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

/// Asks `verb` for `count` lines and reads the words of each by `read`; `expected` says in a message what a line should be.
pub fn ask<T>(
    connection: &mut dyn Connection,
    [verb, expected]: [&str; 2],
    count: usize,
    request: String,
    read: impl Fn(&[&str]) -> Option<T>,
) -> Result<Vec<T>> {
    let answer = connection.ask(request.clone(), count)?;
    let wrong = |message| protocol_error(connection.name(), format!("asked \"{verb} {count}\", {message}"));
    let mut values = Vec::with_capacity(count);
    for (i, line) in answer.lines().enumerate() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        values.push(read(&words).ok_or_else(|| {
            let asked = request.lines().nth(i + 1).map_or_else(String::new, |asked| format!(" (for {})", quote(asked)));
            let (number, line) = (i + 1, quote(line));
            wrong(format!("line {number} of the answer is {line}{asked}, not {expected}"))
        })?);
    }
    if values.len() == count { Ok(values) } else { Err(wrong(format!("it answered only {} lines", values.len()))) }
}

/// An error of the program called `name`.
pub fn protocol_error(name: &str, message: impl Into<String>) -> Error {
    Error::input(Path::new(name), message)
}
