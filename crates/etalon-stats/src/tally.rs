//! Generates samples in batches, checks each of them, and counts them.

use crate::cubature::{Integration, Probe};
use crate::density::{Atom, Density};
use crate::domain::Domain;
use crate::error::{Cancelled, Result, poll};
use crate::exact::{outside, pdf_violation};
use crate::fixed::{Share, add};
use crate::hash::{mix32, mix64};
use crate::point::Point;
use crate::repeats::Repeats;
use crate::sampler::{Sample, Sampler};
use crate::serial::{Labels, Past, SerialCounts};
use crate::stream::CounterRng;
use crate::subdivision::{Parts, Subdivision};
use crate::text::tuple;
use rand::RngExt;
use rayon::prelude::*;

/// Samples taken at a time: many enough for a program in another process, few enough to stay in the cache.
pub const BATCH: u64 = 1 << 13;
/// Most probes that are remembered because the pdf there is not what the cubature predicts.
pub const FOUND: usize = 1 << 12;
/// Samples of every round whose inverse is tried.
const INVERTED: usize = 256;
/// How far an inverse may be from the random numbers that it should return.
const INVERSE: f64 = 1e-6;

/// Where samples come from.
pub struct Source<'a> {
    pub domain: &'a dyn Domain,
    pub sampler: &'a dyn Sampler,
    pub density: &'a dyn Density,
    pub seed: u64,
    pub cancelled: Cancelled,
}

/// Counts of samples, and the findings of the checks.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Counts of the grid's cells, then of the atoms.
    pub observed: Vec<u64>,
    /// Counts of finer parts.
    pub parts: Parts<u64>,
    /// Counts of what follows what.
    pub serial: SerialCounts,
    /// Values that several samples have.
    pub repeats: Repeats,
    /// Samples that were "no sample".
    pub none: u64,
    /// Samples where the pdf is 0.
    pub outside_support: u64,
    /// Samples where the pdf is infinite.
    pub infinite: u64,
    /// The share of the pdf at each sample that the cubature misses, summed over the samples of each cell.
    pub missed: Vec<Share>,
    /// Some of the places where the nodes do not predict the pdf, at most [`FOUND`].
    pub found: Vec<Probe>,
    /// What is wrong with the first sample that fails an exact check.
    pub violation: Option<String>,
}

impl Tally {
    fn plus(mut self, other: Self) -> Self {
        self.observed.iter_mut().zip(other.observed).for_each(|(sum, n)| *sum += n);
        self.parts.add(&other.parts);
        self.serial.add(other.serial);
        self.repeats.add(other.repeats);
        self.none += other.none;
        self.outside_support += other.outside_support;
        self.infinite += other.infinite;
        add(&mut self.missed, &other.missed);
        self.found.extend(other.found);
        self.found.truncate(FOUND);
        self.violation = self.violation.or(other.violation);
        self
    }
}

/// What samples are counted by.
pub struct Counters<'a, 'i> {
    pub subdivision: &'a Subdivision<'a>,
    pub labels: Labels,
    pub atoms: &'a [Atom],
    pub integration: &'a Integration<'i>,
}

/// The random numbers of a batch, and its samples.
type Batch = (Vec<f64>, Vec<Option<Sample>>);

impl Source<'_> {
    /// Batch number `batch` of the first `count` samples of random stream number `stream`.
    fn batch(&self, stream: u64, batch: u64, count: u64) -> Result<Batch> {
        poll(self.cancelled)?;
        let size = BATCH.min(count - batch * BATCH) as usize;
        // Streams are fewer than 2⁸, batches than 2²⁴.
        let counter = batch << 8 | stream;
        let mut samples = Vec::with_capacity(size);
        let dimension = self.sampler.dimension();
        if dimension == 0 {
            self.sampler.sample_seeded(size, batch_seed(self.seed, counter as u32), &mut samples)?;
            return Ok((Vec::new(), samples));
        }
        let mut rng = CounterRng::new(self.seed, counter);
        let u: Vec<f64> = (0..size * dimension).map(|_| rng.random::<f64>()).collect();
        self.sampler.sample(&u, &mut samples)?;
        Ok((u, samples))
    }

    /// The chart coordinates of samples, atoms left out, with the pdf there.
    pub fn probes(&self, stream: u64, count: u64) -> Result<Vec<Probe>> {
        let of_batch = |batch| {
            let (_, samples) = self.batch(stream, batch, count)?;
            let spread = samples.into_iter().flatten().filter(|sample| !sample.atom).map(|sample| sample.point);
            let (points, charts): (Vec<Point>, Vec<[f64; 2]>) =
                spread.filter_map(|point| Some((point, self.domain.to_chart(point)?))).unzip();
            let mut pdfs = Vec::with_capacity(points.len());
            self.density.pdf(&points, &mut pdfs)?;
            // A pdf that is infinite at a single point says nothing of its surroundings.
            let known = charts.into_iter().zip(pdfs).filter(|(_, pdf)| *pdf != f64::INFINITY);
            Ok(known.map(|(at, pdf)| Probe { at, pdf }).collect::<Vec<_>>())
        };
        let batches = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch);
        Ok(batches.collect::<Result<Vec<_>>>()?.concat())
    }

    /// Counts samples in cells, in their parts and at atoms, and what the integration misses at them.
    pub fn tally(&self, stream: u64, count: u64, counters: &Counters) -> Result<Tally> {
        let cells = counters.subdivision.grid.len();
        let empty = || Tally {
            observed: vec![0; cells + counters.atoms.len()],
            parts: Parts::new(counters.subdivision),
            serial: SerialCounts::new(&counters.labels),
            missed: vec![Share::default(); cells],
            ..Tally::default()
        };
        let add_batch = |mut tally: Tally, batch| {
            let (u, samples) = self.batch(stream, batch, count)?;
            self.count(batch, &u, &samples, counters, &mut tally)?;
            if batch == 0 && tally.violation.is_none() {
                tally.violation = self.inverse_violation(&u, &samples)?;
            }
            Ok(tally)
        };
        // Add batches up as they come, so that memory does not grow with the number of samples.
        let batches = (0..count.div_ceil(BATCH)).into_par_iter();
        batches.try_fold(empty, add_batch).try_reduce(empty, |a, b| Ok(a.plus(b)))
    }

    /// Counts the `samples` of batch number `batch`, that were made from `u`.
    fn count(
        &self,
        batch: u64,
        u: &[f64],
        samples: &[Option<Sample>],
        counters: &Counters,
        tally: &mut Tally,
    ) -> Result<()> {
        let Counters { subdivision, labels, atoms, integration } = counters;
        let mut past = Past::default();
        tally.none += samples.iter().filter(|sample| sample.is_none()).count() as u64;

        // Samples that are at hand come from no random numbers.
        let dimension = if self.sampler.finite_len().is_some() { 0 } else { self.sampler.dimension() };
        let mut first: Option<(usize, String)> = None;
        let mut note = |i: usize, violation: String| {
            if first.as_ref().is_none_or(|(known, _)| i < *known) {
                first = Some((i, violation));
            }
        };
        // Ask for all pdfs of the batch at once; a point outside of the domain has none.
        let (mut spread, mut points) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
        for (i, sample) in samples.iter().enumerate() {
            let Some(sample) = sample.as_ref().filter(|sample| !sample.atom) else { continue };
            if let Some(at) = self.domain.to_chart(sample.point) {
                spread.push((i, sample, at));
                points.push(sample.point);
            } else {
                note(i, outside(sample));
            }
        }
        let mut pdfs = Vec::with_capacity(points.len());
        self.density.pdf(&points, &mut pdfs)?;
        if self.domain.outcomes().is_none() {
            let known = spread.iter().zip(&pdfs).map(|((_, _, at), pdf)| (*at, *pdf));
            tally.repeats.count(batch, 1 + usize::from(self.domain.is_plane()), known);
        }

        // Check and count samples that have a density.
        let precision = self.density.precision();
        for ((i, sample, at), pdf) in spread.into_iter().zip(pdfs) {
            if let Some(violation) = pdf_violation(sample, pdf, precision) {
                note(i, violation);
            }
            tally.outside_support += u64::from(pdf == 0.0);
            tally.infinite += u64::from(pdf == f64::INFINITY);
            let (cell, probe) = (subdivision.grid.find(at), Probe { at, pdf });
            tally.observed[cell] += 1;
            tally.parts.cells[subdivision.find(cell, at)] += 1;
            let mut parts = [0; 2];
            for (axis, (part, counts)) in parts.iter_mut().zip(&mut tally.parts.axes).enumerate() {
                *part = subdivision.axes[axis].find(at[axis]);
                counts[*part] += 1;
            }
            tally.serial.count(labels, &mut past, parts, at);
            let within = match integration {
                Integration::Exact(..) => 1.0,
                Integration::Refined(_) if pdf == f64::INFINITY => 1.0,
                Integration::Refined(refinement) if refinement.reaches(cell, pdf) => 1.0,
                Integration::Refined(refinement) => refinement.share_within(&probe),
            };
            if within < 1.0 {
                tally.missed[cell].add(Share::new(1.0 - within));
                if tally.found.len() < FOUND {
                    tally.found.push(probe);
                }
            }
        }

        tally.serial.end(past);
        if let Some((i, violation)) = first {
            let from = u.get(i * dimension..(i + 1) * dimension).filter(|_| dimension > 0);
            let from = from.map_or(String::new(), |u| format!(" (sampled from u = {})", tuple(&u)));
            tally.violation.get_or_insert(violation + &from);
        }

        // Match samples at atoms with the declared ones.
        for sample in samples.iter().flatten().filter(|sample| sample.atom) {
            match atoms.iter().position(|atom| self.domain.same(atom.point, sample.point)) {
                Some(i) => tally.observed[subdivision.grid.len() + i] += 1,
                None => {
                    let violation = || format!("the sample {} is at none of the density's atoms", tuple(&sample.point));
                    tally.violation.get_or_insert_with(violation);
                }
            }
        }
        Ok(())
    }

    /// The first sample whose inverse is not the random numbers that it was made from.
    fn inverse_violation(&self, u: &[f64], samples: &[Option<Sample>]) -> Result<Option<String>> {
        for (u, sample) in u.chunks_exact(self.sampler.dimension().max(1)).zip(samples).take(INVERTED) {
            let Some(Sample { point, .. }) = sample else { continue };
            let Some(back) = self.sampler.invert(*point)? else { continue };
            let far = back.len() != u.len() || back.iter().zip(u).any(|(a, b)| a.is_nan() || (a - b).abs() > INVERSE);
            if far {
                return Ok(Some(format!(
                    "{} was sampled from u = {}, but its inverse is {}",
                    tuple(point),
                    tuple(&u),
                    tuple(&back)
                )));
            }
        }
        Ok(None)
    }
}

/// The seed of a batch for a sampler with a generator of its own: for each `seed` of a run this is a bijection of the
/// batches' numbers, so that no two batches share a seed.
fn batch_seed(seed: u64, number: u32) -> u32 {
    let key = mix64(seed);
    mix32(number ^ key as u32) ^ (key >> 32) as u32
}
