//! Tests of whether samples depend on those before them.
//!
//! Samples are labelled by the parts of the axes that they lie in. A table counts how often each label follows each label
//! of the past. If samples are independent, then given the past the next label is multinomial with the same probabilities
//! in every row, also where rows overlap, and Pearson's statistic with estimated margins is chi-square distributed with
//! (rows − 1)(columns − 1) degrees of freedom. Source: Billingsley, "Statistical Methods in Markov Chains", Annals of
//! Mathematical Statistics 32, 1961.

use crate::extremes::Extremes;
use crate::grid::Subdivision;
use crate::power::{FEWEST, chi_square_below, chi_square_tail};

/// Expected counts per entry of the table, about.
const SAMPLES_PER_ENTRY: f64 = 20.0;
/// Halvings of each coordinate of the past, at most.
const MOST_BITS: u32 = 4;
/// Samples at the start of a batch by which it is recognized.
const HEAD: usize = 8;

/// The labels of samples and of their pasts.
///
/// The past has two coordinates of 2ᵇ parts each: of one sample of a plane, of two samples of a line. The next label is one
/// of 2ᵇ: parts of a line, or of both axes of a plane together. Three numbers of a generator thus meet in one entry, in which
/// lattices of bad generators (Marsaglia, "Random Numbers Fall Mainly in the Planes", 1968) are seen.
#[derive(Debug, Clone, Copy)]
pub struct Labels {
    bits: u32,
    /// Halvings of each axis.
    of_axes: [u32; 2],
}

impl Labels {
    /// As many as `samples` samples fill.
    pub fn new(subdivision: &Subdivision, samples: u64) -> Self {
        let bits = ((samples as f64 / SAMPLES_PER_ENTRY).log2() / 3.0).at_least(0.0) as u32;
        let of_axes = [0, 1].map(|axis| subdivision.axes.get(axis).map_or(0, |axis| axis.bits()));
        Self { bits: bits.min(MOST_BITS).min(of_axes[0]), of_axes }
    }

    fn is_plane(&self) -> bool {
        self.of_axes[1] > 0
    }

    /// The first `bits` halvings that lead to part number `part` of an axis.
    #[inline]
    fn first(&self, axis: usize, part: usize, bits: u32) -> usize {
        part >> (self.of_axes[axis] - bits)
    }

    #[inline]
    fn past(&self, parts: [usize; 2]) -> usize {
        let second = usize::from(self.is_plane());
        self.first(0, parts[0], self.bits) << self.bits | self.first(second, parts[1], self.bits)
    }

    #[inline]
    fn next(&self, parts: [usize; 2]) -> usize {
        if !self.is_plane() {
            return self.first(0, parts[0], self.bits);
        }
        let second = self.bits / 2;
        self.first(0, parts[0], self.bits - second) << second | self.first(1, parts[1], second)
    }
}

/// Counts of which samples follow which: what tests of serial dependence need.
#[derive(Debug, Clone, Default)]
pub struct SerialCounts {
    /// How often each label follows each label of the past.
    table: Vec<u64>,
    /// Over the batches, for each axis: Σ L² and Σ L n, where L of the n samples of a batch are in the lower half.
    lower: [[u64; 2]; 2],
    /// The number of batches, Σ n and Σ n².
    batches: [u64; 3],
    /// The first samples of each batch.
    heads: Vec<[u64; 2 * HEAD]>,
}

/// What is known of the samples of a batch so far.
#[derive(Debug, Clone, Default)]
pub struct Past {
    /// The parts of the axes that the past consists of, if it is long enough.
    parts: [Option<usize>; 2],
    lower: [u64; 2],
    count: u64,
    head: Vec<u64>,
}

impl SerialCounts {
    pub fn new(labels: &Labels) -> Self {
        Self { table: vec![0; 1 << (3 * labels.bits)], ..Self::default() }
    }

    /// Counts a sample that lies in these parts of the axes.
    #[inline]
    pub fn count(&mut self, labels: &Labels, past: &mut Past, parts: [usize; 2], at: [f64; 2]) {
        if let [Some(a), Some(b)] = past.parts {
            self.table[labels.past([a, b]) << labels.bits | labels.next(parts)] += 1;
        }
        past.parts = if labels.is_plane() { parts.map(Some) } else { [past.parts[1], Some(parts[0])] };
        for (axis, (part, lower)) in parts.into_iter().zip(&mut past.lower).enumerate() {
            *lower += u64::from(labels.of_axes[axis] > 0 && labels.first(axis, part, 1) == 0);
        }
        past.count += 1;
        if past.head.len() < 2 * HEAD {
            past.head.extend(at.map(f64::to_bits));
        }
    }

    /// Ends a batch.
    pub fn end(&mut self, past: Past) {
        let n = past.count;
        for (sums, lower) in self.lower.iter_mut().zip(past.lower) {
            *sums = [sums[0] + lower * lower, sums[1] + lower * n];
        }
        self.batches = [self.batches[0] + 1, self.batches[1] + n, self.batches[2] + n * n];
        self.heads.extend(<[u64; 2 * HEAD]>::try_from(past.head).ok());
    }

    pub fn add(&mut self, other: Self) {
        self.table.iter_mut().zip(other.table).for_each(|(sum, n)| *sum += n);
        let more = other.lower.as_flattened().iter().chain(&other.batches);
        let sums = self.lower.as_flattened_mut().iter_mut().chain(&mut self.batches);
        sums.zip(more).for_each(|(sum, more)| *sum += more);
        self.heads.extend(other.heads);
    }

    /// Statistic, degrees of freedom and p-value of the independence of next label and past; `None` with too few samples.
    ///
    /// Rows and columns that expect too few samples are put together.
    pub fn dependence(&self, labels: &Labels) -> Option<[f64; 3]> {
        let width = 1usize << labels.bits;
        let total = self.table.iter().sum::<u64>() as f64;
        let margin = |of: &dyn Fn(usize) -> usize, len: usize| {
            let mut sums = vec![0u64; len];
            self.table.iter().enumerate().for_each(|(i, n)| sums[of(i)] += n);
            sums
        };
        let (rows, columns) = (margin(&|i| i / width, width * width), margin(&|i| i % width, width));
        let columns = grouped(&columns, total / (4.0 * width as f64))?;
        let least = columns.sums.iter().copied().min()? as f64;
        let rows = grouped(&rows, FEWEST * total / least)?;
        let mut table = vec![0u64; rows.sums.len() * columns.sums.len()];
        for (i, n) in self.table.iter().enumerate() {
            table[rows.group[i / width] * columns.sums.len() + columns.group[i % width]] += n;
        }
        let statistic = table.chunks(columns.sums.len()).zip(&rows.sums).flat_map(|(row, of_row)| {
            row.iter().zip(&columns.sums).map(move |(n, of_column)| {
                let expected = *of_row as f64 * *of_column as f64 / total;
                (*n as f64 - expected).powi(2) / expected
            })
        });
        let (statistic, dof) = (statistic.sum(), ((rows.sums.len() - 1) * (columns.sums.len() - 1)) as f64);
        Some([statistic, dof, chi_square_tail(dof, statistic)])
    }

    /// The probability that batches of independent samples have as equal a share in the lower half of an axis as these, of
    /// the axis where it is smaller; `None` with few batches.
    pub fn stratification(&self) -> Option<f64> {
        const FEWEST: u64 = 8;
        let [batches, samples, squares] = self.batches;
        // For B batches of n samples, Σ (L − qn)²/(nq(1 − q)) is chi-square distributed with B − 1 degrees of freedom.
        let of_axis = |[lower, products]: [u64; 2]| {
            let q = products as f64 / squares.max(1) as f64;
            let spread = (lower as f64 - q * products as f64).at_least(0.0);
            let variance = q * (1.0 - q) * samples as f64 / batches as f64;
            (variance > 1.0).then(|| chi_square_below((batches - 1) as f64, spread / variance))
        };
        let of_axes = (batches >= FEWEST).then(|| self.lower.into_iter().filter_map(of_axis))?;
        of_axes.min_by(f64::total_cmp)
    }

    /// The number of batches that begin with the same samples as another.
    pub fn repeated_batches(&self) -> usize {
        let mut heads = self.heads.clone();
        heads.sort_unstable();
        heads.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }
}

/// A partition of rows or columns: the number of the group of each, and the sums.
struct Groups {
    group: Vec<usize>,
    sums: Vec<u64>,
}

/// Each with at least `least` samples by itself, the others in one group; `None` if there are not two groups.
fn grouped(sums: &[u64], least: f64) -> Option<Groups> {
    let (mut groups, mut rest) = (Groups { group: vec![usize::MAX; sums.len()], sums: Vec::new() }, 0);
    for (i, n) in sums.iter().enumerate() {
        if *n as f64 >= least.at_least(1.0) {
            groups.group[i] = groups.sums.len();
            groups.sums.push(*n);
        } else {
            rest += n;
        }
    }
    // What is left is a group of its own, or joins the last.
    let last = if rest as f64 >= least.at_least(1.0) || groups.sums.is_empty() {
        groups.sums.push(0);
        groups.sums.len() - 1
    } else {
        groups.sums.len() - 1
    };
    groups.sums[last] += rest;
    groups.group.iter_mut().filter(|group| **group == usize::MAX).for_each(|group| *group = last);
    (groups.sums.len() >= 2).then_some(groups)
}
