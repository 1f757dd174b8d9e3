//! Domains that an external sampler can have: their points as words and as rows of a table, their cells in tables of pdfs.

use etalon_core::import::number::number;
use etalon_stats::{Directions, Discrete, Domain, Line, Pole, Square};
use std::f64::consts::PI;
use std::fmt::Write;

/// A domain whose points have coordinates.
pub trait Coordinates: Domain + Copy + Send + 'static {
    /// Names of the coordinates of a point; those of the first list are used between programs.
    const NAMES: &'static [&'static [&'static str]];
    /// In a table of pdfs, whether a row is a step along the chart's second axis.
    const TRANSPOSED: bool = false;

    /// The point with coordinates of the list `names` of [`NAMES`](Self::NAMES); `None` if no point can have them.
    fn point(&self, names: usize, coordinates: &[f64]) -> Option<Self::Point>;

    /// Appends the coordinates of the first list of [`NAMES`](Self::NAMES).
    fn coordinates(point: Self::Point, out: &mut Vec<f64>);

    /// Appends the coordinates, with spaces between them, to be read back to the last bit.
    fn write(point: Self::Point, out: &mut String);

    /// The chart's first coordinate at the fraction `t` of the rows of a table of pdfs.
    fn first(&self, t: f64) -> f64 {
        t
    }

    /// The lines of the chart between the cells of a table with so many rows and columns.
    fn steps(&self, [rows, columns]: [usize; 2]) -> [Vec<f64>; 2] {
        let divide = |n: usize| (1..n).map(move |i| i as f64 / n as f64);
        let (first, second) = if Self::TRANSPOSED { (columns, rows) } else { (rows, columns) };
        [divide(first).map(|t| self.first(t)).collect(), divide(second).collect()]
    }

    /// The point that is written in words; a coordinate may be NaN, which no point of the domain has.
    fn read(&self, words: &[&str]) -> Option<Self::Point> {
        let numbers: Vec<f64> = words.iter().map(|word| number(word)).collect::<Option<_>>()?;
        if numbers.len() == Self::NAMES[0].len() { self.point(0, &numbers) } else { None }
    }
}

/// Appends numbers, with spaces between them, that read back to the last bit.
pub fn write_numbers(numbers: &[f64], out: &mut String) {
    for (i, x) in numbers.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(out, "{}{x:e}", if i == 0 { "" } else { " " });
    }
}

/// Unit vectors, or angles in radians: θ from the pole, and φ. Tables of pdfs: equal steps of θ from the pole in rows, of φ
/// from +x towards +y in columns.
impl Coordinates for Directions {
    const NAMES: &'static [&'static [&'static str]] = &[&["x", "y", "z"], &["theta", "phi"]];

    fn point(&self, _: usize, coordinates: &[f64]) -> Option<[f64; 3]> {
        let &[theta, phi] = coordinates else { return coordinates.try_into().ok() };
        let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
        // φ of a lat-long image goes from +x towards +z.
        Some(match self.pole {
            Pole::Z => [sin * cos_phi, sin * sin_phi, cos],
            Pole::Y => [sin * cos_phi, cos, sin * sin_phi],
        })
    }

    fn coordinates(point: [f64; 3], out: &mut Vec<f64>) {
        out.extend(point);
    }

    fn write(point: [f64; 3], out: &mut String) {
        write_numbers(&point, out);
    }

    fn first(&self, t: f64) -> f64 {
        // 1 − cos θ without the subtraction.
        if self.half { 2.0 * (0.25 * PI * t).sin().powi(2) } else { (0.5 * PI * t).sin().powi(2) }
    }
}

/// Tables of pdfs: equal steps of y in rows, of x in columns.
impl Coordinates for Square {
    const NAMES: &'static [&'static [&'static str]] = &[&["x", "y"]];
    const TRANSPOSED: bool = true;

    fn point(&self, _: usize, coordinates: &[f64]) -> Option<[f64; 2]> {
        coordinates.try_into().ok()
    }

    fn coordinates(point: [f64; 2], out: &mut Vec<f64>) {
        out.extend(point);
    }

    fn write(point: [f64; 2], out: &mut String) {
        write_numbers(&point, out);
    }
}

/// Tables of pdfs: a row or a column of equal steps.
impl Coordinates for Line {
    const NAMES: &'static [&'static [&'static str]] = &[&["x"]];

    fn point(&self, _: usize, coordinates: &[f64]) -> Option<f64> {
        coordinates.first().copied()
    }

    fn coordinates(point: f64, out: &mut Vec<f64>) {
        out.push(point);
    }

    fn write(point: f64, out: &mut String) {
        write_numbers(&[point], out);
    }
}

/// Tables of pdfs: a row or a column of the probabilities.
impl Coordinates for Discrete {
    const NAMES: &'static [&'static [&'static str]] = &[&["i"]];

    fn point(&self, _: usize, coordinates: &[f64]) -> Option<usize> {
        let i = coordinates.first().copied()?;
        (i >= 0.0 && i.fract() == 0.0 && i < 2f64.powi(53)).then_some(i as usize)
    }

    fn coordinates(point: usize, out: &mut Vec<f64>) {
        out.push(point as f64);
    }

    fn write(point: usize, out: &mut String) {
        let _ = write!(out, "{point}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_round_trip_to_the_last_bit() {
        fn returns<D: Coordinates>(domain: D, point: D::Point) {
            let mut line = String::new();
            D::write(point, &mut line);
            let words: Vec<&str> = line.split(' ').collect();
            // As text, since −0 equals 0.
            assert_eq!(format!("{:?}", domain.read(&words)), format!("{:?}", Some(point)), "{line}");
            assert!(domain.read(&words[1..]).is_none(), "{line}");
        }
        returns(Directions::sphere(Pole::Z), [0.1, -1e-300, 1.0 / 3.0]);
        returns(Square, [0.1, f64::MIN_POSITIVE]);
        [0.1, -1e300, -0.0, f64::INFINITY].into_iter().for_each(|x| returns(Line::UNIT, x));
        returns(Discrete { outcomes: 7 }, 1_000_000);
        assert!(Line::UNIT.read(&["nan"]).is_some_and(|x| Line::UNIT.to_chart(x).is_none()));
        assert_eq!((Square.read(&["1", "x"]), Line::UNIT.read(&["1", "2"])), (None, None));
    }
}
