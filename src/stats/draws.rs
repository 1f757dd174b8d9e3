//! Samples drawn, checked one by one, and counted.

use super::cubature::{Integration, Place};
use super::density::{Atom, Density};
use super::domain::Domain;
use super::fixed::{Share, add};
use super::grid::Grid;
use super::sampler::{Draw, Drawn, Sampler};
use crate::error::Result;
use crate::interrupt;
use crate::sampling::hash::{mix32, mix64};
use crate::sampling::stream::CounterRng;
use rand::RngExt;
use rayon::prelude::*;

/// Samples drawn at a time: many enough for a program in another process, few enough to stay in the cache.
pub(super) const BATCH: u64 = 1 << 13;
/// Most places that are remembered because the density there is not what its surroundings lead to expect.
pub(super) const FOUND: usize = 1 << 12;
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
    /// The share of the density at each sample that the integration did not see, summed over the samples and over those in
    /// each cell; some of the places where it is not 0.
    pub unseen: Share,
    pub unseen_in: Vec<Share>,
    pub found: Vec<Place>,
    /// The first sample that breaks the contract.
    pub fault: Option<String>,
}

impl Tally {
    fn plus(mut self, other: Self) -> Self {
        self.observed.iter_mut().zip(other.observed).for_each(|(sum, n)| *sum += n);
        self.none += other.none;
        self.impossible += other.impossible;
        self.unseen += other.unseen;
        add(&mut self.unseen_in, &other.unseen_in);
        self.found.extend(other.found);
        self.found.truncate(FOUND);
        self.fault = self.fault.or(other.fault);
        self
    }
}

impl<D: Domain> Draws<'_, D> {
    /// Batch number `batch` of the first `count` samples of stream number `stream`: their numbers, and what was drawn.
    fn batch(&self, stream: u64, batch: u64, count: u64) -> Result<(Vec<f64>, Drawn<D::Point>)> {
        interrupt::check()?;
        let size = BATCH.min(count - batch * BATCH) as usize;
        // Streams are fewer than 2⁸, batches than 2²⁴.
        let counter = batch << 8 | stream;
        let mut out = Vec::with_capacity(size);
        let dimension = self.sampler.dimension();
        if dimension == 0 {
            self.sampler.draw_seeded(size, batch_seed(self.seed, counter as u32), &mut out)?;
            return Ok((Vec::new(), out));
        }
        let mut rng = CounterRng::new(self.seed, counter);
        let u: Vec<f64> = (0..size * dimension).map(|_| rng.random::<f64>()).collect();
        self.sampler.draw(&u, &mut out)?;
        Ok((u, out))
    }

    /// The places of samples that have one, with the density there.
    pub fn places(&self, stream: u64, count: u64) -> Result<Vec<Place>> {
        let of_batch = |batch| {
            let (_, drawn) = self.batch(stream, batch, count)?;
            let spread = drawn.into_iter().flatten().filter(|draw| !draw.atom).map(|draw| draw.point);
            let (points, places): (Vec<D::Point>, Vec<[f64; 2]>) =
                spread.filter_map(|point| Some((point, self.domain.place(point)?))).unzip();
            let mut pdfs = Vec::with_capacity(points.len());
            self.density.pdf(&points, &mut pdfs)?;
            Ok(places.into_iter().zip(pdfs).map(|(at, pdf)| Place { at, pdf }).collect::<Vec<_>>())
        };
        let batches = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch);
        Ok(batches.collect::<Result<Vec<_>>>()?.concat())
    }

    /// Counts samples in the cells of `grid` and at `atoms`, and what `integration` does not see at them.
    pub fn tally(
        &self,
        stream: u64,
        count: u64,
        grid: &Grid,
        atoms: &[Atom<D::Point>],
        integration: &Integration<D>,
    ) -> Result<Tally> {
        let empty = || Tally {
            observed: vec![0; grid.len() + atoms.len()],
            unseen_in: vec![Share::default(); grid.len()],
            ..Tally::default()
        };
        let of_batch = |batch| {
            let (u, drawn) = self.batch(stream, batch, count)?;
            let mut tally = empty();
            self.count(&drawn, grid, atoms, integration, &mut tally)?;
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
        integration: &Integration<D>,
        tally: &mut Tally,
    ) -> Result<()> {
        tally.none += drawn.iter().filter(|draw| draw.is_none()).count() as u64;
        let spread: Vec<Draw<D::Point>> = drawn.iter().flatten().filter(|draw| !draw.atom).copied().collect();
        let points: Vec<D::Point> = spread.iter().map(|draw| draw.point).collect();
        let mut pdfs = Vec::with_capacity(points.len());
        self.density.pdf(&points, &mut pdfs)?;
        for (draw, pdf) in spread.iter().zip(pdfs) {
            let Some(at) = self.domain.place(draw.point) else {
                tally.fault.get_or_insert_with(|| format!("the sample {:?} is outside of the domain", draw.point));
                continue;
            };
            if let Some(fault) = claim_fault(draw, pdf) {
                tally.fault.get_or_insert(fault);
            }
            tally.impossible += u64::from(pdf == 0.0);
            let (cell, place) = (grid.find(at), Place { at, pdf });
            tally.observed[cell] += 1;
            let seen = match integration {
                Integration::Exact(_) => 1.0,
                Integration::Refined(refinement) => refinement.seen(&place),
            };
            if seen < 1.0 {
                tally.unseen += Share::new(1.0 - seen);
                tally.unseen_in[cell] += Share::new(1.0 - seen);
                if tally.found.len() < FOUND {
                    tally.found.push(place);
                }
            }
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

/// The seed of a batch for a sampler with random numbers of its own: no two batches of a run have the same, since for each
/// `seed` of a run this is a bijection of their numbers.
fn batch_seed(seed: u64, number: u32) -> u32 {
    let key = mix64(seed);
    mix32(number ^ key as u32) ^ (key >> 32) as u32
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
    if dimension == 0 {
        return Ok(None);
    }
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
