//! Piecewise-constant distributions: cumulative tables with a guide, in one and two dimensions, and the alias method.
//!
//! Probabilities are differences of the *stored* table, so that what is drawn and what the density says agree to the
//! last bit. Cells are found through a guide (cutpoint) table: one look-up per draw and a short search, monotone in
//! `u`, hence invertible and safe for stratified numbers. Source: Chen & Asau, "On generating random variates from an
//! empirical distribution", AIIE Transactions 6(2), 1974.

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
    /// For bucket b of 2ᵏ ≥ 2n: the first cell that ends beyond b / 2ᵏ; one more entry closes the last bucket.
    guide: &'a [u32],
}

/// Cell ends that are compared with `u` without a branch; buckets with more (at most one in eight) are bisected.
const PROBES: usize = 8;

/// How many draws [`Table2::draw_batch`] takes at once.
pub const BATCH: usize = 64;

impl Cdf<'_> {
    #[inline]
    fn probability(self, cell: usize) -> f64 {
        self.cdf[cell + 1] - self.cdf[cell]
    }

    /// The cells that the guide leaves in question for `u`: the first and the last of them.
    #[inline]
    fn bracket(self, u: f64) -> (u32, u32) {
        // The number of buckets is a power of two, so u · buckets is exact and cannot round into the next bucket.
        let bucket = (u * (self.guide.len() - 1) as f64) as usize;
        (self.guide[bucket], self.guide[bucket + 1])
    }

    /// The draw for `u` in one of the cells of a bracket. Which cell it is cannot be predicted, so the common way has
    /// no branch that depends on it: the processor overlaps the table look-ups of successive draws.
    #[inline]
    fn draw_within(self, (first, last): (u32, u32), u: f64) -> Draw {
        let (first, last) = (first as usize, last as usize);
        let ends = &self.cdf[first + 1..];
        let passed = if last - first > PROBES {
            ends[..last - first].partition_point(|&end| end <= u)
        } else {
            ends[..PROBES].iter().map(|&end| usize::from(end <= u)).sum()
        };
        let cell = first + passed;
        let (start, probability) = (self.cdf[cell], self.probability(cell));
        Draw { cell, offset: ((u - start) / probability).clamp(BORDER, 1.0 - BORDER), probability }
    }

    #[inline]
    fn draw(self, u: f64) -> Draw {
        self.draw_within(self.bracket(u), u)
    }

    fn invert(self, cell: usize, offset: f64) -> f64 {
        self.cdf[cell] + offset * self.probability(cell)
    }
}

#[inline]
fn cdf_len(cells: usize) -> usize {
    cells + 1 + PROBES
}

#[inline]
fn guide_len(cells: usize) -> usize {
    (cells.next_power_of_two() / 2).max(1) + 1
}

/// Fills a cumulative table and its guide from weights ≥ 0 and returns their sum; if that is 0 the table is all zeros.
///
/// A cell of positive weight always gets a positive probability, be it 10⁻²⁴ of the whole.
fn fill(weights: &[f64], cdf: &mut [f64], guide: &mut [u32]) -> f64 {
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
    let buckets = guide.len() - 1;
    let mut cell = 0;
    for (b, entry) in guide.iter_mut().enumerate() {
        let start = b as f64 / buckets as f64;
        while cell < n - 1 && cdf[cell + 1] <= start {
            cell += 1;
        }
        *entry = cell as u32;
    }
    guide[buckets] = last as u32;
    total
}

/// A distribution over n cells of a line.
#[derive(Debug, Clone)]
pub struct Table1 {
    cdf: Vec<f64>,
    guide: Vec<u32>,
    total: f64,
}

impl Table1 {
    /// From at least one weight, all finite and ≥ 0.
    #[must_use]
    pub fn new(weights: &[f64]) -> Self {
        debug_assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0));
        let mut cdf = vec![0.0; cdf_len(weights.len())];
        let mut guide = vec![0; guide_len(weights.len())];
        let total = fill(weights, &mut cdf, &mut guide);
        Self { cdf, guide, total }
    }

    #[inline]
    fn view(&self) -> Cdf<'_> {
        Cdf { cdf: &self.cdf, guide: &self.guide }
    }

    /// Sum of the weights; when it is 0 nothing can be drawn.
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

/// A cell of a grid and the position inside it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Draw2 {
    pub x: Draw,
    pub y: Draw,
}

impl Draw2 {
    /// Probability of the cell: the very product that [`Table2::probability`] returns.
    #[inline]
    #[must_use]
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
    guide: Vec<u32>,
}

impl Table2 {
    /// From `width * height` weights (finite, ≥ 0) given row by row through `weight(x, y)`.
    #[must_use]
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        use rayon::prelude::*;
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

    /// Sum of the weights; when it is 0 nothing can be drawn.
    #[inline]
    #[must_use]
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

    /// Draws the row with `u[0]`, then the column with `u[1]`, both in \[0, 1); `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn draw(&self, u: [f64; 2]) -> Option<Draw2> {
        let y = self.rows.draw(u[0])?;
        Some(Draw2 { x: self.row(y.cell).draw(u[1]), y })
    }

    /// [`Table2::draw`] for up to [`BATCH`] pairs at once: step by step for all of them, so that the processor waits
    /// for their table look-ups together. Returns how many were drawn: none from weights that are all 0.
    #[inline]
    pub fn draw_batch(&self, u: &[[f64; 2]], out: &mut [Draw2; BATCH]) -> usize {
        if self.total() <= 0.0 {
            return 0;
        }
        let n = u.len().min(BATCH);
        let mut bracket = [(0u32, 0u32); BATCH];
        for (draw, u) in out.iter_mut().zip(&u[..n]) {
            draw.y = self.rows.view().draw(u[0]);
        }
        for ((bracket, draw), u) in bracket.iter_mut().zip(&*out).zip(&u[..n]) {
            *bracket = self.row(draw.y.cell).bracket(u[1]);
        }
        for ((bracket, draw), u) in bracket.iter().zip(&mut *out).zip(&u[..n]) {
            draw.x = self.row(draw.y.cell).draw_within(*bracket, u[1]);
        }
        n
    }

    /// Probability of a cell (not per area).
    #[inline]
    #[must_use]
    pub fn probability(&self, x: usize, y: usize) -> f64 {
        self.rows.probability(y) * self.row(y).probability(x)
    }

    /// The `u` that [`Table2::draw`] maps to this place in cell (x, y).
    #[must_use]
    pub fn invert(&self, (x, y): (usize, usize), (fx, fy): (f64, f64)) -> [f64; 2] {
        [self.rows.invert(y, fy), self.row(y).invert(x, fx)]
    }
}

/// The alias method: constant time per draw, but neither monotone nor invertible, which spoils stratified numbers.
///
/// Source: Walker 1977; built as in Vose, "A linear algorithm for generating random numbers with a given
/// distribution", IEEE Trans. Softw. Eng. 17(9), 1991.
#[derive(Debug, Clone)]
pub struct AliasTable {
    entries: Vec<AliasEntry>,
    total: f64,
}

#[derive(Debug, Clone, Copy)]
struct AliasEntry {
    /// Share of the bucket that belongs to the cell itself.
    keep: f32,
    /// The cell that owns the rest.
    other: u32,
    /// Probability of the cell, as the finished table realizes it.
    probability: f64,
}

impl AliasTable {
    /// From at least one and fewer than 2³² weights, all finite and ≥ 0.
    #[must_use]
    pub fn new(weights: &[f64]) -> Self {
        let n = weights.len();
        let total: f64 = weights.iter().sum();
        let mut entries: Vec<AliasEntry> =
            (0..n).map(|i| AliasEntry { keep: 1.0, other: i as u32, probability: 0.0 }).collect();
        if total <= 0.0 {
            return Self { entries, total: 0.0 };
        }
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
        let (mut small, mut large): (Vec<u32>, Vec<u32>) = (0..n as u32).partition(|&i| scaled[i as usize] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            let (s, l) = (s as usize, l as usize);
            entries[s] = AliasEntry { keep: scaled[s] as f32, other: l as u32, probability: 0.0 };
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l as u32);
            }
        }
        // What is left over is 1 but for rounding, unless its weight is 0: such a cell must never be drawn.
        let heaviest = (0..n).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
        for &i in &small {
            if weights[i as usize] == 0.0 {
                entries[i as usize] = AliasEntry { keep: 0.0, other: heaviest as u32, probability: 0.0 };
            }
        }
        let mut probability = vec![0.0; n];
        for (i, e) in entries.iter().enumerate() {
            probability[i] += f64::from(e.keep) / n as f64;
            probability[e.other as usize] += (1.0 - f64::from(e.keep)) / n as f64;
        }
        for (e, p) in entries.iter_mut().zip(probability) {
            e.probability = p;
        }
        Self { entries, total }
    }

    /// Sum of the weights; when it is 0 nothing can be drawn.
    #[inline]
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The cell for `u` in \[0, 1), and what is left of `u` as the position inside it; `None` when all weights are 0.
    #[inline]
    #[must_use]
    pub fn draw(&self, u: f64) -> Option<Draw> {
        if self.total <= 0.0 {
            return None;
        }
        let scaled = u * self.entries.len() as f64;
        let bucket = (scaled as usize).min(self.entries.len() - 1);
        let (rest, entry) = (scaled - bucket as f64, &self.entries[bucket]);
        let keep = f64::from(entry.keep);
        let (cell, offset) =
            if rest < keep { (bucket, rest / keep) } else { (entry.other as usize, (rest - keep) / (1.0 - keep)) };
        let probability = self.probability(cell);
        Some(Draw { cell, offset: offset.clamp(BORDER, 1.0 - BORDER), probability })
    }

    /// Probability of a cell, as the table realizes it.
    #[inline]
    #[must_use]
    pub fn probability(&self, cell: usize) -> f64 {
        self.entries[cell].probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        ]
    }

    #[test]
    fn probabilities_are_the_weights() {
        for w in weights() {
            let (table, alias, total) = (Table1::new(&w), AliasTable::new(&w), w.iter().sum::<f64>());
            let mut sum = 0.0;
            for (i, &wi) in w.iter().enumerate() {
                let p = table.probability(i);
                assert!((p - wi / total).abs() < 1e-12, "{p} {wi} {total}");
                assert_eq!(p > 0.0, wi > 0.0, "a cell of positive weight can be drawn");
                assert!((alias.probability(i) - wi / total).abs() < 1e-7);
                assert!(wi > 0.0 || alias.probability(i) == 0.0);
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
        assert_eq!(AliasTable::new(&[0.0]).draw(0.5), None);
        assert_eq!(Table2::new(3, 2, |_, _| 0.0).draw([0.1, 0.9]), None);
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
            let draw = table.draw(u).unwrap();
            assert!(w(draw.x.cell, draw.y.cell) > 0.0);
            let back = table.invert((draw.x.cell, draw.y.cell), (draw.x.offset, draw.y.offset));
            assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9);
        }
    }

    #[test]
    fn alias_draws_its_own_probabilities() {
        let w = [1.0, 0.0, 3.0, 0.5, 0.5];
        let table = AliasTable::new(&w);
        let n = 100_000u32;
        let mut counts = [0u32; 5];
        for i in 0..n {
            counts[table.draw((f64::from(i) + 0.5) / f64::from(n)).unwrap().cell] += 1;
        }
        for (i, &c) in counts.iter().enumerate() {
            assert!((f64::from(c) / f64::from(n) - table.probability(i)).abs() < 5.0 / f64::from(n), "{counts:?}");
        }
    }
}
