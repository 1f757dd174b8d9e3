//! One cumulative table with its guide: how it is filled, and how a cell is found in it.

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
pub(super) struct Cdf<'a> {
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
pub(super) fn inside(offset: f64) -> f64 {
    offset.clamp(BORDER, 1.0 - BORDER)
}

/// Values in the table of n cells.
#[inline]
pub(super) fn cdf_len(cells: usize) -> usize {
    cells + 1 + PROBES
}

/// Entries in the guide of n cells.
#[inline]
pub(super) fn guide_len(cells: usize) -> usize {
    cells.next_power_of_two() + 2
}

/// Fills a cumulative table and its guide from weights ≥ 0 and returns their sum; if that is 0 the table is all zeros.
///
/// A cell of positive weight always gets a positive probability, even if its weight is 10⁻²⁴ of the sum.
pub(super) fn fill(weights: &[f64], cdf: &mut [f64], guide: &mut [u16]) -> f64 {
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

/// Weights that tables of every kind are tested with.
#[cfg(test)]
pub(super) fn weights() -> Vec<Vec<f64>> {
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
