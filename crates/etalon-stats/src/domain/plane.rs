//! Regions of the plane: the unit square, products of two axes, the disk.

use super::line::region;
use super::{ATOM, Axis, Domain, EDGE, Line, Point, RealLine, equal_parts, near, within};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::{Mistake, Variable};
use etalon_random::turns;
use std::f64::consts::{PI, TAU};

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

    fn axes(&self) -> [&str; 2] {
        ["x", "y"]
    }

    fn boxed(&self, cell: &Cell) -> Option<Cell> {
        Some(*cell)
    }

    fn table(&self, sides: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        Rectangle::UNIT.table(sides)
    }

    fn is_transposed(&self) -> bool {
        true
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        Rectangle::UNIT.variables()
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        Rectangle::UNIT.mistakes()
    }
}

/// Pairs of numbers along two axes; μ is area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Product<X, Y> {
    /// The first numbers.
    pub x: X,
    /// The second numbers.
    pub y: Y,
}

/// A rectangle.
pub type Rectangle = Product<Line, Line>;

/// The whole plane.
pub type Plane = Product<RealLine, RealLine>;

impl Rectangle {
    /// The unit square.
    pub const UNIT: Self = Self { x: Line::UNIT, y: Line::UNIT };
}

impl Plane {
    /// Around the origin, of width 1.
    pub const UNIT: Self = Self { x: RealLine::UNIT, y: RealLine::UNIT };
}

impl<X: Axis, Y: Axis> Product<X, Y> {
    /// 1 − x or −x, and the same of y: `(1 - x)` is the distance from the upper end 1.
    fn mirrored(&self) -> [(String, f64); 2] {
        let of = |name: &str, [from, to]: [f64; 2]| match from + to {
            sum if sum.is_nan() || sum == 0.0 => (format!("-{name}"), 0.0),
            sum => (format!("{sum} - {name}"), sum),
        };
        [of("x", self.x.ends()), of("y", self.y.ends())]
    }
}

impl<X: Axis, Y: Axis> Domain for Product<X, Y> {
    fn measure(&self) -> f64 {
        let length = |[from, to]: [f64; 2]| (to - from).abs();
        length(self.x.ends()) * length(self.y.ends())
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let [x, y] = point.into();
        Some([self.x.to_unit(x)?, self.y.to_unit(y)?])
    }

    #[inline]
    fn point_at(&self, [u, v]: [f64; 2]) -> Point {
        [self.x.at(u), self.y.at(v)].into()
    }

    fn same(&self, a: Point, b: Point) -> bool {
        near(a, b, self.x.extent().at_least(self.y.extent()))
    }

    fn is_even(&self) -> bool {
        self.measure().is_finite()
    }

    #[inline]
    fn jacobian(&self, [u, v]: [f64; 2]) -> f64 {
        self.x.slope(u) * self.y.slope(v)
    }

    fn axes(&self) -> [&str; 2] {
        if self.is_even() { ["x", "y"] } else { ["chart of x", "chart of y"] }
    }

    fn coordinates(&self) -> [&str; 2] {
        ["x", "y"]
    }

    fn told(&self, axis: usize, at: f64) -> String {
        if axis == 0 { format!("x = {}", self.x.at(at)) } else { format!("y = {}", self.y.at(at)) }
    }

    fn table(&self, [rows, columns]: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        self.is_even().then(|| [equal_parts(columns), equal_parts(rows)])
    }

    fn is_transposed(&self) -> bool {
        true
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        let ([left, right], [low, high]) = (self.x.ends(), self.y.ends());
        let xy = |at: Point| <[f64; 2]>::from(at);
        if [left, right, low, high] == [0.0, 1.0, 0.0, 1.0] {
            return vec![
                Variable::new("x", move |at| xy(at)[0]),
                Variable::new("y", move |at| xy(at)[1]),
                Variable::new("(1 - x)", move |at| 1.0 - xy(at)[0]),
                Variable::new("(1 - y)", move |at| 1.0 - xy(at)[1]),
            ];
        }
        vec![
            Variable::new("|x|", move |at| xy(at)[0].abs()),
            Variable::new("|y|", move |at| xy(at)[1].abs()),
            Variable::new("r, the distance from the origin", move |at| xy(at)[0].hypot(xy(at)[1])),
        ]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let [(x_name, of_x), (y_name, of_y)] = self.mirrored();
        let at = |name: &str, place: &'static (dyn Fn([f64; 2], [f64; 2]) -> [f64; 2] + Sync)| {
            Mistake::at(name, move |point| place(point.into(), [of_x, of_y]).into())
        };
        vec![
            at("with x and y exchanged", &|[x, y], _| [y, x]),
            at(&format!("at {x_name}"), &|[x, y], [a, _]| [a - x, y]),
            at(&format!("at {y_name}"), &|[x, y], [_, b]| [x, b - y]),
            at(&format!("at {x_name} and {y_name}"), &|[x, y], [a, b]| [a - x, b - y]),
        ]
    }

    fn boxed(&self, cell: &Cell) -> Option<Cell> {
        Some(Cell { x: self.x.range(cell.x), y: self.y.range(cell.y) })
    }

    fn region(&self, cell: &Cell) -> String {
        format!("{}, {}", region("x", self.x.range(cell.x)), region("y", self.y.range(cell.y)))
    }
}

/// The points within `radius` of the origin of the plane; μ is area.
///
/// The chart is (r²/radius², φ/2π) with φ from +x towards +y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// The radius.
    pub radius: f64,
}

impl Disk {
    /// The unit disk.
    pub const UNIT: Self = Self { radius: 1.0 };
}

impl Domain for Disk {
    fn measure(&self) -> f64 {
        PI * self.radius * self.radius
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let [x, y] = <[f64; 2]>::from(point).map(|x| x / self.radius);
        let square = x * x + y * y;
        Some([within(if square <= 1.0 + EDGE { square.at_most(1.0) } else { square })?, turns(y, x)])
    }

    #[inline]
    fn point_at(&self, [square, turns]: [f64; 2]) -> Point {
        let (r, (sin, cos)) = (self.radius * square.sqrt(), (TAU * turns).sin_cos());
        [r * cos, r * sin].into()
    }

    fn same(&self, a: Point, b: Point) -> bool {
        near(a, b, self.radius)
    }

    fn axes(&self) -> [&str; 2] {
        ["r² / R²", "φ / 2π"]
    }

    fn coordinates(&self) -> [&str; 2] {
        ["r", "φ"]
    }

    fn hint(&self, outside: Point) -> String {
        let [x, y] = outside.into();
        format!(": it is {:.6} from the centre", x.hypot(y))
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![Variable::new("r, the distance from the centre", |at| {
            let [x, y] = at.into();
            x.hypot(y)
        })]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        vec![
            Mistake::at("with x and y exchanged", |at| {
                let [x, y] = at.into();
                [y, x].into()
            }),
            Mistake::density("a density in proportion to 1/r (the radius is u, not √u)", |at| {
                let [x, y] = at.into();
                1.0 / x.hypot(y)
            }),
        ]
    }

    fn region(&self, cell: &Cell) -> String {
        let [inner, outer] = cell.x.map(|square| self.radius * square.sqrt());
        let [from, to] = cell.y.map(|y| 360.0 * y);
        format!("{}, phi {from:.2}°..{to:.2}°", region("r", [inner, outer]))
    }
}
