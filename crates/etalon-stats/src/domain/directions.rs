//! Directions: the sphere and the hemisphere.

use super::chart::{OUTSIDE, of_closures};
use super::{ATOM, Chart, ChartFunctions, Domain, OFF, Place, Point, equal_parts, place};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::mistakes::{Mistake, Variable};
use etalon_random::turns;
use std::f64::consts::{PI, TAU};

/// The axis of a chart of directions, from which θ is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pole {
    /// The normal of the local frame; φ goes from +x towards +y.
    Z,
    /// The zenith of the world; φ goes from +z towards +x.
    Y,
}

/// Unit vectors, all or those of the pole's hemisphere; μ is solid angle in sr.
///
/// The chart is ((1 − cos θ)/2 or 1 − cos θ, φ/2π) with θ from the pole. Both coordinates keep their relative precision at
/// the pole, and rectangles follow the plane of incidence, so that lobes that are 10⁴ times as high as wide at grazing angles
/// still fit their cells. This is why cells adapt in this chart and the chart is not rotated towards the lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Directions {
    /// The axis of the chart.
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

    /// The direction at chart coordinates: [`point_at`](Domain::point_at).
    #[inline]
    #[must_use]
    pub fn direction_at(&self, [below, turns]: [f64; 2]) -> [f64; 3] {
        let below = if self.half { below } else { 2.0 * below };
        let (sin_phi, cos_phi) = (TAU * turns).sin_cos();
        let (sin, z) = ((below * (2.0 - below)).at_least(0.0).sqrt(), 1.0 - below);
        let (x, y) = (sin * cos_phi, sin * sin_phi);
        match self.pole {
            Pole::Z => [x, y, z],
            Pole::Y => [y, z, x],
        }
    }

    /// The cosine of the angle with the pole.
    fn cos(&self, point: Point) -> f64 {
        let [_, y, z] = point.into();
        if self.pole == Pole::Z { z } else { y }
    }

    /// The pdf in the frames whose axes are other ones, or point the other way: those of a hemisphere have its pole.
    fn frames(&self) -> Vec<Mistake<'_>> {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
        let pole = if self.pole == Pole::Z { 2 } else { 1 };
        let is_kept = |order: [usize; 3], signs: [f64; 3]| !self.half || order[pole] == pole && signs[pole] > 0.0;
        // The usual ones first: the opposite direction, then those with few signs
        const SIGNS: [usize; 8] = [0, 7, 1, 2, 4, 3, 5, 6];
        let mut all = Vec::new();
        for (order, bits) in ORDERS.into_iter().flat_map(|order| SIGNS.map(|bits| (order, bits))).skip(1) {
            let signs = [0, 1, 2].map(|i| if bits >> i & 1 == 0 { 1.0 } else { -1.0 });
            let [x, y, z] =
                [0, 1, 2].map(|i| format!("{}{}", if signs[i] < 0.0 { "-" } else { "" }, ["x", "y", "z"][order[i]]));
            let name = match (order, bits) {
                ([0, 1, 2], 7) => "at the opposite direction".to_owned(),
                ([1, 0, 2], 0) => "with x and y exchanged".to_owned(),
                ([0, 2, 1], 0) => "with y and z exchanged".to_owned(),
                ([2, 1, 0], 0) => "with x and z exchanged".to_owned(),
                _ => format!("at ({x}, {y}, {z})"),
            };
            let place = move |point: Point| {
                let w: [f64; 3] = point.into();
                [0, 1, 2].map(|i| signs[i] * w[order[i]]).into()
            };
            all.extend(is_kept(order, signs).then(|| Mistake::at(&name, place)));
        }
        all
    }

    /// The angles with the pole, in degrees, at the ends of a range of the chart's first coordinate.
    fn theta(&self, range: [f64; 2]) -> [f64; 2] {
        // 1 − cos θ = 2 sin² (θ/2), which keeps small angles precise.
        range.map(|x| 2.0 * (if self.half { 0.5 * x } else { x }).sqrt().asin().to_degrees())
    }
}

/// All directions, in leaves, for densities that jump: the chart of the cylinder round the axis that is most at right angles to `middle`,
/// the direction that is in the middle of the chart.
pub(crate) fn around(middle: [f64; 3]) -> Chart<impl ChartFunctions> {
    let pole = (0..3).min_by(|&i, &j| middle[i].abs().total_cmp(&middle[j].abs())).unwrap_or(2);
    let [x, y] = [1, 2].map(|i| (pole + i) % 3);
    let across = middle[x].hypot(middle[y]);
    let [c, s] = if across > 0.0 { [middle[x] / across, middle[y] / across] } else { [1.0, 0.0] };
    let to_cube = move |point: Point| {
        let w = <[f64; 3]>::from(point);
        let is_unit = (length(w) - 1.0).abs() <= OFF;
        let turn = (c * w[y] - s * w[x]).atan2(c * w[x] + s * w[y]) / TAU;
        if is_unit { place(&[(0.5 + 0.5 * w[pole]).within(0.0, 1.0), 0.5 + turn]) } else { OUTSIDE }
    };
    let from_cube = move |at: Place| {
        let (z, (sin, cos)) = (2.0 * at[0] - 1.0, (TAU * (at[1] - 0.5)).sin_cos());
        let r = (1.0 - z * z).at_least(0.0).sqrt();
        let mut w = [z; 3];
        (w[x], w[y]) = (r * (c * cos - s * sin), r * (s * cos + c * sin));
        w.into()
    };
    let axis = ["x", "y", "z"][pole];
    let axes = vec![format!("(1 + {axis}) / 2"), format!("turns about {axis} from the middle")];
    of_closures(2, to_cube, from_cube, |_| 2.0 * TAU).even(2.0 * TAU).with_axes(axes).in_leaves()
}

/// The sine of θ up to which densities in proportion to 1/sin θ are not compared: points do not tell their integrals there.
const AT_POLE: f64 = 0.05;

#[inline]
fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

impl Domain for Directions {
    #[inline]
    fn measure(&self) -> f64 {
        if self.half { TAU } else { 2.0 * TAU }
    }

    #[inline]
    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        let point = <[f64; 3]>::from(point);
        let norm = length(point);
        if norm.is_nan() || (norm - 1.0).abs() > OFF {
            return None;
        }
        // The frame with the pole at +z.
        let [x, y, z] = point.map(|v| v / norm);
        let (x, y, z) = match self.pole {
            Pole::Z => (x, y, z),
            Pole::Y => (z, x, y),
        };
        if self.half && z < 0.0 {
            return None;
        }
        // 1 − cos θ = sin² θ / (1 + cos θ), without the subtraction where that would cancel.
        let below = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
        let below = if self.half { below } else { 0.5 * below };
        // On the horizon of the hemisphere, and opposite to the pole, rounding must not leave the chart.
        Some([below.at_most(1f64.next_down()), turns(y, x)])
    }

    #[inline]
    fn point_at(&self, chart: [f64; 2]) -> Point {
        self.direction_at(chart).into()
    }

    #[inline]
    fn same(&self, a: Point, b: Point) -> bool {
        let (a, b) = (<[f64; 3]>::from(a), <[f64; 3]>::from(b));
        length([a[0] - b[0], a[1] - b[1], a[2] - b[2]]) <= ATOM * PI
    }

    fn axes(&self) -> [&str; 2] {
        match self.half {
            true => ["1 - cos θ", "φ / 2π"],
            false => ["(1 - cos θ) / 2", "φ / 2π"],
        }
    }

    fn coordinates(&self) -> [&str; 2] {
        ["cos θ", "φ"]
    }

    fn at_angles(&self, [theta, phi]: [f64; 2]) -> Option<Point> {
        let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
        // φ of a lat-long image goes from +x towards +z.
        Some(match self.pole {
            Pole::Z => [sin * cos_phi, sin * sin_phi, cos].into(),
            Pole::Y => [sin * cos_phi, cos, sin * sin_phi].into(),
        })
    }

    /// Equal steps of θ from the pole in rows, of φ from +x towards +y (for the pole +y: towards +z) in columns.
    fn table(&self, [rows, columns]: [usize; 2]) -> Option<[Vec<f64>; 2]> {
        // Equal steps of θ: the chart's coordinate is sin² (θ/2), twice that for a hemisphere.
        let along_first = |t: f64| match self.half {
            true => 2.0 * (0.25 * PI * t).sin().powi(2),
            false => (0.5 * PI * t).sin().powi(2),
        };
        Some([equal_parts(rows).into_iter().map(along_first).collect(), equal_parts(columns)])
    }

    fn hint(&self, outside: Point) -> String {
        let length = length(outside.into());
        if (length - 1.0).abs() > 1e-4 { format!(": its length is {length:.6}") } else { String::new() }
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        vec![
            Variable::new("cos θ", |w| self.cos(w).abs()).of(|_| String::new()),
            Variable::new("sin θ", |w| (1.0 - self.cos(w).powi(2)).at_least(0.0).sqrt()),
        ]
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let cos = |point: Point| self.cos(point);
        let sin = move |point| (1.0 - cos(point).powi(2)).at_least(0.0).sqrt();
        let known = move |point| Some(sin(point)).filter(|sin| *sin > AT_POLE).unwrap_or(f64::NAN);
        let upper = move |point| cos(point).at_least(0.0);
        let cube = |point: Point| <[f64; 3]>::from(point).map(f64::abs).into_iter().fold(0.0, f64::at_least).powi(-3);
        let mut all = vec![
            Mistake::density("cos θ/π", upper),
            Mistake::density(
                "a density in proportion to 1/sin θ (θ is uniform, without the factor sin θ)",
                move |w| 1.0 / known(w),
            ),
            Mistake::density(
                "a density in proportion to cos θ/sin θ (the radius of a disk is u, not √u)",
                move |w| upper(w) / known(w),
            ),
            Mistake::density("the density of points of a cube, normalised", cube),
        ];
        if !self.half {
            all.push(Mistake::density("a uniform density over the hemisphere", move |w| f64::from(cos(w) > 0.0)));
        }
        all.extend(self.frames());
        let turned = move |degrees: f64, w: Point| {
            let ([x, y, z], (sin, cos)) = (w.into(), degrees.to_radians().sin_cos());
            let back: [f64; 3] = match self.pole {
                Pole::Z => [cos * x + sin * y, cos * y - sin * x, z],
                Pole::Y => [cos * x - sin * z, y, cos * z + sin * x],
            };
            back.into()
        };
        all.push(Mistake::moved("turned by {}° about the pole", [-180.0, 180.0], turned));
        all
    }

    fn region(&self, cell: &Cell) -> String {
        let ([t0, t1], [p0, p1]) = (self.theta(cell.x), cell.y.map(|y| 360.0 * y));
        format!("theta {}°..{}°, phi {}°..{}°", degrees(t0), degrees(t1), degrees(p0), degrees(p1))
    }

    fn in_words(&self, cell: &Cell) -> String {
        let [t0, t1] = self.theta(cell.x);
        let horizon = |t: f64| (t - 90.0).abs() < 1e-6;
        if *cell == Cell::WHOLE {
            return "in total".to_owned();
        }
        let place = match (cell.x == [0.0, 1.0], t0 == 0.0, cell.x[1] == 1.0 && !self.half) {
            (true, ..) => "for all theta".to_owned(),
            (_, true, _) if horizon(t1) => "above the horizon".to_owned(),
            (_, true, _) if t1 < POLAR => format!("within {}° of theta = 0", degrees(t1)),
            (_, _, true) if horizon(t0) => "below the horizon".to_owned(),
            (_, _, true) if t0 > 180.0 - POLAR => format!("within {}° of theta = 180°", degrees(180.0 - t0)),
            _ if horizon(t1) && t0 > 90.0 - NEAR => format!("within {}° of the horizon", degrees(90.0 - t0)),
            _ if horizon(t0) && t1 < 90.0 + NEAR => format!("within {}° below the horizon", degrees(t1 - 90.0)),
            _ => format!("for theta {}°..{}°", degrees(t0), degrees(t1)),
        };
        let [p0, p1] = cell.y.map(|y| 360.0 * y);
        if cell.y == [0.0, 1.0] { place } else { format!("{place}, phi {}°..{}°", degrees(p0), degrees(p1)) }
    }
}

/// Degrees within which a place is near a pole, and near the horizon: places that reach further are named by their limits.
const POLAR: f64 = 75.0;
const NEAR: f64 = 45.0;

/// Degrees with two decimals, or three significant digits where those would be 0.00.
fn degrees(x: f64) -> String {
    if x == 0.0 || x >= 0.1 { format!("{x:.2}") } else { format!("{x:.2e}") }
}
