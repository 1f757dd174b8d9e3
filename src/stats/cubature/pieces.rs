//! The pieces that cells are cut into, and the tree that finds the piece of a place.

use super::super::grid::{Cell, Grid};
use super::Place;
use super::rule::{interpolate, rules};

/// How far above the values at its nodes a piece may be expected to reach. What is above counts as not seen.
const REACH: f64 = 1.25;

/// A difference between a density and a polynomial, as a share of what the piece reaches, that is worth learning: more than
/// rounding of f32 explains, even in the narrowest lobes.
pub(super) const LARGE: f64 = 0.1;

/// A rectangle that one rule is applied to.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Its leaf of the [`Tree`], and the cell of the grid that it is a part of.
    pub(super) leaf: usize,
    pub(super) cell: usize,
    pub(super) at: Cell,
    pub(super) integral: f64,
    /// |K − G| for each axis.
    pub(super) errors: [f64; 2],
    /// What the largest contradiction between the density at a known place and the rule's polynomial would do to the
    /// integral; infinite where the density is beyond reach.
    pub(super) doubt: f64,
    /// The largest density that the piece is expected to reach, and the densities at the nodes as shares of it.
    top: f64,
    shape: Vec<f64>,
    /// Known places in it, by number.
    pub(super) places: Vec<u32>,
}

impl Piece {
    /// The rules' results from the densities at the nodes; `measure` is that of the whole chart.
    pub(super) fn new(leaf: usize, cell: usize, at: Cell, values: &[f64], measure: f64) -> Self {
        let [k, gx, gy] = rules(values).map(|sum| 0.25 * at.area() * measure * sum);
        let top = REACH * values.iter().copied().fold(0.0, f64::max);
        let shape = values.iter().map(|value| if top > 0.0 { value / top } else { 0.0 }).collect();
        let errors = [(gx - k).abs(), (gy - k).abs()];
        Self { leaf, cell, at, integral: k, errors, doubt: 0.0, top, shape, places: Vec::new() }
    }

    pub(super) fn error(&self) -> f64 {
        (self.errors[0] + self.errors[1]).max(self.doubt)
    }

    /// The share of a density that is within reach.
    pub(super) fn seen(&self, pdf: f64) -> f64 {
        if pdf > self.top { self.top / pdf } else { 1.0 }
    }

    /// The difference between the density at a place, as far as it is within reach, and the rule's polynomial there, from −1
    /// to 1, in units of what the piece reaches.
    pub(super) fn difference(&self, place: &Place) -> f64 {
        if self.top == 0.0 {
            return 0.0;
        }
        ((place.pdf / self.top).min(1.0) - interpolate(&self.shape, &self.at, place.at)).clamp(-1.0, 1.0)
    }

    /// The integral of the largest density that the piece is expected to reach.
    pub(super) fn reach(&self, measure: f64) -> f64 {
        self.top * self.at.area() * measure
    }

    /// Learns the density at a place in it.
    pub(super) fn learn(&mut self, place: &Place, measure: f64) {
        if self.seen(place.pdf) < 1.0 {
            self.doubt = f64::INFINITY;
            return;
        }
        let difference = self.difference(place).abs();
        if difference > LARGE {
            self.doubt = self.doubt.max(difference * self.reach(measure));
        }
    }

    /// Its parts: halves along the axis whose rules differ more; quarters where known places contradict the rules and these do
    /// not say along which axis.
    pub(super) fn parts(&self, plane: bool) -> Option<Grid> {
        let [x, y] = self.errors;
        let axes = if self.doubt <= x + y {
            [x >= y, x < y]
        } else {
            // An axis is spared whose error is much smaller than the other's; errors near rounding say nothing.
            const SMALL: f64 = 0.1;
            const ROUNDING: f64 = 1e-6;
            let silent = x + y < ROUNDING * self.integral;
            [silent || x >= SMALL * y, plane && (silent || y >= SMALL * x)]
        };
        Grid::halved(self.at, axes)
    }
}

/// A partition of the chart: rectangles cut by grids, and their parts by further grids.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
enum Node {
    /// The number of a piece.
    Leaf(usize),
    /// Cut by the grid; the node of its first part.
    Cut(Grid, usize),
}

impl Tree {
    /// The whole chart as one leaf, number 0.
    pub(super) fn new() -> Self {
        Self { nodes: vec![Node::Leaf(usize::MAX)] }
    }

    /// Cuts a leaf; returns the leaves of the parts, in the grid's order.
    pub(super) fn cut(&mut self, leaf: usize, grid: Grid) -> std::ops::Range<usize> {
        let first = self.nodes.len();
        let parts = first..first + grid.len();
        self.nodes.extend(parts.clone().map(|_| Node::Leaf(usize::MAX)));
        self.nodes[leaf] = Node::Cut(grid, first);
        parts
    }

    /// Says which piece belongs to a leaf.
    pub(super) fn set(&mut self, leaf: usize, piece: usize) {
        self.nodes[leaf] = Node::Leaf(piece);
    }

    /// The number of the piece that a place is in.
    pub(super) fn find(&self, at: [f64; 2]) -> usize {
        let mut node = 0;
        loop {
            match &self.nodes[node] {
                Node::Leaf(piece) => return *piece,
                Node::Cut(grid, first) => node = first + grid.find(at),
            }
        }
    }
}
