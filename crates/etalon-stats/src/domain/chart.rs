//! A chart of the user's own, and the test of charts.

use super::{Domain, Point, near, within};
use crate::cubature::integrate;
use crate::diagnosis::tuple;
use crate::error::{Error, Result};
use crate::extremes::Extremes;
use crate::grid::Grid;
use crate::mistakes;
use crate::sampler::density;
use std::sync::OnceLock;

/// Most coordinates of a unit cube: six, and one for the index of [`Indexed`](super::Indexed).
const MOST: usize = 7;

/// A place of a unit cube; ½ along the axes that the cube does not have.
pub type Place = [f64; MOST];

/// The place of what is not in the set.
pub(super) const OUTSIDE: Place = [f64::NAN; MOST];

/// The functions of a chart, each for many points at a time.
pub trait ChartFunctions: Sync {
    /// The coordinates in the unit cube of points; outside of it, or NaN, where a point is not in the set.
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) from functions in another process.
    fn to_cube(&self, points: &[Point]) -> Result<Vec<Place>>;

    /// The points at coordinates in the unit cube.
    ///
    /// # Errors
    /// As [`to_cube`](Self::to_cube).
    #[allow(clippy::wrong_self_convention, reason = "its name in all languages")]
    fn from_cube(&self, cube: &[Place]) -> Result<Vec<Point>>;

    /// Length, area or volume of the set per length, area or volume of the unit cube, there.
    ///
    /// # Errors
    /// As [`to_cube`](Self::to_cube).
    fn jacobian(&self, cube: &[Place]) -> Result<Vec<f64>>;
}

/// The chart of a set of more than two dimensions.
pub struct Space<'a> {
    /// To the unit cube.
    pub functions: &'a dyn ChartFunctions,
    /// The names of the coordinates of the cube.
    pub axes: Vec<String>,
    /// Whether each of these tells the coordinate of points of the same number, which then gives the name.
    pub is_product: bool,
}

/// A place, from the first of its coordinates.
#[must_use]
pub fn place(coordinates: &[f64]) -> Place {
    std::array::from_fn(|axis| coordinates.get(axis).copied().unwrap_or(0.5))
}

/// Coordinates in a unit cube of one to six dimensions: `f64`, and `[f64; 2]` to `[f64; 6]`.
pub trait Cube: Copy {
    /// How many there are.
    const DIMENSION: usize;

    /// From a place, whose further coordinates are ½.
    fn of_place(place: Place) -> Self;

    /// The place.
    fn place(self) -> Place;
}

impl Cube for f64 {
    const DIMENSION: usize = 1;

    fn of_place(place: Place) -> Self {
        place[0]
    }

    fn place(self) -> Place {
        place(&[self])
    }
}

impl<const N: usize> Cube for [f64; N] {
    const DIMENSION: usize = {
        assert!(N >= 1 && N < MOST, "a cube has one to six dimensions");
        N
    };

    fn of_place(place: Place) -> Self {
        std::array::from_fn(|axis| place[axis])
    }

    fn place(self) -> Place {
        place(&self)
    }
}

/// A domain by the functions of its chart; see [`chart`]. μ is the length, area or volume of the set that the points' coordinates lie in.
pub struct Chart<F> {
    functions: F,
    dimension: usize,
    axes: Vec<String>,
    /// How many coordinates points have.
    width: OnceLock<usize>,
    /// μ of the whole, where it is known: then equal parts of the cube have equal measures.
    even: Option<f64>,
    /// The volume, in the coordinates of points, of a set of μ = 1.
    unit: f64,
    is_product: bool,
    /// Whether tests use the [`Space`].
    in_leaves: bool,
    /// Why a point may lie outside.
    hint: fn(Point) -> String,
}

impl<F: ChartFunctions> Chart<F> {
    /// The chart to the unit cube of n dimensions, n from one to six.
    pub fn new(functions: F, dimension: usize) -> Self {
        let axes = (0..dimension).map(|axis| format!("u{axis}")).collect();
        Self {
            functions,
            dimension,
            axes,
            width: OnceLock::new(),
            even: None,
            unit: 1.0,
            is_product: false,
            in_leaves: dimension > 2,
            hint: |_| String::new(),
        }
    }

    /// Names the coordinates of the unit cube.
    #[must_use]
    pub fn with_axes(self, axes: Vec<String>) -> Self {
        Self { axes, ..self }
    }

    /// Says that equal parts of the cube have equal measures, `measure` in all.
    pub(super) fn even(self, measure: f64) -> Self {
        Self { even: Some(measure), ..self }
    }

    /// Says that a set of μ = 1 has another volume in the coordinates of points.
    pub(super) fn in_units_of(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// Says why a point may lie outside.
    pub(super) fn with_hint(self, hint: fn(Point) -> String) -> Self {
        Self { hint, ..self }
    }

    /// Says that each coordinate of the cube tells one of points.
    pub(super) fn of_product(self) -> Self {
        Self { is_product: true, ..self }
    }

    /// Has tests use the [`Space`] in two dimensions, too: its integrals are without bias where densities jump.
    pub(super) fn in_leaves(self) -> Self {
        Self { in_leaves: true, ..self }
    }

    fn width(&self) -> usize {
        let of = |point: Point| point.coordinates().len();
        self.width.get().copied().unwrap_or_else(|| {
            let middle = self.points_at(&[[0.5; 2]]).ok().and_then(|mut points| points.pop());
            middle.map_or(0, |point| *self.width.get_or_init(|| of(point)))
        })
    }
}

/// Closures as [`ChartFunctions`].
struct Closures<T, F, J>(T, F, J);

/// The domain whose chart these functions are: `to_cube` maps its points one to one to the unit cube of two to six dimensions
/// (`[f64; 2]` to `[f64; 6]`) or the unit interval (`f64`), and others outside of it or to NaN; `from_cube` is the inverse; `jacobian`
/// is the area (volume) of the domain per area of the cube at coordinates of the cube. Tests check all three first.
///
/// ```
/// use etalon_stats::{Protocol, Sample, chart, density, sampler, validate};
/// // The upper half of the unit disk, by radius and angle.
/// use std::f64::consts::PI;
/// let half_disk = chart(
///     |[x, y]: [f64; 2]| [x.hypot(y), y.atan2(x) / PI],
///     |[r, turn]: [f64; 2]| [r * (PI * turn).cos(), r * (PI * turn).sin()],
///     |[r, _]: [f64; 2]| PI * r,
/// );
/// let uniform = sampler(2, |u| {
///     let (r, phi) = (u[0].sqrt(), PI * u[1]);
///     Some(Sample::new([r * phi.cos(), r * phi.sin()]))
/// });
/// let outcome = validate(&half_disk, &uniform, &density(|_: [f64; 2]| 2.0 / PI), &Protocol::default())?;
/// assert!(outcome.is_accepted());
/// # Ok::<(), etalon_stats::Error>(())
/// ```
pub fn chart<P: From<Point> + Into<Point>, C: Cube>(
    to_cube: impl Fn(P) -> C + Sync,
    from_cube: impl Fn(C) -> P + Sync,
    jacobian: impl Fn(C) -> f64 + Sync,
) -> Chart<impl ChartFunctions> {
    let to_cube = move |point: Point| to_cube(point.into()).place();
    let from_cube = move |place| from_cube(C::of_place(place)).into();
    of_closures(C::DIMENSION, to_cube, from_cube, move |place| jacobian(C::of_place(place)))
}

/// [`chart`] of points of any kind.
pub(super) fn of_closures(
    dimension: usize,
    to_cube: impl Fn(Point) -> Place + Sync,
    from_cube: impl Fn(Place) -> Point + Sync,
    jacobian: impl Fn(Place) -> f64 + Sync,
) -> Chart<impl ChartFunctions> {
    Chart::new(Closures(to_cube, from_cube, jacobian), dimension)
}

impl<T, F, J> ChartFunctions for Closures<T, F, J>
where
    T: Fn(Point) -> Place + Sync,
    F: Fn(Place) -> Point + Sync,
    J: Fn(Place) -> f64 + Sync,
{
    fn to_cube(&self, points: &[Point]) -> Result<Vec<Place>> {
        Ok(points.iter().map(|&point| (self.0)(point)).collect())
    }

    fn from_cube(&self, cube: &[Place]) -> Result<Vec<Point>> {
        Ok(cube.iter().map(|&at| (self.1)(at)).collect())
    }

    fn jacobian(&self, cube: &[Place]) -> Result<Vec<f64>> {
        Ok(cube.iter().map(|&at| (self.2)(at)).collect())
    }
}

/// Places from the first two of their coordinates.
fn places(charts: &[[f64; 2]]) -> Vec<Place> {
    charts.iter().map(|at| place(at)).collect()
}

/// The place itself if it is in the cube, else NaN.
pub(crate) fn inside(mut place: Place) -> Place {
    for u in &mut place {
        let Some(within) = within(*u) else { return OUTSIDE };
        *u = within;
    }
    place
}

/// The two-dimensional chart is the plane of the first two axes; in more dimensions tests use the [`Space`].
impl<F: ChartFunctions> Domain for Chart<F> {
    /// The integral of the Jacobian, infinite where that is not known to a hundredth.
    fn measure(&self) -> f64 {
        if let Some(measure) = self.even {
            return measure;
        }
        let shape = if self.is_plane() { [8, 8] } else { [64, 1] };
        let integrals =
            (self.dimension <= 2).then(|| integrate(self, &density(|_: Point| 1.0), &Grid::equal(shape, None)));
        integrals.and_then(Result::ok).map_or(f64::INFINITY, |integrals| {
            let [value, error] = [integrals.values, integrals.errors].map(|all| all.iter().sum::<f64>());
            if error < 0.01 * value { value } else { f64::INFINITY }
        })
    }

    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        self.charts(&[point]).ok()?.pop().filter(|at| !at[0].is_nan())
    }

    fn point_at(&self, chart: [f64; 2]) -> Point {
        self.points_at(&[chart]).ok().and_then(|mut points| points.pop()).unwrap_or(f64::NAN.into())
    }

    fn same(&self, a: Point, b: Point) -> bool {
        let extent = a.coordinates().iter().fold(1.0, |extent: f64, x| extent.at_least(x.abs()));
        near(a, b, extent)
    }

    fn is_even(&self) -> bool {
        self.even.is_some()
    }

    fn jacobian(&self, chart: [f64; 2]) -> f64 {
        self.functions
            .jacobian(&places(&[chart]))
            .map_or(f64::NAN, |values| values.first().copied().unwrap_or(f64::NAN))
    }

    fn charts(&self, points: &[Point]) -> Result<Vec<[f64; 2]>> {
        Ok(self.functions.to_cube(points)?.into_iter().map(inside).map(|[x, y, ..]| [x, y]).collect())
    }

    fn points_at(&self, charts: &[[f64; 2]]) -> Result<Vec<Point>> {
        self.functions.from_cube(&places(charts))
    }

    fn per_chart_area(&self, charts: &[[f64; 2]], pdfs: &mut [f64]) -> Result<()> {
        let factors = self.functions.jacobian(&places(charts))?;
        pdfs.iter_mut().zip(factors).filter(|(pdf, _)| **pdf != 0.0).for_each(|(pdf, factor)| *pdf *= factor);
        Ok(())
    }

    fn check(&self) -> Result<()> {
        check_chart(&self.functions, self.dimension, self.unit)
    }

    fn is_plane(&self) -> bool {
        self.dimension > 1
    }

    fn space(&self) -> Option<Space<'_>> {
        let Self { functions, is_product, .. } = self;
        self.in_leaves.then(|| Space { functions, axes: self.axes.clone(), is_product: *is_product })
    }

    fn hint(&self, outside: Point) -> String {
        (self.hint)(outside)
    }

    fn axes(&self) -> [&str; 2] {
        [0, 1].map(|axis| self.axes.get(axis).map_or("", |name| name.as_str()))
    }

    fn point(&self, coordinates: &[f64]) -> Option<Point> {
        Point::of(coordinates).filter(|_| coordinates.len() == self.width())
    }

    fn names(&self) -> Vec<&'static str> {
        super::names(self.width())
    }
}

/// Places at which a chart is tested, and how far coordinates may be from those that they return to.
const PLACES: usize = 64;
const RETURN: f64 = 1e-6;
/// The steps of differences, as shares of the distance from the ends: the second where the chart has a crease within the first.
const STEPS: [f64; 2] = [1e-3, 1e-5];
/// The relative error that differences may have, those of functions in single precision too.
const PRECISION: f64 = 1e-3;

/// Points that fill the cube evenly and lie on none of its symmetries: multiples of 1/φᵏ, φ being the root of φᵈ⁺¹ = φ + 1.
/// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
pub(crate) fn steps(dimension: usize) -> Vec<f64> {
    let power = 1.0 / (dimension.max(2) + 1) as f64;
    let phi = (0..64).fold(1.3, |phi: f64, _| (1.0 + phi).powf(power));
    (1..=dimension as i32).map(|k| phi.powi(-k)).collect()
}

/// Tests whether the functions invert each other, and the Jacobian against differences of `from_cube`; a set of μ = 1 has the
/// volume `unit`.
///
/// The volume that derivatives span is the root of the determinant of their scalar products, in any number of coordinates.
/// Derivatives are (8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h, with an error of h⁴.
pub(super) fn check_chart(functions: &dyn ChartFunctions, dimension: usize, unit: f64) -> Result<()> {
    const SQUARE: &str = "a chart maps the domain to the unit square one to one, with its area per area of the square";
    const CUBE: &str = "a chart maps the domain to the unit cube one to one, with its volume per volume of the cube";
    let (cube, size, hint) = match dimension {
        1 => ("unit square", "length", SQUARE),
        2 => ("unit square", "area", SQUARE),
        _ => ("unit cube", "volume", CUBE),
    };
    let wrong = |message: String| Err(Error::parameter("chart", message, hint));
    let coordinates = |at: &Place| if dimension > 1 { tuple(&&at[..dimension]) } else { format!("{}", at[0]) };
    let steps = steps(dimension);
    let along = |i: usize| move |step: &f64| (0.5 + step * (i as f64 + 1.0)).fract();
    let places: Vec<Place> = (0..PLACES).map(|i| place(&steps.iter().map(along(i)).collect::<Vec<_>>())).collect();
    let points = functions.from_cube(&places)?;
    let finite = |point: &Point| point.coordinates().iter().all(|x| x.is_finite());
    if let Some(i) = points.iter().position(|point| !finite(point)) {
        return wrong(format!("from_cube({}) is {}", coordinates(&places[i]), tuple(&points[i])));
    }
    for ((at, point), back) in places.iter().zip(&points).zip(functions.to_cube(&points)?) {
        let back = inside(back);
        let is_near = (0..dimension).all(|axis| (back[axis] - at[axis]).abs() <= RETURN);
        if !is_near {
            let is_outside = back[0].is_nan();
            let back = if is_outside { format!("outside of the {cube}") } else { coordinates(&back) };
            let (at, point) = (coordinates(at), tuple(point));
            return wrong(format!(
                "from_cube({at}) is {point}, but to_cube({point}) is {back}: they do not invert each other"
            ));
        }
    }
    let jacobians = functions.jacobian(&places)?;
    if let Some(i) = jacobians.iter().position(|jacobian| !(jacobian.is_finite() && *jacobian > 0.0)) {
        let (at, value) = (coordinates(&places[i]), jacobians[i]);
        return wrong(format!("jacobian({at}) is {value}; it must be positive and finite inside of the {cube}"));
    }
    let [first, second] = STEPS.map(|step| differences(functions, dimension, &places, step));
    let is_near = |volume: f64, jacobian: f64| (volume / jacobian - 1.0).abs() <= PRECISION;
    for (((at, jacobian), first), second) in places.iter().zip(jacobians).zip(first?).zip(second?) {
        let [first, second] = [first / unit, second / unit];
        if !is_near(first, jacobian) && !is_near(second, jacobian) {
            let (at, ratio) = (coordinates(at), mistakes::number(first / jacobian));
            return wrong(format!(
                "jacobian({at}) is {jacobian:.6}, but by differences of from_cube the {size} per {size} of the {cube} is {first:.6} there, {ratio} times as much (differences up to {} % are allowed)",
                100.0 * PRECISION
            ));
        }
    }
    Ok(())
}

/// The volume of the domain per volume of the cube, by differences of `from_cube`.
fn differences(functions: &dyn ChartFunctions, dimension: usize, places: &[Place], step: f64) -> Result<Vec<f64>> {
    const WEIGHTS: [(f64, f64); 4] = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
    let derivatives = |axis: usize| -> Result<Vec<Vec<f64>>> {
        let width = |at: &Place| step * at[axis].at_most(1.0 - at[axis]);
        let moved = |(steps, _): (f64, f64)| {
            let moved = |at: &Place| {
                let mut moved = *at;
                moved[axis] += steps * width(at);
                moved
            };
            functions.from_cube(&places.iter().map(moved).collect::<Vec<_>>())
        };
        let points: Vec<Vec<Point>> = WEIGHTS.into_iter().map(moved).collect::<Result<_>>()?;
        let derivative = |(i, at): (usize, &Place)| {
            let width = 12.0 * width(at);
            let along = |k: usize| -> f64 {
                let term = |(points, (_, weight)): (&Vec<Point>, (f64, f64))| {
                    weight * points[i].coordinates().get(k).copied().unwrap_or(f64::NAN)
                };
                points.iter().zip(WEIGHTS).map(term).sum::<f64>() / width
            };
            (0..points[0][i].coordinates().len()).map(along).collect()
        };
        Ok(places.iter().enumerate().map(derivative).collect())
    };
    let along: Vec<Vec<Vec<f64>>> = (0..dimension).map(derivatives).collect::<Result<_>>()?;
    Ok((0..places.len()).map(|i| volume(along.iter().map(|of_axis| of_axis[i].clone()).collect())).collect())
}

/// The volume of the parallelepiped with these edges: the product of their lengths, of each what is perpendicular to those before.
fn volume(mut edges: Vec<Vec<f64>>) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut volume = 1.0;
    for i in 0..edges.len() {
        let (before, rest) = edges.split_at_mut(i);
        for edge in before {
            let along = dot(&rest[0], edge) / dot(edge, edge);
            rest[0].iter_mut().zip(edge.iter()).for_each(|(x, y)| *x -= along * y);
        }
        volume *= dot(&rest[0], &rest[0]).sqrt();
    }
    volume
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Protocol, Sample, Verdict, sampler, validate};
    use std::f64::consts::TAU;

    fn to_cube([x, y]: [f64; 2]) -> [f64; 2] {
        [x.hypot(y), (y.atan2(x) / TAU).rem_euclid(1.0)]
    }

    fn from_cube([r, turn]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (TAU * turn).sin_cos();
        [r * cos, r * sin]
    }

    fn jacobian([r, _]: [f64; 2]) -> f64 {
        TAU * r
    }

    #[test]
    fn a_disk_by_radius_and_angle_has_its_area_and_right_and_wrong_samplers_are_told_apart() {
        let disk = chart(to_cube, from_cube, jacobian);
        assert!((disk.measure() - TAU / 2.0).abs() < 1e-9 && !disk.is_even());
        let verdict = |radius: fn(f64) -> f64| {
            let draw = sampler(2, move |u| Some(Sample::new(from_cube([radius(u[0]), u[1]]))));
            let uniform = density(|_: [f64; 2]| 2.0 / TAU);
            validate(&disk, &draw, &uniform, &Protocol::default()).unwrap().verdict
        };
        assert_eq!([verdict(f64::sqrt), verdict(|u| u)], [Verdict::Accept, Verdict::Reject]);
    }

    #[test]
    fn each_wrong_function_is_told() {
        let told = |domain: &dyn Domain| {
            let uniform = sampler(2, |u| Some(Sample::new([u[0], u[1]])));
            validate(domain, &uniform, &density(|_: [f64; 2]| 1.0), &Protocol::default()).unwrap_err().to_string()
        };
        let other_angle = |[x, y]: [f64; 2]| [x.hypot(y), (x.atan2(y) / TAU).rem_euclid(1.0)];
        let cases = [
            (told(&chart(other_angle, from_cube, jacobian)), "do not invert each other"),
            (told(&chart(to_cube, from_cube, |[r, _]: [f64; 2]| r)), "6.283185 = 2π times as much"),
            (told(&chart(to_cube, from_cube, |_: [f64; 2]| TAU / 2.0)), "by differences of from_cube"),
            (told(&chart(to_cube, from_cube, |[r, _]: [f64; 2]| -TAU * r)), "must be positive and finite"),
            (told(&chart(to_cube, |[r, _]: [f64; 2]| [r / 0.0, 0.0], jacobian)), "from_cube("),
            (told(&chart(|[x, y]: [f64; 2]| [x + 2.0, y], from_cube, jacobian)), "outside of the unit square"),
        ];
        for (told, what) in cases {
            assert!(told.starts_with("chart: ") && told.contains(what), "{told}");
        }
    }
}
