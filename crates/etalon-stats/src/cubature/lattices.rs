//! Integrals over the leaves of a tree: lattices of points, shifted at random.
//!
//! In many dimensions no product of rules is affordable, and none knows its error where a density jumps. So each piece of a leaf has eight
//! lattices with independent shifts: the mean of their means is the integral, without bias whatever the density is, and their spread
//! tells its standard error. Pieces whose errors matter are halved. The sides of a piece are folded (u ↦ 1 − |2u − 1|), so that smooth
//! densities are periodic. Sources: Cranley & Patterson, "Randomization of Number Theoretic Methods for Multiple Integration",
//! SIAM Journal on Numerical Analysis 13(6), 1976; Hickernell, "Obtaining O(N⁻²⁺ᵋ) Convergence for Lattice Quadrature Rules", MCQMC
//! 2000 (the fold); Press & Farrar, "Recursive Stratified Sampling for Multidimensional Monte Carlo Integration", Computers in Physics
//! 4, 1990 (the axis).

use super::pieces::share_within;
use super::{Integrals, InvalidPdf, Probe, Shares, first_invalid};
use crate::domain::{Place, steps};
use crate::error::{Cancelled, Result, poll};
use crate::extremes::Extremes;
use crate::grid::Subdivision;
use crate::leaves::Leaves;
use crate::parallel::each;
use crate::power::FEWEST;
use crate::sampler::Density;
use crate::stream::CounterRng;
use rand::RngExt;
use std::sync::{Mutex, PoisonError};

/// Lattices of a piece, and the points of each.
pub const LATTICES: usize = 8;
const POINTS: usize = 4;
/// Pieces of which points are asked for at a time, and most points in all.
const PIECES: usize = 128;
const BUDGET: usize = 1 << 23;
/// How far above the values at its points a leaf may be expected to reach. What is above counts as missed.
const REACH: f64 = 4.0;
/// The share of the variance of a cell's count that the variance of its integral should stay below. About as many more samples make up
/// for it: that takes fewer values in all than precise integrals do.
pub const NOISE: f64 = 0.08;

/// What lattices are believed to gain over independent points, as a share of these points' variance.
const GAIN: f64 = 0.1;

/// A part of a leaf.
#[derive(Debug, Clone)]
struct Piece {
    leaf: usize,
    /// Its sides in units of the leaf's, and the samples of the pilot in it, by number.
    sides: Vec<[f64; 2]>,
    known: Vec<usize>,
    /// What it adds to the mean density of the leaf, per length of the leaves' chart, and the variance of this.
    mean: f64,
    variance: f64,
    /// The variance that decides whether it is halved.
    doubt: f64,
    /// The largest density at its points, and whether a sample of the pilot has one that is beyond reach.
    top: f64,
    is_missed: bool,
    /// The axis across which halves differ most.
    axis: usize,
}

impl Piece {
    fn new(leaf: usize, sides: Vec<[f64; 2]>, known: Vec<usize>) -> Self {
        Self { leaf, sides, known, mean: 0.0, variance: 0.0, doubt: 0.0, top: 0.0, is_missed: false, axis: 0 }
    }

    fn halves(self, pilot: &[Known]) -> [Self; 2] {
        let Self { leaf, sides, axis, .. } = self;
        let [from, to] = sides[axis];
        let middle = 0.5 * (from + to);
        let (low, high) = self.known.into_iter().partition(|&sample| pilot[sample].at[axis] < middle);
        [([from, middle], low), ([middle, to], high)].map(|(side, known)| {
            let mut sides = sides.clone();
            sides[axis] = side;
            Self::new(leaf, sides, known)
        })
    }

    /// Takes the densities at its points, which are `at` these places from 0 to 1 along its sides.
    fn take(&mut self, values: &[f64], at: &[f64], pilot: &[Known]) {
        let volume: f64 = self.sides.iter().map(|[from, to]| to - from).product();
        let of_lattices = values.chunks(POINTS).map(|values| volume * values.iter().sum::<f64>() / POINTS as f64);
        let of_lattices: Vec<f64> = of_lattices.collect();
        self.mean = of_lattices.iter().sum::<f64>() / LATTICES as f64;
        let squares: f64 = of_lattices.iter().map(|mean| (mean - self.mean).powi(2)).sum();
        self.variance = squares / (LATTICES * (LATTICES - 1)) as f64;
        // Eight lattices that miss the same corner agree with each other; their points differ.
        let n = values.len() as f64;
        let squares: f64 = values.iter().map(|value| (volume * value - self.mean).powi(2)).sum();
        self.doubt = self.variance.at_least(GAIN * squares / (n * (n - 1.0)));
        self.top = values.iter().copied().fold(self.top, f64::at_least);
        self.is_missed = self.known.iter().any(|&sample| pilot[sample].density > REACH * self.top);
        // Across which axis do the standard deviations of the halves add up to least?
        let dimension = self.sides.len();
        let deviation = |axis: usize, is_upper: bool| {
            let half = values.iter().zip(at.chunks(dimension)).filter(|(_, at)| (at[axis] >= 0.5) == is_upper);
            let [n, sum, squares] =
                half.fold([0.0; 3], |[n, sum, squares], (value, _)| [n + 1.0, sum + value, squares + value * value]);
            (squares - sum * sum / f64::at_least(n, 1.0)).at_least(0.0).sqrt()
        };
        let both = |axis: usize| deviation(axis, false) + deviation(axis, true);
        let all: Vec<f64> = (0..dimension).map(both).collect();
        self.axis = (0..dimension).min_by(|&a, &b| all[a].total_cmp(&all[b])).unwrap_or(0);
    }
}

/// A sample of the pilot: its place in its leaf, from 0 to 1 along the sides, and the density there, per length of the leaves' chart.
struct Known {
    at: Place,
    density: f64,
}

/// What the integrals are for.
pub(crate) struct Wanted<'a, 'g> {
    pub subdivision: &'a Subdivision<'g>,
    /// The number of samples.
    pub samples: f64,
    /// Places of samples, at which the density is to be within reach.
    pub known: &'a [Place],
    /// Seed and stream of the random shifts.
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
    /// Halves the pieces whose errors matter most until those of the cells hardly matter, or the budget is spent.
    pub fn new(leaves: &Leaves, density: &dyn Density, wanted: &Wanted, cancelled: Cancelled) -> Result<Self> {
        let Wanted { subdivision, samples: n, .. } = *wanted;
        let (cells, length) = (subdivision.grid.len(), 1.0 / leaves.len() as f64);
        let cell = |leaf: usize| leaf * cells / leaves.len();
        let whole = vec![[0.0, 1.0]; leaves.space.axes.len()];
        let mut open: Vec<Piece> = (0..leaves.len()).map(|leaf| Piece::new(leaf, whole.clone(), Vec::new())).collect();
        let mut pilot = Vec::new();
        let (values, ..) = densities(leaves, density, wanted.known, &vec![1.0; wanted.known.len()])?;
        for (place, value) in wanted.known.iter().zip(values).filter(|(_, value)| value.is_finite()) {
            let (leaf, at, factor) = leaves.find(place);
            open[leaf].known.push(pilot.len());
            pilot.push(Known { at: leaves.within(leaf, at), density: factor * value });
        }
        let mut pieces: Vec<Piece> = Vec::new();
        let (mut spent, mut asked, mut invalid, mut far) = (0, 0, None, None);
        let mut is_fresh = false;
        loop {
            spent += open.len() * LATTICES * POINTS;
            let batches: Vec<Mutex<&mut [Piece]>> = open.chunks_mut(PIECES).map(Mutex::new).collect();
            let ask = |number: u64| {
                poll(cancelled)?;
                let mut batch = batches[number as usize].lock().unwrap_or_else(PoisonError::into_inner);
                sample(leaves, density, &mut batch, &pilot, [wanted.seed, (asked + number) << 8 | wanted.stream])
            };
            let found = each(batches.len() as u64, ask)?;
            asked += found.len() as u64;
            for [of_invalid, of_far] in found {
                (invalid, far) = (invalid.or(of_invalid), far.or(of_far));
            }
            pieces.append(&mut open);
            // The share of the variance of its cell's count that the error of each piece adds
            let mut expected = vec![0.0; cells];
            pieces.iter().for_each(|piece| expected[cell(piece.leaf)] += n * length * piece.mean);
            let noise = |piece: &Piece, variance: f64| {
                variance * (n * length).powi(2) / expected[cell(piece.leaf)].at_least(FEWEST)
            };
            let allowed = NOISE * cells as f64;
            let is_good = pieces.iter().map(|piece| noise(piece, piece.variance)).sum::<f64>() <= allowed;
            if is_fresh && (is_good || spent > BUDGET) || invalid.is_some() {
                break;
            }
            // Pieces that happen to look smooth are not halved, and their integrals are too low: those that count are of fresh points.
            let all: f64 = pieces.iter().map(|piece| noise(piece, piece.doubt)).sum();
            let least = if all > 0.5 * allowed { 0.5 * allowed / pieces.len() as f64 } else { f64::INFINITY };
            let is_coarse = |piece: &Piece| piece.is_missed || noise(piece, piece.doubt) > least;
            let (coarse, fine): (Vec<Piece>, Vec<Piece>) = pieces.into_iter().partition(is_coarse);
            is_fresh = coarse.is_empty() || spent > BUDGET;
            (open, pieces) = if is_fresh {
                ([coarse, fine].concat(), Vec::new())
            } else {
                (coarse.into_iter().flat_map(|piece| piece.halves(&pilot)).collect(), fine)
            };
        }

        let mut integrals = Integrals { values: vec![0.0; cells], errors: vec![0.0; cells], invalid };
        let (mut shares, mut tops) = (Shares::new(subdivision), vec![0.0f64; leaves.len()]);
        shares.are_independent = true;
        for Piece { leaf, mean, variance, top, .. } in &pieces {
            let of_axis = [&mut shares.values.axes[0][*leaf], &mut shares.errors.axes[0][*leaf]];
            let of_cell = [&mut integrals.values[cell(*leaf)], &mut integrals.errors[cell(*leaf)]];
            for [value, error] in [of_axis, of_cell] {
                *value += length * mean;
                *error = error.hypot(length * variance.sqrt());
            }
            tops[*leaf] = tops[*leaf].at_least(REACH * top);
        }
        shares.values.cells.copy_from_slice(&integrals.values);
        shares.errors.cells.copy_from_slice(&integrals.errors);
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

/// Asks for the density in pieces, with random shifts from a seed and a stream. Returns a value that no pdf can have; and one far from all
/// samples, where formulas overflow, which counts as 0.
fn sample(
    leaves: &Leaves,
    density: &dyn Density,
    batch: &mut [Piece],
    pilot: &[Known],
    [seed, stream]: [u64; 2],
) -> Result<[Option<InvalidPdf>; 2]> {
    let steps = steps(leaves.space.axes.len());
    let mut rng = CounterRng::new(seed, stream);
    let (mut at, mut places, mut factors) = (Vec::new(), Vec::new(), Vec::new());
    for Piece { leaf, sides, .. } in &*batch {
        for _ in 0..LATTICES {
            let shifts: Vec<f64> = steps.iter().map(|_| rng.random()).collect();
            for i in 0..POINTS {
                let first = at.len();
                let along = |(step, shift): (&f64, &f64)| 1.0 - (2.0 * (shift + step * i as f64).fract() - 1.0).abs();
                at.extend(steps.iter().zip(&shifts).map(along));
                let in_leaf = sides.iter().zip(&at[first..]).map(|([from, to], at)| from + at * (to - from));
                let (place, factor) = leaves.place(*leaf, in_leaf);
                places.push(place);
                factors.push(factor);
            }
        }
    }
    let (values, invalid, far) = densities(leaves, density, &places, &factors)?;
    let of_pieces = values.chunks(LATTICES * POINTS).zip(at.chunks(LATTICES * POINTS * steps.len()));
    batch.iter_mut().zip(of_pieces).for_each(|(piece, (values, at))| piece.take(values, at, pilot));
    Ok([invalid, far])
}

/// The density at places of the cube per volume of the cube, times these factors, and the two kinds of values that [`sample`] returns.
fn densities(
    leaves: &Leaves,
    density: &dyn Density,
    places: &[Place],
    factors: &[f64],
) -> Result<(Vec<f64>, Option<InvalidPdf>, Option<InvalidPdf>)> {
    let points = leaves.space.functions.from_cube(places)?;
    let mut values = Vec::with_capacity(points.len());
    density.pdf(&points, &mut values)?;
    let (jacobians, mut far) = (leaves.space.functions.jacobian(places)?, None);
    for (i, value) in values.iter_mut().enumerate().filter(|(_, value)| **value != 0.0) {
        *value *= factors[i] * jacobians[i];
        if (value.is_nan() || *value == f64::INFINITY) && !leaves.is_sampled(&places[i]) && !leaves.is_bounded() {
            far = far.or(Some(InvalidPdf { point: points[i], value: std::mem::take(value) }));
        }
    }
    let invalid = first_invalid(&points, &values);
    Ok((values, invalid, far))
}
