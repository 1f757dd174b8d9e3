//! Triangles: barycentric coordinates, two or three of them, and points between three corners.

use super::line::region;
use super::{ATOM, Domain, OFF, Point, near, nearly_within};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::Mistake;

/// The chart coordinates of barycentric coordinates (b₀, b₁): ((1 − b₀)², b₁/(1 − b₀)).
#[inline]
fn to_chart([b0, b1]: [f64; 2]) -> Option<[f64; 2]> {
    let side = nearly_within(1.0 - b0)?;
    let along = if side > 0.0 { b1 / side } else { 0.5 };
    // Rounding counts in units of the triangle.
    let beyond = side * (along - 1.0).at_least(-along);
    let along = if beyond <= OFF { along.within(0.0, 1.0) } else { along };
    Some([nearly_within(side * side)?, nearly_within(along)?])
}

/// The barycentric coordinates at chart coordinates.
#[inline]
fn at([square, along]: [f64; 2]) -> [f64; 3] {
    let side = square.sqrt();
    [1.0 - side, along * side, (1.0 - along) * side]
}

const AXES: [&str; 2] = ["(1 - b0)²", "b1 / (1 - b0)"];

fn region_of(cell: &Cell) -> String {
    let [to, from] = cell.x.map(|square| 1.0 - square.sqrt());
    format!("{}, {}", region("b0", [from, to]), region("b1 / (1 - b0)", cell.y))
}

/// The mistakes of densities of barycentric coordinates, by what makes points of them.
fn mistakes<'a>(
    barycentric: impl Fn(Point) -> [f64; 3] + Copy + 'a,
    point: impl Fn([f64; 3]) -> Point + Copy + 'a,
) -> Vec<Mistake<'a>> {
    let exchanged = |name: &str, [i, k]: [usize; 2]| {
        Mistake::at(name, move |at| {
            let mut b = barycentric(at);
            b.swap(i, k);
            point(b)
        })
    };
    let mut all = vec![
        exchanged("with b0 and b1 exchanged", [0, 1]),
        exchanged("with b0 and b2 exchanged", [0, 2]),
        exchanged("with b1 and b2 exchanged", [1, 2]),
    ];
    // Whichever corner's coordinate a sampler draws first
    all.extend((0..3).map(|i| {
        let name = format!("a density in proportion to 1/(1 - b{i}) (1 - b{i} is u, not √u)");
        Mistake::density(&name, move |at| 1.0 / (1.0 - barycentric(at)[i]))
    }));
    let normalized = "a density in proportion to 1/max(b0, b1, b2)³ (three uniform numbers divided by their sum, not exponential ones)";
    all.push(Mistake::density(normalized, move |at| barycentric(at).into_iter().fold(0.0, f64::at_least).powi(-3)));
    all
}

/// The first two of three barycentric coordinates; μ is the area of these pairs, ½ in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Barycentric;

impl Domain for Barycentric {
    fn measure(&self) -> f64 {
        0.5
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        to_chart(point.into())
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        let [b0, b1, _] = at(chart);
        [b0, b1].into()
    }

    fn same(&self, a: Point, b: Point) -> bool {
        near(a, b, 1.0)
    }

    fn axes(&self) -> [&str; 2] {
        AXES
    }

    fn hint(&self, outside: Point) -> String {
        let [b0, b1] = outside.into();
        format!(": its third coordinate is {:.6}", 1.0 - b0 - b1)
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let barycentric = |point: Point| {
            let [b0, b1] = point.into();
            [b0, b1, 1.0 - b0 - b1]
        };
        mistakes(barycentric, |[b0, b1, _]| [b0, b1].into())
    }

    fn region(&self, cell: &Cell) -> String {
        region_of(cell)
    }
}

/// Three numbers from 0 to 1 whose sum is 1; μ is the area of the first two, as in the Dirichlet distribution, ½ in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Simplex;

impl Domain for Simplex {
    fn measure(&self) -> f64 {
        0.5
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let [b0, b1, b2] = point.into();
        ((b0 + b1 + b2 - 1.0).abs() <= OFF).then(|| to_chart([b0, b1]))?
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        at(chart).into()
    }

    fn same(&self, a: Point, b: Point) -> bool {
        near(a, b, 1.0)
    }

    fn axes(&self) -> [&str; 2] {
        AXES
    }

    fn hint(&self, outside: Point) -> String {
        let [b0, b1, b2] = outside.into();
        format!(": its sum is {:.6}", b0 + b1 + b2)
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        mistakes(|point| point.into(), |b| b.into())
    }

    fn region(&self, cell: &Cell) -> String {
        region_of(cell)
    }
}

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// The points of a triangle in space; μ is area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// The corners.
    pub corners: [[f64; 3]; 3],
}

impl Triangle {
    /// The edges from the first corner.
    fn edges(&self) -> [Vector; 2] {
        let [a, b, c] = self.corners;
        [minus(b, a), minus(c, a)]
    }

    /// The length of the longer edge from the first corner.
    fn size(&self) -> f64 {
        self.edges().map(|edge| dot(edge, edge).sqrt()).into_iter().fold(0.0, f64::at_least)
    }

    /// The barycentric coordinates of the nearest point of the triangle's plane.
    fn barycentric(&self, point: Point) -> [f64; 3] {
        let ([e, f], p) = (self.edges(), minus(point.into(), self.corners[0]));
        let (ee, ef, ff, pe, pf) = (dot(e, e), dot(e, f), dot(f, f), dot(p, e), dot(p, f));
        let square = ee * ff - ef * ef;
        let [b1, b2] = [(pe * ff - pf * ef) / square, (pf * ee - pe * ef) / square];
        [1.0 - b1 - b2, b1, b2]
    }

    fn at(&self, b: [f64; 3]) -> Point {
        let corners = &self.corners;
        [0, 1, 2].map(|i| b[0] * corners[0][i] + b[1] * corners[1][i] + b[2] * corners[2][i]).into()
    }
}

impl Domain for Triangle {
    fn measure(&self) -> f64 {
        let [e, f] = self.edges();
        0.5 * (dot(e, e) * dot(f, f) - dot(e, f).powi(2)).at_least(0.0).sqrt()
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let b = self.barycentric(point);
        let off = minus(self.at(b).into(), point.into());
        (dot(off, off).sqrt() <= OFF * self.size()).then(|| to_chart([b[0], b[1]]))?
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        self.at(at(chart))
    }

    fn same(&self, a: Point, b: Point) -> bool {
        let apart = minus(a.into(), b.into());
        dot(apart, apart).sqrt() <= ATOM * self.size()
    }

    fn axes(&self) -> [&str; 2] {
        AXES
    }

    fn hint(&self, outside: Point) -> String {
        let b = self.barycentric(outside);
        let off = minus(self.at(b).into(), outside.into());
        let [b0, b1, b2] = b;
        format!(
            ": its barycentric coordinates are {b0:.4}, {b1:.4}, {b2:.4}, and it is {:.2e} off the plane",
            dot(off, off).sqrt()
        )
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        mistakes(|point| self.barycentric(point), |b| self.at(b))
    }

    fn region(&self, cell: &Cell) -> String {
        region_of(cell)
    }
}
