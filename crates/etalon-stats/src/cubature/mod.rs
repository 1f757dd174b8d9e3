//! Integrals of a density over cells, in f64.
//!
//! Smooth densities: the tensor product of the Gauss–Kronrod rule (7, 15), bisected where the two rules of an axis
//! disagree, for all cells at once and round by round, so that a density in another process is asked in large batches.
//! A rule misses spikes and gaps between its nodes. So the density is also known at probes: where it is not what the nodes
//! around a probe predict, the rectangle is cut further. A check at random points measures what is still missed.
//! Densities that are constant between lines of the chart: exact sums.
//! More than two dimensions: points in the leaves of a tree.

mod check;
mod lattices;
mod pieces;
mod refine;
mod rule;
mod shares;
mod steps;

pub(crate) use check::Check;
pub(crate) use lattices::{LATTICES, Lattices, NOISE, Wanted};
pub(crate) use refine::{Refinement, SLACK};
pub(crate) use shares::Shares;

use crate::domain::{Domain, Point};
use crate::error::{Cancelled, Result};
use crate::grid::{Grid, Subdivision};
use crate::sampler::Density;

/// Integrals over the cells of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrals {
    /// The integrals, in the order of the grid's cells.
    pub values: Vec<f64>,
    /// Estimates of the errors: the root of Σ (K − G)² over a cell's pieces, whose errors have either sign, or more where the density is
    /// known to differ from what the nodes predict; 0 for exact sums. Random points check what the pieces have in common.
    pub errors: Vec<f64>,
    /// The first value of the density that is negative or not finite, nor finite beside a single point.
    pub invalid: Option<InvalidPdf>,
}

/// A value that no pdf can have, and where the density has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InvalidPdf {
    /// The point.
    pub point: Point,
    /// The value there.
    pub value: f64,
}

/// A place of the chart at which the density is known, per area of the chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Probe {
    pub at: [f64; 2],
    pub density: f64,
}

/// How far from a point where a density is infinite it is asked for again, as a share of the way to [`AWAY`]: far enough for
/// coordinates of single precision, and less than a piece of the cubature needs beside a singularity.
const ASIDE: f64 = 1.0 / (1 << 16) as f64;
/// A place of the chart that has nothing to do with any density's symmetries.
const AWAY: [f64; 2] = [0.618_034, 0.381_966];

/// The points at places of the chart, and the density there for sums, per area of the chart: where it is infinite, its value beside.
/// A single point has no part in an integral.
pub(crate) fn values_at(
    domain: &dyn Domain,
    density: &dyn Density,
    charts: &[[f64; 2]],
) -> Result<(Vec<Point>, Vec<f64>)> {
    let points = domain.points_at(charts)?;
    let mut values = Vec::with_capacity(points.len());
    density.pdf(&points, &mut values)?;
    domain.per_chart_area(charts, &mut values)?;
    let is_infinite = |(i, value): (usize, &f64)| (*value == f64::INFINITY).then_some(i);
    let infinite: Vec<usize> = values.iter().enumerate().filter_map(is_infinite).collect();
    if !infinite.is_empty() {
        let aside = |i: &usize| [0, 1].map(|axis| charts[*i][axis] + ASIDE * (AWAY[axis] - charts[*i][axis]));
        let beside: Vec<[f64; 2]> = infinite.iter().map(aside).collect();
        let mut finite = Vec::with_capacity(beside.len());
        density.pdf(&domain.points_at(&beside)?, &mut finite)?;
        domain.per_chart_area(&beside, &mut finite)?;
        infinite.iter().zip(finite).for_each(|(i, value)| values[*i] = value);
    }
    Ok((points, values))
}

/// How the integrals of a density are computed.
pub(crate) enum Integration<'a> {
    /// Exact sums, from declared lines between which the density is constant.
    Exact(Integrals, Shares),
    /// Rules on pieces of the cells.
    Refined(Refinement<'a>),
    /// Points in the leaves of a tree, in more than two dimensions.
    Lattices(Lattices),
}

impl<'a> Integration<'a> {
    /// Integrates `density` over the cells of `grid`, given its values at `probes`, to compare the integrals with counts of `samples` samples.
    pub fn new(
        domain: &'a dyn Domain,
        density: &'a dyn Density,
        grid: &'a Grid,
        samples: f64,
        probes: &[Probe],
        cancelled: Cancelled,
    ) -> Result<Self> {
        Self::with_parts(domain, density, &Subdivision::coarse(grid), samples, probes, cancelled)
    }

    /// [`Integration::new`] over the cells of the grid of `subdivision`, of which [`shares`](Self::shares) may be asked.
    pub fn with_parts(
        domain: &'a dyn Domain,
        density: &'a dyn Density,
        subdivision: &Subdivision<'a>,
        samples: f64,
        probes: &[Probe],
        cancelled: Cancelled,
    ) -> Result<Self> {
        let outcomes = domain.outcomes().map(|n| [(1..n).map(|i| i as f64 / n as f64).collect(), Vec::new()]);
        let declared = || density.steps().filter(|_| domain.is_even());
        Ok(match outcomes.or_else(declared) {
            Some(steps) => {
                let (integrals, shares) = steps::sums(domain, density, subdivision, &steps, cancelled)?;
                Self::Exact(integrals, shares)
            }
            None => Self::Refined(Refinement::new(domain, density, subdivision.grid, samples, probes, cancelled)?),
        })
    }

    /// A place far from all samples at which the density is no number, and counts as 0.
    pub fn far(&self) -> Option<InvalidPdf> {
        match self {
            Self::Exact(..) => None,
            Self::Refined(refinement) => refinement.far(),
            Self::Lattices(lattices) => lattices.far,
        }
    }

    /// The integrals as they are known so far.
    pub fn integrals(&self) -> Integrals {
        match self {
            Self::Exact(integrals, _) => integrals.clone(),
            Self::Refined(refinement) => refinement.integrals(),
            Self::Lattices(lattices) => lattices.integrals.clone(),
        }
    }

    /// The integrals over the parts of `subdivision`, as they are known so far.
    pub fn shares(&self, subdivision: &Subdivision) -> Shares {
        match self {
            Self::Exact(_, shares) => shares.clone(),
            Self::Refined(refinement) => refinement.shares(subdivision),
            Self::Lattices(lattices) => lattices.shares.clone(),
        }
    }
}

/// The integrals of `density` over the cells of `grid`, with respect to the domain's measure.
///
/// # Errors
/// Those of the density, which is also how to end this early.
pub fn integrate(domain: &dyn Domain, density: &dyn Density, grid: &Grid) -> Result<Integrals> {
    Ok(Integration::new(domain, density, grid, f64::INFINITY, &[], || false)?.integrals())
}

/// The first of `values` that is negative or not finite.
pub(crate) fn first_invalid<P: Copy + Into<Point>>(points: &[P], values: &[f64]) -> Option<InvalidPdf> {
    let mut all = points.iter().zip(values).map(|(&point, &value)| InvalidPdf { point: point.into(), value });
    all.find(|InvalidPdf { value, .. }| !(value.is_finite() && *value >= 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Directions, Discrete, Line, Pole, Square};
    use crate::grid::Cell;
    use crate::sampler::density;
    use crate::testing::{combine, dot, ggx_visible, ggx_visible_pdf, normalize, tangents};
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn total(integrals: &Integrals) -> (f64, f64) {
        (integrals.values.iter().sum(), integrals.errors.iter().sum())
    }

    #[test]
    fn smooth_functions_in_each_cell() {
        let f = density(|[x, y]: [f64; 2]| (3.0 * x).exp() * (5.0 * y).cos().powi(2));
        let grid = Grid::equal([3, 4], None);
        let integrals = integrate(&Square, &f, &grid).unwrap();
        let ex = |x: f64| (3.0 * x).exp() / 3.0;
        let ey = |y: f64| 0.5 * y + (10.0 * y).sin() / 20.0;
        for (cell, value) in grid.cells().zip(&integrals.values) {
            let exact = (ex(cell.x[1]) - ex(cell.x[0])) * (ey(cell.y[1]) - ey(cell.y[0]));
            assert!((value - exact).abs() < 1e-10 * exact.abs().max(1e-3), "{value} {exact}");
        }
    }

    #[test]
    fn kinks_and_edges_meet_the_bound() {
        let line = density(|x: f64| if x < 1.0 / 3.0 { 0.0 } else { (x - 1.0 / 3.0).sqrt() });
        let integrals = integrate(&Line::UNIT, &line, &Grid::equal([5, 1], None)).unwrap();
        let exact = 2.0 / 3.0 * (2.0f64 / 3.0).powf(1.5);
        let (value, error) = total(&integrals);
        assert!((value - exact).abs() <= error && error < 5e-5, "{value} {exact} {error}");
        // A disc of the square: a discontinuity that no rectangle follows.
        let disc = density(|[x, y]: [f64; 2]| f64::from(u8::from((x - 0.5).hypot(y - 0.5) < 0.4)));
        let (value, error) = total(&integrate(&Square, &disc, &Grid::equal([4, 4], None)).unwrap());
        let exact = std::f64::consts::PI * 0.16;
        assert!((value - exact).abs() < error.min(1e-4), "{value} {exact} {error}");
    }

    #[test]
    fn a_lobe_that_no_node_sees_is_found_by_the_pilot() {
        // A lobe of 10⁻⁵ radians around an arbitrary direction.
        let axis = normalize([0.3, 0.5, 0.4]);
        let kappa = 1e10;
        let pdf = move |w: [f64; 3]| {
            let apart = [0, 1, 2].map(|i| w[i] - axis[i]);
            kappa / std::f64::consts::TAU * (-0.5 * kappa * dot(apart, apart)).exp()
        };
        let lobe = density(pdf);
        let domain = Directions::sphere(Pole::Z);
        let [t, b] = tangents(axis);
        let pilot: Vec<[f64; 2]> = (1..1000)
            .map(|i| {
                let (r, phi) = ((-2.0 * (f64::from(i) / 1000.0).ln() / kappa).sqrt(), f64::from(i) * 2.4);
                let w = combine([(1.0, axis), (r * phi.cos(), t), (r * phi.sin(), b)]);
                domain.to_chart(normalize(w).into()).unwrap()
            })
            .collect();
        let probes: Vec<Probe> =
            pilot.iter().map(|&at| Probe { at, density: domain.measure() * pdf(domain.direction_at(at)) }).collect();
        let blind = total(&integrate(&domain, &lobe, &Grid::equal([10, 20], None)).unwrap()).0;
        assert!(blind < 0.5, "{blind}");
        for grid in [Grid::equal([10, 20], None), Grid::adapted(&pilot, [10, 20], Cell::WHOLE, None)] {
            let (value, error) =
                total(&Integration::new(&domain, &lobe, &grid, f64::INFINITY, &probes, || false).unwrap().integrals());
            assert!((value - 1.0).abs() < 1e-6 + error && error < 1e-4, "{value} {error}");
        }
    }

    #[test]
    fn a_lobe_in_the_corner_of_wide_cells_is_found() {
        // Visible normals of GGX near grazing: in the cells opposite to the view the density ends 10⁻⁴ from the pole.
        let domain = Directions::hemisphere(Pole::Z);
        for alpha in [0.05, 0.25] {
            let (sin, cos) = 89f64.to_radians().sin_cos();
            let wo = [sin, 0.0, cos];
            let pdf = move |wm: [f64; 3]| ggx_visible_pdf(wo, alpha, wm);
            let probe = |i: u32| {
                let u = [f64::from(i) / f64::from(1 << 14), (f64::from(i) * 0.618_034).fract()];
                let at = domain.to_chart(ggx_visible(wo, alpha, u).into()).unwrap();
                Probe { at, density: domain.measure() * pdf(domain.direction_at(at)) }
            };
            let probes: Vec<Probe> = (0..1 << 14).map(probe).collect();
            let (visible, grid) = (density(pdf), Grid::equal([10, 20], None));
            let integration = Integration::new(&domain, &visible, &grid, f64::INFINITY, &probes, || false).unwrap();
            let (value, error) = total(&integration.integrals());
            // What holds fewer than four probes of the pilot may still be missed.
            assert!((value - 1.0).abs() < 5e-5 && error < 5e-5, "{alpha}: {value} {error}");
        }
    }

    #[test]
    fn steps_are_summed_exactly() {
        let die = density(|face: usize| [0.1, 0.2, 0.3, 0.0, 0.25, 0.15][face]);
        let integrals = integrate(&Discrete { outcomes: 6 }, &die, &Grid::equal([3, 1], Some(6))).unwrap();
        for (value, exact) in integrals.values.iter().zip([0.3, 0.3, 0.4]) {
            assert!((value - exact).abs() < 1e-15);
        }
        let stairs = density(|[x, y]: [f64; 2]| if (x < 0.3) == (y < 0.7) { 1.5 } else { 0.25 });
        let stairs = stairs.with_steps([vec![0.3], vec![0.7]]);
        let (value, error) = total(&integrate(&Square, &stairs, &Grid::equal([7, 3], None)).unwrap());
        assert!((value - (0.42 * 1.25 + 0.25)).abs() < 1e-14 && error == 0.0);
    }

    #[test]
    fn impossible_values_are_reported() {
        let f = density(|x: f64| if x > 0.9 { f64::NAN } else { 1.0 });
        assert!(integrate(&Line::UNIT, &f, &Grid::equal([5, 1], None)).unwrap().invalid.is_some());
        let f = density(|x: f64| 0.5 - x);
        assert!(integrate(&Line::UNIT, &f, &Grid::equal([5, 1], None)).unwrap().invalid.unwrap().value < 0.0);
    }

    #[test]
    fn a_strip_between_the_nodes_is_measured_and_integrated_where_it_was_found() {
        // Too high by 0.9 in a strip that has no node of any piece.
        let (from, width) = (0.518_05, 1e-4);
        let strip = density(move |[x, _]: [f64; 2]| if (from..from + width).contains(&x) { 1.9 } else { 1.0 });
        let grid = Grid::equal([10, 20], None);
        let mut refinement = Refinement::new(&Square, &strip, &grid, f64::INFINITY, &[], || false).unwrap();
        assert!((total(&refinement.integrals()).0 - 1.0).abs() < 1e-12, "no rule sees it");
        let check = refinement.check(1 << 18, 1, 0).unwrap();
        let mean = check.reach * (check.total(0) - check.total(1)) / check.count as f64;
        let sees = refinement.share_within(&Probe { at: [from + 0.5 * width, 0.5], density: 1.9 });
        assert!((sees - 1.25 / 1.9).abs() < 1e-12 && !check.found.is_empty());
        // Up to 1.25, in a share of 10⁻⁴ of the places: 26 of them.
        assert!((mean - 0.25 * width).abs() < 4.0 * 0.25 * (width / check.count as f64).sqrt(), "{mean}");
        refinement.learn(&check.found).unwrap();
        let (value, error) = total(&refinement.integrals());
        assert!((1.0 + 1e-6..1.0 + 0.9 * width + error).contains(&value), "{value} {error}");
    }

    #[test]
    fn edges_take_as_many_values_as_the_samples_need() {
        let asked = AtomicUsize::new(0);
        let triangle = density(|[x, y]: [f64; 2]| {
            asked.fetch_add(1, Ordering::Relaxed);
            let (a, b) = ((0.8125 * (x - 0.1) - 0.25 * (y - 0.1)) / 0.6, (0.8 * (y - 0.1) - 0.15 * (x - 0.1)) / 0.6);
            f64::from(u8::from(a >= 0.0 && b >= 0.0 && a + b <= 1.0))
        });
        let (area, grid) = (0.18 / 0.6125, Grid::equal([10, 20], None));
        let values = [1e4, f64::INFINITY].map(|samples| {
            let before = asked.load(Ordering::Relaxed);
            let integrals = Integration::new(&Square, &triangle, &grid, samples, &[], || false).unwrap().integrals();
            let (value, error) = total(&integrals);
            assert!((value - area).abs() < error && error < 3e-4, "{value} ± {error}");
            asked.load(Ordering::Relaxed) - before
        });
        assert!(8 * values[0] < values[1], "{values:?}");
    }
}
