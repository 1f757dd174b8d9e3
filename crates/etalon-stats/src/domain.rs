//! Where samples lie: points, and sets with a measure, each with an area-preserving chart to the unit square.

use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::{Mistake, Variable};
use etalon_random::turns;
use std::f64::consts::{PI, TAU};
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

/// A set of points with a measure μ, to which pdfs refer, and its chart.
///
/// The chart maps the set one to one to \[0, 1)² such that equal areas of the square are equal measures of the set. Cells
/// are rectangles of the chart, so that the expected share of a cell is μ(whole set) times the integral of the pdf over the
/// cell in chart coordinates.
pub trait Domain: Sync {
    /// μ of the whole set: 4π for the sphere.
    fn measure(&self) -> f64;

    /// The chart coordinates of a point; `None` if it is not in the set or not a number.
    fn to_chart(&self, point: Point) -> Option<[f64; 2]>;

    /// The point at chart coordinates in \[0, 1\]²: the inverse of [`to_chart`](Self::to_chart).
    fn point_at(&self, chart: [f64; 2]) -> Point;

    /// Whether two points are equal up to rounding: how a sample is matched with an atom.
    fn same(&self, a: Point, b: Point) -> bool;

    /// Whether the chart's second axis is in use.
    fn is_plane(&self) -> bool {
        true
    }

    /// The number of points of a finite set.
    fn outcomes(&self) -> Option<usize> {
        None
    }

    /// The quantities along the chart's axes, for figures.
    fn axes(&self) -> [&'static str; 2];

    /// The quantities along the chart's axes, as mistakes name them.
    fn coordinates(&self) -> [&'static str; 2] {
        self.axes()
    }

    /// Quantities of points by whose powers pdfs differ.
    fn variables(&self) -> Vec<Variable<'_>> {
        Vec::new()
    }

    /// Usual mistakes of samplers of this domain.
    fn mistakes(&self) -> Vec<Mistake<'_>> {
        Vec::new()
    }

    /// A cell of the chart in the domain's own coordinates, for messages: `theta 10.0°..20.0°, phi 0.0°..36.0°`.
    fn region(&self, cell: &Cell) -> String {
        let [x, y] = self.axes();
        let along = |name: &str, [from, to]: [f64; 2]| format!("{name} {from:.4}..{to:.4}");
        if self.is_plane() { format!("{}, {}", along(x, cell.x), along(y, cell.y)) } else { along(x, cell.x) }
    }

    /// Where a cell is, as the end of a sentence: `within 2.0° of the horizon`.
    fn in_words(&self, cell: &Cell) -> String {
        format!("for {}", self.region(cell))
    }
}

/// A place where a mistake asks for the pdf, and its name.
type Place<const N: usize> = (&'static str, fn([f64; N]) -> [f64; N]);

/// The points 0 to `outcomes` − 1; μ counts points, so that a pdf is a probability.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Discrete {
    /// The number of points.
    pub outcomes: usize,
}

impl Domain for Discrete {
    #[inline]
    fn measure(&self) -> f64 {
        self.outcomes as f64
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let point = usize::from(point);
        (point < self.outcomes).then(|| [(point as f64 + 0.5) / self.outcomes as f64, 0.5])
    }

    #[inline]
    fn point_at(&self, [x, _]: [f64; 2]) -> Point {
        ((x * self.outcomes as f64) as usize).min(self.outcomes.saturating_sub(1)).into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        a == b
    }

    #[inline]
    fn is_plane(&self) -> bool {
        false
    }

    fn outcomes(&self) -> Option<usize> {
        Some(self.outcomes)
    }

    fn axes(&self) -> [&'static str; 2] {
        ["outcome", ""]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        vec![Mistake::at("of the outcomes in reverse", |point| {
            (self.outcomes - 1).saturating_sub(usize::from(point)).into()
        })]
    }

    fn region(&self, cell: &Cell) -> String {
        let [from, end] = cell.x.map(|x| (x * self.outcomes as f64).round() as usize);
        if end == from + 1 { format!("outcome {from}") } else { format!("outcomes {from} to {}", end - 1) }
    }
}

/// How far apart two points of one atom may be, in units of the domain's extent: a few roundings of f32.
const ATOM: f64 = 2e-6;

/// The numbers from `from` to `to`; μ is length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The lower end.
    pub from: f64,
    /// The upper end.
    pub to: f64,
}

impl Line {
    /// The numbers from 0 to 1.
    pub const UNIT: Self = Self { from: 0.0, to: 1.0 };
}

/// `x` itself if it is in \[0, 1\], with 1 moved just inside.
#[inline]
fn within(x: f64) -> Option<f64> {
    (0.0..=1.0).contains(&x).then(|| x.at_most(1f64.next_down()))
}

impl Domain for Line {
    #[inline]
    fn measure(&self) -> f64 {
        self.to - self.from
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        Some([within((f64::from(point) - self.from) / (self.to - self.from))?, 0.5])
    }

    #[inline]
    fn point_at(&self, [x, _]: [f64; 2]) -> Point {
        (self.from + x * (self.to - self.from)).into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        (f64::from(a) - f64::from(b)).abs() <= ATOM * (self.to - self.from)
    }

    #[inline]
    fn is_plane(&self) -> bool {
        false
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", ""]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let reversed = |point| (self.from + self.to - f64::from(point)).into();
        let half = 0.5 * (self.to - self.from);
        let shifted = |by: f64, point: Point| Point::from(f64::from(point) - by);
        let mut all = vec![
            Mistake::at("with both ends exchanged", reversed),
            Mistake::moved("shifted by {}", [-half, half], shifted),
        ];
        for (end, at) in [("lower", self.from), ("upper", self.to)] {
            let name = format!("with distances from the {end} end that are {{}} times as large");
            let scaled = move |scale: f64, point: Point| ((at + (f64::from(point) - at) / scale).into(), 1.0);
            all.push(Mistake::scaled(&name, scaled));
        }
        let powers = [(1.0, "d"), (2.0, "d²"), (0.5, "√d"), (-0.5, "1/√d")];
        for (end, at, sign) in [("lower", self.from, 1.0), ("upper", self.to, -1.0)] {
            let distance = move |point| sign * (f64::from(point) - at);
            let density = |(power, text)| {
                let name = format!("a density in proportion to {text}, d the distance from the {end} end");
                Mistake::density(&name, move |point| distance(point).powf(power))
            };
            all.extend(powers.map(density));
        }
        all
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![
            Variable::new("the distance from the lower end", |x| f64::from(x) - self.from),
            Variable::new("the distance from the upper end", |x| self.to - f64::from(x)),
        ]
    }

    fn region(&self, cell: &Cell) -> String {
        let [from, to] = cell.x.map(|x| self.from + x * (self.to - self.from));
        format!("x {from:.5}..{to:.5}")
    }
}

/// Pairs of numbers from 0 to 1; μ is area.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Square;

impl Domain for Square {
    #[inline]
    fn measure(&self) -> f64 {
        1.0
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let [x, y] = point.into();
        Some([within(x)?, within(y)?])
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        chart.into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        let (a, b) = (<[f64; 2]>::from(a), <[f64; 2]>::from(b));
        (a[0] - b[0]).abs() <= ATOM && (a[1] - b[1]).abs() <= ATOM
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", "y"]
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![
            Variable::new("x", |at| <[f64; 2]>::from(at)[0]),
            Variable::new("y", |at| <[f64; 2]>::from(at)[1]),
            Variable::new("(1 - x)", |at| 1.0 - <[f64; 2]>::from(at)[0]),
            Variable::new("(1 - y)", |at| 1.0 - <[f64; 2]>::from(at)[1]),
        ]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let places: [Place<2>; 4] = [
            ("with x and y exchanged", |[x, y]| [y, x]),
            ("at 1 - x", |[x, y]| [1.0 - x, y]),
            ("at 1 - y", |[x, y]| [x, 1.0 - y]),
            ("at 1 - x and 1 - y", |[x, y]| [1.0 - x, 1.0 - y]),
        ];
        let at = |(name, place): Place<2>| Mistake::at(name, move |point| place(point.into()).into());
        places.map(at).into()
    }
}

/// The axis of a chart of directions, from which θ is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pole {
    /// The normal of the local frame; φ goes from +x towards +y.
    Z,
    /// The zenith of the world; φ goes from +z towards +x.
    Y,
}

/// Unit vectors, all or those of the pole's hemisphere; μ is solid angle in sr.
///
/// The chart is ((1 − cos θ)/2 or 1 − cos θ, φ/2π) with θ from the pole. Both coordinates keep their relative precision at
/// the pole, and rectangles follow the plane of incidence, so that lobes that are 10⁴ times as high as wide at grazing angles
/// still fit their cells. This is why cells adapt in this chart and the chart is not rotated towards the lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Directions {
    /// The axis of the chart.
    pub pole: Pole,
    /// Whether only cos θ ≥ 0 belongs to the set.
    pub half: bool,
}

impl Directions {
    /// All directions.
    #[must_use]
    pub fn sphere(pole: Pole) -> Self {
        Self { pole, half: false }
    }

    /// Directions with cos θ ≥ 0.
    #[must_use]
    pub fn hemisphere(pole: Pole) -> Self {
        Self { pole, half: true }
    }

    /// The direction at chart coordinates: [`point_at`](Domain::point_at).
    #[inline]
    #[must_use]
    pub fn direction_at(&self, [below, turns]: [f64; 2]) -> [f64; 3] {
        let below = if self.half { below } else { 2.0 * below };
        let (sin_phi, cos_phi) = (TAU * turns).sin_cos();
        let (sin, z) = ((below * (2.0 - below)).at_least(0.0).sqrt(), 1.0 - below);
        let (x, y) = (sin * cos_phi, sin * sin_phi);
        match self.pole {
            Pole::Z => [x, y, z],
            Pole::Y => [y, z, x],
        }
    }

    /// The cosine of the angle with the pole.
    fn cos(&self, point: Point) -> f64 {
        let [_, y, z] = point.into();
        if self.pole == Pole::Z { z } else { y }
    }

    /// The pdf in the frames whose axes are other ones, or point the other way: those of a hemisphere have its pole.
    fn frames(&self) -> Vec<Mistake<'_>> {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
        let pole = if self.pole == Pole::Z { 2 } else { 1 };
        let is_kept = |order: [usize; 3], signs: [f64; 3]| !self.half || order[pole] == pole && signs[pole] > 0.0;
        // The usual ones first: the opposite direction, then those with few signs
        const SIGNS: [usize; 8] = [0, 7, 1, 2, 4, 3, 5, 6];
        let mut all = Vec::new();
        for (order, bits) in ORDERS.into_iter().flat_map(|order| SIGNS.map(|bits| (order, bits))).skip(1) {
            let signs = [0, 1, 2].map(|i| if bits >> i & 1 == 0 { 1.0 } else { -1.0 });
            let [x, y, z] =
                [0, 1, 2].map(|i| format!("{}{}", if signs[i] < 0.0 { "-" } else { "" }, ["x", "y", "z"][order[i]]));
            let name = match (order, bits) {
                ([0, 1, 2], 7) => "at the opposite direction".to_owned(),
                ([1, 0, 2], 0) => "with x and y exchanged".to_owned(),
                ([0, 2, 1], 0) => "with y and z exchanged".to_owned(),
                ([2, 1, 0], 0) => "with x and z exchanged".to_owned(),
                _ => format!("at ({x}, {y}, {z})"),
            };
            let place = move |point: Point| {
                let w: [f64; 3] = point.into();
                [0, 1, 2].map(|i| signs[i] * w[order[i]]).into()
            };
            all.extend(is_kept(order, signs).then(|| Mistake::at(&name, place)));
        }
        all
    }

    /// The angles with the pole, in degrees, at the ends of a range of the chart's first coordinate.
    fn theta(&self, range: [f64; 2]) -> [f64; 2] {
        // 1 − cos θ = 2 sin² (θ/2), which keeps small angles precise.
        range.map(|x| 2.0 * (if self.half { 0.5 * x } else { x }).sqrt().asin().to_degrees())
    }
}

/// The sine of θ up to which densities in proportion to 1/sin θ are not compared: points do not tell their integrals there.
const AT_POLE: f64 = 0.05;

/// How far from 1 the length of a unit vector may be: rounding of f32, and little more.
const UNIT: f64 = 1e-5;

#[inline]
fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

impl Domain for Directions {
    #[inline]
    fn measure(&self) -> f64 {
        if self.half { TAU } else { 2.0 * TAU }
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let point = <[f64; 3]>::from(point);
        let norm = length(point);
        if norm.is_nan() || (norm - 1.0).abs() > UNIT {
            return None;
        }
        // The frame with the pole at +z.
        let [x, y, z] = point.map(|v| v / norm);
        let (x, y, z) = match self.pole {
            Pole::Z => (x, y, z),
            Pole::Y => (z, x, y),
        };
        if self.half && z < 0.0 {
            return None;
        }
        // 1 − cos θ = sin² θ / (1 + cos θ), without the subtraction where that would cancel.
        let below = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
        let below = if self.half { below } else { 0.5 * below };
        // On the horizon of the hemisphere, and opposite to the pole, rounding must not leave the chart.
        Some([below.at_most(1f64.next_down()), turns(y, x)])
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        self.direction_at(chart).into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        let (a, b) = (<[f64; 3]>::from(a), <[f64; 3]>::from(b));
        length([a[0] - b[0], a[1] - b[1], a[2] - b[2]]) <= ATOM * PI
    }

    fn axes(&self) -> [&'static str; 2] {
        match self.half {
            true => ["1 - cos θ", "φ / 2π"],
            false => ["(1 - cos θ) / 2", "φ / 2π"],
        }
    }

    fn coordinates(&self) -> [&'static str; 2] {
        ["cos θ", "φ"]
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![
            Variable::new("cos θ", |w| self.cos(w).abs()).of(|_| String::new()),
            Variable::new("sin θ", |w| (1.0 - self.cos(w).powi(2)).at_least(0.0).sqrt()),
        ]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let cos = |point: Point| self.cos(point);
        let sin = move |point| (1.0 - cos(point).powi(2)).at_least(0.0).sqrt();
        let known = move |point| Some(sin(point)).filter(|sin| *sin > AT_POLE).unwrap_or(f64::NAN);
        let upper = move |point| cos(point).at_least(0.0);
        let cube = |point: Point| <[f64; 3]>::from(point).map(f64::abs).into_iter().fold(0.0, f64::at_least).powi(-3);
        let mut all = vec![
            Mistake::density("cos θ/π", upper),
            Mistake::density(
                "a density in proportion to 1/sin θ (θ is uniform, without the factor sin θ)",
                move |w| 1.0 / known(w),
            ),
            Mistake::density(
                "a density in proportion to cos θ/sin θ (the radius of a disk is u, not √u)",
                move |w| upper(w) / known(w),
            ),
            Mistake::density("the density of points of a cube, normalised", cube),
        ];
        if !self.half {
            all.push(Mistake::density("a uniform density over the hemisphere", move |w| f64::from(cos(w) > 0.0)));
        }
        all.extend(self.frames());
        let turned = move |degrees: f64, w: Point| {
            let ([x, y, z], (sin, cos)) = (w.into(), degrees.to_radians().sin_cos());
            let back: [f64; 3] = match self.pole {
                Pole::Z => [cos * x + sin * y, cos * y - sin * x, z],
                Pole::Y => [cos * x - sin * z, y, cos * z + sin * x],
            };
            back.into()
        };
        all.push(Mistake::moved("turned by {}° about the pole", [-180.0, 180.0], turned));
        all
    }

    fn region(&self, cell: &Cell) -> String {
        let ([t0, t1], [p0, p1]) = (self.theta(cell.x), cell.y.map(|y| 360.0 * y));
        format!("theta {}°..{}°, phi {}°..{}°", degrees(t0), degrees(t1), degrees(p0), degrees(p1))
    }

    fn in_words(&self, cell: &Cell) -> String {
        let [t0, t1] = self.theta(cell.x);
        let horizon = |t: f64| (t - 90.0).abs() < 1e-6;
        if *cell == Cell::WHOLE {
            return "in total".to_owned();
        }
        let place = match (cell.x == [0.0, 1.0], t0 == 0.0, cell.x[1] == 1.0 && !self.half) {
            (true, ..) => "for all theta".to_owned(),
            (_, true, _) if horizon(t1) => "above the horizon".to_owned(),
            (_, true, _) if t1 < NEAR => format!("within {}° of theta = 0", degrees(t1)),
            (_, _, true) if horizon(t0) => "below the horizon".to_owned(),
            (_, _, true) if t0 > 180.0 - NEAR => format!("within {}° of theta = 180°", degrees(180.0 - t0)),
            _ if horizon(t1) && t0 > 90.0 - NEAR => format!("within {}° of the horizon", degrees(90.0 - t0)),
            _ if horizon(t0) && t1 < 90.0 + NEAR => format!("within {}° below the horizon", degrees(t1 - 90.0)),
            _ => format!("for theta {}°..{}°", degrees(t0), degrees(t1)),
        };
        let [p0, p1] = cell.y.map(|y| 360.0 * y);
        if cell.y == [0.0, 1.0] { place } else { format!("{place}, phi {}°..{}°", degrees(p0), degrees(p1)) }
    }
}

/// Degrees that are near: places that reach further are named by their limits.
const NEAR: f64 = 75.0;

/// Degrees with two decimals, or three significant digits where those would be 0.00.
fn degrees(x: f64) -> String {
    if x == 0.0 || x >= 0.1 { format!("{x:.2}") } else { format!("{x:.2e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::tuple;

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

    /// `floor` is the absolute error that a chart without a pole at 0 may add.
    fn returns(domain: &dyn Domain, floor: f64) {
        for i in 0..400 {
            let y = if domain.is_plane() { (f64::from(i % 20) + 0.5) / 20.0 } else { 0.5 };
            for x in [(f64::from(i / 20) + 0.5) / 20.0, 10f64.powi(-1 - i / 20)] {
                let back = domain.to_chart(domain.point_at([x, y])).unwrap();
                assert!((back[0] - x).abs() <= 1e-13 * x + floor && (back[1] - y).abs() < 1e-13, "{x} {y}: {back:?}");
                assert!(domain.same(domain.point_at([x, y]), domain.point_at(back)));
            }
        }
        assert!(!domain.same(domain.point_at([0.1, 0.5]), domain.point_at([0.9, 0.5])));
    }

    #[test]
    fn charts_and_their_inverses() {
        returns(&Line { from: -2.0, to: 5.0 }, 1e-15);
        returns(&Square, 0.0);
        for pole in [Pole::Y, Pole::Z] {
            returns(&Directions::sphere(pole), 0.0);
            returns(&Directions::hemisphere(pole), 0.0);
        }
        let die = Discrete { outcomes: 6 };
        assert!((0..6).map(Point::from).all(|face: Point| die.point_at(die.to_chart(face).unwrap()) == face));
    }

    #[test]
    fn regions_are_named_in_the_domains_own_coordinates() {
        let cell = Cell { x: [0.0, 0.5], y: [0.25, 0.5] };
        let hemisphere = Directions::hemisphere(Pole::Z);
        assert_eq!(hemisphere.region(&cell), "theta 0.00°..60.00°, phi 90.00°..180.00°");
        assert_eq!(Directions::sphere(Pole::Y).region(&cell), "theta 0.00°..90.00°, phi 90.00°..180.00°");
        let narrow = Cell { x: [5e-9, 1e-8], y: [0.0, 1.0] };
        assert_eq!(hemisphere.region(&narrow), "theta 5.73e-3°..8.10e-3°, phi 0.00°..360.00°");
        assert_eq!(Line { from: -1.0, to: 3.0 }.region(&cell), "x -1.00000..1.00000");
        assert_eq!(Square.region(&cell), "x 0.0000..0.5000, y 0.2500..0.5000");
        assert_eq!(Discrete { outcomes: 6 }.region(&cell), "outcomes 0 to 2");
        assert_eq!(Discrete { outcomes: 2 }.region(&cell), "outcome 0");
    }

    #[test]
    fn what_is_outside_has_no_chart_coordinates() {
        let half = Directions::hemisphere(Pole::Z);
        assert_eq!(half.to_chart([0.0, 0.6, -0.8].into()), None);
        assert_eq!(half.to_chart([0.0, 0.6, 0.9].into()), None);
        assert_eq!(half.to_chart([f64::NAN; 3].into()), None);
        assert!(half.to_chart([1.0 + 1e-7, 1e-7, 1e-16].into()).is_some(), "just above the horizon, but for rounding");
        assert_eq!(Square.to_chart([0.5, 1.5].into()), None);
        assert_eq!(Line::UNIT.to_chart(f64::NAN.into()), None);
        assert_eq!(Discrete { outcomes: 6 }.to_chart(6_usize.into()), None);
    }
}
