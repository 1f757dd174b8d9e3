//! External samplers: their domains, and [`files`] with their samples and their pdf. A sampler that can be called is one of
//! [`program`](super::program).

pub mod files;

use etalon_core::error::{Error, Result};
use etalon_core::import::place::number;
use etalon_stats::{Domain, Named, Point, known, named};
use std::fmt::{self, Write};
use std::str::FromStr;
use std::sync::Arc;

/// The domain of an external sampler: one of [`DOMAINS`](etalon_stats::DOMAINS), by its name, or the program's own.
#[derive(Clone)]
pub struct Space {
    name: String,
    domain: Named,
}

impl Space {
    /// A domain that has no name to choose it by.
    pub fn new(name: &str, domain: impl Domain + Send + 'static) -> Self {
        Self { name: name.to_owned(), domain: Arc::new(domain) }
    }

    /// The names of all domains, in a sentence.
    pub fn known() -> String {
        known()
    }

    pub fn domain(&self) -> &dyn Domain {
        &*self.domain
    }

    /// Names of the coordinates of a point: those that are used between programs, and for directions their angles.
    pub fn names(&self) -> Vec<Vec<&'static str>> {
        let angles = self.domain.at_angles([0.0; 2]).map(|_| vec!["theta", "phi"]);
        [self.domain.names()].into_iter().chain(angles).collect()
    }

    /// The number of coordinates of a point between programs.
    pub fn width(&self) -> usize {
        self.domain.names().len()
    }

    /// The point with coordinates of one of the lists of [`names`](Self::names); `None` if their number is
    /// another, or an index is not an integer. The point need not lie in the domain.
    pub fn point(&self, coordinates: &[f64]) -> Option<Point> {
        let at_angles = || self.domain.at_angles(coordinates.try_into().ok()?);
        self.domain.point(coordinates).or_else(at_angles)
    }

    /// [`point`](Self::point) from the fields of a line, of the first list of [`names`](Self::names).
    pub fn read(&self, words: &[&str]) -> Option<Point> {
        let numbers: Vec<f64> = words.iter().map(|word| number(word)).collect::<Option<_>>()?;
        self.domain.point(&numbers)
    }

    /// The lines of the chart between the cells of a table of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a domain that has no tables.
    pub fn steps(&self, sides: [usize; 2]) -> Result<[Vec<f64>; 2]> {
        let wrong = || Error::parameter("table", format!("the domain {self} has no tables"));
        self.domain.table(sides).ok_or_else(wrong)
    }
}

impl PartialEq for Space {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Space").field(&self.name).finish()
    }
}

/// Appends the coordinates of a point, with spaces between them, to be read back to the last bit.
pub fn write_point(point: &Point, out: &mut String) {
    match point.integer() {
        // Writing to a string cannot fail.
        Some(i) => _ = write!(out, "{i}"),
        None => write_numbers(point.coordinates(), out),
    }
}

/// Appends numbers, with spaces between them, that read back to the last bit.
pub fn write_numbers(numbers: &[f64], out: &mut String) {
    for (i, x) in numbers.iter().enumerate() {
        let _ = write!(out, "{}{x:e}", if i == 0 { "" } else { " " });
    }
}

impl FromStr for Space {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let hint = |error: etalon_stats::Error| Error::from(error).with_hint(format!("domains: {}", known()));
        Ok(Self { name: text.to_owned(), domain: named(text).map_err(hint)? })
    }
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(name: &str) -> Space {
        name.parse().unwrap()
    }

    #[test]
    fn points_round_trip_to_the_last_bit() {
        let returns = |name: &str, point: Point| {
            let mut line = String::new();
            write_point(&point, &mut line);
            let words: Vec<&str> = line.split(' ').collect();
            // As text, since −0 equals 0.
            assert_eq!(format!("{:?}", space(name).read(&words)), format!("{:?}", Some(point)), "{line}");
            assert!(space(name).read(&words[1..]).is_none(), "{line}");
        };
        returns("sphere", [0.1, -1e-300, 1.0 / 3.0].into());
        returns("square", [0.1, f64::MIN_POSITIVE].into());
        [0.1, -1e300, -0.0, f64::INFINITY].into_iter().for_each(|x| returns("line", x.into()));
        returns("discrete:7", 1_000_000_usize.into());
        let line = space("line");
        assert!(line.read(&["nan"]).is_some_and(|x| line.domain().to_chart(x).is_none()));
        assert_eq!((space("square").read(&["1", "x"]), line.read(&["1", "2"])), (None, None));
    }

    #[test]
    fn names_are_read_and_written() {
        let pi = std::f64::consts::PI;
        for (name, measure) in
            [("sphere", 4.0 * pi), ("hemisphere", 2.0 * pi), ("square", 1.0), ("line", 1.0), ("discrete:6", 6.0)]
        {
            assert_eq!((space(name).to_string(), space(name).domain().measure()), (name.to_owned(), measure));
        }
        for bad in ["", "disc", "discrete", "discrete:", "discrete:0", "discrete:-1", "discrete:99999999999999999999"] {
            assert!(bad.parse::<Space>().is_err(), "{bad}");
        }
    }
}
