//! A sampler and its pdf in another program.
//!
//! | request | response |
//! |---|---|
//! | `etalon 1` | `etalon 1 KEY=VALUE …`, then a line `coordinates probability` for each atom, `name default from to` for each parameter |
//! | `set VALUE …`, one for each parameter | nothing, or a line `KEY=VALUE …` of what these values change |
//! | `sample N`, then N lines of uniform random numbers | N lines `coordinates [pdf]`, `coordinates weight`, `atom coordinates` or `none` |
//! | `sample N SEED`, if its dimension is 0 | the same, from random numbers of its own that start from SEED < 2³² |
//! | `pdf N`, then N lines of coordinates | N lines with a pdf |
//! | `invert N`, then N lines of coordinates | N lines of random numbers, or `none` |
//! | `to_cube N`, then N lines of coordinates | N lines of coordinates of the unit cube, or `none` |
//! | `from_cube N`, then N lines of those | N lines of coordinates |
//! | `jacobian N`, then N lines of those | N lines with length or area per length or area of the cube |
//!
//! Keys: `name`; `dimension`, the random numbers of a sample (2; 0 if it has its own); `mass`, what the pdf integrates
//! to (1, `at-most-1` or `unknown`); `table=ROWSxCOLUMNS`, of a pdf that is constant in the cells of a table; `domain`; `invert=yes`;
//! `chart=DIMENSION`, of a domain of its own; `precision`, of the pdfs that samples carry (`exact`, `single` or a relative difference);
//! `weights` (`yes`: samples carry weights, and there is no pdf; `target`: `pdf` is asked for their target); `stochastic=yes`, of a pdf whose
//! values are random; `narrow`, where it is narrow in the chart (`X,Y` or `X,Y,X,Y`, separated by `;`).

use super::bsdf::{State, parameter};
use super::connection::{self, Connection, protocol_error};
use super::properties::Greeting;
use crate::protocol::sampler::{Space, write_numbers, write_point};
use etalon_core::error::{Error, Result};
use etalon_core::import::place::{number, quote, real};
use etalon_stats::bsdf::Parameter;
use etalon_stats::{
    Atom, Chart, ChartFunctions, Density, Domain, Mass, Place, Point, SINGLE_PRECISION, Sample, Sampler, place,
};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Most rows or columns of a table.
pub const LONGEST: usize = 1 << 16;
/// Most random numbers of one sample.
pub const DIMENSIONS: usize = 64;

/// A program's description of its sampler.
#[derive(Debug, Clone, PartialEq)]
struct Description {
    name: String,
    /// Random numbers that a sample takes; 0 if the program has random numbers of its own.
    dimension: usize,
    /// Integral of the pdf.
    mass: Mass,
    /// If the program names it.
    domain: Option<Space>,
    /// The dimension of its own chart, if it has one.
    chart: Option<usize>,
    /// Rows and columns of the table in whose cells the pdf is constant.
    table: Option<[usize; 2]>,
    /// Whether it has the inverse of its sampler.
    invert: bool,
    /// Precision of the pdfs that samples carry.
    precision: f64,
    weights: Weights,
    stochastic: bool,
    narrow: Vec<[[f64; 2]; 2]>,
}

/// Whether samples carry weights.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Weights {
    No,
    /// Estimates of 1/pdf.
    Yes,
    /// The program says their target.
    Target,
}

impl Default for Description {
    fn default() -> Self {
        Self {
            name: "exec".to_owned(),
            dimension: 2,
            mass: Mass::Exactly(1.0),
            domain: None,
            chart: None,
            table: None,
            invert: false,
            precision: 0.0,
            weights: Weights::No,
            stochastic: false,
            narrow: Vec::new(),
        }
    }
}

impl Description {
    /// These, with those that `greeting` has keys for in their place.
    fn declared(self, greeting: &Greeting) -> Result<Self> {
        let mut found = self;
        let is = |value: &str| match value {
            "yes" => Some(true),
            "no" => Some(false),
            _ => None,
        };
        for (key, value) in &greeting.keys {
            let refused = || greeting.meaningless(key, value);
            match key.as_str() {
                "name" => found.name.clone_from(value),
                "dimension" => {
                    let dimension = value.parse().ok().filter(|n| *n <= DIMENSIONS);
                    found.dimension =
                        dimension.ok_or_else(|| greeting.wrong(&format!("has a dimension not 0 to {DIMENSIONS}")))?;
                }
                "mass" if value == "at-most-1" => found.mass = Mass::AtMostOne,
                "mass" if value == "unknown" => found.mass = Mass::Unknown,
                "table" => found.table = Some(table(value).ok_or_else(refused)?),
                "mass" => {
                    let mass = number(value).filter(|mass| (0.0..=1.0).contains(mass));
                    let mass = mass.ok_or_else(|| greeting.wrong("has a mass that is not from 0 to 1"))?;
                    found.mass = Mass::Exactly(mass);
                }
                "precision" => found.precision = precision(value).ok_or_else(refused)?,
                "domain" => {
                    let in_greeting = |error: Error| error.in_file(Path::new(&greeting.program));
                    found.domain = Some(value.parse().map_err(in_greeting)?);
                }
                "chart" => {
                    found.chart = Some(
                        number(value).filter(|n| (1..=6).any(|d| f64::from(d) == *n)).ok_or_else(refused)? as usize,
                    );
                }
                "invert" => found.invert = is(value).ok_or_else(refused)?,
                "stochastic" => found.stochastic = is(value).ok_or_else(refused)?,
                "narrow" => found.narrow = narrow(value).ok_or_else(refused)?,
                "weights" => {
                    found.weights = match value.as_str() {
                        "no" => Weights::No,
                        "yes" => Weights::Yes,
                        "target" => Weights::Target,
                        _ => return Err(refused()),
                    }
                }
                _ => return Err(refused()),
            }
        }
        Ok(found)
    }
}

/// The precision of carried pdfs: `exact`, `single`, or a relative difference up to 1 %.
fn precision(value: &str) -> Option<f64> {
    match value {
        "exact" => Some(0.0),
        "single" => Some(SINGLE_PRECISION),
        other => number(other).filter(|precision| (0.0..=0.01).contains(precision)),
    }
}

/// Points and boxes of the chart: `X,Y;X,Y,X,Y`.
fn narrow(value: &str) -> Option<Vec<[[f64; 2]; 2]>> {
    let part = |text: &str| {
        let read = |word| real(word).filter(|x| (0.0..=1.0).contains(x));
        match text.split(',').map(read).collect::<Option<Vec<f64>>>()?[..] {
            [x] => Some([[x; 2], [0.0, 1.0]]),
            [x, y] => Some([[x; 2], [y; 2]]),
            [x0, y0, x1, y1] if x0 <= x1 && y0 <= y1 => Some([[x0, x1], [y0, y1]]),
            _ => None,
        }
    };
    value.split(';').map(part).collect()
}

/// The sides of a table, `ROWSxCOLUMNS`, each from 1 to [`LONGEST`].
fn table(value: &str) -> Option<[usize; 2]> {
    let (rows, columns) = value.split_once('x')?;
    let side = |text: &str| text.parse().ok().filter(|n| (1..=LONGEST).contains(n));
    Some([side(rows)?, side(columns)?])
}

/// The connection to a program, for all that ask it, and the values of the parameters for which they ask.
#[derive(Clone)]
struct Shared {
    state: Arc<Mutex<State>>,
    values: Vec<f64>,
}

impl Shared {
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
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.set(&self.values)?;
        connection::ask(&mut *state.connection, [verb, expected], count, request, read)
    }
}

/// The chart of a program: one request is in flight at a time.
struct OwnChart {
    connection: Shared,
    dimension: usize,
}

impl OwnChart {
    /// Asks `verb` at places of the unit cube.
    fn at_places<T>(
        &self,
        verb: &str,
        places: &[Place],
        expected: &str,
        read: impl Fn(&[&str]) -> Option<T>,
    ) -> etalon_stats::Result<Vec<T>> {
        if places.is_empty() {
            return Ok(Vec::new());
        }
        let numbers = places.iter().map(|place| &place[..self.dimension]);
        Ok(self.connection.ask(verb, places.len(), request(verb, numbers), expected, read)?)
    }
}

impl ChartFunctions for OwnChart {
    fn to_cube(&self, points: &[Point]) -> etalon_stats::Result<Vec<Place>> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let read = |words: &[&str]| {
            let numbers: Option<Vec<f64>> = words.iter().map(|word| number(word)).collect();
            match (words, numbers) {
                (["none"], _) => Some(place(&[f64::NAN])),
                (_, Some(numbers)) if numbers.len() == self.dimension => Some(place(&numbers)),
                _ => None,
            }
        };
        let expected = format!("{} coordinates of the unit cube or \"none\"", self.dimension);
        let request = request("to_cube", points.iter().map(Point::coordinates));
        Ok(self.connection.ask("to_cube", points.len(), request, &expected, read)?)
    }

    fn from_cube(&self, cube: &[Place]) -> etalon_stats::Result<Vec<Point>> {
        let read = |words: &[&str]| {
            let numbers = words.iter().map(|word| number(word)).collect::<Option<Vec<f64>>>()?;
            Point::of(&numbers)
        };
        self.at_places("from_cube", cube, "one to eight coordinates", read)
    }

    fn jacobian(&self, cube: &[Place]) -> etalon_stats::Result<Vec<f64>> {
        let read = |words: &[&str]| match words {
            [value] => number(value),
            _ => None,
        };
        self.at_places("jacobian", cube, "a number", read)
    }
}

/// A request with a line of numbers for each row.
fn request<'a>(verb: &str, rows: impl ExactSizeIterator<Item = &'a [f64]>) -> String {
    let mut request = format!("{verb} {}\n", rows.len());
    for row in rows {
        write_numbers(row, &mut request);
        request.push('\n');
    }
    request
}

/// A running program: a sampler and its pdf over a domain, for some values of its parameters. One request is in flight at a time.
#[derive(Clone)]
pub struct Client {
    connection: Shared,
    description: Description,
    parameters: Vec<Parameter>,
    atoms: Vec<Atom>,
    space: Space,
}

impl Client {
    pub(super) fn new(connection: impl Connection + 'static, greeting: Greeting, space: Option<Space>) -> Result<Self> {
        let description = Description::default().declared(&greeting)?;
        let name = connection.name().to_owned();
        // Numbers are atoms, and names parameters.
        let is_atom = |line: &&String| line.split_ascii_whitespace().next().is_none_or(|word| real(word).is_some());
        let (of_atoms, others): (Vec<&String>, Vec<&String>) = greeting.lines.iter().partition(is_atom);
        let parameters: Vec<Parameter> =
            others.into_iter().map(|line| parameter(&name, line)).collect::<Result<_>>()?;
        let values = parameters.iter().map(|parameter| parameter.value).collect();
        let connection = Shared { state: Arc::new(Mutex::new(State::new(connection))), values };
        let own = match description.chart {
            None => description.domain.clone(),
            Some(dimension) => {
                let chart = Chart::new(OwnChart { connection: connection.clone(), dimension }, dimension);
                // From here on it is known how many coordinates points have.
                chart.points_at(&[[0.5; 2]])?;
                let space = Space::new("its own chart", chart);
                if space.width() == 0 {
                    return Err(protocol_error(&name, "from_cube gives no point"));
                }
                Some(space)
            }
        };
        let space = match (space, own) {
            (Some(asked), Some(own)) if asked != own => {
                return Err(
                    protocol_error(&name, format!("its domain is {own}")).with_hint(format!("use the domain {own}"))
                );
            }
            (Some(space), _) | (None, Some(space)) => space,
            (None, None) => {
                return Err(Error::parameter("domain", "the program does not say what its domain is")
                    .with_hint(format!("domains: {}", Space::known())));
            }
        };
        // Read the atoms
        let words = space.names()[0].join(" ");
        let read = |line: &str| {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let (probability, point) = words.split_last()?;
            let probability = real(probability).filter(|p| (0.0..=1.0).contains(p))?;
            let point = space.read(point).filter(|point| space.domain().to_chart(*point).is_some())?;
            Some(Atom { point, probability })
        };
        let of_line = |line: &String| {
            let wrong = || format!("its atom {} is not \"{words} PROBABILITY\"", quote(line));
            read(line).ok_or_else(|| protocol_error(&name, wrong()))
        };
        let atoms = of_atoms.into_iter().map(of_line).collect::<Result<_>>()?;
        if let Some(sides) = description.table {
            space.steps(sides)?;
        }
        Ok(Self { connection, description, parameters, atoms, space })
    }

    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The same program for other values of its parameters.
    ///
    /// # Errors
    /// Those of the program.
    pub fn with(&self, values: &[f64]) -> Result<Self> {
        let mut state = self.connection.state.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = state.set(values)?.to_owned();
        let greeting = Greeting::of_line(state.connection.name(), &answer)?;
        drop(state);
        let description = self.description.clone().declared(&greeting)?;
        let connection = Shared { values: values.to_vec(), ..self.connection.clone() };
        Ok(Self { connection, description, ..self.clone() })
    }

    /// The name that the program gives its sampler.
    pub fn name(&self) -> &str {
        &self.description.name
    }

    pub fn space(&self) -> Space {
        self.space.clone()
    }

    fn ask_samples(&self, count: usize, request: String) -> Result<Vec<Option<Sample>>> {
        let point = self.space.names()[0].join(" ");
        let expected = match self.description.weights {
            Weights::No => format!("\"{point}\", \"{point} PDF\", \"atom {point}\" or \"none\""),
            Weights::Yes | Weights::Target => format!("\"{point} WEIGHT\" or \"none\""),
        };
        self.connection.ask("sample", count, request, &expected, |words| match words {
            ["none"] => Some(None),
            ["atom", point @ ..] => Some(Some(Sample::atom(self.space.read(point)?))),
            [point @ .., last] if point.len() == self.space.width() => {
                let (point, last) = (self.space.read(point)?, number(last)?);
                let is_weight = self.description.weights != Weights::No;
                Some(Some(if is_weight { Sample::with_weight(point, last) } else { Sample::with_pdf(point, last) }))
            }
            _ if self.description.weights != Weights::No => None,
            point => Some(Some(Sample::new(self.space.read(point)?))),
        })
    }

    /// The request for something at each of `points`.
    fn at_points(&self, verb: &str, points: &[Point]) -> String {
        let mut request = format!("{verb} {}\n", points.len());
        for point in points {
            write_point(point, &mut request);
            request.push('\n');
        }
        request
    }
}

impl Sampler for Client {
    fn dimension(&self) -> usize {
        self.description.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let samples = u.chunks_exact(self.description.dimension.max(1));
        let count = samples.len();
        out.extend(self.ask_samples(count, request("sample", samples))?);
        Ok(())
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        out.extend(self.ask_samples(count, format!("sample {count} {seed}\n"))?);
        Ok(())
    }

    fn invert(&self, point: Point) -> etalon_stats::Result<Option<Vec<f64>>> {
        if !self.description.invert {
            return Ok(None);
        }
        let dimension = self.description.dimension;
        let read = |words: &[&str]| match words {
            ["none"] => Some(None),
            _ if words.len() != dimension => None,
            _ => words.iter().map(|word| number(word)).collect::<Option<Vec<f64>>>().map(Some),
        };
        let expected = format!("{dimension} numbers or \"none\"");
        let mut answer = self.connection.ask("invert", 1, self.at_points("invert", &[point]), &expected, read)?;
        Ok(answer.pop().flatten())
    }
}

impl Density for Client {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        if points.is_empty() {
            return Ok(());
        }
        if self.description.weights == Weights::Yes {
            out.resize(out.len() + points.len(), 1.0);
            return Ok(());
        }
        let request = self.at_points("pdf", points);
        let read_pdf = |words: &[&str]| match words {
            [pdf] => number(pdf),
            _ => None,
        };
        out.extend(self.connection.ask("pdf", points.len(), request, "a pdf", read_pdf)?);
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.description.mass
    }

    fn precision(&self) -> f64 {
        self.description.precision
    }

    fn is_target(&self) -> bool {
        self.description.weights != Weights::No
    }

    fn is_stochastic(&self) -> bool {
        self.description.stochastic
    }

    fn narrow(&self) -> Vec<[[f64; 2]; 2]> {
        self.description.narrow.clone()
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        self.space.steps(self.description.table?).ok()
    }

    fn atoms(&self) -> Vec<Atom> {
        self.atoms.clone()
    }
}
