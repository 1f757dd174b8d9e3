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

/// The functions of a chart, each for many points at a time.
pub trait ChartFunctions: Sync {
    /// The coordinates in the unit square of points; outside of it, or NaN, where a point is not in the set.
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) from functions in another process.
    fn to_cube(&self, points: &[Point]) -> Result<Vec<[f64; 2]>>;

    /// The points at coordinates in the unit square.
    ///
    /// # Errors
    /// As [`to_cube`](Self::to_cube).
    #[allow(clippy::wrong_self_convention, reason = "its name in all languages")]
    fn from_cube(&self, cube: &[[f64; 2]]) -> Result<Vec<Point>>;

    /// Length or area of the set per length or area of the unit square, there.
    ///
    /// # Errors
    /// As [`to_cube`](Self::to_cube).
    fn jacobian(&self, cube: &[[f64; 2]]) -> Result<Vec<f64>>;
}

/// Coordinates in a unit cube of one or two dimensions: `f64` and `[f64; 2]`.
pub trait Cube: Copy {
    /// How many there are.
    const DIMENSION: usize;

    /// From a pair whose second number is ½ where there is one coordinate.
    fn of_pair(pair: [f64; 2]) -> Self;

    /// The pair.
    fn pair(self) -> [f64; 2];
}

impl Cube for f64 {
    const DIMENSION: usize = 1;

    fn of_pair([x, _]: [f64; 2]) -> Self {
        x
    }

    fn pair(self) -> [f64; 2] {
        [self, 0.5]
    }
}

impl Cube for [f64; 2] {
    const DIMENSION: usize = 2;

    fn of_pair(pair: [f64; 2]) -> Self {
        pair
    }

    fn pair(self) -> [f64; 2] {
        self
    }
}

/// A domain by the functions of its chart; see [`chart`]. μ is the length or area of the set that the points' coordinates lie in.
pub struct Chart<F> {
    functions: F,
    is_plane: bool,
    axes: [String; 2],
    /// How many coordinates points have.
    width: OnceLock<usize>,
}

impl<F: ChartFunctions> Chart<F> {
    /// The chart to the unit square, or where `dimension` is 1 to the unit interval.
    pub fn new(functions: F, dimension: usize) -> Self {
        Self { functions, is_plane: dimension > 1, axes: ["u0", "u1"].map(str::to_owned), width: OnceLock::new() }
    }

    /// Names the coordinates of the unit square.
    #[must_use]
    pub fn with_axes(self, axes: [String; 2]) -> Self {
        Self { axes, ..self }
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

/// The domain whose chart these functions are: `to_cube` maps its points one to one to the unit square (`[f64; 2]`) or the unit
/// interval (`f64`), and others outside of it or to NaN; `from_cube` is the inverse; `jacobian` is the area of the domain per area
/// of the square at coordinates of the square. Tests check all three first.
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
    let closures = Closures(
        move |point: Point| to_cube(point.into()).pair(),
        move |pair| from_cube(C::of_pair(pair)).into(),
        move |pair| jacobian(C::of_pair(pair)),
    );
    Chart::new(closures, C::DIMENSION)
}

impl<T, F, J> ChartFunctions for Closures<T, F, J>
where
    T: Fn(Point) -> [f64; 2] + Sync,
    F: Fn([f64; 2]) -> Point + Sync,
    J: Fn([f64; 2]) -> f64 + Sync,
{
    fn to_cube(&self, points: &[Point]) -> Result<Vec<[f64; 2]>> {
        Ok(points.iter().map(|&point| (self.0)(point)).collect())
    }

    fn from_cube(&self, cube: &[[f64; 2]]) -> Result<Vec<Point>> {
        Ok(cube.iter().map(|&at| (self.1)(at)).collect())
    }

    fn jacobian(&self, cube: &[[f64; 2]]) -> Result<Vec<f64>> {
        Ok(cube.iter().map(|&at| (self.2)(at)).collect())
    }
}

impl<F: ChartFunctions> Domain for Chart<F> {
    /// The integral of the Jacobian, infinite where that is not known to a hundredth.
    fn measure(&self) -> f64 {
        let shape = if self.is_plane { [8, 8] } else { [64, 1] };
        integrate(self, &density(|_: Point| 1.0), &Grid::equal(shape, None)).map_or(f64::INFINITY, |integrals| {
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
        false
    }

    fn jacobian(&self, chart: [f64; 2]) -> f64 {
        self.functions.jacobian(&[chart]).map_or(f64::NAN, |values| values.first().copied().unwrap_or(f64::NAN))
    }

    fn charts(&self, points: &[Point]) -> Result<Vec<[f64; 2]>> {
        let inside = |[x, y]: [f64; 2]| Some([within(x)?, within(y)?]);
        Ok(self.functions.to_cube(points)?.into_iter().map(|at| inside(at).unwrap_or([f64::NAN; 2])).collect())
    }

    fn points_at(&self, charts: &[[f64; 2]]) -> Result<Vec<Point>> {
        self.functions.from_cube(charts)
    }

    fn per_chart_area(&self, charts: &[[f64; 2]], pdfs: &mut [f64]) -> Result<()> {
        let factors = self.functions.jacobian(charts)?;
        pdfs.iter_mut().zip(factors).filter(|(pdf, _)| **pdf != 0.0).for_each(|(pdf, factor)| *pdf *= factor);
        Ok(())
    }

    fn check(&self) -> Result<()> {
        check_chart(self)
    }

    fn is_plane(&self) -> bool {
        self.is_plane
    }

    fn axes(&self) -> [&str; 2] {
        [&self.axes[0], &self.axes[1]]
    }

    fn point(&self, coordinates: &[f64]) -> Option<Point> {
        Point::of(coordinates).filter(|_| coordinates.len() == self.width())
    }

    fn names(&self) -> Vec<&'static str> {
        super::NAMES[..self.width()].to_vec()
    }
}

/// Places at which a chart is tested, and how far coordinates may be from those that they return to.
const PLACES: usize = 64;
const RETURN: f64 = 1e-6;
/// The steps of differences, as shares of the distance from the ends: the second where the chart has a crease within the first.
const STEPS: [f64; 2] = [1e-3, 1e-5];
/// The relative error that differences may have, those of functions in single precision too.
const PRECISION: f64 = 1e-3;

/// Tests whether `to_chart` and `point_at` invert each other, and the Jacobian against differences of `point_at`.
///
/// The area of the parallelogram of two derivatives is √(|a|²|b|² − (a·b)²), in any number of coordinates. Derivatives are
/// (8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h, with an error of h⁴.
pub(super) fn check_chart(domain: &dyn Domain) -> Result<()> {
    let plane = domain.is_plane();
    // Points that fill the square evenly and lie on none of its symmetries (Roberts 2018)
    let place = |i: usize| {
        let along = |ratio: f64| (0.5 + ratio * (i as f64 + 1.0)).fract();
        [along(0.754_877_666_246_692_7), if plane { along(0.569_840_290_998_053_3) } else { 0.5 }]
    };
    let wrong = |message: String| {
        let hint = "a chart maps the domain to the unit square one to one, with its area per area of the square";
        Err(Error::parameter("chart", message, hint))
    };
    let coordinates = |at: &[f64; 2]| if plane { tuple(&at) } else { format!("{}", at[0]) };
    let places: Vec<[f64; 2]> = (0..PLACES).map(place).collect();
    let points = domain.points_at(&places)?;
    let finite = |point: &Point| point.coordinates().iter().all(|x| x.is_finite());
    if let Some(i) = points.iter().position(|point| !finite(point)) {
        return wrong(format!("from_cube({}) is {}", coordinates(&places[i]), tuple(&points[i])));
    }
    for ((at, point), back) in places.iter().zip(&points).zip(domain.charts(&points)?) {
        let is_near = |back: [f64; 2]| (0..2).all(|axis| (back[axis] - at[axis]).abs() <= RETURN);
        if !is_near(back) {
            let is_outside = back[0].is_nan();
            let back = if is_outside { "outside of the unit square".to_owned() } else { coordinates(&back) };
            let (at, point) = (coordinates(at), tuple(point));
            return wrong(format!(
                "from_cube({at}) is {point}, but to_cube({point}) is {back}: they do not invert each other"
            ));
        }
    }
    let mut jacobians = vec![1.0; PLACES];
    domain.per_chart_area(&places, &mut jacobians)?;
    if let Some(i) = jacobians.iter().position(|jacobian| !(jacobian.is_finite() && *jacobian > 0.0)) {
        let (at, value) = (coordinates(&places[i]), jacobians[i]);
        return wrong(format!("jacobian({at}) is {value}; it must be positive and finite inside of the unit square"));
    }
    let [first, second] = STEPS.map(|step| differences(domain, &places, step));
    let is_near = |area: f64, jacobian: f64| (area / jacobian - 1.0).abs() <= PRECISION;
    for (((at, jacobian), first), second) in places.iter().zip(jacobians).zip(first?).zip(second?) {
        if !is_near(first, jacobian) && !is_near(second, jacobian) {
            let (at, ratio) = (coordinates(at), mistakes::number(first / jacobian));
            let size = if plane { "area" } else { "length" };
            return wrong(format!(
                "jacobian({at}) is {jacobian:.6}, but by differences of from_cube the {size} per {size} of the unit square is {first:.6} there, {ratio} times as much (differences up to {} % are allowed)",
                100.0 * PRECISION
            ));
        }
    }
    Ok(())
}

/// The area of the domain per area of the chart, or the length, by differences of `point_at`.
fn differences(domain: &dyn Domain, places: &[[f64; 2]], step: f64) -> Result<Vec<f64>> {
    const WEIGHTS: [(f64, f64); 4] = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
    let derivatives = |axis: usize| -> Result<Vec<Vec<f64>>> {
        let width = |at: &[f64; 2]| step * at[axis].at_most(1.0 - at[axis]);
        let moved = |(steps, _): (f64, f64)| {
            let moved = |at: &[f64; 2]| {
                let mut moved = *at;
                moved[axis] += steps * width(at);
                moved
            };
            domain.points_at(&places.iter().map(moved).collect::<Vec<_>>())
        };
        let points: Vec<Vec<Point>> = WEIGHTS.into_iter().map(moved).collect::<Result<_>>()?;
        let derivative = |(i, at): (usize, &[f64; 2])| {
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
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let x = derivatives(0)?;
    if !domain.is_plane() {
        return Ok(x.iter().map(|x| dot(x, x).sqrt()).collect());
    }
    let area = |(x, y): (&Vec<f64>, &Vec<f64>)| (dot(x, x) * dot(y, y) - dot(x, y).powi(2)).at_least(0.0).sqrt();
    Ok(x.iter().zip(&derivatives(1)?).map(area).collect())
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
