//! Cutting cells into pieces until the rule agrees with itself on each.

use super::super::density::Density;
use super::super::domain::Domain;
use super::super::grid::{Cell, Grid};
use super::rule::{KRONROD, nodes, rules};
use super::{Fault, Integrals, first_fault};
use crate::error::Result;
use crate::interrupt;
use rayon::prelude::*;

/// Evaluations of the density after which refinement stops.
const BUDGET: usize = 1 << 23;
/// The share of a cell's integral, or of an average cell's, that its error should stay below. 200 cells then leave the whole
/// uncertain by 5·10⁻⁵ at most.
const PRECISION: f64 = 2.5e-5;

/// The integrals over the cells of `grid`, with `pilot` as in [`super::integrate`].
pub(super) fn integrals<D: Domain>(
    domain: &D,
    density: &dyn Density<D::Point>,
    grid: &Grid,
    pilot: &[[f64; 2]],
) -> Result<Integrals<D::Point>> {
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
            interrupt::check()?;
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
