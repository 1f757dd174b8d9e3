//! Points of any domain.

use std::fmt;

/// A point of a domain: an integer, or one to four coordinates.
///
/// `usize` (to 2⁵³), `f64`, `[f64; 2]`, `[f64; 3]` and `[f64; 4]` convert to points and back. Converted to another kind than its own, a point
/// becomes NaN or `usize::MAX`, which lie in no domain.
#[derive(Clone, Copy)]
pub struct Point {
    /// [`NONE`] where there is none; after that of an integer, [`INTEGER`].
    coordinates: [f64; 4],
}

/// Numbers that are no coordinates. (A field for the kind would make samples larger, and tests of fast samplers slower.)
const NONE: f64 = f64::from_bits(0x7ff8_0000_6e6f_6e65);
const INTEGER: f64 = f64::from_bits(0x7ff8_0000_696e_7465);

#[inline]
fn is(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

impl Point {
    #[inline]
    fn is_integer(&self) -> bool {
        is(self.coordinates[1], INTEGER)
    }

    /// How many coordinates there are.
    #[inline]
    fn len(&self) -> usize {
        let [_, y, z, w] = self.coordinates;
        if is(y, NONE) || is(y, INTEGER) { 1 } else { 4 - usize::from(is(z, NONE)) - usize::from(is(w, NONE)) }
    }

    /// The coordinates; an integer counts as one.
    #[inline]
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        &self.coordinates[..self.len()]
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
        self.is_integer().then_some(self.coordinates[0] as usize)
    }
}

impl From<usize> for Point {
    #[inline]
    fn from(i: usize) -> Self {
        Self { coordinates: [i as f64, INTEGER, NONE, NONE] }
    }
}

impl From<f64> for Point {
    #[inline]
    fn from(x: f64) -> Self {
        Self { coordinates: [x, NONE, NONE, NONE] }
    }
}

impl From<[f64; 2]> for Point {
    #[inline]
    fn from([x, y]: [f64; 2]) -> Self {
        Self { coordinates: [x, y, NONE, NONE] }
    }
}

impl From<[f64; 3]> for Point {
    #[inline]
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { coordinates: [x, y, z, NONE] }
    }
}

impl From<[f64; 4]> for Point {
    #[inline]
    fn from(coordinates: [f64; 4]) -> Self {
        Self { coordinates }
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
        if is(point.coordinates[1], NONE) { point.coordinates[0] } else { f64::NAN }
    }
}

impl From<Point> for [f64; 2] {
    #[inline]
    fn from(point: Point) -> Self {
        let [x, y, z, _] = point.coordinates;
        if is(z, NONE) && point.len() == 2 { [x, y] } else { [f64::NAN; 2] }
    }
}

impl From<Point> for [f64; 3] {
    #[inline]
    fn from(point: Point) -> Self {
        let [x, y, z, w] = point.coordinates;
        if is(w, NONE) && !is(z, NONE) { [x, y, z] } else { [f64::NAN; 3] }
    }
}

impl From<Point> for [f64; 4] {
    #[inline]
    fn from(point: Point) -> Self {
        if is(point.coordinates[3], NONE) { [f64::NAN; 4] } else { point.coordinates }
    }
}

impl PartialEq for Point {
    fn eq(&self, other: &Self) -> bool {
        self.is_integer() == other.is_integer() && self.coordinates() == other.coordinates()
    }
}

impl fmt::Debug for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.integer(), self.coordinates()) {
            (Some(i), _) => i.fmt(f),
            (None, [x]) => x.fmt(f),
            (None, several) => several.fmt(f),
        }
    }
}
