//! Samples drawn, checked one by one, and counted.

use super::density::{Atom, Density};
use super::domain::Domain;
use super::grid::Grid;
use super::sampler::{Draw, Drawn, Sampler};
use crate::error::Result;
use crate::interrupt;
use crate::sampling::stream::CounterRng;
use rand::RngExt;
use rayon::prelude::*;

/// Samples drawn at a time: many enough for a program in another process, few enough to stay in the cache.
const BATCH: u64 = 1 << 13;
/// Samples of every round whose inverse is tried.
const INVERTED: usize = 256;
/// How far an inverse may be from the numbers that it should give back.
const INVERSE: f64 = 1e-6;

/// Where samples come from.
pub struct Draws<'a, D: Domain> {
    pub domain: &'a D,
    pub sampler: &'a dyn Sampler<D::Point>,
    pub density: &'a dyn Density<D::Point>,
    pub seed: u64,
}

/// What became of samples.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Counts of the grid's cells, then of the atoms.
    pub observed: Vec<u64>,
    /// "No sample".
    pub none: u64,
    /// Samples where the density is 0.
    pub impossible: u64,
    /// The first sample that breaks the contract.
    pub fault: Option<String>,
}

impl Tally {
    fn plus(mut self, other: Self) -> Self {
        self.observed.iter_mut().zip(other.observed).for_each(|(sum, n)| *sum += n);
        self.none += other.none;
        self.impossible += other.impossible;
        self.fault = self.fault.or(other.fault);
        self
    }
}

impl<D: Domain> Draws<'_, D> {
    /// Batch number `batch` of the first `count` samples of stream number `stream`: their numbers, and what was drawn.
    fn batch(&self, stream: u64, batch: u64, count: u64) -> Result<(Vec<f64>, Drawn<D::Point>)> {
        interrupt::check()?;
        let size = BATCH.min(count - batch * BATCH);
        // Streams are fewer than 2⁸, batches than 2⁵⁶.
        let mut rng = CounterRng::new(self.seed, batch << 8 | stream);
        let u: Vec<f64> = (0..size * self.sampler.dimension() as u64).map(|_| rng.random::<f64>()).collect();
        let mut out = Vec::with_capacity(size as usize);
        self.sampler.draw(&u, &mut out)?;
        Ok((u, out))
    }

    /// The places of samples that have one.
    pub fn places(&self, stream: u64, count: u64) -> Result<Vec<[f64; 2]>> {
        let of_batch = |batch| {
            let (_, drawn) = self.batch(stream, batch, count)?;
            let spread = drawn.into_iter().flatten().filter(|draw| !draw.atom);
            Ok(spread.filter_map(|draw| self.domain.place(draw.point)).collect::<Vec<_>>())
        };
        let batches = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch);
        Ok(batches.collect::<Result<Vec<_>>>()?.concat())
    }

    /// Counts samples in the cells of `grid` and at `atoms`.
    pub fn tally(&self, stream: u64, count: u64, grid: &Grid, atoms: &[Atom<D::Point>]) -> Result<Tally> {
        let empty = || Tally { observed: vec![0; grid.len() + atoms.len()], ..Tally::default() };
        let of_batch = |batch| {
            let (u, drawn) = self.batch(stream, batch, count)?;
            let mut tally = empty();
            self.count(&drawn, grid, atoms, &mut tally)?;
            if batch == 0 && tally.fault.is_none() {
                tally.fault = self.inverse_fault(&u, &drawn)?;
            }
            Ok(tally)
        };
        // Reduced as they come, so that memory does not grow with the number of samples.
        (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch).try_reduce(empty, |a, b| Ok(a.plus(b)))
    }

    fn count(
        &self,
        drawn: &[Option<Draw<D::Point>>],
        grid: &Grid,
        atoms: &[Atom<D::Point>],
        tally: &mut Tally,
    ) -> Result<()> {
        tally.none += drawn.iter().filter(|draw| draw.is_none()).count() as u64;
        let spread: Vec<Draw<D::Point>> = drawn.iter().flatten().filter(|draw| !draw.atom).copied().collect();
        let points: Vec<D::Point> = spread.iter().map(|draw| draw.point).collect();
        let mut pdfs = Vec::with_capacity(points.len());
        self.density.pdf(&points, &mut pdfs)?;
        for (draw, pdf) in spread.iter().zip(pdfs) {
            let Some(place) = self.domain.place(draw.point) else {
                tally.fault.get_or_insert_with(|| format!("the sample {:?} is outside of the domain", draw.point));
                continue;
            };
            if let Some(fault) = claim_fault(draw, pdf) {
                tally.fault.get_or_insert(fault);
            }
            tally.impossible += u64::from(pdf == 0.0);
            tally.observed[grid.find(place)] += 1;
        }
        for draw in drawn.iter().flatten().filter(|draw| draw.atom) {
            match atoms.iter().position(|atom| self.domain.same(atom.point, draw.point)) {
                Some(i) => tally.observed[grid.len() + i] += 1,
                None => {
                    let fault = || format!("the sample {:?} is at none of the density's atoms", draw.point);
                    tally.fault.get_or_insert_with(fault);
                }
            }
        }
        Ok(())
    }

    /// The first sample whose inverse is not what it was drawn from.
    fn inverse_fault(&self, u: &[f64], drawn: &[Option<Draw<D::Point>>]) -> Result<Option<String>> {
        for (u, draw) in u.chunks_exact(self.sampler.dimension().max(1)).zip(drawn).take(INVERTED) {
            let Some(Draw { point, .. }) = draw else { continue };
            let Some(back) = self.sampler.invert(*point)? else { continue };
            let far = back.len() != u.len() || back.iter().zip(u).any(|(a, b)| a.is_nan() || (a - b).abs() > INVERSE);
            if far {
                return Ok(Some(format!("{point:?} was drawn from {u:?}, but its inverse is {back:?}")));
            }
        }
        Ok(None)
    }
}

/// What is wrong with the density that a sample claims, where `pdf` is the one at its point.
fn claim_fault<P: std::fmt::Debug>(draw: &Draw<P>, pdf: f64) -> Option<String> {
    if !(pdf.is_finite() && pdf >= 0.0) {
        return Some(format!("the density at the sample {:?} is {pdf}", draw.point));
    }
    let claimed = draw.pdf?;
    (claimed.to_bits() != pdf.to_bits())
        .then(|| format!("the sample {:?} carries the density {claimed:e}, but pdf says {pdf:e}", draw.point))
}

/// What goes wrong with numbers at the edges of \[0, 1), which random ones hardly ever meet.
pub fn corners<D: Domain>(
    domain: &D,
    sampler: &dyn Sampler<D::Point>,
    density: &dyn Density<D::Point>,
) -> Result<Option<String>> {
    const EDGES: [f64; 4] = [0.0, 0.5, 1.0 / (1u64 << 53) as f64, 1.0 - 1.0 / (1u64 << 53) as f64];
    let dimension = sampler.dimension();
    // All corners of few numbers; of many, those where all but one number are ½.
    let corner = |i: usize| -> Vec<f64> {
        if dimension <= 4 {
            (0..dimension).map(|d| EDGES[i >> (2 * d) & 3]).collect()
        } else {
            (0..dimension).map(|d| if i / 4 == d { EDGES[i % 4] } else { 0.5 }).collect()
        }
    };
    let count = if dimension <= 4 { 1 << (2 * dimension) } else { 4 * dimension };
    let numbers: Vec<Vec<f64>> = (0..count).map(corner).collect();
    let mut drawn = Vec::with_capacity(count);
    sampler.draw(&numbers.concat(), &mut drawn)?;
    let some: Vec<(&Vec<f64>, Draw<D::Point>)> =
        numbers.iter().zip(drawn).filter_map(|(u, draw)| Some((u, draw?))).collect();
    let points: Vec<D::Point> = some.iter().map(|(_, draw)| draw.point).collect();
    let mut pdfs = Vec::with_capacity(points.len());
    density.pdf(&points, &mut pdfs)?;
    Ok(some.iter().zip(pdfs).find_map(|((u, draw), pdf)| {
        let fault = match domain.place(draw.point) {
            None => Some(format!("the sample {:?} is outside of the domain", draw.point)),
            Some(_) if draw.atom => None,
            Some(_) => claim_fault(draw, pdf),
        };
        fault.map(|fault| format!("{fault} (drawn from {u:?})"))
    }))
}
