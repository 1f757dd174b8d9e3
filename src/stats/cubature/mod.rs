//! Integrals of a density over cells, in f64 with error bounds.
//!
//! Smooth densities: the tensor product of the Gauss–Kronrod rule (7, 15), bisected where the two rules of an axis
//! disagree, for all cells at once and round by round, so that a density in another process is asked in large batches.
//! Densities that are constant between lines of the chart: exact sums. Source of the rule: Piessens et al., QUADPACK, 1983.

use super::density::Density;
use super::domain::Domain;
use super::grid::{Cell, Grid};
use crate::error::Result;
use rayon::prelude::*;

/// Integrals over the cells of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrals<P> {
    pub values: Vec<f64>,
    /// Bounds of the errors: Σ |K − G| over a cell's pieces, 0 for exact sums.
    pub errors: Vec<f64>,
    /// The first value of the density that is negative or not finite.
    pub fault: Option<Fault<P>>,
}

/// A value that no density can have, and where it has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault<P> {
    pub point: P,
    pub value: f64,
}

/// Evaluations of the density after which refinement stops.
const BUDGET: usize = 1 << 23;
/// The share of a cell's integral, or of an average cell's, that its error should stay below. 200 cells then leave the whole
/// uncertain by 5·10⁻⁵ at most.
const PRECISION: f64 = 2.5e-5;

/// Integrates `density` over the cells of `grid`.
///
/// `pilot` are places of samples: a cell that they find fuller or emptier than its integral says is split at them and
/// integrated again, for no rule sees a lobe between its nodes.
pub fn integrate<D: Domain>(
    domain: &D,
    density: &dyn Density<D::Point>,
    grid: &Grid,
    pilot: &[[f64; 2]],
) -> Result<Integrals<D::Point>> {
    let outcomes = domain.outcomes().map(|n| [(1..n).map(|i| i as f64 / n as f64).collect(), Vec::new()]);
    if let Some(steps) = outcomes.or_else(|| density.steps()) {
        return sums(domain, density, grid, &steps);
    }
    let mut work = Refinement { domain, density, pieces: Vec::new(), evaluations: 0, fault: None };
    let inside = sorted_into(grid, pilot);
    let pieces = |(cell, pieces): (usize, Vec<Cell>)| {
        let places = &inside[cell];
        pieces.into_iter().flat_map(|at| parts(at, places, domain.is_plane())).map(move |piece| (cell, piece))
    };
    work.add(grid.graded_cells().enumerate().flat_map(pieces))?;
    work.refine(grid.len())?;
    let split = work.split_at_pilot(grid, &inside, pilot.len());
    if !split.is_empty() {
        work.add(split.into_iter())?;
        work.refine(grid.len())?;
    }
    let (values, errors) = work.totals(grid.len());
    Ok(Integrals { values, errors, fault: work.fault })
}

/// Sums over the rectangles between the lines of `steps`, on each of which the density is constant.
fn sums<D: Domain>(
    domain: &D,
    density: &dyn Density<D::Point>,
    grid: &Grid,
    steps: &[Vec<f64>; 2],
) -> Result<Integrals<D::Point>> {
    let lines = |axis: usize, [from, to]: [f64; 2]| {
        let all = &steps[axis];
        let inner = all.partition_point(|&line| line <= from)..all.partition_point(|&line| line < to);
        [&[from], &all[inner], &[to]].concat()
    };
    // Values asked for at a time: enough for a density in another process.
    const POINTS: usize = 1 << 12;
    let cells: Vec<Cell> = grid.cells().collect();
    let sum = |cell: &Cell| -> Result<(f64, Option<Fault<D::Point>>)> {
        let (xs, ys) = (lines(0, cell.x), lines(1, cell.y));
        let (mut total, mut fault, mut points, mut values) = (0.0, None, Vec::new(), Vec::new());
        let (rows, columns): (Vec<&[f64]>, Vec<&[f64]>) = (xs.windows(2).collect(), ys.windows(2).collect());
        for rows in rows.chunks(POINTS.div_ceil(columns.len())) {
            points.clear();
            values.clear();
            let middle = |x: &[f64], y: &[f64]| domain.point([0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])]);
            points.extend(rows.iter().flat_map(|x| columns.iter().map(|y| middle(x, y))));
            density.pdf(&points, &mut values)?;
            fault = fault.or_else(|| first_fault(&points, &values));
            for (x, values) in rows.iter().zip(values.chunks(columns.len())) {
                let row: f64 = columns.iter().zip(values).map(|(y, value)| (y[1] - y[0]) * value).sum();
                total += (x[1] - x[0]) * row;
            }
        }
        Ok((total * domain.measure(), fault))
    };
    let sums = cells.par_iter().map(sum).collect::<Result<Vec<_>>>()?;
    Ok(Integrals {
        errors: vec![0.0; sums.len()],
        fault: sums.iter().find_map(|(_, fault)| *fault),
        values: sums.into_iter().map(|(sum, _)| sum).collect(),
    })
}

fn first_fault<P: Copy>(points: &[P], values: &[f64]) -> Option<Fault<P>> {
    let faults = points.iter().zip(values).map(|(&point, &value)| Fault { point, value });
    faults.into_iter().find(|fault| !(fault.value.is_finite() && fault.value >= 0.0))
}

/// The pilot's places in each cell.
fn sorted_into(grid: &Grid, pilot: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut inside = vec![Vec::new(); grid.len()];
    pilot.iter().for_each(|&place| inside[grid.find(place)].push(place));
    inside
}

/// The first pieces of a rectangle: cut across every axis in use where the pilot's places in it are halved, and graded from
/// there, so that a density which fills only a corner does not fall between the nodes; in the middle where there are few.
fn parts(at: Cell, places: &[[f64; 2]], plane: bool) -> Vec<Cell> {
    const FEWEST: usize = 4;
    let within = |[x, y]: &[f64; 2]| at.x[0] <= *x && *x < at.x[1] && at.y[0] <= *y && *y < at.y[1];
    let places: Vec<[f64; 2]> = places.iter().filter(|place| within(place)).copied().collect();
    if places.len() >= FEWEST {
        let shape = if plane { [2, 2] } else { [2, 1] };
        return Grid::adapted(&places, shape, at, None).graded_cells().flatten().collect();
    }
    let ys = if plane { halves(at.y).into() } else { vec![at.y] };
    halves(at.x).into_iter().flat_map(|x| ys.iter().map(move |&y| Cell { x, y }).collect::<Vec<_>>()).collect()
}

fn halves([from, to]: [f64; 2]) -> [[f64; 2]; 2] {
    let middle = 0.5 * (from + to);
    [[from, middle], [middle, to]]
}

/// A rectangle that one rule is applied to.
#[derive(Debug, Clone, Copy)]
struct Piece {
    cell: usize,
    at: Cell,
    integral: f64,
    /// |K − G| for each axis.
    errors: [f64; 2],
}

impl Piece {
    fn error(&self) -> f64 {
        self.errors[0] + self.errors[1]
    }

    /// The halves along the axis that needs it more.
    fn halves(&self) -> [Cell; 2] {
        let Cell { x, y } = self.at;
        if self.errors[0] >= self.errors[1] {
            halves(x).map(|x| Cell { x, y })
        } else {
            halves(y).map(|y| Cell { x, y })
        }
    }
}

struct Refinement<'a, D: Domain> {
    domain: &'a D,
    density: &'a dyn Density<D::Point>,
    pieces: Vec<Piece>,
    evaluations: usize,
    fault: Option<Fault<D::Point>>,
}

impl<D: Domain> Refinement<'_, D> {
    /// Applies the rules to new pieces, given with the number of their cell.
    fn add(&mut self, pieces: impl Iterator<Item = (usize, Cell)>) -> Result<()> {
        // Enough points for a batch, few enough to share out.
        const PIECES: usize = 16;
        let pieces: Vec<(usize, Cell)> = pieces.collect();
        let plane = self.domain.is_plane();
        let apply = |batch: &[(usize, Cell)]| {
            let points: Vec<D::Point> =
                batch.iter().flat_map(|(_, at)| nodes(at, plane)).map(|place| self.domain.point(place)).collect();
            let mut values = Vec::with_capacity(points.len());
            self.density.pdf(&points, &mut values)?;
            let per_piece = points.len() / batch.len();
            let made = batch.iter().zip(values.chunks(per_piece)).map(|(&(cell, at), values)| {
                let scale = 0.25 * at.area() * self.domain.measure();
                let [k, gx, gy] = rules(values).map(|sum| sum * scale);
                Piece { cell, at, integral: k, errors: [(gx - k).abs(), (gy - k).abs()] }
            });
            Ok((made.collect::<Vec<_>>(), first_fault(&points, &values)))
        };
        self.evaluations += pieces.len() * if plane { KRONROD * KRONROD } else { KRONROD };
        for made in pieces.par_chunks(PIECES).map(apply).collect::<Result<Vec<_>>>()? {
            self.pieces.extend(made.0);
            self.fault = self.fault.or(made.1);
        }
        Ok(())
    }

    /// Halves pieces until every cell is precise enough, or the budget is spent, or the density is at fault.
    fn refine(&mut self, cells: usize) -> Result<()> {
        while self.evaluations < BUDGET && self.fault.is_none() {
            let (values, errors) = self.totals(cells);
            let mut counts = vec![0usize; cells];
            self.pieces.iter().for_each(|piece| counts[piece.cell] += 1);
            let allowed: Vec<f64> = values.iter().map(|value| PRECISION * (value + 1.0 / cells as f64)).collect();
            let (coarse, fine): (Vec<Piece>, Vec<Piece>) = self.pieces.iter().partition(|piece| {
                let cell = piece.cell;
                errors[cell] > allowed[cell] && piece.error() > 0.5 * allowed[cell] / counts[cell] as f64
            });
            if coarse.is_empty() {
                break;
            }
            self.pieces = fine;
            self.add(coarse.iter().flat_map(|piece| piece.halves().map(|half| (piece.cell, half))))?;
        }
        Ok(())
    }

    /// The new pieces of cells whose share of the pilot contradicts their integral; their old ones are removed.
    fn split_at_pilot(&mut self, grid: &Grid, inside: &[Vec<[f64; 2]>], pilot: usize) -> Vec<(usize, Cell)> {
        let (values, _) = self.totals(grid.len());
        let contradicts = |cell: usize| {
            let (seen, expected) = (inside[cell].len() as f64, values[cell] * pilot as f64);
            seen > 0.0 && (seen - expected).abs() > 5.0 + 5.0 * expected.sqrt()
        };
        let doubtful: Vec<bool> = (0..grid.len()).map(contradicts).collect();
        self.pieces.retain(|piece| !doubtful[piece.cell]);
        let cells = grid.cells().zip(inside).enumerate().filter(|(cell, _)| doubtful[*cell]);
        cells
            .flat_map(|(cell, (at, places))| {
                let parts = if self.domain.is_plane() { [8, 8] } else { [64, 1] };
                let pieces: Vec<Cell> = Grid::adapted(places, parts, at, None).graded_cells().flatten().collect();
                pieces.into_iter().map(move |piece| (cell, piece))
            })
            .collect()
    }

    fn totals(&self, cells: usize) -> (Vec<f64>, Vec<f64>) {
        let (mut values, mut errors) = (vec![0.0; cells], vec![0.0; cells]);
        for piece in &self.pieces {
            values[piece.cell] += piece.integral;
            errors[piece.cell] += piece.error();
        }
        (values, errors)
    }
}

/// Nodes of the Kronrod rule.
const KRONROD: usize = 15;
/// Its nodes on \[−1, 1\] with their weights, and those of the Gauss rule that shares every second node.
const RULE: [(f64, f64, f64); KRONROD] = {
    const HALF: [(f64, f64, f64); 8] = [
        (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
        (0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7),
        (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
        (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
        (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
        (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
        (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
        (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
    ];
    let mut rule = [(0.0, 0.0, 0.0); KRONROD];
    let mut i = 0;
    while i < 8 {
        let (x, k, g) = HALF[i];
        rule[i] = (-x, k, g);
        rule[KRONROD - 1 - i] = (x, k, g);
        i += 1;
    }
    rule
};

/// The nodes in a rectangle, row by row; on a line those with y = ½.
fn nodes(at: &Cell, plane: bool) -> impl Iterator<Item = [f64; 2]> {
    let place = |[from, to]: [f64; 2], node: f64| 0.5 * (from + to) + 0.5 * (to - from) * node;
    let (x, y) = (at.x, at.y);
    let columns = if plane { &RULE[..] } else { &RULE[KRONROD / 2..=KRONROD / 2] };
    RULE.iter().flat_map(move |(u, ..)| columns.iter().map(move |(v, ..)| [place(x, *u), place(y, *v)]))
}

/// Sums over \[−1, 1\]²: Kronrod's rule along both axes; Gauss's along x; Gauss's along y.
fn rules(values: &[f64]) -> [f64; 3] {
    if values.len() == KRONROD {
        let sum = |weight: fn(&(f64, f64, f64)) -> f64| {
            2.0 * RULE.iter().zip(values).map(|(node, value)| weight(node) * value).sum::<f64>()
        };
        let (k, g) = (sum(|node| node.1), sum(|node| node.2));
        return [k, g, k];
    }
    let mut sums = [0.0; 3];
    for ((_, kx, gx), row) in RULE.iter().zip(values.chunks(KRONROD)) {
        let (mut k, mut g) = (0.0, 0.0);
        for ((_, ky, gy), value) in RULE.iter().zip(row) {
            (k, g) = (k + ky * value, g + gy * value);
        }
        sums = [sums[0] + kx * k, sums[1] + gx * k, sums[2] + kx * g];
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::density::density;
    use super::super::domain::{Directions, Discrete, Line, Pole, Square};
    use super::*;
    use glam::DVec3;

    fn total<P>(integrals: &Integrals<P>) -> (f64, f64) {
        (integrals.values.iter().sum(), integrals.errors.iter().sum())
    }

    #[test]
    fn smooth_functions_in_each_cell() {
        let f = density(|[x, y]: [f64; 2]| (3.0 * x).exp() * (5.0 * y).cos().powi(2));
        let grid = Grid::equal([3, 4], None);
        let integrals = integrate(&Square, &f, &grid, &[]).unwrap();
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
        let integrals = integrate(&Line::UNIT, &line, &Grid::equal([5, 1], None), &[]).unwrap();
        let exact = 2.0 / 3.0 * (2.0f64 / 3.0).powf(1.5);
        let (value, error) = total(&integrals);
        assert!((value - exact).abs() <= error && error < 5e-5, "{value} {exact} {error}");
        // A disc of the square: a discontinuity that no rectangle follows.
        let disc = density(|[x, y]: [f64; 2]| f64::from(u8::from((x - 0.5).hypot(y - 0.5) < 0.4)));
        let (value, error) = total(&integrate(&Square, &disc, &Grid::equal([4, 4], None), &[]).unwrap());
        let exact = std::f64::consts::PI * 0.16;
        assert!((value - exact).abs() < error.min(1e-4), "{value} {exact} {error}");
    }

    #[test]
    fn a_lobe_that_no_node_sees_is_found_by_the_pilot() {
        // A lobe of 10⁻⁵ radians around an arbitrary direction.
        let axis = DVec3::new(0.3, 0.5, 0.4).normalize();
        let kappa = 1e10;
        let lobe = density(move |w: DVec3| {
            let apart2 = (w - axis).length_squared();
            kappa / std::f64::consts::TAU * (-0.5 * kappa * apart2).exp()
        });
        let domain = Directions::sphere(Pole::Z);
        let (t, b) = axis.any_orthonormal_pair();
        let pilot: Vec<[f64; 2]> = (1..1000)
            .map(|i| {
                let (r, phi) = ((-2.0 * (f64::from(i) / 1000.0).ln() / kappa).sqrt(), f64::from(i) * 2.4);
                domain.place((axis + r * (phi.cos() * t + phi.sin() * b)).normalize()).unwrap()
            })
            .collect();
        let blind = total(&integrate(&domain, &lobe, &Grid::equal([10, 20], None), &[]).unwrap()).0;
        assert!(blind < 0.5, "{blind}");
        for grid in [Grid::equal([10, 20], None), Grid::adapted(&pilot, [10, 20], Cell::WHOLE, None)] {
            let (value, error) = total(&integrate(&domain, &lobe, &grid, &pilot).unwrap());
            assert!((value - 1.0).abs() < 1e-6 + error && error < 1e-4, "{value} {error}");
        }
    }

    #[test]
    fn a_lobe_in_the_corner_of_wide_cells_is_found() {
        // Visible normals of GGX near grazing: in the cells opposite to the view the density ends 10⁻⁴ from the pole.
        use crate::optics::microfacet::Ggx;
        use crate::sampling::normals::SampleNormals;
        let domain = Directions::hemisphere(Pole::Z);
        for alpha in [0.05, 0.25] {
            let (sin, cos) = 89f64.to_radians().sin_cos();
            let (wo, ggx) = ([sin, 0.0, cos], Ggx::new(alpha));
            let pilot: Vec<[f64; 2]> = (0..1 << 14)
                .map(|i| [f64::from(i) / f64::from(1 << 14), (f64::from(i) * 0.618_034).fract()])
                .map(|u| domain.place(DVec3::from_array(ggx.sample_visible(wo, u))).unwrap())
                .collect();
            let visible = density(|wm: DVec3| ggx.pdf_visible(wo, wm.to_array()));
            let (value, error) = total(&integrate(&domain, &visible, &Grid::equal([10, 20], None), &pilot).unwrap());
            // What fewer than four places of the pilot lie in may still be missed.
            assert!((value - 1.0).abs() < 5e-5 && error < 5e-5, "{alpha}: {value} {error}");
        }
    }

    #[test]
    fn steps_are_summed_exactly() {
        let die = density(|face: usize| [0.1, 0.2, 0.3, 0.0, 0.25, 0.15][face]);
        let integrals = integrate(&Discrete { outcomes: 6 }, &die, &Grid::equal([3, 1], Some(6)), &[]).unwrap();
        for (value, exact) in integrals.values.iter().zip([0.3, 0.3, 0.4]) {
            assert!((value - exact).abs() < 1e-15);
        }
        let stairs = density(|[x, y]: [f64; 2]| if (x < 0.3) == (y < 0.7) { 1.5 } else { 0.25 });
        let stairs = stairs.with_steps([vec![0.3], vec![0.7]]);
        let (value, error) = total(&integrate(&Square, &stairs, &Grid::equal([7, 3], None), &[]).unwrap());
        assert!((value - (0.42 * 1.25 + 0.25)).abs() < 1e-14 && error == 0.0);
    }

    #[test]
    fn impossible_values_are_reported() {
        let f = density(|x: f64| if x > 0.9 { f64::NAN } else { 1.0 });
        assert!(integrate(&Line::UNIT, &f, &Grid::equal([5, 1], None), &[]).unwrap().fault.is_some());
        let f = density(|x: f64| 0.5 - x);
        assert!(integrate(&Line::UNIT, &f, &Grid::equal([5, 1], None), &[]).unwrap().fault.unwrap().value < 0.0);
    }
}
