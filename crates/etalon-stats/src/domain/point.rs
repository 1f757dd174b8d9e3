//! Points of any domain.

use std::fmt;

/// Most coordinates of a point.
const MOST: usize = 8;

/// A point of a domain: an integer, or one to eight coordinates.
///
/// `usize` (to 2⁵³), `f64`, and `[f64; 2]` to `[f64; 8]` convert to points and back. Converted to another kind than its own, a point
/// becomes NaN or `usize::MAX`, which lie in no domain.
#[derive(Clone, Copy)]
pub struct Point {
    /// [`NONE`] where there is none; after that of an integer, [`INTEGER`].
    coordinates: [f64; MOST],
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
        let is_end = |x: &f64| is(*x, NONE) || is(*x, INTEGER);
        1 + self.coordinates[1..].iter().position(is_end).unwrap_or(MOST - 1)
    }

    /// The coordinates; an integer counts as one.
    #[inline]
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        &self.coordinates[..self.len()]
    }

    /// The point with one to eight coordinates; `None` for more or fewer.
    #[must_use]
    pub fn of(coordinates: &[f64]) -> Option<Self> {
        let mut all = [NONE; MOST];
        all.get_mut(..coordinates.len()).filter(|all| !all.is_empty())?.copy_from_slice(coordinates);
        Some(Self { coordinates: all })
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
        let mut coordinates = [NONE; MOST];
        (coordinates[0], coordinates[1]) = (i as f64, INTEGER);
        Self { coordinates }
    }
}

impl From<f64> for Point {
    #[inline]
    fn from(x: f64) -> Self {
        [x].into()
    }
}

impl<const N: usize> From<[f64; N]> for Point {
    #[inline]
    fn from(from: [f64; N]) -> Self {
        const { assert!(N >= 1 && N <= MOST, "points have one to eight coordinates") };
        let mut coordinates = [NONE; MOST];
        coordinates[..N].copy_from_slice(&from);
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
        let [x] = point.into();
        x
    }
}

impl<const N: usize> From<Point> for [f64; N] {
    #[inline]
    fn from(point: Point) -> Self {
        const { assert!(N >= 1 && N <= MOST, "points have one to eight coordinates") };
        let of = &point.coordinates;
        let ends = N == MOST || is(of[N.min(MOST - 1)], NONE);
        if ends && !is(of[N - 1], NONE) && !point.is_integer() { std::array::from_fn(|i| of[i]) } else { [f64::NAN; N] }
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
