//! Points of any domain.

use std::fmt;

/// A point of a domain: an integer, or one to four coordinates.
///
/// `usize` (to 2⁵³), `f64`, `[f64; 2]`, `[f64; 3]` and `[f64; 4]` convert to points and back. Converted to another kind than its own, a point
/// becomes NaN or `usize::MAX`, which lie in no domain.
#[derive(Clone, Copy, PartialEq)]
pub struct Point {
    coordinates: [f64; 4],
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Integer,
    Real,
    Pair,
    Triple,
    Quadruple,
}

impl Point {
    /// The coordinates; an integer counts as one.
    #[inline]
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        match self.kind {
            Kind::Integer | Kind::Real => &self.coordinates[..1],
            Kind::Pair => &self.coordinates[..2],
            Kind::Triple => &self.coordinates[..3],
            Kind::Quadruple => &self.coordinates,
        }
    }

    /// The point with one to four coordinates; `None` for more or fewer.
    #[must_use]
    pub fn of(coordinates: &[f64]) -> Option<Self> {
        Some(match *coordinates {
            [x] => x.into(),
            [x, y] => [x, y].into(),
            [x, y, z] => [x, y, z].into(),
            [x, y, z, w] => [x, y, z, w].into(),
            _ => return None,
        })
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
        Self { coordinates: [i as f64, 0.0, 0.0, 0.0], kind: Kind::Integer }
    }
}

impl From<f64> for Point {
    #[inline]
    fn from(x: f64) -> Self {
        Self { coordinates: [x, 0.0, 0.0, 0.0], kind: Kind::Real }
    }
}

impl From<[f64; 2]> for Point {
    #[inline]
    fn from([x, y]: [f64; 2]) -> Self {
        Self { coordinates: [x, y, 0.0, 0.0], kind: Kind::Pair }
    }
}

impl From<[f64; 3]> for Point {
    #[inline]
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { coordinates: [x, y, z, 0.0], kind: Kind::Triple }
    }
}

impl From<[f64; 4]> for Point {
    #[inline]
    fn from(coordinates: [f64; 4]) -> Self {
        Self { coordinates, kind: Kind::Quadruple }
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
        let [x, y, ..] = point.coordinates;
        if point.kind == Kind::Pair { [x, y] } else { [f64::NAN; 2] }
    }
}

impl From<Point> for [f64; 3] {
    #[inline]
    fn from(point: Point) -> Self {
        let [x, y, z, _] = point.coordinates;
        if point.kind == Kind::Triple { [x, y, z] } else { [f64::NAN; 3] }
    }
}

impl From<Point> for [f64; 4] {
    #[inline]
    fn from(point: Point) -> Self {
        if point.kind == Kind::Quadruple { point.coordinates } else { [f64::NAN; 4] }
    }
}

impl fmt::Debug for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            Kind::Integer => usize::from(*self).fmt(f),
            Kind::Real => self.coordinates[0].fmt(f),
            _ => self.coordinates().fmt(f),
        }
    }
}
