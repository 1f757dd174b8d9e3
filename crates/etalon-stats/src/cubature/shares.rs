//! Integrals of a density over parts of the chart that are finer than the cells.
//!
//! On a piece the density is taken for the polynomial p = Σ cₖ Pₖ of Legendre polynomials with
//! cₖ = (2k + 1)/2 Σᵢ wᵢ p(xᵢ) Pₖ(xᵢ), the sum over the nodes of Kronrod's rule, and
//! ∫ Pₖ = (Pₖ₊₁ − Pₖ₋₁)/(2k + 1) from −1. Kronrod's rule integrates products up to degree 22, so that k ends at 11.

use super::pieces::Piece;
use super::refine::Refinement;
use super::rule::{KRONROD, RULE, add_times, dot};
use crate::extremes::Extremes;
use crate::grid::{Cell, Parts, Subdivision, subdivided};
use std::collections::BTreeMap;
use std::ops::Range;

/// Integrals over the parts, and bounds of their errors.
#[derive(Debug, Clone)]
pub(crate) struct Shares {
    pub values: Parts<f64>,
    pub errors: Parts<f64>,
    /// Whether these are independent standard errors.
    pub are_independent: bool,
}

impl Shares {
    /// Zeros.
    pub(super) fn new(subdivision: &Subdivision) -> Self {
        Self { values: Parts::new(subdivision), errors: Parts::new(subdivision), are_independent: false }
    }

    /// The same, multiplied by `scale`.
    pub fn times(mut self, scale: f64) -> Self {
        let Self { values, errors, .. } = &mut self;
        for Parts { axes, cells } in [values, errors] {
            axes.iter_mut().flatten().chain(cells).for_each(|integral| *integral *= scale);
        }
        self
    }
}

/// Number of Legendre polynomials.
const TERMS: usize = 12;
/// Coefficients 2cₖ/(2k + 1), and the error of the integral.
type Terms = ([f64; TERMS], f64);

/// Legendre polynomials up to degree [`TERMS`].
fn legendre(x: f64) -> [f64; TERMS + 1] {
    let mut p = [1.0; TERMS + 1];
    p[1] = x;
    for k in 1..TERMS {
        let n = k as f64;
        p[k + 1] = ((2.0 * n + 1.0) * x * p[k] - n * p[k - 1]) / (n + 1.0);
    }
    p
}

/// (2k + 1)/2 ∫ Pₖ from −1 to `x`.
fn primitives(x: f64) -> [f64; TERMS] {
    let p = legendre(x);
    let mut integrals = [0.5 * (x + 1.0); TERMS];
    for k in 1..TERMS {
        integrals[k] = 0.5 * (p[k + 1] - p[k - 1]);
    }
    integrals
}

/// wᵢ Pₖ(xᵢ) for each node i.
fn projection() -> [[f64; TERMS]; KRONROD] {
    RULE.map(|(node, weight, _)| std::array::from_fn(|k| weight * legendre(node)[k]))
}

/// The numbers of the intervals between `ends` that meet `[from, to]`.
pub(super) fn met(ends: &[f64], [from, to]: [f64; 2]) -> Range<usize> {
    let inner = &ends[1..ends.len() - 1];
    inner.partition_point(|&end| end <= from)..inner.partition_point(|&end| end < to) + 1
}

/// The [`primitives`] of the interval `within` over each of the intervals `met` between `ends`.
fn over(ends: &[f64], met: Range<usize>, [from, to]: [f64; 2]) -> Vec<[f64; TERMS]> {
    let at = |end: f64| primitives(((2.0 * end - from - to) / (to - from)).within(-1.0, 1.0));
    let ends: Vec<[f64; TERMS]> = ends[met.start..=met.end].iter().map(|&end| at(end)).collect();
    let between = |e: &[[f64; TERMS]]| {
        let mut difference = e[1];
        add_times(&mut difference, -1.0, &e[0]);
        difference
    };
    ends.windows(2).map(between).collect()
}

impl Refinement<'_> {
    /// The integrals over the parts of `subdivision`, with the error of each piece as that of every part that it meets.
    pub fn shares(&self, subdivision: &Subdivision) -> Shares {
        let (projection, plane) = (projection(), self.domain.is_plane());
        let mut shares = Shares::new(subdivision);
        // Pieces over the same interval of an axis add up before their polynomials are integrated.
        let mut along: [BTreeMap<[u64; 2], Terms>; 2] = Default::default();
        let side = 1 << subdivision.depth;
        let cells: Vec<Cell> = if subdivision.depth > 0 { subdivision.grid.cells().collect() } else { Vec::new() };
        for piece in &self.pieces {
            let Piece { part, integral, .. } = piece;
            let (values, scale) = piece.values();
            let terms = if plane { tensor(values, scale, &projection) } else { vec![line(values, scale, &projection)] };
            let margins = [terms[0], std::array::from_fn(|k| terms.get(k).map_or(0.0, |row| row[0]))];
            // Rows of the tensor belong to the second axis: its margin along x is the first row.
            for (axis, margin) in margins.iter().enumerate().take(subdivision.axes.len()) {
                let interval = [part.at.x, part.at.y][axis].map(f64::to_bits);
                let (sum, error) = along[axis].entry(interval).or_insert(([0.0; TERMS], 0.0));
                add_times(sum, 1.0, margin);
                *error += piece.error();
            }
            let mut add = |i: usize, value: f64| {
                shares.values.cells[i] += value;
                shares.errors.cells[i] += piece.error();
            };
            if subdivision.depth == 0 {
                add(part.cell, *integral);
                continue;
            }
            let (xs, ys) = (subdivided(&cells[part.cell].x, side), subdivided(&cells[part.cell].y, side));
            let (rows, columns) = (met(&xs, part.at.x), met(&ys, part.at.y));
            if rows.len() == 1 && columns.len() == 1 {
                add(subdivision.part(part.cell, [rows.start, columns.start]), *integral);
                continue;
            }
            let of_columns: Vec<[f64; TERMS]> = over(&ys, columns.clone(), part.at.y)
                .iter()
                .map(|y| {
                    let mut sums = [0.0; TERMS];
                    terms.iter().zip(y).for_each(|(row, y)| add_times(&mut sums, *y, row));
                    sums
                })
                .collect();
            for (row, x) in rows.clone().zip(over(&xs, rows, part.at.x)) {
                for (column, terms) in columns.clone().zip(&of_columns) {
                    add(subdivision.part(part.cell, [row, column]), dot(&x, terms).at_least(0.0));
                }
            }
        }
        for (axis, intervals) in along.into_iter().enumerate().take(subdivision.axes.len()) {
            let ends = subdivision.axes[axis].ends();
            for (interval, (terms, error)) in intervals {
                let interval = interval.map(f64::from_bits);
                let met = met(&ends, interval);
                for (part, x) in met.clone().zip(over(&ends, met, interval)) {
                    shares.values.axes[axis][part] += dot(&x, &terms).at_least(0.0);
                    shares.errors.axes[axis][part] += error;
                }
            }
        }
        shares
    }
}

/// The coefficients along x of `values` at the nodes of a line.
fn line(values: &[f64], scale: f64, projection: &[[f64; TERMS]; KRONROD]) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    for (value, row) in values.iter().zip(projection) {
        add_times(&mut terms, scale * value, row);
    }
    terms
}

/// The coefficients of `values` at the nodes of a rectangle: for each degree along y those along x.
fn tensor(values: &[f64], scale: f64, projection: &[[f64; TERMS]; KRONROD]) -> Vec<[f64; TERMS]> {
    // Along y for each row of nodes, then along x.
    let rows: Vec<[f64; TERMS]> = values.chunks(KRONROD).map(|row| line(row, scale, projection)).collect();
    let degree = |l: usize| {
        let column: [f64; KRONROD] = std::array::from_fn(|i| rows[i][l]);
        line(&column, 1.0, projection)
    };
    (0..TERMS).map(degree).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cubature::Integration;
    use crate::domain::{Line, Square};
    use crate::grid::Grid;
    use crate::sampler::density;

    #[test]
    fn parts_of_pieces_have_the_integrals_of_the_density() {
        let f = density(|[x, y]: [f64; 2]| (3.0 * x).exp() * (5.0 * y).cos().powi(2));
        let exact = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
            let ey = |y: f64| 0.5 * y + (10.0 * y).sin() / 20.0;
            ((3.0 * b).exp() - (3.0 * a).exp()) / 3.0 * (ey(d) - ey(c))
        };
        let grid = Grid::equal([3, 4], None);
        let pilot: Vec<[f64; 2]> = (0..1000).map(|i| [f64::from(i) / 1000.0; 2]).collect();
        let subdivision = Subdivision::new(&grid, true, &pilot, 1 << 18);
        let integration = Integration::with_parts(&Square, &f, &subdivision, f64::INFINITY, &[], || false).unwrap();
        let shares = integration.shares(&subdivision);
        for (axis, values) in shares.values.axes.iter().enumerate() {
            for (ends, value) in subdivision.axes[axis].ends().windows(2).zip(values) {
                let (x, y) =
                    if axis == 0 { ([ends[0], ends[1]], [0.0, 1.0]) } else { ([0.0, 1.0], [ends[0], ends[1]]) };
                assert!((value - exact(x, y)).abs() < 1e-10, "{axis} {ends:?} {value}");
            }
        }
        for (number, cell) in grid.cells().enumerate() {
            let side = 1 << subdivision.depth;
            let (xs, ys) = (subdivided(&cell.x, side), subdivided(&cell.y, side));
            for (i, x) in xs.windows(2).enumerate() {
                for (j, y) in ys.windows(2).enumerate() {
                    let value = shares.values.cells[subdivision.part(number, [i, j])];
                    assert!((value - exact([x[0], x[1]], [y[0], y[1]])).abs() < 1e-11);
                }
            }
        }
        assert!(shares.errors.axes[0].iter().all(|error| *error < 1e-9));
    }

    #[test]
    fn parts_between_steps_have_exact_sums() {
        let stairs = density(|x: f64| if x < 0.3 { 2.0 } else { 4.0 / 7.0 }).with_steps([vec![0.3], vec![]]);
        let grid = Grid::equal([5, 1], None);
        let subdivision = Subdivision::new(&grid, false, &[], 1 << 12);
        let shares = Integration::with_parts(&Line::UNIT, &stairs, &subdivision, f64::INFINITY, &[], || false)
            .unwrap()
            .shares(&subdivision);
        for (ends, value) in subdivision.axes[0].ends().windows(2).zip(&shares.values.axes[0]) {
            let below = |x: f64| if x < 0.3 { 2.0 * x } else { 0.6 + (x - 0.3) * 4.0 / 7.0 };
            assert!((value - (below(ends[1]) - below(ends[0]))).abs() < 1e-15);
        }
        assert!((shares.values.cells[1] - (0.2 + 0.4 / 7.0)).abs() < 1e-15);
    }
}
