//! Where samples lie: sets with a measure, each with a chart of equal areas to the unit square.

use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::fmt::Debug;

/// A set of points with a measure μ, against which densities are meant, and its chart.
///
/// The chart maps the set one to one to \[0, 1)² such that equal areas there are equal measures here. Cells are
/// rectangles of the chart, so that the expected share of a cell is μ(whole) times the integral of the density over it.
pub trait Domain: Sync {
    type Point: Copy + Send + Sync + Debug;

    /// μ of the whole set: 4π for the sphere.
    fn measure(&self) -> f64;

    /// The point's place in the chart; `None` if it is not in the set or not a number.
    fn place(&self, point: Self::Point) -> Option<[f64; 2]>;

    /// The point at a place of \[0, 1\]²: the inverse of [`place`](Self::place).
    fn point(&self, place: [f64; 2]) -> Self::Point;

    /// Whether two points are the same but for rounding: how samples are told to belong to an atom.
    fn same(&self, a: Self::Point, b: Self::Point) -> bool;

    /// Whether the chart's second axis is in use.
    fn is_plane(&self) -> bool {
        true
    }

    /// The number of points of a set that is finite.
    fn outcomes(&self) -> Option<usize> {
        None
    }

    /// What the chart's axes stand for, for figures.
    fn axes(&self) -> [&'static str; 2];
}

/// Points of a finite set, numbered from 0; μ counts points, so that a density is a probability.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Discrete {
    pub outcomes: usize,
}

impl Domain for Discrete {
    type Point = usize;

    fn measure(&self) -> f64 {
        self.outcomes as f64
    }

    fn place(&self, point: usize) -> Option<[f64; 2]> {
        (point < self.outcomes).then(|| [(point as f64 + 0.5) / self.outcomes as f64, 0.5])
    }

    fn point(&self, [x, _]: [f64; 2]) -> usize {
        ((x * self.outcomes as f64) as usize).min(self.outcomes.saturating_sub(1))
    }

    fn same(&self, a: usize, b: usize) -> bool {
        a == b
    }

    fn is_plane(&self) -> bool {
        false
    }

    fn outcomes(&self) -> Option<usize> {
        Some(self.outcomes)
    }

    fn axes(&self) -> [&'static str; 2] {
        ["outcome", ""]
    }
}

/// How far apart two points of one atom may be, in units of the domain's extent: a few roundings of f32.
const ATOM: f64 = 2e-6;

/// The numbers from `from` to `to`; μ is length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    pub from: f64,
    pub to: f64,
}

impl Line {
    /// The numbers from 0 to 1.
    pub const UNIT: Self = Self { from: 0.0, to: 1.0 };
}

/// `x` itself if it is in \[0, 1\], with 1 moved just inside.
fn within(x: f64) -> Option<f64> {
    (0.0..=1.0).contains(&x).then(|| x.min(1f64.next_down()))
}

impl Domain for Line {
    type Point = f64;

    fn measure(&self) -> f64 {
        self.to - self.from
    }

    fn place(&self, point: f64) -> Option<[f64; 2]> {
        Some([within((point - self.from) / (self.to - self.from))?, 0.5])
    }

    fn point(&self, [x, _]: [f64; 2]) -> f64 {
        self.from + x * (self.to - self.from)
    }

    fn same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= ATOM * (self.to - self.from)
    }

    fn is_plane(&self) -> bool {
        false
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", ""]
    }
}

/// Pairs of numbers from 0 to 1; μ is area.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Square;

impl Domain for Square {
    type Point = [f64; 2];

    fn measure(&self) -> f64 {
        1.0
    }

    fn place(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        Some([within(x)?, within(y)?])
    }

    fn point(&self, place: [f64; 2]) -> [f64; 2] {
        place
    }

    fn same(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        (a[0] - b[0]).abs() <= ATOM && (a[1] - b[1]).abs() <= ATOM
    }

    fn axes(&self) -> [&'static str; 2] {
        ["x", "y"]
    }
}

/// Where the chart of directions has its pole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pole {
    /// The normal of the local frame.
    Z,
    /// The zenith of the world.
    Y,
}

/// Unit vectors, all or those of the pole's half; μ is solid angle in sr.
///
/// The chart is ((1 − cos θ)/2 or 1 − cos θ, φ/2π) with θ from the pole: both parts keep their relative precision at the
/// pole, and rectangles follow the plane of incidence, so lobes that are 10⁴ times as high as wide at grazing angles still
/// fit their cells. That is why cells adapt in this chart instead of turning it towards the lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Directions {
    pub pole: Pole,
    /// Whether only cos θ ≥ 0 belongs to the set.
    pub half: bool,
}

impl Directions {
    /// All directions.
    #[must_use]
    pub fn sphere(pole: Pole) -> Self {
        Self { pole, half: false }
    }

    /// Directions with cos θ ≥ 0.
    #[must_use]
    pub fn hemisphere(pole: Pole) -> Self {
        Self { pole, half: true }
    }
}

/// How far from 1 the length of a unit vector may be: rounding of f32, and little more.
const UNIT: f64 = 1e-5;

impl Domain for Directions {
    type Point = DVec3;

    fn measure(&self) -> f64 {
        if self.half { TAU } else { 2.0 * TAU }
    }

    fn place(&self, point: DVec3) -> Option<[f64; 2]> {
        let length = point.length();
        if length.is_nan() || (length - 1.0).abs() > UNIT {
            return None;
        }
        let DVec3 { x, y, z } = point / length;
        let (x, y, z) = match self.pole {
            Pole::Z => (x, y, z),
            Pole::Y => (z, x, y),
        };
        // 1 − z without the subtraction where that would cancel.
        let below = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
        if self.half && z < 0.0 {
            return None;
        }
        // On the horizon of the half, and opposite to the pole, rounding must not leave the chart.
        let below = if self.half { below } else { 0.5 * below };
        Some([below.min(1f64.next_down()), crate::math::circular::turns(y, x)])
    }

    fn point(&self, [below, turns]: [f64; 2]) -> DVec3 {
        let below = if self.half { below } else { 2.0 * below };
        let (sin_phi, cos_phi) = (TAU * turns).sin_cos();
        let (sin, z) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = (sin * cos_phi, sin * sin_phi);
        match self.pole {
            Pole::Z => DVec3::new(x, y, z),
            Pole::Y => DVec3::new(y, z, x),
        }
    }

    fn same(&self, a: DVec3, b: DVec3) -> bool {
        a.distance(b) <= ATOM * PI
    }

    fn axes(&self) -> [&'static str; 2] {
        match self.half {
            true => ["1 - cos θ", "φ / 2π"],
            false => ["(1 - cos θ) / 2", "φ / 2π"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `floor` is the absolute error that a chart without a pole at 0 may add.
    fn returns<D: Domain>(domain: &D, floor: f64) {
        for i in 0..400 {
            let y = if domain.is_plane() { (f64::from(i % 20) + 0.5) / 20.0 } else { 0.5 };
            for x in [(f64::from(i / 20) + 0.5) / 20.0, 10f64.powi(-1 - i / 20)] {
                let back = domain.place(domain.point([x, y])).unwrap();
                assert!((back[0] - x).abs() <= 1e-13 * x + floor && (back[1] - y).abs() < 1e-13, "{x} {y}: {back:?}");
                assert!(domain.same(domain.point([x, y]), domain.point(back)));
            }
        }
        assert!(!domain.same(domain.point([0.1, 0.5]), domain.point([0.9, 0.5])));
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
        assert!((0..6).all(|face| die.point(die.place(face).unwrap()) == face));
    }

    #[test]
    fn equal_areas_are_equal_measures() {
        // The mean of z² is 1/3 over the sphere and over the hemisphere.
        let n = 1000;
        for domain in [Directions::sphere(Pole::Z), Directions::hemisphere(Pole::Z)] {
            let mean = (0..n).map(|i| domain.point([(f64::from(i) + 0.5) / f64::from(n), 0.3]).z.powi(2)).sum::<f64>();
            assert!((mean / f64::from(n) - 1.0 / 3.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_is_outside_has_no_place() {
        let half = Directions::hemisphere(Pole::Z);
        assert_eq!(half.place(DVec3::new(0.0, 0.6, -0.8)), None);
        assert_eq!(half.place(DVec3::new(0.0, 0.6, 0.9)), None);
        assert_eq!(half.place(DVec3::NAN), None);
        assert!(half.place(DVec3::new(1.0 + 1e-7, 1e-7, 1e-16)).is_some(), "just above the horizon, but for rounding");
        assert_eq!(Square.place([0.5, 1.5]), None);
        assert_eq!(Line::UNIT.place(f64::NAN), None);
        assert_eq!(Discrete { outcomes: 6 }.place(6), None);
    }
}
