//! The axis about which a pdf of directions is symmetric, and usual mistakes around it.

use super::Mistake;
use crate::domain::{Directions, Domain, Point, Pole};
use crate::extremes::Extremes;
use std::f64::consts::PI;

pub type Direction = [f64; 3];

/// Points at which the symmetry is looked at, the angles of turns in radians, and the mean relative change that is allowed: edges
/// of a cone meet it, where the axis is not exact.
const PLACES: usize = 256;
pub const TURNS: [f64; 3] = [0.7, 2.1, 4.0];
pub const CHANGE: f64 = 0.05;
/// The length of the mean direction from which an axis is clear, and the distance at which axes count as equal.
const CLEAR: f64 = 0.05;
const SAME: f64 = 0.01;
/// Steps by which the axis is found, rows and columns of points, and the share of a point that lies outside of the pdf.
const CAPS: usize = 3;
const CAP: usize = 64;
const NOTHING: f64 = 1e-6;
/// The cosine below which slopes are too large.
const FLAT: f64 = 1e-3;
/// The share of the mean sine that is too near to the axis.
const LEAST: f64 = 0.15;

/// An axis about which a pdf is symmetric.
#[derive(Clone, Copy)]
pub struct Axis {
    pub direction: Direction,
    /// Whether it is the pole of the domain.
    pub is_pole: bool,
    /// The sine of the angle within which densities are not compared: where they are infinite at the axis, points do not tell
    /// their integrals.
    least: f64,
}

pub fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Direction, b: Direction) -> Direction {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `w`, turned about `axis` by an angle (Rodrigues).
fn turned(w: Direction, axis: Direction, angle: f64) -> Direction {
    let ((sin, cos), across, along) = (angle.sin_cos(), cross(axis, w), dot(axis, w));
    [0, 1, 2].map(|i| cos * w[i] + sin * across[i] + (1.0 - cos) * along * axis[i])
}

/// The turn that takes `from` to `to` on the shortest way, of `w`.
pub fn turn_to(from: Direction, to: Direction, w: Direction) -> Direction {
    let axis = cross(from, to);
    let sin = dot(axis, axis).sqrt();
    if sin < 1e-12 {
        return if dot(from, to) > 0.0 { w } else { w.map(|x| -x) };
    }
    turned(w, axis.map(|x| x / sin), sin.atan2(dot(from, to)))
}

/// The mean of directions with weights, and its length.
pub fn mean(directions: impl Iterator<Item = (Direction, f64)>) -> Option<(Direction, f64)> {
    let (mut sum, mut all) = ([0.0; 3], 0.0);
    for (w, weight) in directions.filter(|(_, weight)| *weight > 0.0) {
        all += weight;
        (0..3).for_each(|i| sum[i] += weight * w[i]);
    }
    let length = dot(sum, sum).sqrt();
    (length > 0.0).then(|| (sum.map(|x| x / length), length / all))
}

/// The axis of a pdf that has the `masses` near `points`, if it is symmetric about the mean direction. `pdf` is asked for the pdf,
/// NaN outside of the domain.
pub fn of<E>(
    domain: &dyn Domain,
    points: &[Point],
    masses: &[f64],
    pdf: impl Fn(&[Point]) -> Result<Vec<f64>, E>,
) -> Result<Option<Axis>, E> {
    let [pole, other] = [[0.0; 2], [0.5; 2]].map(|chart| Direction::from(domain.point_at(chart)));
    let is_unit = |w: &Direction| (dot(*w, *w) - 1.0).abs() < SAME;
    if ![pole, other].iter().all(is_unit) {
        return Ok(None);
    }
    let all = points.iter().map(|&point| Direction::from(point)).zip(masses.iter().copied());
    let Some((mut direction, _)) = mean(all).filter(|(_, length)| *length > CLEAR) else { return Ok(None) };
    // More precisely, by points of the cap that holds the pdf
    let total: f64 = masses.iter().sum();
    for _ in 0..CAPS {
        let outside = points.iter().zip(masses).filter(|(_, mass)| **mass > NOTHING * total);
        let least = outside.map(|(&point, _)| dot(point.into(), direction)).fold(1.0, f64::at_most);
        let height = (2.0 * (1.0 - least)).at_most(2.0);
        let cap = Directions { pole: Pole::Z, half: false };
        let place = |i: usize| {
            let at = [i / CAP, i % CAP].map(|i| (i as f64 + 0.5) / CAP as f64);
            turn_to([0.0, 0.0, 1.0], direction, cap.direction_at([0.5 * height * at[0], at[1]]))
        };
        let all: Vec<Direction> = (0..CAP * CAP).map(place).collect();
        let values = pdf(&all.iter().map(|&w| w.into()).collect::<Vec<_>>())?;
        direction = mean(all.into_iter().zip(values)).map_or(direction, |(direction, _)| direction);
    }
    let is_pole = (dot(direction, pole).abs() - 1.0).abs() < 0.5 * SAME * SAME;
    let direction = if is_pole { pole.map(|x| x * dot(direction, pole).signum()) } else { direction };
    // Points that represent equal shares of the mass
    let (mut sum, mut places) = (0.0, Vec::with_capacity(PLACES));
    for (&point, mass) in points.iter().zip(masses) {
        sum += mass / total * PLACES as f64;
        if sum > places.len() as f64 + 0.5 {
            places.push(Direction::from(point));
        }
    }
    let asked = |angle: f64| pdf(&places.iter().map(|&w| turned(w, direction, angle).into()).collect::<Vec<_>>());
    let here = asked(0.0)?;
    for angle in TURNS {
        let there = asked(angle)?;
        let both = here.iter().zip(&there).filter(|(here, there)| !there.is_nan() && **here > 0.0);
        let changes: Vec<f64> = both.map(|(here, there)| (there / here - 1.0).abs().at_most(1.0)).collect();
        let change = changes.iter().sum::<f64>() / changes.len() as f64;
        if change.is_nan() || change > CHANGE {
            return Ok(None);
        }
    }
    let sine = |&w: &Direction| (1.0 - dot(w, direction).powi(2)).at_least(0.0).sqrt();
    let least = LEAST * places.iter().map(sine).sum::<f64>() / places.len() as f64;
    Ok(Some(Axis { direction, is_pole, least }))
}

impl Axis {
    /// As messages name it.
    pub fn name(&self) -> String {
        name(self.direction)
    }

    /// Usual mistakes around it.
    pub fn mistakes<'a>(self) -> Vec<Mistake<'a>> {
        let Self { direction, is_pole, least } = self;
        let cos = move |point: Point| dot(point.into(), direction);
        let sin = move |point: Point| (1.0 - cos(point).powi(2)).at_least(0.0).sqrt();
        let axis = format!("its axis {}", self.name());
        let mut all = vec![Mistake::within(
            &format!(
                "a density in proportion to 1/sin γ where the pdf is positive (the angle γ with {axis} is uniform)"
            ),
            move |w| if sin(w) > least { 1.0 / sin(w) } else { f64::NAN },
        )];
        if !is_pole {
            all.extend(Mistake::factor(&format!("cos γ, γ the angle with {axis}"), move |w| cos(w).abs()));
            all.extend(Mistake::factor(&format!("sin γ, γ the angle with {axis}"), sin));
        }
        // The place at another angle with the axis
        let at_angle = move |point: Point, of: &dyn Fn(f64) -> f64| {
            let w = Direction::from(point);
            let (across, angle) = (cross(direction, w), sin(point).atan2(cos(point)));
            let length = dot(across, across).sqrt();
            match of(angle) {
                _ if length == 0.0 => w,
                other => turned(w, across.map(|x| x / length), other - angle),
            }
        };
        let by_slope = move |scale: f64, point: Point| {
            if cos(point) < FLAT {
                return (direction.into(), 0.0);
            }
            let place = at_angle(point, &|angle| (angle.tan() / scale).atan());
            // Areas of slopes are solid angles over cos³ γ.
            (place.into(), (dot(place, direction) / cos(point)).powi(3))
        };
        let name = format!("with slopes about {axis} that are {{}} times as large");
        all.push(Mistake::scaled(&name, by_slope));
        let by_angle = move |scale: f64, point: Point| {
            let place = at_angle(point, &|angle| (angle / scale).at_most(PI));
            (place.into(), f64::from(sin(point).atan2(cos(point)) <= PI * scale))
        };
        let name = format!("with angles to {axis} that are {{}} times as large");
        all.push(Mistake::scaled(&name, by_angle));
        // Solid angles of caps are 4π sin² γ/2.
        let by_solid_angle = move |scale: f64, point: Point| {
            let height = (1.0 - cos(point)) / (scale * scale);
            let place = at_angle(point, &|_| (1.0 - height).within(-1.0, 1.0).acos());
            (place.into(), f64::from(height <= 2.0))
        };
        let name = format!("with sin γ/2, γ the angle with {axis}, {{}} times as large");
        all.push(Mistake::scaled(&name, by_solid_angle));
        all
    }
}

/// A direction as messages name it.
pub fn name(w: Direction) -> String {
    let [x, y, z] = w.map(|x| if x.abs() < 5e-3 { 0.0 } else { x });
    format!("({x:.2}, {y:.2}, {z:.2})")
}
