//! External samplers: their domains, and [`files`] with their samples and their pdf. A sampler that can be called is one of
//! [`program`](super::program).

pub mod files;

use etalon_core::error::{Error, Result};
use etalon_core::import::place::number;
use etalon_stats::{Directions, Discrete, Domain, Line, Point, Pole, Square};
use std::f64::consts::PI;
use std::fmt::{self, Write};
use std::str::FromStr;

/// A domain that an external sampler can have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Space {
    /// Unit vectors, or angles in radians: θ from the pole, and φ. Tables of pdfs: equal steps of θ from the pole in rows, of φ
    /// from +x towards +y (for the pole +y: towards +z) in columns.
    Directions(Directions),
    /// Tables of pdfs: equal steps of y in rows, of x in columns.
    Square(Square),
    /// Tables of pdfs: a row or a column of equal steps.
    Line(Line),
    /// Tables of pdfs: a row or a column of the probabilities.
    Discrete(Discrete),
}

/// The domains of a fixed size, by name; `discrete:N` has a size. The pole of directions is +z.
pub const NAMED: [(&str, Space); 4] = [
    ("sphere", Space::Directions(Directions { pole: Pole::Z, half: false })),
    ("hemisphere", Space::Directions(Directions { pole: Pole::Z, half: true })),
    ("square", Space::Square(Square)),
    ("line", Space::Line(Line::UNIT)),
];
/// Most points of a finite set.
const MOST_OUTCOMES: usize = 1 << 20;

impl Space {
    /// The names of all domains, in a sentence.
    #[must_use]
    pub fn known() -> String {
        let names: Vec<&str> = NAMED.iter().map(|(name, _)| *name).collect();
        format!("{} or discrete:N", names.join(", "))
    }

    /// The domain itself.
    #[must_use]
    pub fn domain(&self) -> &dyn Domain {
        match self {
            Self::Directions(domain) => domain,
            Self::Square(domain) => domain,
            Self::Line(domain) => domain,
            Self::Discrete(domain) => domain,
        }
    }

    /// Names of the coordinates of a point; those of the first list are used between programs.
    #[must_use]
    pub fn names(&self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Directions(_) => &[&["x", "y", "z"], &["theta", "phi"]],
            Self::Square(_) => &[&["x", "y"]],
            Self::Line(_) => &[&["x"]],
            Self::Discrete(_) => &[&["i"]],
        }
    }

    /// The number of coordinates of a point between programs.
    #[must_use]
    pub fn width(&self) -> usize {
        self.names()[0].len()
    }

    /// The point with coordinates of one of the lists of [`names`](Self::names); `None` if their number is
    /// another, or an outcome is not an integer. The point need not lie in the domain.
    #[must_use]
    pub fn point(&self, coordinates: &[f64]) -> Option<Point> {
        Some(match (self, coordinates) {
            (Self::Directions(_), &[x, y, z]) => [x, y, z].into(),
            (Self::Directions(domain), &[theta, phi]) => {
                let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
                // φ of a lat-long image goes from +x towards +z.
                match domain.pole {
                    Pole::Z => [sin * cos_phi, sin * sin_phi, cos].into(),
                    Pole::Y => [sin * cos_phi, cos, sin * sin_phi].into(),
                }
            }
            (Self::Square(_), &[x, y]) => [x, y].into(),
            (Self::Line(_), &[x]) => x.into(),
            (Self::Discrete(_), &[i]) if i >= 0.0 && i.fract() == 0.0 && i < 2f64.powi(53) => (i as usize).into(),
            _ => return None,
        })
    }

    /// [`point`](Self::point) from the fields of a line, of the first list of [`names`](Self::names).
    #[must_use]
    pub fn read(&self, words: &[&str]) -> Option<Point> {
        let numbers: Vec<f64> = words.iter().map(|word| number(word)).collect::<Option<_>>()?;
        if numbers.len() == self.width() { self.point(&numbers) } else { None }
    }

    /// In a table of pdfs, whether a row is a step along the chart's second axis.
    pub(super) fn is_transposed(&self) -> bool {
        matches!(self, Self::Square(_))
    }

    /// The lines of the chart between the cells of a table of this size.
    #[must_use]
    pub fn steps(&self, [rows, columns]: [usize; 2]) -> [Vec<f64>; 2] {
        let (first, second) = if self.is_transposed() { (columns, rows) } else { (rows, columns) };
        let divide = |n: usize| (1..n).map(move |i| i as f64 / n as f64);
        // Equal steps of θ: the chart's coordinate is sin² (θ/2), twice that for a hemisphere.
        let along_first = |t: f64| match self {
            Self::Directions(Directions { half: true, .. }) => 2.0 * (0.25 * PI * t).sin().powi(2),
            Self::Directions(_) => (0.5 * PI * t).sin().powi(2),
            _ => t,
        };
        [divide(first).map(along_first).collect(), divide(second).collect()]
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
        if let Some((_, space)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(*space);
        }
        let error =
            |message: String| Error::parameter("domain", message).with_hint(format!("domains: {}", Self::known()));
        let count = text.strip_prefix("discrete:").ok_or_else(|| error(format!("unknown domain {text:?}")))?;
        let outcomes = count.parse().ok().filter(|n| (1..=MOST_OUTCOMES).contains(n));
        let outcomes = outcomes.ok_or_else(|| error(format!("{text:?} needs a number from 1 to {MOST_OUTCOMES}")))?;
        Ok(Self::Discrete(Discrete { outcomes }))
    }
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, NAMED.iter().find(|(_, space)| space == self)) {
            (_, Some((name, _))) => f.write_str(name),
            (Self::Discrete(Discrete { outcomes }), _) => write!(f, "discrete:{outcomes}"),
            // Directions of a lat-long image, and lines of another length
            (other, _) => write!(f, "{other:?}"),
        }
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
        let pi = PI;
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
