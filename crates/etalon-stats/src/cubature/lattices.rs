//! Integrals over the leaves of a tree: lattices of points, shifted at random.
//!
//! In many dimensions no product of rules is affordable, and none sees the error of a density that jumps. So each leaf has eight lattices
//! with independent shifts: the mean of their means is the integral, without bias whatever the density is, and their spread tells its
//! standard error. The sides of the box are folded (u ↦ 1 − |2u − 1|), so that smooth densities are periodic. Sources: Cranley &
//! Patterson, "Randomization of Number Theoretic Methods for Multiple Integration", SIAM Journal on Numerical Analysis 13(6), 1976;
//! Hickernell, "Obtaining O(N⁻²⁺ᵋ) Convergence for Lattice Quadrature Rules", MCQMC 2000 (the fold).

use super::pieces::share_within;
use super::{Integrals, InvalidPdf, Probe, Shares, first_invalid};
use crate::domain::steps;
use crate::error::{Cancelled, Result, poll};
use crate::extremes::Extremes;
use crate::grid::Subdivision;
use crate::leaves::Leaves;
use crate::sampler::Density;
use crate::stream::CounterRng;
use rand::RngExt;
use rayon::prelude::*;

/// Lattices of a leaf, and the points that each has at first.
const LATTICES: usize = 8;
const POINTS: usize = 8;
/// Points asked for at a time, about, and most in all.
const BATCH: usize = 1 << 13;
const BUDGET: usize = 1 << 23;
/// How far above the values at its points a leaf may be expected to reach. What is above counts as missed.
const REACH: f64 = 4.0;

/// The points of a leaf, summed up.
#[derive(Debug, Clone, Copy, Default)]
struct Leaf {
    /// Points of each lattice, and the sums of the densities there, per length of the leaves' chart.
    count: usize,
    sums: [f64; LATTICES],
    /// The largest density.
    top: f64,
}

impl Leaf {
    /// The mean density, and the variance of this mean.
    fn mean(&self) -> [f64; 2] {
        let [n, lattices] = [self.count, LATTICES].map(|n| n as f64);
        let mean = self.sums.iter().sum::<f64>() / (n * lattices);
        let squares: f64 = self.sums.iter().map(|sum| (sum / n - mean).powi(2)).sum();
        [mean, squares / (lattices * (lattices - 1.0))]
    }
}

/// What the integrals are for.
pub(crate) struct Wanted<'a, 'g> {
    pub subdivision: &'a Subdivision<'g>,
    /// The number of samples, the least expected count of a cell, and what errors may add to the chi-square statistic of the cells.
    pub samples: f64,
    pub fewest: f64,
    pub slack: f64,
    /// Of the random shifts.
    pub seed: u64,
    pub stream: u64,
}

/// Integrals over the leaves, with their standard errors.
pub(crate) struct Lattices {
    pub integrals: Integrals,
    pub shares: Shares,
    /// For each leaf the density that it is expected to reach, and for each cell the least of these.
    tops: Vec<f64>,
    reach: Vec<f64>,
    pub far: Option<InvalidPdf>,
}

impl Lattices {
    /// Doubles the points of the leaves whose errors matter most until those of the cells do not show, or the budget is spent.
    pub fn new(leaves: &Leaves, density: &dyn Density, wanted: &Wanted, cancelled: Cancelled) -> Result<Self> {
        let Wanted { subdivision, samples: n, fewest, slack, .. } = *wanted;
        let cells = subdivision.grid.len();
        let cell = |leaf: usize| leaf * cells / leaves.len();
        let mut known = vec![Leaf::default(); leaves.len()];
        let (mut coarse, mut spent): (Vec<usize>, usize) = ((0..leaves.len()).collect(), 0);
        let (mut invalid, mut far) = (None, None);
        while !coarse.is_empty() && invalid.is_none() && spent < BUDGET {
            let more = |leaf: &usize| LATTICES * known[*leaf].count.max(POINTS);
            spent += coarse.iter().map(more).sum::<usize>();
            // Leaves that have as many points are asked about together.
            coarse.sort_by_key(|&leaf| known[leaf].count);
            let batches = coarse.chunk_by(|&a, &b| known[a].count == known[b].count);
            let batches: Vec<&[usize]> =
                batches.flat_map(|same| same.chunks((BATCH / more(&same[0])).max(1))).collect();
            let add = |batch: &&[usize]| {
                poll(cancelled)?;
                add(leaves, density, batch, &known, wanted)
            };
            let added = batches.par_iter().map(add).collect::<Result<Vec<_>>>()?;
            for (batch, (better, of_batch)) in batches.iter().zip(added) {
                batch.iter().zip(better).for_each(|(&leaf, better)| known[leaf] = better);
                [invalid, far] = [invalid.or(of_batch[0]), far.or(of_batch[1])];
            }
            // The noncentrality that the error of each leaf adds to the statistic
            let mut expected = vec![0.0; cells];
            let means: Vec<[f64; 2]> = known.iter().map(Leaf::mean).collect();
            let length = 1.0 / leaves.len() as f64;
            means.iter().enumerate().for_each(|(leaf, [mean, _])| expected[cell(leaf)] += n * mean * length);
            let added = |leaf: usize| means[leaf][1] * (n * length).powi(2) / expected[cell(leaf)].at_least(fewest);
            let added: Vec<f64> = (0..leaves.len()).map(added).collect();
            let is_good = added.iter().sum::<f64>() <= 0.5 * slack;
            coarse = (0..leaves.len()).filter(|&leaf| !is_good && added[leaf] > 0.25 * slack * length).collect();
        }

        let mut integrals = Integrals { values: vec![0.0; cells], errors: vec![0.0; cells], invalid };
        let mut shares = Shares::new(subdivision);
        shares.are_independent = true;
        for (leaf, [mean, variance]) in known.iter().map(Leaf::mean).enumerate() {
            let [value, error] = [mean, variance.sqrt()].map(|of| of / leaves.len() as f64);
            integrals.values[cell(leaf)] += value;
            integrals.errors[cell(leaf)] = integrals.errors[cell(leaf)].hypot(error);
            (shares.values.axes[0][leaf], shares.errors.axes[0][leaf]) = (value, error);
        }
        shares.values.cells.copy_from_slice(&integrals.values);
        shares.errors.cells.copy_from_slice(&integrals.errors);
        let tops: Vec<f64> = known.iter().map(|leaf| REACH * leaf.top).collect();
        let least = |tops: &[f64]| tops.iter().copied().fold(f64::INFINITY, f64::at_most);
        let reach = tops.chunks(leaves.len() / cells).map(least).collect();
        Ok(Self { integrals, shares, tops, reach, far })
    }

    /// Whether all leaves of a cell are expected to reach a density.
    #[inline]
    pub fn reaches(&self, cell: usize, density: f64) -> bool {
        density <= self.reach[cell]
    }

    /// The share of the density at a probe that its leaf is expected to reach.
    pub fn share_within(&self, probe: &Probe) -> f64 {
        let leaf = (probe.at[0] * self.tops.len() as f64) as usize;
        share_within(self.tops[leaf.min(self.tops.len() - 1)], probe.density)
    }
}

/// The leaves of a batch, which have as many points, with twice as many; a value that no pdf can have, and one far from all samples, where
/// formulas overflow, which counts as 0.
fn add(
    leaves: &Leaves,
    density: &dyn Density,
    batch: &[usize],
    known: &[Leaf],
    wanted: &Wanted,
) -> Result<(Vec<Leaf>, [Option<InvalidPdf>; 2])> {
    let steps = steps(leaves.space.axes.len());
    let before = known[batch[0]].count;
    let after = if before > 0 { 2 * before } else { POINTS };
    let (mut places, mut factors) = (Vec::new(), Vec::new());
    for &leaf in batch {
        let mut rng = CounterRng::new(wanted.seed, (leaf as u64) << 8 | wanted.stream);
        for _ in 0..LATTICES {
            let shifts: Vec<f64> = steps.iter().map(|_| rng.random()).collect();
            for i in before..after {
                let along = |(step, shift): (&f64, &f64)| 1.0 - (2.0 * (shift + step * i as f64).fract() - 1.0).abs();
                let (place, factor) = leaves.place(leaf, steps.iter().zip(&shifts).map(along));
                places.push(place);
                factors.push(factor);
            }
        }
    }
    let points = leaves.space.functions.from_cube(&places)?;
    let mut values = Vec::with_capacity(points.len());
    density.pdf(&points, &mut values)?;
    let jacobians = leaves.space.functions.jacobian(&places)?;
    let mut far = None;
    for (((value, place), point), factor) in values.iter_mut().zip(&places).zip(&points).zip(factors.iter().zip(jacobians)) {
        if *value != 0.0 {
            *value *= factor.0 * factor.1;
        }
        if (value.is_nan() || *value == f64::INFINITY) && !leaves.is_sampled(place) && !leaves.is_bounded() {
            far = far.or(Some(InvalidPdf { point: *point, value: std::mem::take(value) }));
        }
    }
    let of_leaf = |(&leaf, values): (&usize, &[f64])| {
        let mut better = Leaf { count: after, ..known[leaf] };
        better.top = values.iter().copied().fold(better.top, f64::at_least);
        let of_lattices = better.sums.iter_mut().zip(values.chunks(after - before));
        of_lattices.for_each(|(sum, values)| *sum += values.iter().sum::<f64>());
        better
    };
    let better = batch.iter().zip(values.chunks(LATTICES * (after - before))).map(of_leaf).collect();
    Ok((better, [first_invalid(&points, &values), far]))
}
