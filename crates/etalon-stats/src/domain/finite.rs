//! Finite sets, and their products with other domains.

use super::{ChartFunctions, Domain, Named, Place, Point, Space, equal_parts, place};
use crate::error::{Error, Result};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::Mistake;

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

    fn axes(&self) -> [&str; 2] {
        ["outcome", ""]
    }

    fn point(&self, coordinates: &[f64]) -> Option<Point> {
        let &[i] = coordinates else { return None };
        (i >= 0.0 && i.fract() == 0.0 && i < 2f64.powi(53)).then(|| (i as usize).into())
    }

    fn names(&self) -> Vec<&'static str> {
        vec!["i"]
    }

    fn table(&self, [rows, columns]: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        Some([equal_parts(rows), equal_parts(columns)])
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

/// An index below `count`, and a point of `domain`: a triangle of a mesh and a point on it. μ is that of `domain` for each index.
///
/// Points have the index as their first coordinate. The chart's first axis has a part for each index.
#[derive(Clone)]
pub struct Indexed {
    /// How many indices there are.
    pub count: usize,
    /// Where the points lie.
    pub domain: Named,
}

impl Indexed {
    /// The index and the point.
    fn split(&self, point: Point) -> Option<(usize, Point)> {
        let (index, rest) = point.coordinates().split_first()?;
        let is_index = *index >= 0.0 && index.fract() == 0.0 && *index < self.count as f64;
        is_index.then_some(*index as usize).zip(self.domain.point(rest))
    }

    /// The functions of a domain of more than two dimensions.
    fn functions(&self) -> Result<&dyn ChartFunctions> {
        let none = || Error::parameter("domain", "it has no cube".to_owned(), "use one of more than two dimensions");
        self.domain.space().map(|space| space.functions).ok_or_else(none)
    }

    /// The index at chart coordinates, and those of the point.
    fn unfold(&self, [u, v]: [f64; 2]) -> (usize, [f64; 2]) {
        let scaled = u * self.count as f64;
        let index = (scaled as usize).min(self.count - 1);
        (index, [scaled - index as f64, v])
    }
}

impl Domain for Indexed {
    fn measure(&self) -> f64 {
        self.count as f64 * self.domain.measure()
    }

    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let (index, point) = self.split(point)?;
        let [u, v] = self.domain.to_chart(point)?;
        // Rounding must not carry it into the next part.
        let next = ((index + 1) as f64 / self.count as f64).next_down();
        Some([((index as f64 + u) / self.count as f64).at_most(next), v])
    }

    fn point_at(&self, chart: [f64; 2]) -> Point {
        let (index, chart) = self.unfold(chart);
        let point = self.domain.point_at(chart);
        Point::of(&[&[index as f64], point.coordinates()].concat()).unwrap_or(point)
    }

    fn same(&self, a: Point, b: Point) -> bool {
        matches!((self.split(a), self.split(b)), (Some((i, a)), Some((k, b))) if i == k && self.domain.same(a, b))
    }

    fn is_even(&self) -> bool {
        self.domain.is_even()
    }

    fn jacobian(&self, chart: [f64; 2]) -> f64 {
        self.count as f64 * self.domain.jacobian(self.unfold(chart).1)
    }

    fn check(&self) -> Result<()> {
        self.domain.check()
    }

    fn is_plane(&self) -> bool {
        self.domain.is_plane()
    }

    fn space(&self) -> Option<Space<'_>> {
        let Space { axes, is_product, .. } = self.domain.space()?;
        Some(Space { functions: self, axes: [vec!["index".to_owned()], axes].concat(), is_product })
    }

    fn parts(&self) -> usize {
        self.count
    }

    fn axes(&self) -> [&str; 2] {
        ["index", self.domain.axes()[1]]
    }

    fn coordinates(&self) -> [&str; 2] {
        ["the index", self.domain.coordinates()[1]]
    }

    fn names(&self) -> Vec<&'static str> {
        [vec!["i"], self.domain.names()].concat()
    }

    fn region(&self, cell: &Cell) -> String {
        let (first, [from, _]) = self.unfold([cell.x[0], 0.0]);
        let to = cell.x[1] * self.count as f64 - first as f64;
        if to <= 1.0 {
            let inside = Cell { x: [from, to], ..*cell };
            return format!("index {first}, {}", self.domain.region(&inside));
        }
        let last = (cell.x[1] * self.count as f64).ceil() as usize - 1;
        let across = self.domain.region(&Cell { x: [0.0, 1.0], ..*cell });
        let is_whole = cell.y == [0.0, 1.0];
        format!("indices {first} to {last}{}", if is_whole { String::new() } else { format!(", {across}") })
    }
}

/// The index is the first coordinate of the cube, in equal parts.
impl ChartFunctions for Indexed {
    fn to_cube(&self, points: &[Point]) -> Result<Vec<Place>> {
        let split: Vec<Option<(usize, Point)>> = points.iter().map(|&point| self.split(point)).collect();
        let rest: Vec<Point> = split.iter().map(|split| split.map_or(f64::NAN.into(), |(_, point)| point)).collect();
        let at = |(split, at): (Option<(usize, Point)>, Place)| {
            let index = split.map_or(f64::NAN, |(index, _)| (index as f64 + 0.5) / self.count as f64);
            place(&[&[index], &at[..at.len() - 1]].concat())
        };
        Ok(split.into_iter().zip(self.functions()?.to_cube(&rest)?).map(at).collect())
    }

    fn from_cube(&self, cube: &[Place]) -> Result<Vec<Point>> {
        let index = |at: &Place| ((at[0] * self.count as f64) as usize).min(self.count - 1) as f64;
        let point = |(at, rest): (&Place, Point)| Point::of(&[&[index(at)], rest.coordinates()].concat());
        let points = self.functions()?.from_cube(&rest(cube))?;
        Ok(cube.iter().zip(points).map(|of| point(of).unwrap_or(f64::NAN.into())).collect())
    }

    fn jacobian(&self, cube: &[Place]) -> Result<Vec<f64>> {
        let jacobians = self.functions()?.jacobian(&rest(cube))?;
        Ok(jacobians.into_iter().map(|jacobian| self.count as f64 * jacobian).collect())
    }
}

/// The places without the index.
fn rest(cube: &[Place]) -> Vec<Place> {
    cube.iter().map(|at| place(&at[1..])).collect()
}
