//! Cells of domains of more than two dimensions: a tree halves the unit cube, again and again, at the median of a pilot's samples.
//!
//! Leaf number i of the L leaves is the interval from i/L to (i + 1)/L of a chart with one axis, on which tests count. Numbers 2i and
//! 2i + 1 are halves of one box at every level, so that the scales of this axis are those of boxes.

use crate::domain::{Domain, Place, Point, Space, inside, place, steps};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};

/// Pilot samples in a leaf, at least.
const FEWEST: usize = 4;

/// An axis of the cube, stretched so that about equally many samples of the pilot lie in equal parts: a density that is a product of densities
/// along the axes is nearly constant then. Source: Lepage, "A New Algorithm for Adaptive Multidimensional Integration" (VEGAS),
/// Journal of Computational Physics 27, 1978.
struct Stretch {
    /// Lines across the axis, and the share of samples below each.
    lines: Vec<f64>,
    shares: Vec<f64>,
}

impl Stretch {
    fn new(mut pilot: Vec<f64>) -> Self {
        const PARTS: usize = 32;
        pilot.sort_by(f64::total_cmp);
        // The outermost parts are halved until they hold one sample: a density that ends there would hide in a wider part.
        let halvings = (pilot.len() / PARTS).checked_ilog2().map_or(0, |halvings| halvings as i32);
        let halved = |k: i32| 0.5f64.powi(k) / PARTS as f64;
        let ends = (1..=halvings).rev().map(halved).chain((1..PARTS).map(|i| i as f64 / PARTS as f64));
        let shares = ends.chain((1..=halvings).map(|k| 1.0 - halved(k)));
        let line = |share: f64| {
            let above = (share * pilot.len() as f64).round() as usize;
            (share, 0.5 * (pilot[above - 1] + pilot[above]))
        };
        let is_known = |share: &f64| (1..pilot.len()).contains(&((share * pilot.len() as f64).round() as usize));
        let inner: Vec<(f64, f64)> = shares.filter(is_known).map(line).collect();
        let all: Vec<(f64, f64)> = [(0.0, 0.0)].into_iter().chain(inner).chain([(1.0, 1.0)]).collect();
        // Samples that share a coordinate, as indices do, leave the axis as it is.
        let is_good = all.windows(2).all(|pair| pair[0].1 < pair[1].1);
        let (shares, lines) = if is_good { all.into_iter().unzip() } else { (vec![0.0, 1.0], vec![0.0, 1.0]) };
        Self { lines, shares }
    }

    /// The coordinate on an axis after the stretch or before it, and its derivative there.
    #[inline]
    fn map(at: f64, from: &[f64], to: &[f64]) -> (f64, f64) {
        let part = from[1..from.len() - 1].partition_point(|&line| line <= at);
        let slope = (to[part + 1] - to[part]) / (from[part + 1] - from[part]);
        (to[part] + (at - from[part]) * slope, slope)
    }

    #[inline]
    fn stretched(&self, u: f64) -> (f64, f64) {
        Self::map(u, &self.lines, &self.shares)
    }

    #[inline]
    fn unstretched(&self, v: f64) -> (f64, f64) {
        Self::map(v, &self.shares, &self.lines)
    }
}

/// The sides of a box of stretched coordinates.
type Sides = Vec<[f64; 2]>;

/// A domain of more than two dimensions in leaves.
pub struct Leaves<'a> {
    domain: &'a dyn Domain,
    pub space: Space<'a>,
    axes: Vec<Stretch>,
    /// The axis and the coordinate at which each inner node is cut: those of node i are nodes 2i and 2i + 1, the root is 1.
    cuts: Vec<(usize, f64)>,
    leaves: Vec<Sides>,
    /// The places of the pilot's samples in the cube, and the box around them.
    pilot: Vec<Place>,
    sampled: Sides,
    /// Weights of the coordinates in the place of a sample in its leaf's interval, which tells samples apart.
    steps: Vec<f64>,
}

impl<'a> Leaves<'a> {
    /// 2ᵇ leaves for `bits` b, or fewer where the samples of the pilot are few.
    pub fn new(domain: &'a dyn Domain, space: Space<'a>, pilot: &[Point], bits: u32) -> Result<Self> {
        let dimension = space.axes.len();
        let pilot = places(&space, pilot)?;
        let along = |axis: usize| pilot.iter().map(move |place| place[axis]);
        let ends = |axis| [along(axis).fold(1.0, f64::at_most), along(axis).fold(0.0, f64::at_least)];
        let sampled = (0..dimension).map(ends).collect();
        let axes: Vec<Stretch> = (0..dimension).map(|axis| Stretch::new(along(axis).collect())).collect();
        let mut stretched = pilot.clone();
        for place in &mut stretched {
            place.iter_mut().zip(&axes).for_each(|(u, axis)| *u = axis.stretched(*u).0);
        }
        let bits = bits.min((pilot.len() / FEWEST).checked_ilog2().unwrap_or(0));
        let (mut cuts, mut leaves) = (vec![(0, 0.0)], vec![(vec![[0.0, 1.0]; dimension], stretched)]);
        for _ in 0..bits {
            let halves = |(mut below, samples): (Sides, Vec<Place>)| {
                let (axis, at) = cut(&below, &samples);
                cuts.push((axis, at));
                let mut above = below.clone();
                (below[axis][1], above[axis][0]) = (at, at);
                let (low, high) = samples.into_iter().partition(|sample| sample[axis] < at);
                [(below, low), (above, high)]
            };
            leaves = leaves.into_iter().flat_map(halves).collect();
        }
        let leaves = leaves.into_iter().map(|(sides, _)| sides).collect();
        Ok(Self { domain, space, axes, cuts, leaves, pilot, sampled, steps: steps(dimension) })
    }

    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// The number of halvings.
    pub fn bits(&self) -> u32 {
        self.len().ilog2()
    }

    /// About `cells` cells of equally many leaves.
    pub fn grid(&self, cells: usize) -> Grid {
        let bits = (cells as f64).log2().round() as u32;
        Grid::equal([1 << bits.min(self.bits()), 1], None)
    }

    /// The place of a leaf at coordinates from 0 to 1 along its sides, and what makes a density there one per length of the chart.
    pub fn place(&self, leaf: usize, at: impl Iterator<Item = f64>) -> (Place, f64) {
        let (mut found, mut factor) = (place(&[]), self.len() as f64);
        for (((u, at), [from, to]), axis) in found.iter_mut().zip(at).zip(&self.leaves[leaf]).zip(&self.axes) {
            let slope;
            (*u, slope) = axis.unstretched(from + at * (to - from));
            factor *= slope * (to - from);
        }
        (found, factor)
    }

    /// Whether the domain has no far ends.
    pub fn is_bounded(&self) -> bool {
        self.domain.is_even()
    }

    /// Whether a place of the cube is within the samples of the pilot along all axes.
    pub fn is_sampled(&self, place: &Place) -> bool {
        self.sampled.iter().zip(place).all(|([from, to], u)| (*from..=*to).contains(u))
    }

    /// The places of the pilot's samples in the cube.
    pub fn pilot(&self) -> &[Place] {
        &self.pilot
    }

    /// The places of samples in the cube, of those that are in the domain.
    pub fn places(&self, samples: &[Point]) -> Result<Vec<Place>> {
        places(&self.space, samples)
    }

    /// The leaf at a place of the cube, the stretched place, and what makes a density there one per length of the chart.
    pub fn find(&self, place: &Place) -> (usize, Place, f64) {
        let (mut stretched, mut factor) = (*place, self.len() as f64);
        for (v, axis) in stretched.iter_mut().zip(&self.axes) {
            let slope;
            (*v, slope) = axis.stretched(*v);
            factor /= slope;
        }
        let mut node = 1;
        while node < self.len() {
            let (axis, at) = self.cuts[node];
            node = 2 * node + usize::from(stretched[axis] >= at);
        }
        let leaf = node - self.len();
        let volume: f64 = self.leaves[leaf].iter().map(|[from, to]| to - from).product();
        (leaf, stretched, factor * volume)
    }

    /// A stretched place of a leaf, from 0 to 1 along its sides.
    pub fn within(&self, leaf: usize, mut stretched: Place) -> Place {
        for (v, [from, to]) in stretched.iter_mut().zip(&self.leaves[leaf]) {
            *v = (*v - from) / (to - from);
        }
        stretched
    }
}

fn places(space: &Space, samples: &[Point]) -> Result<Vec<Place>> {
    let places = space.functions.to_cube(samples)?.into_iter().map(inside);
    Ok(places.filter(|place| !place[0].is_nan()).collect())
}

/// Where a box is cut: across its longest side, at the median of its samples; across another, if these agree along it.
fn cut(sides: &Sides, samples: &[Place]) -> (usize, f64) {
    let length = |axis: usize| sides[axis][1] - sides[axis][0];
    let mut axes: Vec<usize> = (0..sides.len()).collect();
    axes.sort_by(|&a, &b| length(b).total_cmp(&length(a)));
    let median = |&axis: &usize| {
        let mut along: Vec<f64> = samples.iter().map(|sample| sample[axis]).collect();
        along.sort_by(f64::total_cmp);
        let between = |i: usize| 0.5 * (along[i - 1] + along[i]);
        let middle = along.len() / 2;
        let found = (middle.max(1)..along.len()).chain((1..middle).rev()).find(|&i| along[i - 1] < along[i])?;
        Some((axis, between(found))).filter(|(_, at)| sides[axis][0] < *at && *at < sides[axis][1])
    };
    axes.iter().find_map(median).unwrap_or((axes[0], 0.5 * (sides[axes[0]][0] + sides[axes[0]][1])))
}

/// The chart with one axis. Its second coordinate, which is in no use, has what makes a density at the sample one per length of the chart.
impl Domain for Leaves<'_> {
    fn measure(&self) -> f64 {
        self.domain.measure()
    }

    fn to_chart(&self, point: Point) -> Option<[f64; 2]> {
        self.charts(&[point]).ok()?.pop().filter(|at| !at[0].is_nan())
    }

    /// The middle of the leaf.
    fn point_at(&self, chart: [f64; 2]) -> Point {
        self.points_at(&[chart]).ok().and_then(|mut points| points.pop()).unwrap_or(f64::NAN.into())
    }

    fn same(&self, a: Point, b: Point) -> bool {
        self.domain.same(a, b)
    }

    fn is_even(&self) -> bool {
        false
    }

    fn charts(&self, points: &[Point]) -> Result<Vec<[f64; 2]>> {
        let places: Vec<Place> = self.space.functions.to_cube(points)?.into_iter().map(inside).collect();
        let known: Vec<Place> = places.iter().filter(|place| !place[0].is_nan()).copied().collect();
        let mut jacobians = self.space.functions.jacobian(&known)?.into_iter();
        let chart = |place: &Place| {
            if place[0].is_nan() {
                return [f64::NAN; 2];
            }
            let (leaf, _, factor) = self.find(place);
            let inside = self.steps.iter().zip(place).map(|(step, u)| step * u).sum::<f64>().fract();
            let [from, to] = [leaf, leaf + 1].map(|leaf| leaf as f64 / self.len() as f64);
            [(from + inside * (to - from)).at_most(to.next_down()), factor * jacobians.next().unwrap_or(f64::NAN)]
        };
        Ok(places.iter().map(chart).collect())
    }

    fn points_at(&self, charts: &[[f64; 2]]) -> Result<Vec<Point>> {
        let leaf = |x: f64| ((x * self.len() as f64) as usize).min(self.len() - 1);
        let place = |at: &[f64; 2]| self.place(leaf(at[0]), std::iter::repeat(0.5)).0;
        self.space.functions.from_cube(&charts.iter().map(place).collect::<Vec<_>>())
    }

    fn per_chart_area(&self, charts: &[[f64; 2]], pdfs: &mut [f64]) -> Result<()> {
        let known = pdfs.iter_mut().zip(charts).filter(|(pdf, _)| **pdf != 0.0);
        known.for_each(|(pdf, [_, factor])| *pdf *= factor);
        Ok(())
    }

    fn is_plane(&self) -> bool {
        false
    }

    fn axes(&self) -> [&str; 2] {
        ["boxes", ""]
    }

    fn told(&self, _: usize, at: f64) -> String {
        format!("place {}", self.region(&Cell { x: [at, at], ..Cell::WHOLE }))
    }

    fn point(&self, coordinates: &[f64]) -> Option<Point> {
        self.domain.point(coordinates)
    }

    fn names(&self) -> Vec<&'static str> {
        self.domain.names()
    }

    fn hint(&self, outside: Point) -> String {
        self.domain.hint(outside)
    }

    /// The box around the leaves, in coordinates of points where these tell them.
    fn region(&self, cell: &Cell) -> String {
        let [first, end] = cell.x.map(|x| x * self.len() as f64);
        let first = (first as usize).min(self.len() - 1);
        let leaves = &self.leaves[first..(end.ceil() as usize).max(first + 1)];
        let mut around = leaves[0].clone();
        for (side, [from, to]) in leaves.iter().flat_map(|leaf| (0..).zip(leaf)) {
            let side: &mut [f64; 2] = &mut around[side];
            *side = [side[0].at_most(*from), side[1].at_least(*to)];
        }
        let volume = |sides: &Sides| sides.iter().map(|[from, to]| to - from).product::<f64>();
        let is_box = leaves.iter().map(volume).sum::<f64>() > 0.999 * volume(&around);

        let Space { functions, axes, is_product } = &self.space;
        let ends = [0, 1].map(|end| {
            let along = |(side, axis): (&[f64; 2], &Stretch)| axis.unstretched(side[end]).0.at_most(1f64.next_down());
            place(&around.iter().zip(&self.axes).map(along).collect::<Vec<_>>())
        });
        let points = functions.from_cube(&ends).ok().filter(|points| *is_product && points.len() == 2);
        let names: Vec<&str> = if points.is_some() { self.names() } else { axes.iter().map(|axis| &**axis).collect() };
        let number = |end: usize, axis: usize| {
            let x = points.as_ref().map_or(ends[end][axis], |points| points[end].coordinates()[axis]);
            if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.2e}") }
        };
        let words = |(axis, side): (usize, &[f64; 2])| match side {
            [0.0, 1.0] => None,
            [0.0, _] => Some(format!("{} up to {}", names[axis], number(1, axis))),
            [_, 1.0] => Some(format!("{} from {}", names[axis], number(0, axis))),
            _ => Some(format!("{} {}..{}", names[axis], number(0, axis), number(1, axis))),
        };
        let words = around.iter().enumerate().filter_map(words).collect::<Vec<_>>().join(", ");
        let words = if words.is_empty() { "the whole".to_owned() } else { words };
        if is_box { words } else { format!("part of {words}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::named;

    #[test]
    fn places_of_a_leaf_are_found_in_it_and_leaves_fill_the_cube() {
        for name in ["ball", "3*simplex:7"] {
            let domain = named(name).unwrap();
            let space = || domain.space().unwrap();
            let along = |i: usize| move |step: &f64| (0.5 + step * (i as f64 + 1.0)).fract();
            let spread: Vec<Place> =
                (0..4096).map(|i| place(&steps(space().axes.len()).iter().map(along(i)).collect::<Vec<_>>())).collect();
            let pilot = space().functions.from_cube(&spread).unwrap();
            let leaves = Leaves::new(&*domain, space(), &pilot, 8).unwrap();
            let volume = |sides: &Sides| sides.iter().map(|[from, to]| to - from).product::<f64>();
            assert!(leaves.len() == 256 && (leaves.leaves.iter().map(volume).sum::<f64>() - 1.0).abs() < 1e-12);
            for (leaf, at) in spread.iter().take(leaves.len()).enumerate() {
                let (place, factor) = leaves.place(leaf, at.iter().copied());
                let (found, stretched, again) = leaves.find(&place);
                assert!(
                    found == leaf && (again / factor - 1.0).abs() < 1e-9,
                    "{name} {leaf}: {found} {again} {factor}"
                );
                let within = leaves.within(leaf, stretched);
                assert!(within.iter().zip(at).take(3).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }
}
