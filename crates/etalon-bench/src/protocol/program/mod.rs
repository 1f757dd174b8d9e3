//! Samplers and BSDFs in other programs, called over their standard input and output.
//!
//! The program reads requests and responds to each with the requested lines and a line `end`. The first request is `etalon 1`;
//! the response is a greeting, `etalon 1 KEY=VALUE …`, whose key `kind` says what the program has: a [`sampler`] with its pdf, or
//! a [`bsdf`] over its parameters. The request `quit`, or the end of its input, ends the program.
//! The order of the other requests is not fixed: an answer depends on what a request holds, not on what was asked before.

pub mod bsdf;
mod connection;
mod process;
pub mod properties;
pub mod sampler;

pub use connection::{Answer, Connection};
pub(crate) use process::{Group, last_line, tail, words};

use crate::protocol::sampler::Space;
use etalon_core::error::{Error, Result};
use process::Process;
use properties::Greeting;
use std::time::Duration;

/// What a program says in its greeting that it has.
pub enum External {
    Sampler(sampler::Client),
    /// BSDFs over their parameters.
    Bsdf(bsdf::Program),
}

/// Starts `command`, which has at most `limit` for every response. The domain of a sampler is `space`, or else the one that it
/// names.
///
/// # Errors
/// [`Error::Parameter`] for a command that cannot be split or a domain that is missing, [`Error::Io`] for one that cannot be
/// started, [`Error::Input`] for a response that is late or malformed.
pub fn start(command: &str, space: Option<Space>, limit: Duration) -> Result<External> {
    connect(Process::start(command, limit)?, space)
}

/// Exchanges the handshake over `connection`. The domain of a sampler is `space`, or else the one that it names.
///
/// # Errors
/// [`Error::Parameter`] for a domain that is missing, [`Error::Input`] for a malformed handshake.
pub fn connect(mut connection: impl Connection + 'static, space: Option<Space>) -> Result<External> {
    let mut greeting = Greeting::of(&mut connection)?;
    match greeting.take("kind").as_deref() {
        None | Some("sampler") => sampler::Client::new(connection, greeting, space).map(External::Sampler),
        Some("bsdf") if space.is_some() => Err(Error::parameter("domain", "directions of a BSDF lie on the sphere")),
        Some("bsdf") => bsdf::Program::new(connection, greeting).map(External::Bsdf),
        Some(other) => Err(greeting.meaningless("kind", other)),
    }
}
