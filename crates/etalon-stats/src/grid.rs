//! Cells: rectangles of a domain's chart, in rows, each row with columns of its own; and parts of the chart that are finer than
//! the cells: both axes, and every cell, halved again and again.

use crate::extremes::Extremes;

/// A rectangle of the chart.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Cell {
    /// Its ends along the first axis.
    pub x: [f64; 2],
    /// Its ends along the second axis.
    pub y: [f64; 2],
}

impl Cell {
    /// The whole chart.
    pub const WHOLE: Self = Self { x: [0.0, 1.0], y: [0.0, 1.0] };

    /// The place in it at coordinates from −1 to 1.
    #[inline]
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let along = |[from, to]: [f64; 2], v: f64| 0.5 * (from + to) + 0.5 * (to - from) * v;
        [along(self.x, x), along(self.y, y)]
    }

    /// Its area in the chart: the share of the domain's measure.
    #[must_use]
    pub fn area(&self) -> f64 {
        (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])
    }
}

/// A partition of a rectangle of the chart: rows along x, and each row's columns along y.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Grid {
    rows: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Number of the first cell of each row.
    first: Vec<usize>,
}

impl Grid {
    /// Edges of rows, and of every row's columns: ascending, at least two each.
    fn new(rows: Vec<f64>, columns: Vec<Vec<f64>>) -> Self {
        let first = columns
            .iter()
            .scan(0, |next, edges| {
                let first = *next;
                *next += edges.len() - 1;
                Some(first)
            })
            .collect();
        Self { rows, columns, first }
    }

    /// Cells of equal area over the whole chart.
    #[must_use]
    pub fn equal([rows, columns]: [usize; 2], snap: Option<usize>) -> Self {
        let edges = |n: usize, snap| tidy((1..n).map(|i| i as f64 / n as f64), [0.0, 1.0], snap);
        let rows = edges(rows, snap);
        let columns = vec![edges(columns, None); rows.len() - 1];
        Self::new(rows, columns)
    }

    /// Cells of `within` that hold about equally many of the chart coordinates `places`: narrow where these are dense.
    ///
    /// `snap` = n lets rows end at multiples of 1/n only, where there are no points between them.
    #[must_use]
    pub fn adapted(places: &[[f64; 2]], [rows, columns]: [usize; 2], within: Cell, snap: Option<usize>) -> Self {
        let mut places = places.to_vec();
        places.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let xs: Vec<f64> = places.iter().map(|p| p[0]).collect();
        let edges = tidy(quantiles(&xs, rows), within.x, snap);
        let columns = edges
            .windows(2)
            .map(|row| {
                let of_row = xs.partition_point(|&x| x < row[0])..xs.partition_point(|&x| x < row[1]);
                let mut ys: Vec<f64> = places[of_row].iter().map(|p| p[1]).collect();
                ys.sort_by(f64::total_cmp);
                tidy(quantiles(&ys, columns), within.y, None)
            })
            .collect();
        Self::new(edges, columns)
    }

    /// The rows of this grid, then those of `next`, which starts where this one ends.
    #[must_use]
    pub(crate) fn followed_by(self, next: Self) -> Self {
        Self::new([&self.rows[..], &next.rows[1..]].concat(), [self.columns, next.columns].concat())
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.iter().map(|edges| edges.len() - 1).sum()
    }

    /// Always false: a grid has at least one cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The ends of the rows, and of each row's columns.
    pub(crate) fn ends(&self) -> (&[f64], &[Vec<f64>]) {
        (&self.rows, &self.columns)
    }

    /// The number of the cell in that column of a row.
    pub(crate) fn number(&self, row: usize, column: usize) -> usize {
        self.first[row] + column
    }

    /// The cells, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.rows.windows(2).zip(&self.columns).flat_map(|(row, columns)| {
            columns.windows(2).map(|column| Cell { x: [row[0], row[1]], y: [column[0], column[1]] })
        })
    }

    /// The grid's rows and, where all rows have the same columns, its columns; each with the numbers of its cells.
    pub(crate) fn strips(&self) -> Vec<(Cell, Vec<usize>)> {
        let (n, ends) = (self.rows.len() - 1, |edges: &[f64]| [edges[0], edges[edges.len() - 1]]);
        let of_row = |row: usize| {
            let columns = &self.columns[row];
            let cell = Cell { x: [self.rows[row], self.rows[row + 1]], y: ends(columns) };
            (cell, (self.first[row]..self.first[row] + columns.len() - 1).collect())
        };
        let of_column = |column: usize| {
            let cell = Cell { x: ends(&self.rows), y: [self.columns[0][column], self.columns[0][column + 1]] };
            (cell, self.first.iter().map(|first| first + column).collect())
        };
        let aligned = self.columns.iter().all(|columns| *columns == self.columns[0]);
        let columns = if aligned { self.columns[0].len() - 1 } else { 0 };
        (0..n).map(of_row).chain((0..columns).map(of_column)).collect()
    }

    /// The number of the cell at chart coordinates.
    #[inline]
    #[must_use]
    pub fn find(&self, [x, y]: [f64; 2]) -> usize {
        let row = interval(&self.rows, x);
        self.first[row] + interval(&self.columns[row], y)
    }

    /// The same cells, cut where they are far wider than a neighbour: see [`graded`].
    #[must_use]
    pub(crate) fn graded(&self) -> Self {
        let (mut rows, mut columns) = (vec![self.rows[0]], Vec::new());
        for (xs, ys) in graded(&self.rows).iter().zip(&self.columns) {
            let mut edges = vec![ys[0]];
            graded(ys).iter().for_each(|inner| edges.extend(&inner[1..]));
            rows.extend(&xs[1..]);
            columns.extend(std::iter::repeat_n(edges, xs.len() - 1));
        }
        Self::new(rows, columns)
    }

    /// The same cells, cut at the lines between that many equal parts of the first axis.
    #[must_use]
    pub(crate) fn cut_at_parts(self, parts: usize) -> Self {
        if parts == 1 {
            return self;
        }
        let (mut rows, mut columns) = (vec![self.rows[0]], Vec::new());
        for (row, ys) in self.rows.windows(2).zip(&self.columns) {
            let first = (row[0] * parts as f64).floor() as usize + 1;
            let lines = (first..parts).map(|i| i as f64 / parts as f64).take_while(|line| *line < row[1]);
            let edges = tidy(lines, [row[0], row[1]], None);
            columns.extend(std::iter::repeat_n(ys.clone(), edges.len() - 1));
            rows.extend(&edges[1..]);
        }
        Self::new(rows, columns)
    }
}

/// The number of the interval between ascending `edges` that `at` is in; the first or last if it is in none.
#[inline]
fn interval(edges: &[f64], at: f64) -> usize {
    let last = edges.len() - 2;
    // Intervals of equal length need no search.
    let guess = (at - edges[0]) * (last + 1) as f64 / (edges[last + 1] - edges[0]);
    let guess = (guess as usize).min(last);
    if edges[guess] <= at && at < edges[guess + 1] {
        guess
    } else {
        edges[1..=last].partition_point(|&edge| edge <= at)
    }
}

/// Ascending edges from `from` to `to` through those of `inner` that lie strictly between, without repetition.
fn tidy(inner: impl Iterator<Item = f64>, [from, to]: [f64; 2], snap: Option<usize>) -> Vec<f64> {
    let mut edges = vec![from];
    for edge in inner {
        let edge = snap.map_or(edge, |n| (edge * n as f64).round() / n as f64);
        if edge > edges[edges.len() - 1] && edge < to {
            edges.push(edge);
        }
    }
    edges.push(to);
    edges
}

/// What parts sorted values into `parts` groups of equal size: midpoints between neighbours.
fn quantiles(sorted: &[f64], parts: usize) -> impl Iterator<Item = f64> + '_ {
    (1..parts).filter_map(move |i| {
        let next = i * sorted.len() / parts;
        let (before, after) = (sorted.get(next.checked_sub(1)?)?, sorted.get(next)?);
        Some(0.5 * (before + after))
    })
}

/// Splits each interval that is far wider than a neighbour at geometrically growing distances from it.
///
/// The density that made the neighbour narrow extends beyond the edge at the neighbour's scale, which the nodes of a wide
/// interval would miss.
fn graded(edges: &[f64]) -> Vec<Vec<f64>> {
    const RATIO: f64 = 4.0;
    let widths: Vec<f64> = edges.windows(2).map(|e| e[1] - e[0]).collect();
    (0..widths.len())
        .map(|i| {
            let (from, to, half) = (edges[i], edges[i + 1], 0.5 * widths[i]);
            let steps = |neighbour: Option<&f64>| {
                let first = neighbour.map_or(f64::INFINITY, |w| w * RATIO);
                std::iter::successors(Some(first), |d| Some(d * RATIO)).take_while(|d| *d < half).collect::<Vec<_>>()
            };
            let left = steps(i.checked_sub(1).map(|i| &widths[i]));
            let right = steps(widths.get(i + 1));
            tidy(left.iter().map(|d| from + d).chain(right.iter().rev().map(|d| to - d)), [from, to], None)
        })
        .collect()
}

/// Samples per part, on average, of the finest partitions.
const SAMPLES_PER_PART: f64 = 16.0;
/// Most halvings of an axis, and of a cell along each axis.
const AXIS_BITS: u32 = 12;
const CELL_BITS: u32 = 3;
/// The first halvings of an axis are quantiles of the pilot samples.
const QUANTILE_BITS: u32 = 4;

/// The relative error of coordinates in single precision.
const ROUNDING: f64 = f32::EPSILON as f64;

/// One axis of the chart in 2ʲ parts: about equally many pilot samples in each of the first 16, which are cut into equal parts.
#[derive(Debug, Clone)]
pub struct Axis {
    bits: u32,
    /// The ends of the quantiles.
    ends: Vec<f64>,
    /// For each quantile, its parts per length.
    density: Vec<f64>,
    /// The share of pairs of pilot samples with equal coordinates: the inverse of the number of values that there are.
    pub coincidence: f64,
    /// Whether its coordinates are those of a finite set, which have no rounding.
    pub finite: bool,
}

impl Axis {
    fn new(mut pilot: Vec<f64>, bits: u32) -> Self {
        pilot.sort_by(f64::total_cmp);
        let count = 1 << bits.min(QUANTILE_BITS);
        let quantile = |i: usize| match i {
            0 => 0.0,
            _ if i == count => 1.0,
            _ if pilot.len() < count => i as f64 / count as f64,
            _ => 0.5 * (pilot[i * pilot.len() / count - 1] + pilot[i * pilot.len() / count]),
        };
        let ends: Vec<f64> = (0..=count).map(quantile).collect();
        let parts = ((1 << bits) / count) as f64;
        let density = ends.windows(2).map(|e| parts / (e[1] - e[0])).collect();
        Self { bits, ends, density, coincidence: coincidence(&pilot), finite: false }
    }

    /// The number of halvings.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// The part at a coordinate.
    #[inline]
    pub fn find(&self, at: f64) -> usize {
        let count = self.density.len();
        let quantile = if count == 16 {
            // Without branches.
            [8, 4, 2, 1].into_iter().fold(0, |low, step| low + step * usize::from(self.ends[low + step] <= at))
        } else {
            self.ends[1..count].partition_point(|&end| end <= at)
        };
        let parts = (1 << self.bits) / count;
        quantile * parts + (((at - self.ends[quantile]) * self.density[quantile]) as usize).min(parts - 1)
    }

    /// The mean square of the displacement of a coordinate by rounding to f32, in units of the width of one of `parts` parts.
    pub fn rounding(&self, parts: usize) -> f64 {
        let ends: Vec<f64> = self.ends().into_iter().step_by((1 << self.bits) / parts).collect();
        let square = |e: &[f64]| (ROUNDING * e[1] / (e[1] - e[0]).at_least(f64::MIN_POSITIVE)).powi(2);
        ends.windows(2).map(square).sum::<f64>() / parts as f64
    }

    /// The ends of all parts, ascending.
    pub fn ends(&self) -> Vec<f64> {
        subdivided(&self.ends, (1 << self.bits) / (self.ends.len() - 1))
    }
}

/// The share of pairs of sorted values that are equal, or equal up to rounding of f32: that are nearer than they would be
/// if values were spread uniformly over sixteen times this distance.
fn coincidence(values: &[f64]) -> f64 {
    const WIDER: f64 = 16.0;
    let near = |distance: f64| {
        let mut last = 0;
        let mut pairs = 0;
        for (i, value) in values.iter().enumerate() {
            while values[i] - values[last] > distance * value {
                last += 1;
            }
            pairs += i - last;
        }
        pairs as f64
    };
    let (equal, narrow) = (near(0.0), near(2.0 * ROUNDING));
    let uniform = (near(2.0 * WIDER * ROUNDING) - narrow) / (WIDER - 1.0);
    // Three standard deviations are chance.
    let rounded = narrow - uniform - 3.0 * (narrow + uniform).sqrt();
    let n = values.len() as f64;
    equal.at_least(rounded) / (0.5 * n * (n - 1.0)).at_least(1.0)
}

/// The intervals between `ends`, each in `parts` equal ones.
pub fn subdivided(ends: &[f64], parts: usize) -> Vec<f64> {
    let within =
        |e: &[f64]| -> Vec<f64> { (0..parts).map(|i| e[0] + (e[1] - e[0]) * (i as f64 / parts as f64)).collect() };
    ends.windows(2).flat_map(within).chain(ends.last().copied()).collect()
}

/// How often a whole can be halved into that many parts.
fn halvings(parts: f64) -> u32 {
    if parts >= 1.0 { parts.log2() as u32 } else { 0 }
}

/// The axes of the chart and the cells of a grid in subdivision parts.
///
/// The parts of a cell are numbered such that numbers 2i and 2i + 1 are halves of one rectangle at every level: first along
/// the second axis, then, of the rectangles that these make, along the first.
#[derive(Debug, Clone)]
pub struct Subdivision<'a> {
    pub grid: &'a Grid,
    /// One for a line, two for a plane.
    pub axes: Vec<Axis>,
    /// Halvings of each cell along either axis.
    pub depth: u32,
    /// For each cell and axis, its lower end and its parts per length.
    cells: Vec<[[f64; 2]; 2]>,
}

impl<'a> Subdivision<'a> {
    /// The cells as they are, and no axes.
    pub fn coarse(grid: &'a Grid) -> Self {
        Self { grid, axes: Vec::new(), depth: 0, cells: Vec::new() }
    }

    /// An axis of 2ᵇ equal parts, for `bits` b, which are whole: their coordinates have no rounding.
    pub fn even(grid: &'a Grid, bits: u32) -> Self {
        let axis = Axis { finite: true, ..Axis::new(Vec::new(), bits) };
        Self { axes: vec![axis], ..Self::coarse(grid) }
    }

    /// The halvings of an axis into parts that `samples` samples fill.
    pub fn bits(samples: u64) -> u32 {
        halvings(samples as f64 / SAMPLES_PER_PART).min(AXIS_BITS)
    }

    /// Parts that `samples` samples fill, given some others at `pilot`.
    pub fn new(grid: &'a Grid, plane: bool, pilot: &[[f64; 2]], samples: u64) -> Self {
        let bits = Self::bits(samples);
        let axis = |axis: usize| Axis::new(pilot.iter().map(|at| at[axis]).collect(), bits);
        let of_cell = samples as f64 / (SAMPLES_PER_PART * grid.len() as f64);
        // A cell's parts expect half as many samples: their chi-squares sum over many more of them.
        let depth = if plane { (halvings(2.0 * of_cell) / 2).min(CELL_BITS) } else { 0 };
        let scaled = |[from, to]: [f64; 2]| [from, f64::from(1 << depth) / (to - from)];
        let cells = grid.cells().map(|Cell { x, y }| [scaled(x), scaled(y)]).collect();
        Self { grid, axes: (0..if plane { 2 } else { 1 }).map(axis).collect(), depth, cells }
    }

    /// Number of all parts of cells.
    pub fn len(&self) -> usize {
        self.grid.len() << (2 * self.depth)
    }

    /// The same parts of a finite set, whose values are known.
    pub fn of_finite_set(mut self) -> Self {
        self.axes.iter_mut().for_each(|axis| axis.finite = true);
        self
    }

    /// The mean square of the displacement of a coordinate by rounding to f32, in units of the width of the parts of cells that
    /// are halved `depth` times.
    pub fn rounding(&self, depth: u32) -> f64 {
        let wider = f64::from(1 << (self.depth - depth));
        let square = |[from, density]: &[f64; 2]| (ROUNDING * from * density / wider).powi(2);
        self.cells.iter().flatten().map(square).sum::<f64>() / self.cells.len() as f64
    }

    /// The number of the part of a cell in row `x` and column `y`: the bits of both, interleaved.
    #[inline]
    pub fn part(&self, cell: usize, [x, y]: [usize; 2]) -> usize {
        const SPREAD: [usize; 1 << CELL_BITS] = [0, 1, 4, 5, 16, 17, 20, 21];
        cell << (2 * self.depth) | SPREAD[x] << 1 | SPREAD[y]
    }

    /// The number of the part of `cell` at chart coordinates.
    #[inline]
    pub fn find(&self, cell: usize, [x, y]: [f64; 2]) -> usize {
        if self.depth == 0 {
            return cell;
        }
        let last = (1 << self.depth) - 1;
        let along = |[from, density]: [f64; 2], at: f64| (((at - from) * density) as usize).min(last);
        let [xs, ys] = self.cells[cell];
        self.part(cell, [along(xs, x), along(ys, y)])
    }
}

/// A number for each part: a share, its error, a count.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parts<T> {
    /// For each axis, and each of its parts.
    pub axes: Vec<Vec<T>>,
    /// For each part of a cell.
    pub cells: Vec<T>,
}

impl<T: Clone + Default> Parts<T> {
    /// Zeros.
    pub fn new(subdivision: &Subdivision) -> Self {
        let axes = subdivision.axes.iter().map(|axis| vec![T::default(); 1 << axis.bits]).collect();
        Self { axes, cells: vec![T::default(); subdivision.len()] }
    }
}

impl<T: Copy + std::ops::AddAssign> Parts<T> {
    /// Adds the numbers of the same parts.
    pub fn add(&mut self, other: &Self) {
        let sum = |to: &mut [T], from: &[T]| to.iter_mut().zip(from).for_each(|(sum, n)| *sum += *n);
        self.axes.iter_mut().zip(&other.axes).for_each(|(to, from)| sum(to, from));
        sum(&mut self.cells, &other.cells);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_in_the_cell_that_is_found() {
        let places: Vec<[f64; 2]> = (0..1000u32)
            .map(|i| [f64::from(i) / 1000.0, f64::from(i * 618 % 1000) / 1000.0])
            .map(|[x, y]| [x.powi(20), 0.5 + 1e-6 * y])
            .collect();
        for grid in [Grid::equal([7, 5], None), Grid::adapted(&places, [7, 5], Cell::WHOLE, None)] {
            let cells: Vec<Cell> = grid.cells().collect();
            assert_eq!((cells.len(), grid.len()), (35, 35));
            assert!((cells.iter().map(Cell::area).sum::<f64>() - 1.0).abs() < 1e-12);
            for [x, y] in places.iter().copied().chain([[0.0, 0.0], [1f64.next_down(); 2]]) {
                let Cell { x: [x0, x1], y: [y0, y1] } = cells[grid.find([x, y])];
                assert!(x0 <= x && x < x1 && y0 <= y && y < y1);
            }
        }
        let grid = Grid::adapted(&places, [7, 5], Cell::WHOLE, None);
        let mut counts = [0; 35];
        places.iter().for_each(|&p| counts[grid.find(p)] += 1);
        assert!(counts.iter().all(|n| (25..=32).contains(n)), "{counts:?}");
    }

    #[test]
    fn edges_of_a_finite_set_fall_between_its_points() {
        let grid = Grid::equal([4, 1], Some(6));
        let edges: Vec<f64> = grid.cells().map(|c| c.x[1] * 6.0).collect();
        assert_eq!(edges, [2.0, 3.0, 5.0, 6.0]);
        // Half of the points are one outcome: its quantiles are the same edge.
        let places = [[0.25, 0.5], [0.25, 0.5], [0.25, 0.5], [0.75, 0.5]];
        assert_eq!(Grid::adapted(&places, [4, 1], Cell::WHOLE, Some(2)).len(), 2);
    }

    #[test]
    fn wide_cells_grow_away_from_narrow_ones() {
        let grid = Grid::adapted(&[[1e-6, 0.5], [3e-6, 0.5]], [2, 1], Cell::WHOLE, None).graded();
        let cells: Vec<Cell> = grid.cells().collect();
        assert!(cells.len() > 6 && (cells.iter().map(Cell::area).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(cells.windows(2).all(|p| p[1].area() < 20.0 * p[0].area()));
        assert!(cells.iter().enumerate().all(|(i, at)| grid.find([0.5 * (at.x[0] + at.x[1]), 0.5]) == i));
    }

    #[test]
    fn parts_contain_what_is_found_in_them() {
        let places: Vec<[f64; 2]> =
            (0..4096u32).map(|i| [(f64::from(i) / 4096.0).powi(3), f64::from(i * 2531 % 4096) / 4096.0]).collect();
        let grid = Grid::adapted(&places, [5, 7], Cell::WHOLE, None);
        let subdivision = Subdivision::new(&grid, true, &places, 1 << 18);
        assert_eq!((subdivision.depth, subdivision.axes[0].bits()), (3, 12));
        for axis in 0..2 {
            let ends = subdivision.axes[axis].ends();
            assert!(places.iter().map(|at| at[axis]).all(|at| {
                let part = subdivision.axes[axis].find(at);
                ends[part] <= at + 1e-15 && at <= ends[part + 1] + 1e-15
            }));
        }
        // Numbers 2i and 2i + 1 differ in the last column bit only.
        let at = |x, y| subdivision.part(3, [x, y]);
        assert_eq!((at(0, 0), at(0, 1), at(1, 0), at(7, 7)), (192, 193, 194, 255));
        let cell = grid.cells().nth(3).unwrap();
        let middle = [0.5 * (cell.x[0] + cell.x[1]), cell.y[0]];
        assert_eq!(subdivision.find(3, middle), at(4, 0));
    }

    #[test]
    fn equal_values_and_values_that_are_equal_but_for_rounding_are_counted() {
        let random: Vec<f64> = (0..16_384).map(|i| crate::hash::unit_f64(crate::hash::mix64(i))).collect();
        let of = |value: &dyn Fn(usize, f64) -> f64| {
            let mut values: Vec<f64> = random.iter().enumerate().map(|(i, x)| value(i, *x)).collect();
            values.sort_by(f64::total_cmp);
            coincidence(&values)
        };
        assert!(of(&|_, x| x) < 1e-7 && of(&|_, x| x.powi(20)) < 1e-7);
        let lattice = |x: f64| (4096.0 * x).ceil() / 4096.0;
        for share in [of(&|_, x| lattice(x)), of(&|i, x| lattice(x) * (1.0 + 1e-7 * random[16_383 - i]))] {
            assert!((share * 4096.0 - 1.0).abs() < 0.1, "{share}");
        }
    }
}
