//! Cutting cells into pieces until the rules agree with each other and with what is known of the density.

use super::pieces::{Part, Piece, Tree, share_within};
use super::rule::{KRONROD, nodes};
use super::{Integrals, InvalidPdf, Probe, first_invalid, values_at};
use crate::domain::{Domain, Point};
use crate::error::{Cancelled, Result, poll};
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};
use crate::parallel::each_part;
use crate::power::FEWEST;
use crate::sampler::Density;

/// Evaluations of the density after which refinement stops, each time that probes are learned.
const BUDGET: usize = 1 << 22;
/// The share of a cell's integral, or of an average cell's, that its error should stay below. 200 cells then leave the whole
/// uncertain by 5·10⁻⁵ at most.
const PRECISION: f64 = 2.5e-5;
/// Noncentrality per cell that errors of the integrals may add to the chi-square statistic. With 200 cells its mean then
/// moves by 0.025 standard deviations.
pub const SLACK: f64 = 0.0025;
/// What a cell may add to it where that allows a larger error than [`PRECISION`]: a sixteenth, since random points and samples find more errors.
const NONCENTRALITY: f64 = SLACK / 16.0;

/// The probes of a cell are evenly distributed if each half of them fills at least this share of it along each axis.
const EVEN: f64 = 0.35;

/// A density's integrals over the cells of a grid, which become better with every probe that is learned.
pub(crate) struct Refinement<'a> {
    pub(super) domain: &'a dyn Domain,
    pub(super) density: &'a dyn Density,
    pub(super) grid: &'a Grid,
    /// The number of samples whose counts the integrals are compared with; infinite where they are compared with something else.
    samples: f64,
    /// The rectangles that the rules are applied to; together they fill all cells.
    pub(super) pieces: Vec<Piece>,
    /// For each cell the density that all of its pieces are expected to reach.
    reach: Vec<f64>,
    tree: Tree,
    probes: Vec<Probe>,
    evaluations: usize,
    invalid: Option<InvalidPdf>,
    /// Where the density is known of a chart whose ends may be far from all samples: within this rectangle.
    sampled: Option<Cell>,
    far: Option<InvalidPdf>,
    cancelled: Cancelled,
}

/// The rectangle around all probes.
fn around(probes: &[Probe]) -> Cell {
    let none = Cell { x: [1.0, 0.0], y: [1.0, 0.0] };
    let wider = |[from, to]: [f64; 2], at: f64| [from.at_most(at), to.at_least(at)];
    probes.iter().fold(none, |Cell { x, y }, Probe { at, .. }| Cell { x: wider(x, at[0]), y: wider(y, at[1]) })
}

impl<'a> Refinement<'a> {
    /// Integrates over the cells of `grid`, knowing the density at `probes`, to compare the integrals with counts of `samples` samples.
    pub fn new(
        domain: &'a dyn Domain,
        density: &'a dyn Density,
        grid: &'a Grid,
        samples: f64,
        probes: &[Probe],
        cancelled: Cancelled,
    ) -> Result<Self> {
        let (pieces, tree) = (Vec::new(), Tree::new());
        let mut work = Self {
            domain,
            density,
            grid,
            samples,
            pieces,
            reach: Vec::new(),
            tree,
            probes: probes.to_vec(),
            evaluations: 0,
            invalid: None,
            sampled: (!domain.is_even()).then(|| around(probes)),
            far: None,
            cancelled,
        };
        let all = (0..probes.len() as u32).collect();
        let whole = Part { leaf: 0, cell: 0, at: Cell::WHOLE, probes: all };
        let mut parts = work.cut(whole, grid.graded().cut_at_parts(domain.parts()));
        for part in &mut parts {
            let [x, y] = [part.at.x, part.at.y].map(|[from, to]| 0.5 * (from + to));
            part.cell = grid.find([x, y]);
        }
        let parts: Vec<Part> = parts.into_iter().flat_map(|part| work.first_cut(part)).collect();
        work.add(parts)?;
        work.refine()?;
        Ok(work)
    }

    /// Takes the density at more probes into account.
    pub fn learn(&mut self, probes: &[Probe]) -> Result<()> {
        for probe in probes {
            let (piece, _) = self.tree.find(probe.at);
            let piece = &mut self.pieces[piece];
            piece.part.probes.push(self.probes.len() as u32);
            piece.learn(probe);
            self.probes.push(*probe);
        }
        self.refine()
    }

    /// The integrals as they are known so far.
    pub fn integrals(&self) -> Integrals {
        let (mut values, mut errors) = (vec![0.0; self.grid.len()], vec![0.0f64; self.grid.len()]);
        for piece in &self.pieces {
            values[piece.part.cell] += piece.integral;
            errors[piece.part.cell] = errors[piece.part.cell].hypot(piece.error());
        }
        Integrals { values, errors, invalid: self.invalid }
    }

    /// Whether the nodes predict a density as large as this everywhere in a cell: then [`share_within`](Self::share_within)
    /// is 1, without a search for the piece.
    #[inline]
    pub fn reaches(&self, cell: usize, density: f64) -> bool {
        density <= self.reach[cell]
    }

    /// The share of the density at a probe that the nodes around it predict: below 1 for a spike.
    pub fn share_within(&self, probe: &Probe) -> f64 {
        let (_, top) = self.tree.find(probe.at);
        share_within(top, probe.density)
    }

    /// Where a rectangle is cut before any rule is applied: nowhere if its known probes are halved near its middle, as those of
    /// a smooth density are; else where they are halved, and graded from there, so that a density which fills only a corner
    /// does not fall between the nodes; in the middle where there are few.
    fn first_cut(&mut self, part: Part) -> Vec<Part> {
        const FEWEST: usize = 4;
        let plane = self.domain.is_plane();
        if part.probes.len() < FEWEST {
            let axes = [true, plane];
            let Some(middle) = part.middle(axes) else { return vec![part] };
            return self.halve(part, axes, middle);
        }
        let probes: Vec<[f64; 2]> = part.probes.iter().map(|&probe| self.probes[probe as usize].at).collect();
        let shape = if plane { [2, 2] } else { [2, 1] };
        let grid = Grid::adapted(&probes, shape, part.at, None);
        let is_even = grid.cells().all(|cell| {
            let of_part = |[from, to]: [f64; 2], whole: [f64; 2]| (to - from) / (whole[1] - whole[0]);
            let shares = [of_part(cell.x, part.at.x), of_part(cell.y, part.at.y)];
            shares[0] >= EVEN && (!plane || shares[1] >= EVEN)
        });
        if is_even { vec![part] } else { self.cut(part, grid.graded()) }
    }

    /// The parts of a rectangle between the lines of `grid`, with the probes in each.
    fn cut(&mut self, whole: Part, grid: Grid) -> Vec<Part> {
        let mut inside = vec![Vec::new(); grid.len()];
        for probe in whole.probes {
            inside[grid.find(self.probes[probe as usize].at)].push(probe);
        }
        let cells: Vec<Cell> = grid.cells().collect();
        let leaves = self.tree.cut(whole.leaf, grid);
        let parts = leaves.zip(cells).zip(inside);
        parts.map(|((leaf, at), probes)| Part { leaf, cell: whole.cell, at, probes }).collect()
    }

    /// The halves of a rectangle along `axes` at its `middle`, or their halves.
    fn halve(&mut self, whole: Part, axes: [bool; 2], middle: [f64; 2]) -> Vec<Part> {
        let mut parts = vec![whole];
        for axis in (0..2).filter(|&axis| axes[axis]) {
            let middle = middle[axis];
            let halves = |Part { leaf, cell, at, probes }| {
                let leaves = self.tree.halve(leaf, axis, middle);
                let [mut below, mut above]: [Cell; 2] = [at; 2];
                match axis {
                    0 => (below.x[1], above.x[0]) = (middle, middle),
                    _ => (below.y[1], above.y[0]) = (middle, middle),
                }
                let is_below = |probe: &u32| self.probes[*probe as usize].at[axis] < middle;
                let (low, high): (Vec<u32>, Vec<u32>) = probes.into_iter().partition(is_below);
                [
                    Part { leaf: leaves[0], cell, at: below, probes: low },
                    Part { leaf: leaves[1], cell, at: above, probes: high },
                ]
            };
            parts = parts.into_iter().flat_map(halves).collect();
        }
        parts
    }

    /// [`values_at`] places, and the first of those that are no numbers where no sample is, towards an end of a chart that is not even: there
    /// formulas overflow, and the density counts as 0. (Where it is not, samples show it.)
    pub(super) fn values_at(&self, charts: &[[f64; 2]]) -> Result<(Vec<Point>, Vec<f64>, Option<InvalidPdf>)> {
        let (points, mut values) = values_at(self.domain, self.density, charts)?;
        let mut far = None;
        if let Some(Cell { x, y }) = self.sampled {
            let is_sampled = |at: &[f64; 2]| (x[0]..=x[1]).contains(&at[0]) && (y[0]..=y[1]).contains(&at[1]);
            let all = values.iter_mut().zip(charts).zip(&points);
            for ((value, _), &point) in
                all.filter(|((value, at), _)| (value.is_nan() || **value == f64::INFINITY) && !is_sampled(at))
            {
                far = far.or(Some(InvalidPdf { point, value: std::mem::take(value) }));
            }
        }
        Ok((points, values, far))
    }

    /// The first place of those that [`values_at`](Self::values_at) found.
    pub fn far(&self) -> Option<InvalidPdf> {
        self.far
    }

    /// Applies the rules to `parts`.
    fn add(&mut self, parts: Vec<Part>) -> Result<()> {
        // Enough points for a batch, few enough to share out.
        const PARTS: usize = 16;
        let (plane, known) = (self.domain.is_plane(), &self.probes);
        let cancelled = self.cancelled;
        let apply = |batch: &[Part]| {
            poll(cancelled)?;
            let charts: Vec<[f64; 2]> = batch.iter().flat_map(|part| nodes(&part.at, plane)).collect();
            let (points, values, far) = self.values_at(&charts)?;
            let per_part = points.len() / batch.len();
            let made = batch.iter().zip(values.chunks(per_part)).map(|(part, values)| {
                let mut piece = Piece::new(part.clone(), values);
                part.probes.iter().for_each(|&probe| piece.learn(&known[probe as usize]));
                piece
            });
            Ok((made.collect::<Vec<_>>(), (first_invalid(&points, &values), far)))
        };
        let made = each_part(&parts, PARTS, apply)?;
        self.evaluations += parts.len() * if plane { KRONROD * KRONROD } else { KRONROD };
        let (pieces, invalid): (Vec<Vec<Piece>>, Vec<_>) = made.into_iter().unzip();
        let (invalid, far): (Vec<_>, Vec<_>) = invalid.into_iter().unzip();
        self.invalid = invalid.into_iter().flatten().next().or(self.invalid);
        self.far = self.far.or(far.into_iter().flatten().next());
        for piece in pieces.into_iter().flatten() {
            self.tree.set(&piece, self.pieces.len());
            self.pieces.push(piece);
        }
        Ok(())
    }

    /// Cuts pieces until every cell is precise enough, or the budget is spent, or the density has an invalid value.
    fn refine(&mut self) -> Result<()> {
        let cells = self.grid.len();
        self.evaluations = 0;
        while self.evaluations < BUDGET && self.invalid.is_none() {
            // Integral, error and number of pieces of each cell decide which errors are too large.
            let (mut values, mut errors, mut counts) = (vec![0.0; cells], vec![0.0f64; cells], vec![0usize; cells]);
            for piece in &self.pieces {
                values[piece.part.cell] += piece.integral;
                counts[piece.part.cell] += 1;
                errors[piece.part.cell] = errors[piece.part.cell].hypot(piece.error());
            }
            let average = values.iter().sum::<f64>() / cells as f64;
            let of_samples = |value: f64| (NONCENTRALITY * value.at_least(FEWEST / self.samples) / self.samples).sqrt();
            let allowed = values.iter().map(|&value| (PRECISION * (value + average)).at_least(of_samples(value)));
            let allowed: Vec<f64> = allowed.collect();
            // Isolate spikes first: until then the estimated errors mean nothing.
            let spikes = self.pieces.iter().any(|piece| piece.error().is_infinite());
            let is_coarse = |piece: &Piece| {
                let (cell, error) = (piece.part.cell, piece.error());
                let large = errors[cell] > allowed[cell] && error > 0.5 * allowed[cell] / (counts[cell] as f64).sqrt();
                if spikes { error.is_infinite() } else { large }
            };
            let plane = self.domain.is_plane();
            let (coarse, mut fine): (Vec<Piece>, Vec<Piece>) =
                std::mem::take(&mut self.pieces).into_iter().partition(is_coarse);
            if coarse.is_empty() {
                self.pieces = fine;
                break;
            }
            // Halve the coarse pieces along the axes that matter, and apply the rules to the halves.
            let mut parts = Vec::new();
            for mut piece in coarse {
                let axes = piece.axes(plane);
                if let Some(middle) = piece.part.middle(axes) {
                    parts.extend(self.halve(piece.part, axes, middle));
                } else {
                    // Coordinates are too coarse to learn more here.
                    (piece.errors, piece.mismatch) = ([0.0; 2], 0.0);
                    fine.push(piece);
                }
            }
            self.pieces = fine;
            for (number, piece) in self.pieces.iter().enumerate() {
                self.tree.set(piece, number);
            }
            self.add(parts)?;
        }
        self.reach = vec![f64::INFINITY; cells];
        for piece in &self.pieces {
            let reach = &mut self.reach[piece.part.cell];
            *reach = reach.at_most(piece.top);
        }
        Ok(())
    }
}
