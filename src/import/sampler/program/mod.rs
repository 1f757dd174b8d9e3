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

use super::domain::{Coordinates, write_numbers};
use super::space::Space;
use crate::error::{Error, Result};
use crate::import::number::real;
use crate::import::place::quote;
use connection::protocol_error;
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
                return Err(protocol_error(connection.name(), format!("its domain is {own}"))
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

    /// The program as a sampler and pdf over `domain`, which is [`space`](Self::space).
    ///
    /// # Errors
    /// [`Error::Input`] for a malformed atom.
    pub fn over<D: Coordinates>(self, domain: D) -> Result<Program<D>> {
        let Self { connection, handshake, .. } = self;
        let read = |line: &str| {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let (probability, point) = words.split_last()?;
            let probability = real(probability).filter(|p| (0.0..=1.0).contains(p))?;
            Some(Atom { point: domain.read(point)?, probability })
        };
        let of_line = |line: &String| {
            let wrong = || format!("its atom {} is not \"{} PROBABILITY\"", quote(line), words::<D>());
            read(line).ok_or_else(|| protocol_error(connection.name(), wrong()))
        };
        let atoms = handshake.atoms.iter().map(of_line).collect::<Result<_>>()?;
        Ok(Program { domain, name: connection.name().to_owned(), connection: Mutex::new(connection), handshake, atoms })
    }
}

/// The words of a point, for messages.
fn words<D: Coordinates>() -> String {
    D::NAMES[0].join(" ")
}

/// A running program: the sampler and the pdf over a domain. One request is in flight at a time.
pub struct Program<D: Coordinates> {
    domain: D,
    /// The connection's, for messages.
    name: String,
    connection: Mutex<Box<dyn Connection>>,
    handshake: Handshake,
    atoms: Vec<Atom<D::Point>>,
}

impl<D: Coordinates> Program<D> {
    /// Asks `verb` for `count` lines and reads the words of each by `read`.
    fn ask<T>(
        &self,
        verb: &str,
        count: usize,
        request: String,
        expected: &str,
        read: impl Fn(&[&str]) -> Option<T>,
    ) -> Result<Vec<T>> {
        // A panic elsewhere leaves nothing half done that matters here.
        let answer = self.connection.lock().unwrap_or_else(PoisonError::into_inner).ask(request.clone(), count)?;
        let wrong = |message| protocol_error(&self.name, format!("asked \"{verb} {count}\", {message}"));
        let mut values = Vec::with_capacity(count);
        for (i, line) in answer.lines().enumerate() {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            values.push(read(&words).ok_or_else(|| {
                let asked =
                    request.lines().nth(i + 1).map_or_else(String::new, |asked| format!(" (for {})", quote(asked)));
                let (number, line) = (i + 1, quote(line));
                wrong(format!("line {number} of the answer is {line}{asked}, not {expected}; NaN is no number"))
            })?);
        }
        if values.len() == count { Ok(values) } else { Err(wrong(format!("it answered only {} lines", values.len()))) }
    }

    fn ask_samples(&self, count: usize, request: String) -> Result<Vec<Option<Sample<D::Point>>>> {
        let expected = format!("\"{0}\", \"{0} PDF\", \"atom {0}\" or \"none\"", words::<D>());
        self.ask("sample", count, request, &expected, |words| match words {
            ["none"] => Some(None),
            ["atom", point @ ..] => Some(Some(Sample::atom(self.domain.read(point)?))),
            [point @ .., pdf] if point.len() == D::NAMES[0].len() => {
                Some(Some(Sample::with_pdf(self.domain.read(point)?, real(pdf)?)))
            }
            point => Some(Some(Sample::new(self.domain.read(point)?))),
        })
    }

    /// The request for something at each of `points`.
    fn at_points(&self, verb: &str, points: &[D::Point]) -> String {
        let mut request = format!("{verb} {}\n", points.len());
        for &point in points {
            D::write(point, &mut request);
            request.push('\n');
        }
        request
    }
}

impl<D: Coordinates> Sampler<D::Point> for Program<D> {
    fn dimension(&self) -> usize {
        self.handshake.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample<D::Point>>>) -> etalon_stats::Result<()> {
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

    fn sample_seeded(
        &self,
        count: usize,
        seed: u32,
        out: &mut Vec<Option<Sample<D::Point>>>,
    ) -> etalon_stats::Result<()> {
        out.extend(self.ask_samples(count, format!("sample {count} {seed}\n"))?);
        Ok(())
    }

    fn invert(&self, point: D::Point) -> etalon_stats::Result<Option<Vec<f64>>> {
        if !self.handshake.invert {
            return Ok(None);
        }
        let dimension = self.handshake.dimension;
        let read = |words: &[&str]| match words {
            ["none"] => Some(None),
            _ if words.len() != dimension => None,
            _ => words.iter().map(|word| real(word)).collect::<Option<Vec<f64>>>().map(Some),
        };
        let expected = format!("{dimension} numbers or \"none\"");
        let mut answer = self.ask("invert", 1, self.at_points("invert", &[point]), &expected, read)?;
        Ok(answer.pop().flatten())
    }
}

impl<D: Coordinates> Density<D::Point> for Program<D> {
    fn pdf(&self, points: &[D::Point], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        if points.is_empty() {
            return Ok(());
        }
        let request = self.at_points("pdf", points);
        let read_pdf = |words: &[&str]| match words {
            [pdf] => real(pdf),
            _ => None,
        };
        out.extend(self.ask("pdf", points.len(), request, "a pdf", read_pdf)?);
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.handshake.mass
    }

    fn atoms(&self) -> Vec<Atom<D::Point>> {
        self.atoms.clone()
    }
}
