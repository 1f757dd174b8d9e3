//! Piecewise-constant distributions: cumulative tables with a guide, in one and two dimensions.
//!
//! Probabilities are differences of the *stored* table, so that what is sampled and what the density says agree to the
//! last bit. Cells are found through a guide (cutpoint) table: one look-up per draw and a short search, monotone in
//! `u`, hence invertible and safe for stratified numbers. Source: Chen & Asau, "On generating random variates from an
//! empirical distribution", AIIE Transactions 6(2), 1974.

mod grid;

pub use grid::{Draw2, Table2};

/// Share of a cell that is kept free at its borders: a position never rounds into the neighbour cell.
const BORDER: f64 = 1e-9;

/// A cell and the position inside it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Draw {
    pub cell: usize,
    /// Position inside the cell, in (0, 1).
    pub offset: f64,
    /// Probability of the cell.
    pub probability: f64,
}

/// A view of one cumulative table of n cells.
#[derive(Debug, Clone, Copy)]
struct Cdf<'a> {
    /// n + 1 values from 0 to 1, then [`PROBES`] more that no `u` reaches.
    cdf: &'a [f64],
    /// For b from 0 to B = 2ᵏ ≥ n: the first cell that ends beyond (b − ½) / B, or 65535 if it is a later one; another
    /// entry closes the last bucket.
    guide: &'a [u16],
}

/// Cell ends that are compared with `u` without a branch; buckets with more are bisected.
const PROBES: usize = 4;

/// The bucket of `u` in a guide of B = `buckets`: u · B, which is exact, to the nearest integer.
///
/// Adding 2⁵² + 2⁵¹ rounds, and leaves the integer in the lowest bits: unlike a cast it vectorizes.
#[inline]
fn bucket(u: f64, buckets: f64) -> usize {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    (u * buckets + ROUND).to_bits() as u32 as usize
}

impl Cdf<'_> {
    #[inline]
    fn probability(self, cell: usize) -> f64 {
        self.cdf[cell + 1] - self.cdf[cell]
    }

    /// The cell for `u`, its start and its probability.
    #[inline]
    fn find(self, u: f64) -> (usize, f64, f64) {
        let bucket = bucket(u, (self.guide.len() - 2) as f64);
        let bracket = [self.guide[bucket], self.guide[bucket + 1]];
        find(self.cdf, 0, self.cdf.len() - cdf_len(0), bracket, u)
    }

    #[inline]
    fn draw(self, u: f64) -> Draw {
        let (cell, start, probability) = self.find(u);
        Draw { cell, offset: inside((u - start) / probability), probability }
    }

    fn invert(self, cell: usize, offset: f64) -> f64 {
        self.cdf[cell] + offset * self.probability(cell)
    }
}

/// The cell for `u` in the table of n `cells` at `base`, its start and its probability.
///
/// The guide says where it is, if not exactly which: that cannot be predicted, so the common way has no branch that
/// depends on it, and the processor overlaps the look-ups of many draws.
#[inline(always)]
fn find(tables: &[f64], base: usize, cells: usize, [first, last]: [u16; 2], u: f64) -> (usize, f64, f64) {
    let first_cell = usize::from(first);
    if last - first > PROBES as u16 || last == u16::MAX {
        let last_cell = if last == u16::MAX { cells - 1 } else { usize::from(last) };
        return bisect(&tables[base..base + last_cell + 2], first_cell, u);
    }
    let near = &tables[base + first_cell..][..PROBES + 2];
    let passed: usize = near[1..=PROBES].iter().map(|&end| usize::from(end <= u)).sum();
    (first_cell + passed, near[passed], near[passed + 1] - near[passed])
}

/// The cell for `u` from `first` to the last of a table.
#[cold]
#[inline(never)]
fn bisect(cdf: &[f64], first: usize, u: f64) -> (usize, f64, f64) {
    let cell = first + cdf[first + 1..cdf.len() - 1].partition_point(|&end| end <= u);
    (cell, cdf[cell], cdf[cell + 1] - cdf[cell])
}

/// A position in a cell, kept off the borders.
#[inline]
pub(super) fn inside(offset: f64) -> f64 {
    offset.clamp(BORDER, 1.0 - BORDER)
}

#[inline]
fn cdf_len(cells: usize) -> usize {
    cells + 1 + PROBES
}

#[inline]
fn guide_len(cells: usize) -> usize {
    cells.next_power_of_two() + 2
}

/// Fills a cumulative table and its guide from weights ≥ 0 and returns their sum; if that is 0 the table is all zeros.
///
/// A cell of positive weight always gets a positive probability, be it 10⁻²⁴ of the whole.
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
    // The table must end at 1 exactly; make room from the right where rounding left none.
    let last = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
    cdf[last + 1..].fill(1.0);
    for i in (0..=last).rev() {
        let room = if weights[i] > 0.0 { cdf[i + 1].next_down() } else { cdf[i + 1] };
        if cdf[i] <= room {
            break;
        }
        cdf[i] = room;
    }
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
    #[must_use]
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
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The cell for `u` in \[0, 1) and the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn draw(&self, u: f64) -> Option<Draw> {
        (self.total > 0.0).then(|| self.view().draw(u))
    }

    /// Probability of a cell (not per length).
    #[inline]
    #[must_use]
    pub fn probability(&self, cell: usize) -> f64 {
        self.view().probability(cell)
    }

    /// The `u` that [`Table1::draw`] maps to this place.
    #[must_use]
    pub fn invert(&self, cell: usize, offset: f64) -> f64 {
        self.view().invert(cell, offset)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn weights() -> Vec<Vec<f64>> {
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

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (table, total) = (Table1::new(&w), w.iter().sum::<f64>());
            let mut sum = 0.0;
            for (i, &wi) in w.iter().enumerate() {
                let p = table.probability(i);
                assert!((p - wi / total).abs() < 1e-12, "{p} {wi} {total}");
                assert_eq!(p > 0.0, wi > 0.0, "a cell of positive weight can be drawn");
                sum += p;
            }
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn draw_and_invert_are_inverse() {
        for w in weights() {
            let table = Table1::new(&w);
            for i in 0..2000 {
                let u = (f64::from(i) + 0.5) / 2000.0;
                let draw = table.draw(u).unwrap();
                assert!(table.probability(draw.cell) > 0.0);
                assert!((table.invert(draw.cell, draw.offset) - u).abs() < 2e-9 * draw.probability + 1e-15);
            }
            // The ends of the interval never leave the table.
            for u in [0.0, f64::MIN_POSITIVE, 1.0f64.next_down()] {
                assert!(table.probability(table.draw(u).unwrap().cell) > 0.0);
            }
        }
    }

    #[test]
    fn the_guide_finds_what_a_search_finds() {
        for w in weights() {
            let table = Table1::new(&w);
            for i in 0..5000u32 {
                let u = f64::from(i) / 5000.0;
                let expected = table.cdf[1..=w.len()].partition_point(|&end| end <= u);
                assert_eq!(table.draw(u).unwrap().cell, expected, "{u}");
            }
        }
    }

    #[test]
    fn nothing_can_be_drawn_from_nothing() {
        assert_eq!(Table1::new(&[0.0, 0.0]).draw(0.5), None);
    }
}
