//! Points of domains.

use std::fmt;

/// A point of a domain: an integer, or one to three coordinates.
///
/// `usize` (to 2⁵³), `f64`, `[f64; 2]` and `[f64; 3]` convert to points and back. Converted to another kind than its own, a point
/// becomes NaN or `usize::MAX`, which lie in no domain.
#[derive(Clone, Copy, PartialEq)]
pub struct Point {
    coordinates: [f64; 3],
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Integer,
    Real,
    Pair,
    Triple,
}

impl Point {
    /// The coordinates; an integer counts as one.
    #[inline]
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        match self.kind {
            Kind::Integer | Kind::Real => &self.coordinates[..1],
            Kind::Pair => &self.coordinates[..2],
            Kind::Triple => &self.coordinates,
        }
    }

    /// Its value, if it is an integer.
    #[inline]
    #[must_use]
    pub fn integer(&self) -> Option<usize> {
        (self.kind == Kind::Integer).then_some(self.coordinates[0] as usize)
    }
}

impl From<usize> for Point {
    #[inline]
    fn from(i: usize) -> Self {
        Self { coordinates: [i as f64, 0.0, 0.0], kind: Kind::Integer }
    }
}

impl From<f64> for Point {
    #[inline]
    fn from(x: f64) -> Self {
        Self { coordinates: [x, 0.0, 0.0], kind: Kind::Real }
    }
}

impl From<[f64; 2]> for Point {
    #[inline]
    fn from([x, y]: [f64; 2]) -> Self {
        Self { coordinates: [x, y, 0.0], kind: Kind::Pair }
    }
}

impl From<[f64; 3]> for Point {
    #[inline]
    fn from(coordinates: [f64; 3]) -> Self {
        Self { coordinates, kind: Kind::Triple }
    }
}

impl From<Point> for usize {
    #[inline]
    fn from(point: Point) -> Self {
        point.integer().unwrap_or(usize::MAX)
    }
}

impl From<Point> for f64 {
    #[inline]
    fn from(point: Point) -> Self {
        if point.kind == Kind::Real { point.coordinates[0] } else { f64::NAN }
    }
}

impl From<Point> for [f64; 2] {
    #[inline]
    fn from(point: Point) -> Self {
        let [x, y, _] = point.coordinates;
        if point.kind == Kind::Pair { [x, y] } else { [f64::NAN; 2] }
    }
}

impl From<Point> for [f64; 3] {
    #[inline]
    fn from(point: Point) -> Self {
        if point.kind == Kind::Triple { point.coordinates } else { [f64::NAN; 3] }
    }
}

impl fmt::Debug for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            Kind::Integer => usize::from(*self).fmt(f),
            Kind::Real => self.coordinates[0].fmt(f),
            Kind::Pair | Kind::Triple => self.coordinates().fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Discrete, Domain, Line, Square};
    use crate::text::tuple;

    #[test]
    fn points_convert_back_and_those_of_another_kind_lie_in_no_domain() {
        let number = Point::from(0.5);
        assert_eq!((f64::from(number), usize::from(Point::from(3_usize))), (0.5, 3));
        assert!(<[f64; 3]>::from(number).iter().all(|x| x.is_nan()));
        assert!(Line::UNIT.to_chart(number).is_some() && Square.to_chart(number).is_none());
        assert!(Discrete { outcomes: 6 }.to_chart(Point::from(3.0)).is_none());
        let texts = [Point::from(3_usize), number, [0.5, 1e-30].into(), [1.0, 0.0, 0.25].into()].map(|p| tuple(&p));
        assert_eq!(texts, ["3", "0.5", "(0.5, 1e-30)", "(1.0, 0.0, 0.25)"]);
    }
}
