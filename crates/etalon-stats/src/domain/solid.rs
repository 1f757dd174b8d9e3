//! Sets of three to six dimensions, by their charts.

use super::chart::{OUTSIDE, of_closures};
use super::{Axis, Chart, ChartFunctions, Line, OFF, Place, Point, RealLine, nearly_within, place};
use crate::extremes::Extremes;
use std::f64::consts::{PI, TAU};

/// A place if all of its coordinates are known.
fn known(coordinates: impl Iterator<Item = Option<f64>>) -> Place {
    coordinates.collect::<Option<Vec<f64>>>().map_or(OUTSIDE, |known| place(&known))
}

fn point(coordinates: &[f64]) -> Point {
    Point::of(coordinates).unwrap_or(f64::NAN.into())
}

/// The length of a point.
fn length(at: Point) -> String {
    format!(": its length is {:.6}", at.coordinates().iter().map(|x| x * x).sum::<f64>().sqrt())
}

/// The vectors whose numbers lie on these axes.
fn product<A: Axis + Clone>(axes: Vec<A>) -> Chart<impl ChartFunctions> {
    let [of_point, of_place, of_slope] = [axes.clone(), axes.clone(), axes];
    let dimension = of_point.len();
    of_closures(
        dimension,
        move |at: Point| match at.coordinates() {
            all if all.len() == dimension => known(of_point.iter().zip(all).map(|(axis, x)| axis.to_unit(*x))),
            _ => OUTSIDE,
        },
        move |at| point(&of_place.iter().zip(at).map(|(axis, u)| axis.at(u)).collect::<Vec<_>>()),
        move |at| of_slope.iter().zip(at).map(|(axis, u)| axis.slope(u)).product(),
    )
    .of_product()
}

/// Space; most points are about `width` from the origin.
pub fn space(width: f64) -> Chart<impl ChartFunctions> {
    product(vec![RealLine { place: 0.0, width }; 3])
}

/// The box with these sides.
pub fn cuboid(sides: Vec<Line>) -> Chart<impl ChartFunctions> {
    let measure = sides.iter().map(|side| side.to - side.from).product();
    product(sides).even(measure)
}

/// The ball around the origin: the cube of the radius, the cosine of the angle to +z, and the angle from +x.
pub fn ball(radius: f64) -> Chart<impl ChartFunctions> {
    let volume = 4.0 / 3.0 * PI * radius.powi(3);
    let to_cube = move |at: [f64; 3]| {
        let [x, y, z] = at.map(|x| x / radius);
        let r = x.hypot(y).hypot(z);
        let cos = if r > 0.0 { z / r } else { 0.0 };
        let turn = (y.atan2(x) / TAU).rem_euclid(1.0);
        known([nearly_within(r.powi(3)), nearly_within(0.5 * (1.0 + cos)), Some(turn)].into_iter())
    };
    let from_cube = move |at: Place| {
        let (r, cos) = (radius * at[0].cbrt(), 2.0 * at[1] - 1.0);
        let ((y, x), sin) = ((TAU * at[2]).sin_cos(), (1.0 - cos * cos).at_least(0.0).sqrt());
        [r * sin * x, r * sin * y, r * cos].into()
    };
    of_closures(3, move |at: Point| to_cube(at.into()), from_cube, move |_| volume)
        .even(volume)
        .with_hint(length)
        .with_axes(["(r/R)³", "(1 + cos theta)/2", "phi/2π"].map(str::to_owned).to_vec())
}

/// Rotations as unit quaternions x, y, z, w, of which w is the real part; q and −q are one. μ is Haar's measure, 1 in all.
/// Source: Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992.
pub fn rotations() -> Chart<impl ChartFunctions> {
    let to_cube = |q: [f64; 4]| {
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        let is_second = q[2] < 0.0 || q[2] == 0.0 && q[3] < 0.0;
        let [x, y, z, w] = q.map(|x| if is_second { -x / length } else { x / length });
        let is_unit = (length - 1.0).abs() <= OFF;
        let turn = (x.atan2(y) / TAU).rem_euclid(1.0);
        known(
            [is_unit.then_some(z * z + w * w), Some(turn), Some(z.abs().atan2(w) / PI)]
                .map(|u| nearly_within(u?))
                .into_iter(),
        )
    };
    let from_cube = |at: Place| {
        let [first, second] = [(1.0 - at[0]).sqrt(), at[0].sqrt()];
        let ((x, y), (z, w)) = ((TAU * at[1]).sin_cos(), (PI * at[2]).sin_cos());
        [first * x, first * y, second * z, second * w].into()
    };
    of_closures(3, move |at: Point| to_cube(at.into()), from_cube, |_| 1.0)
        .even(1.0)
        .in_units_of(PI * PI)
        .with_hint(length)
        .with_axes(["z² + w²", "angle of (y, x)/2π", "angle of (w, z)/π"].map(str::to_owned).to_vec())
}

/// `weights` numbers of sum 1, each from 0 to 1; μ is the volume of all but the last.
pub fn simplex(weights: usize) -> Chart<impl ChartFunctions> {
    let dimension = weights - 1;
    let volume = (1..=dimension).map(|k| 1.0 / k as f64).product();
    // Each weight leaves a share of what the weights before it left: u is that share, to the power that makes it uniform.
    let power = move |axis: usize| (dimension - axis) as f64;
    let to_cube = move |at: Point| {
        let all = at.coordinates();
        let is_one = all.len() == weights && (all.iter().sum::<f64>() - 1.0).abs() <= OFF;
        let share = |axis: usize| {
            let [with, without] = [axis, axis + 1].map(|first| all[first..].iter().sum::<f64>());
            nearly_within(all[axis])?;
            let share = if with > 0.0 { (without / with).within(0.0, 1.0) } else { 0.5 };
            nearly_within(share.powf(power(axis)))
        };
        let last = all.last().and_then(|last| nearly_within(*last));
        if is_one && last.is_some() { known((0..dimension).map(share)) } else { OUTSIDE }
    };
    let from_cube = move |at: Place| {
        let mut rest = 1.0;
        let weight = |axis: usize| {
            let before = rest;
            rest *= if axis < dimension { at[axis].powf(1.0 / power(axis)) } else { 0.0 };
            before - rest
        };
        point(&(0..weights).map(weight).collect::<Vec<_>>())
    };
    of_closures(dimension, to_cube, from_cube, move |_| volume)
        .even(volume)
        .in_units_of((weights as f64).sqrt())
        .with_hint(|at| format!(": its sum is {:.6}", at.coordinates().iter().sum::<f64>()))
        .with_axes((0..dimension).map(|axis| format!("share left by b{axis}")).collect())
}
