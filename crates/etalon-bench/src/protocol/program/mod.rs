//! Samplers, BSDFs, phase functions and lights in other programs, called over their standard input and output.
//!
//! The program reads requests and responds to each with the requested lines and a line `end`. The first request is `etalon 1`;
//! the response is a greeting, `etalon 1 KEY=VALUE …`, whose key `kind` says what the program has: a [`sampler`] with its pdf, or
//! a [`bsdf`] over its parameters, which may be a phase function or a light, too. The request `quit`, or the end of its input, ends the program.
//! The order of the other requests is not fixed: an answer depends on what a request holds, not on what was asked before. A line
//! `error TEXT` in place of an answer ends the test.

pub mod bsdf;
mod connection;
mod process;
pub mod properties;
pub mod sampler;

pub use connection::{Answer, Connection};
pub(crate) use process::{Group, last_line, tail, words};

use crate::protocol::sampler::Space;
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_stats::{DOMAINS, named};
use process::Process;
use properties::Greeting;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Duration;

/// The client that serves the functions of a Python file.
const PYTHON_CLIENT: &str = include_str!("file.py");
/// The interpreters that are looked for, in this order.
const PYTHON: [&str; 2] = ["python3", "python"];

/// What a program says in its greeting that it has.
pub enum External {
    Sampler(sampler::Client),
    /// BSDFs, phase functions or lights over their parameters.
    Bsdf(bsdf::Program),
}

/// Starts `command`, which has at most `limit` for every response. The domain of a sampler is `space`, or else the one that it
/// names.
///
/// # Errors
/// [`Error::Parameter`] for a command that cannot be split or a domain that is missing, [`Error::Io`] for one that cannot be
/// started, [`Error::Input`] for a response that is late or malformed.
pub fn start(command: &str, space: Option<Space>, limit: Duration) -> Result<External> {
    let words = words("command", command)?;
    connect(Process::start(command, &words, limit)?, space)
}

/// Whether a name is that of a Python file, whose functions [`start_file`] serves.
pub fn is_python_file(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("py"))
}

/// Starts Python with the functions `sample` and `pdf` of a file, a sampler, or with its functions `sample`, `pdf` and `value`, a
/// BSDF. The domain of a sampler is `space`, or the file's variable `domain`, or taken from its samples.
///
/// # Errors
/// Those of [`start`]; [`Error::Input`] for a file that is not there or whose functions make no sense; [`Error::Io`] without Python.
pub fn start_file(file: &str, space: Option<Space>, limit: Duration) -> Result<External> {
    let path = Path::new(file);
    if !path.is_file() {
        return Err(Error::input(path, "there is no such file"));
    }
    files::note_input(path);
    let widths = DOMAINS.iter().map(|entry| {
        let of = |name: &str| named(name).ok().map(|domain| domain.names().len());
        let more = (3..=7).flat_map(|n| [format!("box:{}", vec!["0,1"; n].join(",")), format!("simplex:{n}")]);
        let more = more.filter(|name| name.starts_with(&format!("{}:", entry.name)));
        let names = [entry.name, entry.example].map(str::to_owned).into_iter().chain(more);
        let mut widths: Vec<usize> = names.filter_map(|name| of(&name)).collect();
        widths.dedup();
        format!("\"{}\": {widths:?}", entry.name)
    });
    let widths = widths.collect::<Vec<_>>().join(", ");
    let client = PYTHON_CLIENT.replacen("WIDTHS = {}", &format!("WIDTHS = {{{widths}}}"), 1);
    let program = |python: &str| {
        let domain = space.as_ref().map(ToString::to_string);
        let words = [python, "-c", &client, file].map(str::to_owned).into_iter().chain(domain);
        Process::start(file, &words.collect::<Vec<_>>(), limit)
    };
    let is_missing = |started: &Result<Process>| matches!(started, Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound);
    let started = PYTHON.iter().map(|python| program(python)).find(|started| !is_missing(started));
    let missing = || Error::input(path, format!("it needs Python, but {} are not found", PYTHON.join(" and ")));
    connect(started.ok_or_else(|| missing().with_hint("install Python, or add its folder to PATH"))??, space)
}

/// Exchanges the handshake over `connection`. The domain of a sampler is `space`, or else the one that it names.
///
/// # Errors
/// [`Error::Parameter`] for a domain that is missing, [`Error::Input`] for a malformed handshake.
pub fn connect(mut connection: impl Connection + 'static, space: Option<Space>) -> Result<External> {
    let mut greeting = Greeting::of(&mut connection)?;
    match greeting.take("kind").as_deref() {
        None | Some("sampler") => sampler::Client::new(connection, greeting, space).map(External::Sampler),
        Some(kind) => match properties::of_kind(kind) {
            None => Err(greeting.meaningless("kind", kind)),
            Some(_) if space.is_some() => {
                Err(Error::parameter("domain", format!("directions of a {kind} lie on the sphere")))
            }
            Some(properties) => bsdf::Program::new(connection, greeting, properties).map(External::Bsdf),
        },
    }
}
