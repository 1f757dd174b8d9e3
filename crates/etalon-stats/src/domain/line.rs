//! Numbers: intervals, the half-line, the real line; and the circle.

use super::{ATOM, Domain, OFF, Point, equal_parts, near, within};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::{Mistake, Variable};
use etalon_random::turns;
use std::f64::consts::TAU;

/// Numbers between two ends, of which either may be infinite; μ is length. Their chart is one axis of a [`Product`](super::Product).
pub trait Axis: Sync {
    /// The ends.
    fn ends(&self) -> [f64; 2];

    /// What counts as far between points: the length, or the width of what is near.
    fn extent(&self) -> f64;

    /// The chart coordinate of a number; `None` outside.
    fn to_unit(&self, x: f64) -> Option<f64>;

    /// The number at a chart coordinate.
    fn at(&self, u: f64) -> f64;

    /// dx/du at a chart coordinate.
    fn slope(&self, u: f64) -> f64;

    /// The numbers at the ends of an interval of the chart.
    fn range(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let [lower, upper] = self.ends();
        let ends = [self.at(from), self.at(to)];
        [if from == 0.0 { lower } else { ends[0] }, if to == 1.0 { upper } else { ends[1] }]
    }
}

/// Chart coordinates of unbounded lines keep this distance from the ends: there numbers are about 10⁶³ widths away.
const FAR: f64 = f64::EPSILON / 2.0;

/// The ratio u/(1 − u) at a chart coordinate.
#[inline]
fn ratio(u: f64) -> f64 {
    let u = u.within(FAR, 1.0 - FAR);
    u / (1.0 - u)
}

/// The chart coordinate at which u/(1 − u) is this ratio.
#[inline]
fn at_ratio(ratio: f64) -> f64 {
    (if ratio > 1.0 { 1.0 / (1.0 + 1.0 / ratio) } else { ratio / (1.0 + ratio) }).within(FAR, 1.0 - FAR)
}

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

impl Axis for Line {
    #[inline]
    fn ends(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    #[inline]
    fn extent(&self) -> f64 {
        self.to - self.from
    }

    #[inline]
    fn to_unit(&self, x: f64) -> Option<f64> {
        within((x - self.from) / (self.to - self.from))
    }

    #[inline]
    fn at(&self, u: f64) -> f64 {
        self.from + u * (self.to - self.from)
    }

    #[inline]
    fn slope(&self, _u: f64) -> f64 {
        self.to - self.from
    }
}

impl Domain for Line {
    #[inline]
    fn measure(&self) -> f64 {
        self.to - self.from
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        Some([self.to_unit(point.into())?, 0.5])
    }

    #[inline]
    fn point_at(&self, [x, _]: [f64; 2]) -> Point {
        self.at(x).into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        (f64::from(a) - f64::from(b)).abs() <= ATOM * (self.to - self.from)
    }

    #[inline]
    fn is_plane(&self) -> bool {
        false
    }

    fn axes(&self) -> [&str; 2] {
        ["x", ""]
    }

    fn told(&self, _axis: usize, at: f64) -> String {
        format!("x = {}", self.at(at))
    }

    fn table(&self, [rows, columns]: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        Some([equal_parts(rows), equal_parts(columns)])
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

    fn boxed(&self, cell: &Cell) -> Option<Cell> {
        Some(Cell { x: self.range(cell.x), ..*cell })
    }

    fn region(&self, cell: &Cell) -> String {
        let [from, to] = self.range(cell.x);
        format!("x {from:.5}..{to:.5}")
    }
}

/// The numbers from `from` to infinity, or to −∞ if `width` is negative; μ is length.
///
/// The chart is x = from + width (u/(1 − u))⁴: densities that fall as slowly as x⁻¹·² are smooth in it, and numbers from 10⁻⁶³ to 10⁶³
/// widths have places of their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfLine {
    /// The end.
    pub from: f64,
    /// How far from the end the middle of the chart is.
    pub width: f64,
}

impl HalfLine {
    /// The numbers above 0.
    pub const POSITIVE: Self = Self { from: 0.0, width: 1.0 };
}

impl Axis for HalfLine {
    fn ends(&self) -> [f64; 2] {
        [self.from, self.width * f64::INFINITY]
    }

    fn extent(&self) -> f64 {
        self.width.abs()
    }

    #[inline]
    fn to_unit(&self, x: f64) -> Option<f64> {
        let distance = (x - self.from) / self.width;
        (distance >= 0.0).then(|| at_ratio(distance.sqrt().sqrt()))
    }

    #[inline]
    fn at(&self, u: f64) -> f64 {
        self.from + self.width * ratio(u).powi(4)
    }

    #[inline]
    fn slope(&self, u: f64) -> f64 {
        let (ratio, u) = (ratio(u), u.within(FAR, 1.0 - FAR));
        4.0 * self.width.abs() * ratio.powi(4) / (u * (1.0 - u))
    }
}

/// What the domains of numbers without an end have in common: all but their variables and mistakes, from their [`Axis`].
macro_rules! unbounded {
    () => {
        fn measure(&self) -> f64 {
            f64::INFINITY
        }

        #[inline]
        fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
            Some([self.to_unit(point.into())?, 0.5])
        }

        #[inline]
        fn point_at(&self, [u, _]: [f64; 2]) -> Point {
            self.at(u).into()
        }

        fn same(&self, a: Point, b: Point) -> bool {
            near(a, b, self.extent())
        }

        fn is_even(&self) -> bool {
            false
        }

        #[inline]
        fn jacobian(&self, [u, _]: [f64; 2]) -> f64 {
            self.slope(u)
        }

        fn is_plane(&self) -> bool {
            false
        }

        fn axes(&self) -> [&str; 2] {
            ["chart of x", ""]
        }

        fn coordinates(&self) -> [&str; 2] {
            ["x", ""]
        }

        fn told(&self, _axis: usize, at: f64) -> String {
            format!("x = {}", self.at(at))
        }

        fn boxed(&self, cell: &Cell) -> Option<Cell> {
            Some(Cell { x: self.range(cell.x), ..*cell })
        }

        fn region(&self, cell: &Cell) -> String {
            region("x", self.range(cell.x))
        }
    };
}

impl Domain for HalfLine {
    unbounded!();

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![Variable::new("the distance from the end", |x| (f64::from(x) - self.from).abs())]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let scaled = |scale: f64, x: Point| ((self.from + (f64::from(x) - self.from) / scale).into(), 1.0);
        vec![Mistake::scaled("with distances from the end that are {} times as large", scaled)]
    }
}

/// All numbers; μ is length.
///
/// The chart is x = place + width (q⁴ − q⁻⁴)/8 with q = u/(1 − u): densities that fall as slowly as |x|⁻¹·² are smooth in it, and numbers up
/// to 10⁶³ widths have places of their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealLine {
    /// The number in the middle of the chart.
    pub place: f64,
    /// How wide the middle of the chart is.
    pub width: f64,
}

impl RealLine {
    /// Around 0, of width 1.
    pub const UNIT: Self = Self { place: 0.0, width: 1.0 };
}

impl Axis for RealLine {
    fn ends(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    fn extent(&self) -> f64 {
        self.width
    }

    #[inline]
    fn to_unit(&self, x: f64) -> Option<f64> {
        let y = 4.0 * (x - self.place) / self.width;
        // q⁴ = |y| + √(y² + 1), which is 2 |y| where the square would overflow
        let size = y.abs();
        let power = if size < 1e9 { size + (size * size + 1.0).sqrt() } else { 2.0 * size };
        let q = power.sqrt().sqrt();
        (!y.is_nan()).then(|| at_ratio(if y < 0.0 { 1.0 / q } else { q }))
    }

    #[inline]
    fn at(&self, u: f64) -> f64 {
        let power = ratio(u).powi(4);
        self.place + self.width * 0.125 * (power - 1.0 / power)
    }

    #[inline]
    fn slope(&self, u: f64) -> f64 {
        let (power, u) = (ratio(u).powi(4), u.within(FAR, 1.0 - FAR));
        0.5 * self.width * (power + 1.0 / power) / (u * (1.0 - u))
    }
}

impl Domain for RealLine {
    unbounded!();

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![Variable::new("|x|", |x| f64::from(x).abs())]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let limit = 4.0 * self.width;
        vec![
            Mistake::at("at -x", |x| (-f64::from(x)).into()),
            Mistake::moved("shifted by {}", [-limit, limit], |by, x| (f64::from(x) - by).into()),
            Mistake::scaled("of numbers that are {} times as large", |scale, x| ((f64::from(x) / scale).into(), 1.0)),
        ]
    }
}

/// A range of numbers, also of very large and small ones.
pub(super) fn region(name: &str, range: [f64; 2]) -> String {
    let [from, to] =
        range.map(|x| if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.3e}") });
    format!("{name} {from}..{to}")
}

/// Unit vectors of the plane; μ is the angle, which goes from +x towards +y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Circle;

impl Domain for Circle {
    fn measure(&self) -> f64 {
        TAU
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let [x, y] = point.into();
        ((x.hypot(y) - 1.0).abs() <= OFF).then(|| [turns(y, x), 0.5])
    }

    #[inline]
    fn point_at(&self, [u, _]: [f64; 2]) -> Point {
        let (sin, cos) = (TAU * u).sin_cos();
        [cos, sin].into()
    }

    fn same(&self, a: Point, b: Point) -> bool {
        near(a, b, 1.0)
    }

    fn is_plane(&self) -> bool {
        false
    }

    fn axes(&self) -> [&str; 2] {
        ["φ / 2π", ""]
    }

    fn coordinates(&self) -> [&str; 2] {
        ["φ", ""]
    }

    fn hint(&self, outside: Point) -> String {
        let [x, y] = outside.into();
        format!(": its length is {:.6}", x.hypot(y))
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        type Place = (&'static str, fn([f64; 2]) -> [f64; 2]);
        let places: [Place; 4] = [
            ("at the opposite direction", |[x, y]| [-x, -y]),
            ("with x and y exchanged", |[x, y]| [y, x]),
            ("at -x", |[x, y]| [-x, y]),
            ("at -y", |[x, y]| [x, -y]),
        ];
        places.map(|(name, place)| Mistake::at(name, move |point| place(point.into()).into())).into()
    }

    fn region(&self, cell: &Cell) -> String {
        let [from, to] = cell.x.map(|x| 360.0 * x);
        format!("phi {from:.2}°..{to:.2}°")
    }
}
