//! Where samples lie: sets with a measure, each with a chart to the unit square.

mod chart;
mod directions;
mod finite;
mod line;
mod plane;
mod point;
mod registry;
mod solid;
mod triangle;

pub use chart::{Chart, ChartFunctions, Cube, Place, Space, chart, place};
pub(crate) use chart::{inside, steps};
pub(crate) use directions::around;
pub use directions::{Directions, Pole};
pub use finite::{Discrete, Indexed};
pub use line::{Axis, Circle, HalfLine, Line, RealLine};
pub use plane::{Disk, Plane, Product, Rectangle, Square};
pub use point::Point;
pub use registry::{DOMAINS, Entry, Named, known, named};
pub use solid::{ball, cuboid, rotations, simplex, space};
pub use triangle::{Barycentric, Simplex, Triangle};

use crate::error::Result;
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::{Mistake, Variable};

/// A set of points with a measure μ, to which pdfs refer, and its chart.
///
/// The chart maps the set one to one to \[0, 1)². Cells are rectangles of the chart: the expected share of a cell is the integral
/// over it of the pdf times the Jacobian dμ/du, the measure per area of the chart.
pub trait Domain: Sync {
    /// μ of the whole set: 4π for the sphere; it may be infinite.
    fn measure(&self) -> f64;

    /// The chart coordinates of a point; `None` if it is not in the set or not a number.
    fn to_chart(&self, point: Point) -> Option<[f64; 2]>;

    /// The point at chart coordinates in \[0, 1\]²: the inverse of [`to_chart`](Self::to_chart).
    fn point_at(&self, chart: [f64; 2]) -> Point;

    /// Whether two points are equal up to rounding: how a sample is matched with an atom.
    fn same(&self, a: Point, b: Point) -> bool;

    /// Whether equal areas of the chart are equal measures.
    fn is_even(&self) -> bool {
        true
    }

    /// dμ/du at chart coordinates: constant, unless the chart is not [even](Self::is_even).
    fn jacobian(&self, _chart: [f64; 2]) -> f64 {
        self.measure()
    }

    /// [`to_chart`](Self::to_chart) of many points, NaN for those outside.
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) from a chart that is computed in another process.
    fn charts(&self, points: &[Point]) -> Result<Vec<[f64; 2]>> {
        Ok(points.iter().map(|&point| self.to_chart(point).unwrap_or([f64::NAN; 2])).collect())
    }

    /// [`point_at`](Self::point_at) of many places.
    ///
    /// # Errors
    /// As [`charts`](Self::charts).
    fn points_at(&self, charts: &[[f64; 2]]) -> Result<Vec<Point>> {
        Ok(charts.iter().map(|&chart| self.point_at(chart)).collect())
    }

    /// Makes pdfs at these places densities per area of the chart.
    ///
    /// # Errors
    /// As [`charts`](Self::charts).
    fn per_chart_area(&self, charts: &[[f64; 2]], pdfs: &mut [f64]) -> Result<()> {
        for (pdf, chart) in pdfs.iter_mut().zip(charts).filter(|(pdf, _)| **pdf != 0.0) {
            *pdf *= self.jacobian(*chart);
        }
        Ok(())
    }

    /// Tests the chart itself, if it is one of the user's.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) that says what is wrong with it, and those of [`charts`](Self::charts).
    fn check(&self) -> Result<()> {
        Ok(())
    }

    /// Whether the chart's second axis is in use.
    fn is_plane(&self) -> bool {
        true
    }

    /// The chart of a set of more than two dimensions, from which tests make cells; [`to_chart`](Self::to_chart) says only whether
    /// a point is in the set.
    fn space(&self) -> Option<Space<'_>> {
        None
    }

    /// The number of points of a finite set.
    fn outcomes(&self) -> Option<usize> {
        None
    }

    /// The number of equal parts of the chart's first axis that are sets of their own: pdfs jump between them.
    fn parts(&self) -> usize {
        1
    }

    /// The quantities along the chart's axes, for figures.
    fn axes(&self) -> [&str; 2];

    /// The quantities along the chart's axes, as mistakes name them.
    fn coordinates(&self) -> [&str; 2] {
        self.axes()
    }

    /// A chart coordinate along an axis, in the domain's own coordinates: `x = 0.5`.
    fn told(&self, axis: usize, at: f64) -> String {
        format!("{} = {at}", self.axes()[axis])
    }

    /// The point with these coordinates; `None` if there are too many or too few of them. It need not lie in the set.
    fn point(&self, coordinates: &[f64]) -> Option<Point> {
        let width = self.point_at([0.5; 2]).coordinates().len();
        Point::of(coordinates).filter(|_| coordinates.len() == width)
    }

    /// The names of the coordinates of points.
    fn names(&self) -> Vec<&'static str> {
        names(self.point_at([0.5; 2]).coordinates().len())
    }

    /// The direction with these angles in radians, θ from the pole and φ; `None` where points are no directions in space.
    fn at_angles(&self, _angles: [f64; 2]) -> Option<Point> {
        None
    }

    /// The lines of the chart between the entries of a table of pdfs with that number of rows and columns; `None` if such a table makes no
    /// sense.
    fn table(&self, _sides: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        None
    }

    /// Whether the rows of a table are steps along the chart's second axis.
    fn is_transposed(&self) -> bool {
        false
    }

    /// Why a point may lie outside, as the end of a sentence: `: its length is 1.2`.
    fn hint(&self, _outside: Point) -> String {
        String::new()
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

    /// A cell of the chart in coordinates x and y, of a set of numbers or of pairs of numbers.
    fn boxed(&self, _cell: &Cell) -> Option<Cell> {
        None
    }

    /// Where a cell is, as the end of a sentence: `within 2.0° of the horizon`.
    fn in_words(&self, cell: &Cell) -> String {
        format!("for {}", self.region(cell))
    }
}

/// The names of n coordinates.
fn names(width: usize) -> Vec<&'static str> {
    let all = if width <= 4 {
        ["x", "y", "z", "w", "", "", "", ""]
    } else {
        ["x0", "x1", "x2", "x3", "x4", "x5", "x6", "x7"]
    };
    all[..width].to_vec()
}

/// How far apart two points of one atom may be, in units of the domain's extent: a few roundings of f32.
const ATOM: f64 = 2e-6;

/// How far beyond an edge that is no end of a coordinate rounding may carry a point, in units of the domain's extent; and how far from
/// its length, or from its plane.
const EDGE: f64 = 1e-6;
const OFF: f64 = 1e-5;

/// `x` itself if it is in \[0, 1\], with 1 moved just inside.
#[inline]
fn within(x: f64) -> Option<f64> {
    (0.0..=1.0).contains(&x).then(|| x.at_most(1f64.next_down()))
}

/// [`within`], with what rounding carries a little beyond an end moved to it.
#[inline]
fn nearly_within(x: f64) -> Option<f64> {
    within(if (-EDGE..=1.0 + EDGE).contains(&x) { x.within(0.0, 1.0) } else { x })
}

/// Whether coordinates are equal up to rounding, in units of `extent`.
fn near(a: Point, b: Point, extent: f64) -> bool {
    let (a, b) = (a.coordinates(), b.coordinates());
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ATOM * extent)
}

/// Lines that cut the chart into equal parts.
fn equal_parts(n: usize) -> Vec<f64> {
    (1..n).map(|i| i as f64 / n as f64).collect()
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
