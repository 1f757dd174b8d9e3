//! A sampler and its pdf in another program, called over its standard input and output.
//!
//! The program reads requests and responds to each with the requested number of lines and a line `end`:
//!
//! | request | response |
//! |---|---|
//! | `etalon 1` | `etalon 1 KEY=VALUE …`, then a line `coordinates probability` for each atom |
//! | `sample N`, then N lines of uniform random numbers | N lines `coordinates [pdf]`, `atom coordinates` or `none` |
//! | `sample N SEED`, if its dimension is 0 | the same, from random numbers of its own that start from SEED < 2³² |
//! | `pdf N`, then N lines of coordinates | N lines with a pdf |
//! | `invert N`, then N lines of coordinates | N lines of random numbers, or `none` |
//! | `quit` | it ends; so it does when its input ends |
//!
//! Keys: `name`; `dimension`, the random numbers of a sample (2; 0 if it has its own); `mass`, what the pdf integrates
//! to (1, or `at-most-1`); `domain`; `invert=yes`.
//! The order of the requests is not fixed: samples depend on what a request holds, not on what was asked before.

mod answer;
mod connection;
mod group;
mod handshake;
mod process;

pub use answer::Answer;
pub use connection::Connection;

use super::coordinates::{Coordinates, write_numbers};
use super::number::Words;
use super::space::Space;
use crate::error::{Error, Result};
use crate::import::place::quote;
use connection::violation;
use etalon_stats::{Atom, Density, Mass, Sample, Sampler};
use handshake::Handshake;
use process::Process;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A program after the handshake; the type of its points is chosen by [`Client::over`].
pub struct Client {
    connection: Box<dyn Connection>,
    handshake: Handshake,
    space: Space,
}

impl Client {
    /// Starts `command`, which has at most `limit` for every response. Its domain is `space`, or else the one that it names.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a command that cannot be split or a domain that is missing, [`Error::Io`] for one that cannot be
    /// started, [`Error::Input`] for a response that is late or malformed.
    pub fn start(command: &str, space: Option<Space>, limit: Duration) -> Result<Self> {
        Self::connect(Process::start(command, limit)?, space)
    }

    /// Exchanges the handshake over `connection`. Its domain is `space`, or else the one that it names.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a domain that is missing, [`Error::Input`] for a malformed handshake.
    pub fn connect(mut connection: impl Connection + 'static, space: Option<Space>) -> Result<Self> {
        let handshake = Handshake::of(&mut connection)?;
        let space = match (space, handshake.domain) {
            (Some(asked), Some(own)) if asked != own => {
                return Err(violation(connection.name(), format!("its domain is {own}"))
                    .with_hint(format!("use the domain {own}")));
            }
            (Some(space), _) | (None, Some(space)) => space,
            (None, None) => {
                return Err(Error::parameter("domain", "the program does not say what its domain is")
                    .with_hint("domains: sphere, hemisphere, square, line, discrete:N"));
            }
        };
        Ok(Self { connection: Box::new(connection), handshake, space })
    }

    /// The name that the program gives its sampler.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.handshake.name
    }

    /// The domain.
    #[must_use]
    pub fn space(&self) -> Space {
        self.space
    }

    /// The program as a sampler and pdf of points of [`space`](Self::space).
    ///
    /// # Errors
    /// [`Error::Input`] for a malformed atom.
    pub fn over<P: Coordinates>(self) -> Result<Program<P>> {
        let Self { connection, handshake, .. } = self;
        let read = |line: &String| {
            let mut words = Words::new(line);
            let atom = Atom { point: P::read(&mut words)?, probability: words.number()? };
            (words.is_empty() && (0.0..=1.0).contains(&atom.probability)).then_some(atom)
        };
        let of_line = |line: &String| {
            let wrong = || format!("its atom {} is not \"{} PROBABILITY\"", quote(line), P::WORDS);
            read(line).ok_or_else(|| violation(connection.name(), wrong()))
        };
        let atoms = handshake.atoms.iter().map(of_line).collect::<Result<_>>()?;
        Ok(Program { name: connection.name().to_owned(), connection: Mutex::new(connection), handshake, atoms })
    }
}

/// A running program: the sampler and the pdf of points `P`. One request is in flight at a time.
pub struct Program<P> {
    /// The connection's, for messages.
    name: String,
    connection: Mutex<Box<dyn Connection>>,
    handshake: Handshake,
    atoms: Vec<Atom<P>>,
}

impl<P: Coordinates> Program<P> {
    /// Asks `verb` for `count` lines and reads each by `read`, which also has to use up the words.
    fn ask<T>(
        &self,
        verb: &str,
        count: usize,
        request: String,
        expected: &str,
        read: impl Fn(&mut Words<'_>) -> Option<T>,
    ) -> Result<Vec<T>> {
        // A panic elsewhere leaves nothing half done that matters here.
        let answer = self.connection.lock().unwrap_or_else(PoisonError::into_inner).ask(request.clone(), count)?;
        let wrong = |message| violation(&self.name, format!("asked \"{verb} {count}\", {message}"));
        let mut values = Vec::with_capacity(count);
        for (i, line) in answer.lines().enumerate() {
            let mut words = Words::new(line);
            let value = read(&mut words).filter(|_| words.is_empty()).ok_or_else(|| {
                let asked =
                    request.lines().nth(i + 1).map_or_else(String::new, |line| format!(" (for {})", quote(line)));
                let (number, line) = (i + 1, quote(line));
                wrong(format!("line {number} of the answer is {line}{asked}, not {expected}; NaN is no number"))
            })?;
            values.push(value);
        }
        if values.len() == count { Ok(values) } else { Err(wrong(format!("it answered only {} lines", values.len()))) }
    }

    fn ask_samples(&self, count: usize, request: String) -> Result<Vec<Option<Sample<P>>>> {
        let expected = format!("\"{0}\", \"{0} PDF\", \"atom {0}\" or \"none\"", P::WORDS);
        self.ask("sample", count, request, &expected, read_sample)
    }

    /// The request for something at each of `points`.
    fn at_points(&self, verb: &str, points: &[P]) -> String {
        let mut request = format!("{verb} {}\n", points.len());
        for point in points {
            point.write(&mut request);
            request.push('\n');
        }
        request
    }
}

/// A line of an answer to `sample`; the outer `None` is an error.
fn read_sample<P: Coordinates>(words: &mut Words<'_>) -> Option<Option<Sample<P>>> {
    if words.accept("none") {
        return Some(None);
    }
    if words.accept("atom") {
        return P::read(words).map(|point| Some(Sample::atom(point)));
    }
    let point = P::read(words)?;
    let pdf = if words.is_empty() { None } else { Some(words.number()?) };
    Some(Some(Sample { point, pdf, atom: false }))
}

impl<P: Coordinates> Sampler<P> for Program<P> {
    fn dimension(&self) -> usize {
        self.handshake.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample<P>>>) -> etalon_stats::Result<()> {
        let samples = u.chunks_exact(self.handshake.dimension.max(1));
        let count = samples.len();
        let mut request = format!("sample {count}\n");
        for sample in samples {
            write_numbers(sample, &mut request);
            request.push('\n');
        }
        out.extend(self.ask_samples(count, request)?);
        Ok(())
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample<P>>>) -> etalon_stats::Result<()> {
        out.extend(self.ask_samples(count, format!("sample {count} {seed}\n"))?);
        Ok(())
    }

    fn invert(&self, point: P) -> etalon_stats::Result<Option<Vec<f64>>> {
        if !self.handshake.invert {
            return Ok(None);
        }
        let dimension = self.handshake.dimension;
        let read = |words: &mut Words<'_>| {
            if words.accept("none") {
                return Some(None);
            }
            (0..dimension).map(|_| words.number()).collect::<Option<Vec<f64>>>().map(Some)
        };
        let expected = format!("{dimension} numbers or \"none\"");
        let mut answer = self.ask("invert", 1, self.at_points("invert", &[point]), &expected, read)?;
        Ok(answer.pop().flatten())
    }
}

impl<P: Coordinates> Density<P> for Program<P> {
    fn pdf(&self, points: &[P], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        if points.is_empty() {
            return Ok(());
        }
        let request = self.at_points("pdf", points);
        out.extend(self.ask("pdf", points.len(), request, "a pdf", |words| words.number())?);
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.handshake.mass
    }

    fn atoms(&self) -> Vec<Atom<P>> {
        self.atoms.clone()
    }
}
