//! The pieces that cells are cut into, and the tree that finds the piece at chart coordinates.

use super::Probe;
use super::rule::{KRONROD, interpolate, rules};
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};

/// How far above the values at its nodes a piece may be expected to reach. What is above counts as missed.
const REACH: f64 = 1.25;

/// A difference between a density and a polynomial, as a share of what the piece reaches, that causes refinement: more than
/// rounding of f32 explains, also in the narrowest lobes.
pub(super) const LARGE: f64 = 0.1;

/// A rectangle of a cell.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Its leaf of the [`Tree`].
    pub(super) leaf: usize,
    /// The cell of the grid that it is a part of.
    pub(super) cell: usize,
    /// Its rectangle in the chart.
    pub(super) at: Cell,
    /// Known probes in it, by number.
    pub(super) probes: Vec<u32>,
}

impl Part {
    /// Its middle; `None` where coordinates are too coarse to halve it along `axes`.
    pub(super) fn middle(&self, axes: [bool; 2]) -> Option<[f64; 2]> {
        let ends = [self.at.x, self.at.y];
        let middle = ends.map(|[from, to]| 0.5 * (from + to));
        let divides = |axis: usize| !axes[axis] || ends[axis][0] < middle[axis] && middle[axis] < ends[axis][1];
        (divides(0) && divides(1)).then_some(middle)
    }
}

/// A rectangle that one rule is applied to.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Where it is.
    pub(super) part: Part,
    /// Kronrod's estimate K of the integral over it.
    pub(super) integral: f64,
    /// |K − G| for each axis.
    pub(super) errors: [f64; 2],
    /// What the largest contradiction between the density at a known probe and the rule's polynomial would do to the
    /// integral; infinite where the density is beyond reach.
    pub(super) mismatch: f64,
    /// The largest density that the piece is expected to reach, and the densities at the nodes as shares of it.
    pub(super) top: f64,
    shape: Vec<f64>,
}

impl Piece {
    /// The rules' results from the densities at the nodes, per area of the chart.
    pub(super) fn new(part: Part, values: &[f64]) -> Self {
        let [k, gx, gy] = rules(values).map(|sum| 0.25 * part.at.area() * sum);
        let top = REACH * values.iter().copied().fold(0.0, f64::at_least);
        let shape = values.iter().map(|value| if top > 0.0 { value / top } else { 0.0 }).collect();
        let errors = [(gx - k).abs(), (gy - k).abs()];
        Self { part, integral: k, errors, mismatch: 0.0, top, shape }
    }

    /// Estimate of the error of `integral`; infinite where the density is beyond reach.
    #[inline]
    pub(super) fn error(&self) -> f64 {
        (self.errors[0] + self.errors[1]).at_least(self.mismatch)
    }

    /// The share of a density that is within reach.
    #[inline]
    pub(super) fn share_within(&self, density: f64) -> f64 {
        share_within(self.top, density)
    }

    /// The difference between the density at a probe, as far as it is within reach, and the rule's polynomial there, from −1
    /// to 1, in units of what the piece reaches.
    #[inline]
    pub(super) fn difference(&self, probe: &Probe) -> f64 {
        if self.top == 0.0 {
            return 0.0;
        }
        ((probe.density / self.top).at_most(1.0) - interpolate(&self.shape, &self.part.at, probe.at)).within(-1.0, 1.0)
    }

    /// The integral of the largest density that the piece is expected to reach.
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        self.top * self.part.at.area()
    }

    /// The densities at the nodes in units of what the piece reaches, and the integral of such a unit over the piece divided
    /// by the measure of the rule's square or line.
    pub(super) fn values(&self) -> (&[f64], f64) {
        let of_rule = if self.shape.len() == KRONROD { 0.5 } else { 0.25 };
        (&self.shape, of_rule * self.reach())
    }

    /// Learns the density at a probe in it.
    pub(super) fn learn(&mut self, probe: &Probe) {
        if self.share_within(probe.density) < 1.0 {
            self.mismatch = f64::INFINITY;
            return;
        }
        let difference = self.difference(probe).abs();
        if difference > LARGE {
            self.mismatch = self.mismatch.at_least(difference * self.reach());
        }
    }

    /// The axes to halve it along: that whose rules differ more; both where known probes contradict the rules and these do
    /// not say along which axis.
    pub(super) fn axes(&self, plane: bool) -> [bool; 2] {
        let [x, y] = self.errors;
        if self.mismatch <= x + y {
            return [x >= y, x < y];
        }
        // An axis is spared whose error is much smaller than the other's; errors near rounding say nothing.
        const SMALL: f64 = 0.1;
        const ROUNDING: f64 = 1e-6;
        let silent = x + y < ROUNDING * self.integral;
        [silent || x >= SMALL * y, plane && (silent || y >= SMALL * x)]
    }
}

/// A partition of the chart: rectangles cut by grids, and their parts halved again and again.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
enum Node {
    /// The number of a piece, and the density that it is expected to reach.
    Leaf { piece: u32, top: f64 },
    /// Cut where a coordinate is `middle`; the node of the half below, which that above follows.
    Halves { axis: u8, below: u32, middle: f64 },
    /// Cut by a grid; the node of its first part.
    Grid(Box<Grid>, u32),
}

const EMPTY: Node = Node::Leaf { piece: u32::MAX, top: 0.0 };

impl Tree {
    /// The whole chart as one leaf, number 0.
    pub(super) fn new() -> Self {
        Self { nodes: vec![EMPTY] }
    }

    /// Cuts a leaf; returns the leaves of the parts, in the grid's order.
    pub(super) fn cut(&mut self, leaf: usize, grid: Grid) -> std::ops::Range<usize> {
        let first = self.nodes.len();
        self.nodes.resize(first + grid.len(), EMPTY);
        self.nodes[leaf] = Node::Grid(Box::new(grid), first as u32);
        first..self.nodes.len()
    }

    /// Halves a leaf; returns the leaves below and above.
    pub(super) fn halve(&mut self, leaf: usize, axis: usize, middle: f64) -> [usize; 2] {
        let below = self.nodes.len();
        self.nodes.resize(below + 2, EMPTY);
        self.nodes[leaf] = Node::Halves { axis: axis as u8, below: below as u32, middle };
        [below, below + 1]
    }

    /// Says which piece belongs to its leaf.
    pub(super) fn set(&mut self, piece: &Piece, number: usize) {
        self.nodes[piece.part.leaf] = Node::Leaf { piece: number as u32, top: piece.top };
    }

    /// The number of the piece that a probe is in, and the density that it is expected to reach.
    #[inline]
    pub(super) fn find(&self, at: [f64; 2]) -> (usize, f64) {
        let mut node = 0;
        loop {
            node = match &self.nodes[node] {
                Node::Leaf { piece, top } => return (*piece as usize, *top),
                Node::Halves { axis, below, middle } => *below as usize + usize::from(at[*axis as usize] >= *middle),
                Node::Grid(grid, first) => *first as usize + grid.find(at),
            }
        }
    }
}

/// The share of a density that is within reach of `top`.
#[inline]
pub(super) fn share_within(top: f64, density: f64) -> f64 {
    if density > top { top / density } else { 1.0 }
}
