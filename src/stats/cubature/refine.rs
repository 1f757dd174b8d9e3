//! Cutting cells into pieces until the rules agree with each other and with what is known of the density.

use super::super::density::Density;
use super::super::domain::Domain;
use super::super::grid::{Cell, Grid};
use super::pieces::{Piece, Tree, share_within};
use super::rule::{KRONROD, nodes};
use super::{Fault, Integrals, Place, first_fault};
use crate::error::Result;
use crate::interrupt;
use rayon::prelude::*;

/// Evaluations of the density after which refinement stops, each time that places are learned.
const BUDGET: usize = 1 << 22;
/// The share of a cell's integral, or of an average cell's, that its error should stay below. 200 cells then leave the whole
/// uncertain by 5·10⁻⁵ at most.
const PRECISION: f64 = 2.5e-5;

/// A density's integrals over the cells of a grid, which become better with every place that is learned.
pub struct Refinement<'a, D: Domain> {
    pub(super) domain: &'a D,
    pub(super) density: &'a dyn Density<D::Point>,
    pub(super) grid: &'a Grid,
    pub(super) pieces: Vec<Piece>,
    tree: Tree,
    places: Vec<Place>,
    evaluations: usize,
    fault: Option<Fault<D::Point>>,
}

/// A rectangle still to be integrated: its leaf of the tree, its cell, and the known places in it.
struct Part {
    leaf: usize,
    cell: usize,
    at: Cell,
    places: Vec<u32>,
}

impl<'a, D: Domain> Refinement<'a, D> {
    /// Integrates over the cells of `grid`, knowing the density at `places`.
    pub fn new(domain: &'a D, density: &'a dyn Density<D::Point>, grid: &'a Grid, places: &[Place]) -> Result<Self> {
        let (pieces, tree) = (Vec::new(), Tree::new());
        let mut work =
            Self { domain, density, grid, pieces, tree, places: places.to_vec(), evaluations: 0, fault: None };
        let all = (0..places.len() as u32).collect();
        let whole = Part { leaf: 0, cell: 0, at: Cell::WHOLE, places: all };
        let mut parts = work.cut(whole, grid.graded());
        for part in &mut parts {
            let [x, y] = [part.at.x, part.at.y].map(|[from, to]| 0.5 * (from + to));
            part.cell = grid.find([x, y]);
        }
        let parts: Vec<Part> = parts.into_iter().flat_map(|part| work.first_cut(part)).collect();
        work.add(parts)?;
        work.refine()?;
        Ok(work)
    }

    /// Takes the density at more places into account.
    pub fn learn(&mut self, places: &[Place]) -> Result<()> {
        let measure = self.domain.measure();
        for place in places {
            let (piece, _) = self.tree.find(place.at);
            let piece = &mut self.pieces[piece];
            piece.places.push(self.places.len() as u32);
            piece.learn(place, measure);
            self.places.push(*place);
        }
        self.refine()
    }

    pub fn integrals(&self) -> Integrals<D::Point> {
        let (mut values, mut errors) = (vec![0.0; self.grid.len()], vec![0.0; self.grid.len()]);
        for piece in &self.pieces {
            values[piece.cell] += piece.integral;
            errors[piece.cell] += piece.error();
        }
        Integrals { values, errors, fault: self.fault }
    }

    /// The share of the density at a place that the nodes around it lead to expect: less than 1 for a spike.
    pub fn seen(&self, place: &Place) -> f64 {
        let (_, top) = self.tree.find(place.at);
        share_within(top, place.pdf)
    }

    /// Where a rectangle is cut before any rule is applied: where its known places are halved, and graded from there, so
    /// that a density which fills only a corner does not fall between the nodes; in the middle where there are few.
    fn first_cut(&mut self, part: Part) -> Vec<Part> {
        const FEWEST: usize = 4;
        let plane = self.domain.is_plane();
        if part.places.len() < FEWEST {
            return self.halve(part, [true, plane]).unwrap_or_else(|whole| vec![whole]);
        }
        let places: Vec<[f64; 2]> = part.places.iter().map(|&place| self.places[place as usize].at).collect();
        let shape = if plane { [2, 2] } else { [2, 1] };
        let grid = Grid::adapted(&places, shape, part.at, None).graded();
        self.cut(part, grid)
    }

    /// The parts of a rectangle between the lines of `grid`, with the places in each.
    fn cut(&mut self, whole: Part, grid: Grid) -> Vec<Part> {
        let mut inside = vec![Vec::new(); grid.len()];
        for place in whole.places {
            inside[grid.find(self.places[place as usize].at)].push(place);
        }
        let cells: Vec<Cell> = grid.cells().collect();
        let leaves = self.tree.cut(whole.leaf, grid);
        let parts = leaves.zip(cells).zip(inside);
        parts.map(|((leaf, at), places)| Part { leaf, cell: whole.cell, at, places }).collect()
    }

    /// The halves of a rectangle along `axes`, or their halves; the rectangle itself where coordinates are too coarse for that.
    fn halve(&mut self, whole: Part, axes: [bool; 2]) -> std::result::Result<Vec<Part>, Part> {
        let middle = |[from, to]: [f64; 2]| 0.5 * (from + to);
        let middles = [middle(whole.at.x), middle(whole.at.y)];
        let divides = |axis: usize, [from, to]: [f64; 2]| !axes[axis] || from < middles[axis] && middles[axis] < to;
        if !(divides(0, whole.at.x) && divides(1, whole.at.y)) {
            return Err(whole);
        }
        let mut parts = vec![whole];
        for axis in (0..2).filter(|&axis| axes[axis]) {
            let middle = middles[axis];
            let halves = |Part { leaf, cell, at, places }| {
                let leaves = self.tree.halve(leaf, axis, middle);
                let [mut below, mut above]: [Cell; 2] = [at; 2];
                match axis {
                    0 => (below.x[1], above.x[0]) = (middle, middle),
                    _ => (below.y[1], above.y[0]) = (middle, middle),
                }
                let is_below = |place: &u32| self.places[*place as usize].at[axis] < middle;
                let (low, high): (Vec<u32>, Vec<u32>) = places.into_iter().partition(is_below);
                [
                    Part { leaf: leaves[0], cell, at: below, places: low },
                    Part { leaf: leaves[1], cell, at: above, places: high },
                ]
            };
            parts = parts.into_iter().flat_map(halves).collect();
        }
        Ok(parts)
    }

    /// Applies the rules to `parts`.
    fn add(&mut self, parts: Vec<Part>) -> Result<()> {
        // Enough points for a batch, few enough to share out.
        const PARTS: usize = 16;
        let (plane, measure, known) = (self.domain.is_plane(), self.domain.measure(), &self.places);
        let apply = |batch: &[Part]| {
            interrupt::check()?;
            let points: Vec<D::Point> =
                batch.iter().flat_map(|part| nodes(&part.at, plane)).map(|place| self.domain.point(place)).collect();
            let mut values = Vec::with_capacity(points.len());
            self.density.pdf(&points, &mut values)?;
            let per_part = points.len() / batch.len();
            let made = batch.iter().zip(values.chunks(per_part)).map(|(part, values)| {
                let mut piece = Piece::new(part.leaf, part.cell, part.at, values, measure);
                part.places.iter().for_each(|&place| piece.learn(&known[place as usize], measure));
                piece
            });
            Ok((made.collect::<Vec<_>>(), first_fault(&points, &values)))
        };
        let made = parts.par_chunks(PARTS).map(apply).collect::<Result<Vec<_>>>()?;
        self.evaluations += parts.len() * if plane { KRONROD * KRONROD } else { KRONROD };
        let (pieces, faults): (Vec<Vec<Piece>>, Vec<_>) = made.into_iter().unzip();
        self.fault = faults.into_iter().flatten().next().or(self.fault);
        for (mut piece, part) in pieces.into_iter().flatten().zip(parts) {
            piece.places = part.places;
            self.tree.set(&piece, self.pieces.len());
            self.pieces.push(piece);
        }
        Ok(())
    }

    /// Cuts pieces until every cell is precise enough, or the budget is spent, or the density is at fault.
    fn refine(&mut self) -> Result<()> {
        let cells = self.grid.len();
        self.evaluations = 0;
        while self.evaluations < BUDGET && self.fault.is_none() {
            let (mut values, mut errors, mut counts) = (vec![0.0; cells], vec![0.0; cells], vec![0usize; cells]);
            for piece in &self.pieces {
                values[piece.cell] += piece.integral;
                counts[piece.cell] += 1;
                errors[piece.cell] += piece.error();
            }
            let allowed: Vec<f64> = values.iter().map(|value| PRECISION * (value + 1.0 / cells as f64)).collect();
            // Spikes are cut out first: until they are seen, errors mean nothing.
            let spikes = self.pieces.iter().any(|piece| piece.error().is_infinite());
            let is_coarse = |piece: &Piece| {
                let (cell, error) = (piece.cell, piece.error());
                let large = errors[cell] > allowed[cell] && error > 0.5 * allowed[cell] / counts[cell] as f64;
                if spikes { error.is_infinite() } else { large }
            };
            let plane = self.domain.is_plane();
            let (coarse, mut fine): (Vec<Piece>, Vec<Piece>) =
                std::mem::take(&mut self.pieces).into_iter().partition(is_coarse);
            if coarse.is_empty() {
                self.pieces = fine;
                break;
            }
            let mut parts = Vec::new();
            for mut piece in coarse {
                let axes = piece.axes(plane);
                let (leaf, cell, at) = (piece.leaf, piece.cell, piece.at);
                match self.halve(Part { leaf, cell, at, places: std::mem::take(&mut piece.places) }, axes) {
                    Ok(halves) => parts.extend(halves),
                    // Nothing more is to be known here.
                    Err(Part { places, .. }) => {
                        (piece.errors, piece.doubt, piece.places) = ([0.0; 2], 0.0, places);
                        fine.push(piece);
                    }
                }
            }
            self.pieces = fine;
            for (number, piece) in self.pieces.iter().enumerate() {
                self.tree.set(piece, number);
            }
            self.add(parts)?;
        }
        Ok(())
    }
}
