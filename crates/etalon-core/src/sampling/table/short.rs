//! Many distributions over as many cells each, in single precision and without a guide: small, and fast for up to some hundred
//! cells, among which a cell is found by counting those that end before it.

use super::super::prefetch;
use super::{CellSample, inside};
use rayon::prelude::*;

/// Distributions over n cells each.
#[derive(Debug, Clone)]
pub struct ShortTables {
    cells: usize,
    /// From table to table: `cells` to a multiple of [`LANES`].
    stride: usize,
    /// One table after the other: the ends of the cells, the last one 1, and infinity up to the stride; zeros where all weights
    /// are 0.
    ends: Vec<f32>,
}

/// Most ends that processors compare together.
const LANES: usize = 16;

impl ShortTables {
    /// Memory for each cell, if tables are not of a few cells only.
    pub const BYTES: usize = size_of::<f32>();

    /// `count` tables from weights (finite, ≥ 0) of their cells, written by `weights(table, cells)`; and the sums of their
    /// weights.
    pub fn new(cells: usize, count: usize, weights: impl Fn(usize, &mut [f64]) + Sync) -> (Self, Vec<f64>) {
        let stride = cells.next_multiple_of(LANES);
        let mut ends = vec![f32::INFINITY; stride * count];
        let one = |(buffer, sums): &mut (Vec<f64>, Vec<f64>), (table, ends): (usize, &mut [f32])| {
            weights(table, buffer);
            fill(buffer, sums, &mut ends[..cells])
        };
        let buffers = || (vec![0.0; cells], vec![0.0; cells]);
        let sums = ends.par_chunks_mut(stride).enumerate().map_init(buffers, one).collect();
        (Self { cells, stride, ends }, sums)
    }

    #[inline(always)]
    fn of(&self, table: usize) -> &[f32] {
        &self.ends[table * self.stride..][..self.stride]
    }

    /// Starts to bring the first cells of a table into the cache.
    #[inline(always)]
    pub fn prefetch(&self, table: usize) {
        prefetch(&self.ends, table * self.stride);
    }

    /// The cell of a table for `u` in \[0, 1) and the position inside it; a probability of 0 when all weights are 0.
    #[inline(always)]
    pub fn sample(&self, table: usize, u: f64) -> CellSample {
        let ends = self.of(table);
        // What is at most u is at most u rounded down; where rounding to the nearest went up, the result is positive.
        let nearest = u as f32;
        let below = f32::from_bits(nearest.to_bits() - u32::from(f64::from(nearest) > u));
        let mut passed = [0; LANES];
        for ends in ends.as_chunks::<LANES>().0 {
            for i in 0..LANES {
                passed[i] += u32::from(ends[i] <= below);
            }
        }
        let cell = (passed.iter().sum::<u32>() as usize).min(self.cells - 1);
        let [start, end] = bounds(ends, cell);
        CellSample { cell, offset: inside((u - start) / (end - start)), probability: end - start }
    }

    #[inline]
    pub fn probability(&self, table: usize, cell: usize) -> f64 {
        let [start, end] = bounds(self.of(table), cell);
        end - start
    }
}

/// Start and end of a cell.
#[inline(always)]
fn bounds(ends: &[f32], cell: usize) -> [f64; 2] {
    let start = if cell > 0 { ends[cell - 1] } else { 0.0 };
    [f64::from(start), f64::from(ends[cell])]
}

/// Fills the ends of a table's cells and returns the sum of its weights. A cell of positive weight always gets a positive
/// probability. `sums` is a buffer of as many.
fn fill(weights: &[f64], sums: &mut [f64], ends: &mut [f32]) -> f64 {
    let Some(last) = weights.iter().rposition(|&w| w > 0.0) else {
        ends.fill(0.0);
        return 0.0;
    };
    let mut total = 0.0;
    for (sum, &w) in sums.iter_mut().zip(weights) {
        total += w;
        *sum = total;
    }
    let scale = 1.0 / total;
    ends.iter_mut().zip(&*sums).for_each(|(end, sum)| *end = (sum * scale) as f32);
    // Where rounding left no probability to a cell, move its end and what follows.
    let pairs = ends.windows(2).zip(&weights[1..]);
    let lost = pairs.fold(0, |lost, (ends, &w)| lost + u32::from((w > 0.0) & (ends[1] <= ends[0])));
    if lost > 0 || (weights[0] > 0.0 && ends[0] == 0.0) {
        let mut start = 0.0f32;
        for (end, &w) in ends.iter_mut().zip(weights) {
            *end = if w > 0.0 { end.max(start.next_up()) } else { start };
            start = *end;
        }
    }
    // Let the table end at 1 exactly, and restore increasing values from the right where rounding left no gap.
    ends[last..].fill(1.0);
    for i in (1..=last).rev() {
        let largest = if weights[i] > 0.0 { ends[i].next_down() } else { ends[i] };
        if ends[i - 1] <= largest {
            break;
        }
        ends[i - 1] = largest;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::super::weights;
    use super::*;

    #[test]
    fn probabilities_are_the_weights_and_samples_follow_them() {
        let black = vec![0.0; 5];
        for w in weights().into_iter().chain([black]).filter(|w| w.len() <= 1000) {
            let (n, zeros) = (w.len(), vec![0.0; w.len()]);
            // The table between others.
            let weights = |table, cells: &mut [f64]| cells.copy_from_slice(if table == 1 { &w } else { &zeros });
            let (tables, sums) = ShortTables::new(n, 3, weights);
            let total = w.iter().sum::<f64>();
            assert_eq!(sums, [0.0, total, 0.0]);
            for (i, &wi) in w.iter().enumerate() {
                let p = tables.probability(1, i);
                let expected = if total > 0.0 { wi / total } else { 0.0 };
                assert!((p - expected).abs() < 1e-4 && (p > 0.0) == (wi > 0.0), "{p} {expected}");
            }
            for u in (0..5000).map(|i| f64::from(i) / 5000.0).chain([f64::MIN_POSITIVE, 1.0f64.next_down()]) {
                let at = tables.sample(1, u);
                if total == 0.0 {
                    assert_eq!(at.probability, 0.0);
                    continue;
                }
                let start: f64 = (0..at.cell).map(|i| tables.probability(1, i)).sum();
                assert!(start <= u && u < start + at.probability && (0.0..1.0).contains(&at.offset));
                assert_eq!(at.probability, tables.probability(1, at.cell));
            }
            assert_eq!(tables.sample(0, 0.5).probability, 0.0);
        }
    }
}
