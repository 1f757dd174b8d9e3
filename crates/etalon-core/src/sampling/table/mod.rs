//! Piecewise-constant distributions: cumulative tables with a guide, in one and two dimensions.
//!
//! Probabilities are differences of the *stored* table, so that samples follow the pdf to the last bit.
//! Cells are found through a guide (cutpoint) table: one look-up per sample and a short search. The result is monotone in
//! `u`, hence invertible and suited to stratified random numbers. Source: Chen & Asau, "On generating random variates from an
//! empirical distribution", AIIE Transactions 6(2), 1974.

mod short;

pub use short::ShortTables;

use rayon::prelude::*;

/// Share of a cell at its borders where no position falls, so that none rounds into the neighbour cell.
const BORDER: f64 = 1e-9;

/// A cell and the position inside it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CellSample {
    pub cell: usize,
    /// Position inside the cell, in (0, 1).
    pub offset: f64,
    pub probability: f64,
}

/// A view of one cumulative table of n cells.
#[derive(Debug, Clone, Copy)]
struct Cdf<'a> {
    /// n + 1 values from 0 to 1, then [`PROBES`] more that no `u` reaches.
    pub cdf: &'a [f64],
    /// For b from 0 to B = 2ᵏ ≥ n: the first cell that ends beyond (b − ½) / B, or 65535 if it is a later one; another
    /// entry closes the last bucket.
    pub guide: &'a [u16],
}

/// Cell ends that are compared with `u` without a branch; buckets with more are bisected.
const PROBES: usize = 4;

/// The bucket of `u` in a guide of B = `buckets`: u · B, which is exact, to the nearest integer.
///
/// Adding 2⁵² + 2⁵¹ rounds, and leaves the integer in the lowest bits.
#[inline]
fn bucket(u: f64, buckets: f64) -> usize {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    (u * buckets + ROUND).to_bits() as u32 as usize
}

impl Cdf<'_> {
    #[inline]
    pub fn probability(self, cell: usize) -> f64 {
        self.cdf[cell + 1] - self.cdf[cell]
    }

    /// The cell for `u`, its start and its probability.
    ///
    /// The guide gives a few candidates. Which of them it is the processor cannot predict, so the common case has no branch that
    /// depends on it.
    #[inline]
    fn find(self, u: f64) -> (usize, f64, f64) {
        let bucket = bucket(u, (self.guide.len() - 2) as f64);
        let [first, last] = [self.guide[bucket], self.guide[bucket + 1]];
        let first_cell = usize::from(first);
        if last - first > PROBES as u16 || last == u16::MAX {
            let last_cell = if last == u16::MAX { self.cdf.len() - cdf_len(1) } else { usize::from(last) };
            return bisect(&self.cdf[..last_cell + 2], first_cell, u);
        }
        let near = &self.cdf[first_cell..][..PROBES + 2];
        let passed: usize = near[1..=PROBES].iter().map(|&end| usize::from(end <= u)).sum();
        (first_cell + passed, near[passed], near[passed + 1] - near[passed])
    }

    /// The cell for `u` in \[0, 1) and the position inside it, of a table whose weights are not all 0.
    #[inline]
    pub fn sample(self, u: f64) -> CellSample {
        let (cell, start, probability) = self.find(u);
        CellSample { cell, offset: inside((u - start) / probability), probability }
    }

    /// The `u` that [`Cdf::sample`] maps to this place.
    pub fn invert(self, cell: usize, offset: f64) -> f64 {
        self.cdf[cell] + offset * self.probability(cell)
    }
}

/// The cell for `u` from `first` to the last of a table.
#[cold]
#[inline(never)]
fn bisect(cdf: &[f64], first: usize, u: f64) -> (usize, f64, f64) {
    let cell = first + cdf[first + 1..cdf.len() - 1].partition_point(|&end| end <= u);
    (cell, cdf[cell], cdf[cell + 1] - cdf[cell])
}

/// A position in a cell, clamped away from its borders.
#[inline]
fn inside(offset: f64) -> f64 {
    offset.clamp(BORDER, 1.0 - BORDER)
}

/// Values in the table of n cells.
#[inline]
fn cdf_len(cells: usize) -> usize {
    cells + 1 + PROBES
}

/// Entries in the guide of n cells.
#[inline]
fn guide_len(cells: usize) -> usize {
    cells.next_power_of_two() + 2
}

/// Fills a cumulative table and its guide from weights ≥ 0 and returns their sum; if that is 0 the table is all zeros.
///
/// A cell of positive weight always gets a positive probability, even if its weight is 10⁻²⁴ of the sum.
fn fill(weights: &[f64], cdf: &mut [f64], guide: &mut [u16]) -> f64 {
    let n = weights.len();
    let total: f64 = weights.iter().sum();
    let (cdf, beyond) = cdf.split_at_mut(n + 1);
    beyond.fill(f64::INFINITY);
    if total <= 0.0 {
        cdf.fill(0.0);
        guide.fill(0);
        return 0.0;
    }
    let scale = 1.0 / total;
    let mut sum = 0.0;
    cdf[0] = 0.0;
    for (i, &w) in weights.iter().enumerate() {
        sum += w;
        let next = sum * scale;
        cdf[i + 1] = if w > 0.0 { next.max(cdf[i].next_up()) } else { cdf[i] };
    }
    // Let the table end at 1 exactly, and restore increasing values from the right where rounding left no gap.
    let last = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
    cdf[last + 1..].fill(1.0);
    for i in (0..=last).rev() {
        let largest = if weights[i] > 0.0 { cdf[i + 1].next_down() } else { cdf[i + 1] };
        if cdf[i] <= largest {
            break;
        }
        cdf[i] = largest;
    }
    // Fill the guide: the first cell of each bucket.
    let buckets = guide.len() - 2;
    let mut cell = 0;
    for (b, entry) in guide.iter_mut().enumerate() {
        let start = (b as f64 - 0.5) / buckets as f64;
        while cell < last && cdf[cell + 1] <= start {
            cell += 1;
        }
        *entry = cell.min(usize::from(u16::MAX)) as u16;
    }
    total
}

/// A distribution over n cells of a line.
#[derive(Debug, Clone)]
pub struct Table1 {
    cdf: Vec<f64>,
    guide: Vec<u16>,
    total: f64,
}

impl Table1 {
    /// From at least one weight, all finite and ≥ 0.
    pub fn new(weights: &[f64]) -> Self {
        debug_assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0));
        let mut cdf = vec![0.0; cdf_len(weights.len())];
        // Finer than needed: few tables are of this kind, and they are used most.
        let mut guide = vec![0; guide_len(8 * weights.len())];
        let total = fill(weights, &mut cdf, &mut guide);
        Self { cdf, guide, total }
    }

    #[inline]
    fn view(&self) -> Cdf<'_> {
        Cdf { cdf: &self.cdf, guide: &self.guide }
    }

    /// Sum of the weights; when it is 0 nothing can be sampled.
    #[inline]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The cell for `u` in \[0, 1) and the position inside it; `None` when all weights are 0.
    #[inline]
    pub fn sample(&self, u: f64) -> Option<CellSample> {
        (self.total > 0.0).then(|| self.view().sample(u))
    }

    /// Probability of a cell (not per length).
    #[inline]
    pub fn probability(&self, cell: usize) -> f64 {
        self.view().probability(cell)
    }

    /// The `u` that [`Table1::sample`] maps to this place.
    pub fn invert(&self, cell: usize, offset: f64) -> f64 {
        self.view().invert(cell, offset)
    }
}

/// A cell of a grid and the position inside it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GridSample {
    /// The column, its probability within the row, and the position along x.
    pub x: CellSample,
    /// The row, its probability, and the position along y.
    pub y: CellSample,
}

impl GridSample {
    /// Probability of the cell: the very product that [`Table2::probability`] returns.
    #[inline]
    pub fn probability(&self) -> f64 {
        self.y.probability * self.x.probability
    }
}

/// A distribution over the cells of a grid: the row by the marginal table, then the column by the row's own table.
#[derive(Debug, Clone)]
pub struct Table2 {
    width: usize,
    rows: Table1,
    /// Tables of all rows, one after the other, with stride `cdf_len(width)`.
    cdf: Vec<f64>,
    /// Their guides, with stride `guide_len(width)`.
    guide: Vec<u16>,
}

impl Table2 {
    /// Memory that a table takes for each cell, if rows are not of a few cells only.
    pub const BYTES: usize = size_of::<f64>() + 2 * size_of::<u16>();

    /// From `width * height` weights (finite, ≥ 0) given row by row through `weight(x, y)`.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let (stride, guide_stride) = (cdf_len(width), guide_len(width));
        let mut cdf = vec![0.0; stride * height];
        let mut guide = vec![0; guide_stride * height];
        let sums: Vec<f64> = cdf
            .par_chunks_mut(stride)
            .zip(guide.par_chunks_mut(guide_stride))
            .enumerate()
            .map_init(
                || vec![0.0; width],
                |weights, (y, (cdf, guide))| {
                    for (x, w) in weights.iter_mut().enumerate() {
                        *w = weight(x, y);
                    }
                    fill(weights, cdf, guide)
                },
            )
            .collect();
        Self { width, rows: Table1::new(&sums), cdf, guide }
    }

    /// Sum of the weights; when it is 0 nothing can be sampled.
    #[inline]
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    #[inline]
    fn row(&self, y: usize) -> Cdf<'_> {
        let (stride, guide_stride) = (cdf_len(self.width), guide_len(self.width));
        Cdf {
            cdf: &self.cdf[y * stride..(y + 1) * stride],
            guide: &self.guide[y * guide_stride..(y + 1) * guide_stride],
        }
    }

    /// Samples the row with `u[0]`, then the column with `u[1]`, both in \[0, 1); `None` when all weights are 0.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> Option<GridSample> {
        let y = self.rows.sample(u[0])?;
        Some(GridSample { x: self.row(y.cell).sample(u[1]), y })
    }

    /// Probability of a cell (not per area).
    #[inline]
    pub fn probability(&self, x: usize, y: usize) -> f64 {
        self.rows.probability(y) * self.row(y).probability(x)
    }

    /// The `u` that [`Table2::sample`] maps to this place in cell (x, y).
    pub fn invert(&self, (x, y): (usize, usize), (fx, fy): (f64, f64)) -> [f64; 2] {
        [self.rows.invert(y, fy), self.row(y).invert(x, fx)]
    }
}

/// Weights that tables of every kind are tested with.
#[cfg(test)]
fn weights() -> Vec<Vec<f64>> {
    vec![
        vec![1.0],
        vec![0.0, 1.0],
        vec![1.0, 0.0],
        vec![1.0, 2.0, 3.0, 0.0, 4.0],
        vec![0.0, 0.0, 5.0, 0.0],
        (0..1000).map(|i| f64::from(i % 7) * 0.1).collect(),
        (0..1000).map(|i| if i == 400 { 1e12 } else { 1e-12 }).collect(),
        (0..100).map(|i| if i == 0 { 1.0 } else { 1e-300 }).collect(),
        (0..70_000).map(|i| f64::from(i % 3) + if i == 69_000 { 1e5 } else { 0.0 }).collect(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (table, total) = (Table1::new(&w), w.iter().sum::<f64>());
            let mut sum = 0.0;
            for (i, &wi) in w.iter().enumerate() {
                let p = table.probability(i);
                assert!((p - wi / total).abs() < 1e-12, "{p} {wi} {total}");
                assert_eq!(p > 0.0, wi > 0.0, "a cell of positive weight can be sampled");
                sum += p;
            }
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn sample_and_invert_are_inverse() {
        for w in weights() {
            let table = Table1::new(&w);
            for i in 0..2000 {
                let u = (f64::from(i) + 0.5) / 2000.0;
                let at = table.sample(u).unwrap();
                assert!(table.probability(at.cell) > 0.0);
                assert!((table.invert(at.cell, at.offset) - u).abs() < 2e-9 * at.probability + 1e-15);
            }
            // The ends of the interval never leave the table.
            for u in [0.0, f64::MIN_POSITIVE, 1.0f64.next_down()] {
                assert!(table.probability(table.sample(u).unwrap().cell) > 0.0);
            }
        }
    }

    #[test]
    fn two_dimensions_factor() {
        let w = |x: usize, y: usize| ((x + 2 * y) % 4) as f64;
        let table = Table2::new(5, 3, w);
        let mut sum = 0.0;
        for y in 0..3 {
            for x in 0..5 {
                assert!((table.probability(x, y) - w(x, y) / table.total()).abs() < 1e-15);
                sum += table.probability(x, y);
            }
        }
        assert!((sum - 1.0).abs() < 1e-14);
        for i in 0..400 {
            let u = [(f64::from(i % 20) + 0.3) / 20.0, (f64::from(i / 20) + 0.7) / 20.0];
            let at = table.sample(u).unwrap();
            assert!(w(at.x.cell, at.y.cell) > 0.0);
            let back = table.invert((at.x.cell, at.y.cell), (at.x.offset, at.y.offset));
            assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9);
        }
    }

    /// Rows and columns as long as those of a map of 8192 × 4096 texels.
    #[test]
    fn cells_beside_one_of_nearly_all_weight_can_be_sampled() {
        for (width, height) in [(8192, 8), (8, 4096), (1024, 512)] {
            let hot = (width / 3, height / 3);
            let weight = |x: usize, y: usize| if (x, y) == hot { 1e12 } else { 1e-12 };
            let cells = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let table = Table2::new(width, height, weight);
            // The random numbers of a cell's lower corner lead back to it
            for (x, y) in cells() {
                let sample = table.sample(table.invert((x, y), (0.0, 0.0))).unwrap();
                assert_eq!((sample.x.cell, sample.y.cell), (x, y));
                assert!(sample.probability() > 0.0 && sample.probability() == table.probability(x, y), "{x} {y}");
            }
            // A running sum in f32, as many renderers have it, does not grow by the weights of most
            let grows = |weights: &[f64]| -> Vec<bool> {
                let mut sum = 0f32;
                let grows = |weight: &f64| {
                    let before = sum;
                    sum += *weight as f32;
                    sum > before
                };
                weights.iter().map(grows).collect()
            };
            let rows: Vec<Vec<f64>> = (0..height).map(|y| (0..width).map(|x| weight(x, y)).collect()).collect();
            let sums: Vec<f64> = rows.iter().map(|row| row.iter().sum()).collect();
            let sampled = rows.iter().zip(grows(&sums)).filter(|(_, grows)| *grows).map(|(row, _)| grows(row));
            let reached = sampled.flatten().filter(|grows| *grows).count();
            assert!(reached < width * height / 2, "{reached}");
        }
    }
}
