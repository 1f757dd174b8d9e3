//! Parts of the chart that are finer than the cells: both axes, and every cell, halved again and again.

use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};

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

    /// Parts that `samples` samples fill, given some others at `pilot`.
    pub fn new(grid: &'a Grid, plane: bool, pilot: &[[f64; 2]], samples: u64) -> Self {
        let halvings = |parts: f64| if parts >= 1.0 { parts.log2() as u32 } else { 0 };
        let bits = halvings(samples as f64 / SAMPLES_PER_PART).min(AXIS_BITS);
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
