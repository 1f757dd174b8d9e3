//! Vectors of three numbers.

use super::contract::Direction;
use crate::domain::{Directions, Domain, Pole};
use crate::point::Point;

/// The sphere of all directions, with the chart in which cells are rectangles.
pub fn sphere() -> Directions {
    Directions::sphere(Pole::Z)
}

/// Points of the sphere as directions.
pub fn directions(points: &[Point]) -> Vec<Direction> {
    points.iter().map(|point| Direction::from(*point)).collect()
}

pub fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Direction, b: Direction) -> Direction {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn length(a: Direction) -> f64 {
    dot(a, a).sqrt()
}

/// Whether both are on one side of the surface.
pub fn same_side(a: Direction, b: Direction) -> bool {
    a[2] * b[2] > 0.0
}

/// A direction by its angles in degrees, as messages name it.
pub fn place(w: Direction) -> String {
    let Some([below, turns]) = sphere().to_chart(w.into()) else { return format!("({}, {}, {})", w[0], w[1], w[2]) };
    let theta = 2.0 * below.sqrt().asin().to_degrees();
    format!("({theta:.4}°, {:.2}°)", 360.0 * turns)
}
