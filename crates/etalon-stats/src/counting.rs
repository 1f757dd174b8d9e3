//! Samples generated in batches, each checked, and counted in cells, against the integrals of the pdf, which are refined until
//! their errors do not show. Sums of numbers between 0 and 1 do not depend on the order of addition.

use crate::cubature::{Check, Integration, InvalidPdf, Lattices, Probe, SLACK, Shares, Wanted, values_at};
use crate::diagnosis::tuple;
use crate::domain::{Domain, Place, Point};
use crate::error::{Cancelled, Result, poll};
use crate::exact::{Carried, Repeats, carries_another, invalid_pdf, is_beyond_charts, is_infinite, outside};
use crate::extremes::Extremes;
use crate::grid::{Grid, Parts, Subdivision};
use crate::hash::{mix32, mix64};
use crate::leaves::Leaves;
use crate::looks::Looks;
use crate::mass::Integral;
use crate::parallel::{each, each_part, sum};
use crate::power::FEWEST;
use crate::sampler::{Atom, Density, Sample, Sampler};
use crate::serial::{Labels, Past, SerialCounts};
use crate::stream::CounterRng;
use rand::RngExt;
use std::ops::Range;

/// Random points at which integrals are checked: one for each four samples, between a least and a largest number.
const SAMPLES_PER_CHECK: u64 = 4;
const CHECKS: [u64; 2] = [1 << 14, 1 << 20];
/// Share of the pdf that samples may find above what the nodes predict before it is integrated again.
const MISSED: f64 = 1e-4;
/// The share of the variance of counts that known standard errors of the integrals, which the test takes into account, may have.
const MOST_NOISE: f64 = 0.1;
/// Standard errors of a measured difference that count as chance.
const CHANCE: f64 = 2.0;
/// Samples at which a density in many dimensions is to be within reach of its integrals, at most.
const KNOWN: u64 = 1 << 18;
/// Attempts at counting, each with fresh samples.
const ATTEMPTS: u64 = 3;

/// The numbers of the random streams of an attempt: of its samples and of its checks. Attempt 0 is the pilot.
pub fn streams(round: u64, attempt: u64) -> [u64; 2] {
    let first = 2 * (round * (ATTEMPTS + 1) + attempt);
    [first, first + 1]
}

/// The first of the streams of samples by which mistakes are named, one for each round.
const FOR_NAMES: u64 = 1 << 7;

/// What is to be counted.
pub struct Counting<'a> {
    pub source: &'a Source<'a>,
    /// The cells and their parts.
    pub subdivision: &'a Subdivision<'a>,
    pub labels: Labels,
    /// The density's atoms, which are counted apart.
    pub atoms: &'a [Atom],
    pub looks: Looks,
    /// What the density would have to integrate to for "no sample" never to happen, where its mass is not declared.
    pub whole: Option<f64>,
    /// Whether the density has an unknown mass: its integrals are then divided by their sum.
    pub normalized: bool,
    /// The probability with which the bound of the integral may fail.
    pub risk: f64,
}

/// Counts and integrals.
pub struct Counted {
    pub values: Vec<f64>,
    /// The standard errors of the cells' integrals, as far as the test takes them into account.
    pub errors: Vec<f64>,
    /// The integrals over the parts of the cells and of the axes, and the share of samples that they are known to miss; `None`
    /// where the cells' integrals were corrected by samples, which do not tell the parts.
    pub shares: Option<(Shares, Vec<f64>)>,
    pub integral: Integral,
    /// Whether errors of the cells' integrals would show in the chi-square test.
    pub uncertain: bool,
    pub invalid: Option<InvalidPdf>,
    /// A place far from all samples at which the pdf is no number.
    pub far: Option<InvalidPdf>,
    pub tally: Tally,
}

impl Counted {
    /// Takes `errors` of the cells' integrals into account, unless they are too large for that.
    fn accept_errors(&mut self, errors: Vec<f64>) {
        let noise = noise(self.tally.samples, &self.values, |cell| errors[cell]);
        self.uncertain = noise.may_exceed(MOST_NOISE * self.values.len() as f64);
        self.errors = errors;
    }
}

/// What is added to each cell's integral, and the standard error of that.
type Correction = [f64; 2];

impl Counting<'_> {
    /// Integrates and counts: all samples, or those up to the first of the looks that `ends` the test.
    ///
    /// Where the first samples show that the integrals are too uncertain, the density is integrated again with the probes
    /// that they found. Where the second samples still show it, the missing part of the integrals is estimated from them and
    /// added. Counted samples are always fresh: they had no influence on the integrals that they are compared with.
    pub fn run(&self, pilot: &[Probe], round: u64, ends: impl Fn(&Counted) -> bool) -> Result<Counted> {
        let Source { domain, leaves, sampler, density, seed, cancelled } = *self.source;
        let Self { subdivision, labels, atoms, looks, .. } = *self;
        let all = looks.samples();
        let [_, stream] = streams(round, 0);
        let in_leaves = |leaves: &Leaves, known: &[Place]| {
            let wanted = Wanted { subdivision, samples: all as f64, known, seed, stream };
            Ok(Integration::Lattices(Lattices::new(leaves, density, &wanted, cancelled)?))
        };
        let mut integration = match leaves {
            Some(leaves) => in_leaves(leaves, leaves.pilot())?,
            None => Integration::with_parts(domain, density, subdivision, all as f64, pilot, cancelled)?,
        };
        if let Integration::Refined(refinement) = &mut integration {
            let found = refinement.check(pilot.len() as u64, seed, stream)?.found;
            refinement.learn(&[found, self.source.narrow()?].concat())?;
        }
        let attempts = if sampler.finite_len().is_some() { 1 } else { ATTEMPTS };
        let mut corrections: Option<Vec<Correction>> = None;
        let mut attempt = 1;
        loop {
            let [stream, checks] = streams(round, attempt);
            let counters = Counters { subdivision, labels, atoms, integration: &integration };
            let mut counted = self.uncounted(&integration, &counters);
            let mut from = 0;
            // Each early look is taken once. A test ends there if errors of the integrals do not explain what was found.
            for samples in looks.early().filter(|_| attempt == 1) {
                counted.tally = counted.tally.plus(self.source.tally(stream, from..samples, &counters)?);
                from = samples;
                if ends(&counted) {
                    self.check(&integration, checks, None, &mut counted)?;
                    if ends(&counted) {
                        return Ok(counted);
                    }
                    counted.uncertain = false;
                }
            }
            counted.tally = counted.tally.plus(self.source.tally(stream, from..all, &counters)?);
            let check = self.check(&integration, checks, corrections.as_deref(), &mut counted)?;
            if let Some(leaves) =
                leaves.filter(|_| counted.uncertain && attempt < attempts && counted.invalid.is_none())
            {
                // Samples have found places that the integrals miss.
                integration = in_leaves(leaves, &leaves.places(&self.source.drawn(stream, all.min(KNOWN))?)?)?;
                attempt += 1;
                continue;
            }
            let (Integration::Refined(refinement), Some(check)) = (&mut integration, check) else {
                return Ok(counted);
            };
            // Stop when the integrals are precise enough, after the last attempt, or at an invalid pdf.
            let is_good = !counted.uncertain
                && (corrections.is_some() || Share::total(counted.tally.missed.iter().copied()) <= MISSED * all as f64);
            if is_good || attempt == attempts || counted.invalid.is_some() {
                return Ok(counted);
            }
            // Learn where the density is not what the nodes predict; before the last attempt estimate what is missing.
            attempt += 1;
            if attempt < attempts {
                refinement.learn(&[check.found, counted.tally.found].concat())?;
            } else {
                let scale = self.scale(&refinement.integrals().values);
                let correction = |cell: usize| {
                    let ([within_reach, error], missed) = (check.difference(cell), self.missed(&counted.tally, cell));
                    [scale * within_reach + missed, (scale * error).hypot((missed / all as f64).sqrt())]
                };
                corrections = Some((0..subdivision.grid.len()).map(correction).collect());
            }
        }
    }

    /// No samples yet, and the integrals as far as they have been refined, with errors that are not known.
    fn uncounted(&self, integration: &Integration, counters: &Counters) -> Counted {
        let integrals = integration.integrals();
        let scale = self.scale(&integrals.values);
        Counted {
            integral: Integral { error: f64::INFINITY, ..Integral::exact(&integrals) },
            values: integrals.values.iter().map(|value| scale * value).collect(),
            errors: match integration {
                Integration::Lattices(_) => integrals.errors.iter().map(|error| scale * error).collect(),
                _ => vec![0.0; integrals.errors.len()],
            },
            shares: Some((integration.shares(self.subdivision).times(scale), Vec::new())),
            uncertain: false,
            invalid: integrals.invalid,
            far: integration.far(),
            tally: Tally::empty(counters),
        }
    }

    /// Measures the errors of the integrals at random points of stream number `checks`, and adds `corrections`, if these are
    /// known. Exact sums have no errors and need no such points.
    fn check(
        &self,
        integration: &Integration,
        checks: u64,
        corrections: Option<&[Correction]>,
        counted: &mut Counted,
    ) -> Result<Option<Check>> {
        let integrals = integration.integrals();
        let (tally, scale) = (&counted.tally, self.scale(&integrals.values));
        let refinement = match integration {
            Integration::Exact(..) => {
                counted.integral = Integral::exact(&integrals);
                return Ok(None);
            }
            Integration::Lattices(_) => {
                counted.integral = Integral::of_standard_errors(&integrals, tally, self.risk);
                // What samples found above the integrals is an error, too.
                let missed: Vec<f64> = (0..integrals.errors.len()).map(|cell| self.missed(tally, cell)).collect();
                let errors = integrals.errors.iter().zip(&missed).map(|(error, missed)| (scale * error).hypot(*missed));
                counted.accept_errors(errors.collect());
                counted.shares = counted.shares.take().map(|(shares, _)| (shares, missed));
                return Ok(None);
            }
            Integration::Refined(refinement) => refinement,
        };
        let probes = (tally.samples / SAMPLES_PER_CHECK).clamp(CHECKS[0], CHECKS[1]);
        let check = refinement.check(probes, self.source.seed, checks)?;
        counted.integral = Integral::measured(&integrals, &check, tally, self.risk);
        counted.invalid = integrals.invalid.or(check.invalid);

        // The error of a cell's integral: what the rules say of it, and what probes and samples say beyond chance.
        let found = |cell: usize| {
            let [difference, error] = check.difference(cell);
            scale * (difference.abs() - CHANCE * error).at_least(0.0) + self.missed(tally, cell)
        };
        let all_found: f64 = (0..self.subdivision.grid.len()).map(found).sum();
        match corrections {
            None => {
                let error = |cell: usize| scale * integrals.errors[cell] + found(cell);
                counted.uncertain = self.is_uncertain(tally.samples, &counted.values, error);
                counted.shares = counted.shares.take().map(|(shares, _)| (shares, vec![all_found]));
            }
            // Samples tell what cells lack, and with which standard error, but not which of their parts.
            Some(corrections) => {
                counted.shares = None;
                for (value, [more, _]) in counted.values.iter_mut().zip(corrections) {
                    *value = (*value + more).at_least(0.0);
                }
                counted.accept_errors(corrections.iter().map(|[_, error]| *error).collect());
            }
        }
        let values = &mut counted.values;
        let scale = self.scale(values);
        values.iter_mut().for_each(|value| *value *= scale);
        Ok(Some(check))
    }

    /// The share of samples in a cell that the integrals miss.
    fn missed(&self, tally: &Tally, cell: usize) -> f64 {
        let some = tally.samples - if self.normalized { tally.none } else { 0 };
        tally.missed[cell].sum() / some.max(1) as f64
    }

    /// What integrals are multiplied by to be probabilities.
    fn scale(&self, values: &[f64]) -> f64 {
        let total: f64 = values.iter().sum();
        let at_atoms: f64 = self.atoms.iter().map(|atom| atom.probability).sum();
        if self.normalized && total > 0.0 { (1.0 - at_atoms) / total } else { 1.0 }
    }

    /// Whether errors of the integrals over the cells add more than [`SLACK`] to the statistic; that over "no sample", if it
    /// is not declared, has the errors of all.
    fn is_uncertain(&self, samples: u64, values: &[f64], error: impl Fn(usize) -> f64) -> bool {
        let term = |value: f64, error: f64| noise(samples, &[value], |_| error);
        let of_cells = noise(samples, values, &error);
        let of_none = self.whole.map_or(0.0, |whole| {
            let squares: f64 = (0..values.len()).map(|cell| error(cell).powi(2)).sum();
            term(whole - values.iter().sum::<f64>(), squares.sqrt())
        });
        (of_cells + of_none).may_exceed(SLACK * values.len() as f64)
    }
}

/// What errors of the shares of cells add to the statistic.
fn noise(samples: u64, values: &[f64], error: impl Fn(usize) -> f64) -> f64 {
    let n = samples as f64;
    // Cells that expect less than this are pooled.
    let term = |(cell, value): (usize, &f64)| (n * error(cell)).powi(2) / (n * value).at_least(FEWEST);
    values.iter().enumerate().map(term).sum()
}

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
    /// The domain, where it has more than two dimensions.
    pub leaves: Option<&'a Leaves<'a>>,
    pub sampler: &'a dyn Sampler,
    pub density: &'a dyn Density,
    pub seed: u64,
    pub cancelled: Cancelled,
}

/// Counts of samples, and the findings of the checks.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// The number of samples, "no sample" included.
    pub samples: u64,
    /// Counts of the grid's cells, then of the atoms.
    pub observed: Vec<u64>,
    /// Counts of finer parts.
    pub parts: Parts<u64>,
    /// Counts of what follows what.
    pub serial: SerialCounts,
    /// Values that several samples have.
    pub repeats: Repeats,
    /// The pdfs that samples carry.
    pub carried: Carried,
    /// Samples that were "no sample".
    pub none: u64,
    /// Samples where the pdf is 0.
    pub outside_support: u64,
    /// Samples where the pdf is infinite.
    pub infinite: u64,
    /// Samples of an unbounded set where its pdf is positive and its chart does not tell points apart, and samples at infinity.
    pub beyond: u64,
    pub at_infinity: u64,
    /// One of the samples at infinity.
    pub first_at_infinity: Option<String>,
    /// The share of the pdf at each sample that the cubature misses, summed over the samples of each cell.
    pub missed: Vec<Share>,
    /// Some of the places where the nodes do not predict the pdf, at most [`FOUND`].
    pub found: Vec<Probe>,
    /// What is wrong with the first sample that fails an exact check.
    pub violation: Option<String>,
}

impl Tally {
    fn empty(counters: &Counters) -> Self {
        let cells = counters.subdivision.grid.len();
        Self {
            observed: vec![0; cells + counters.atoms.len()],
            parts: Parts::new(counters.subdivision),
            serial: SerialCounts::new(&counters.labels),
            missed: vec![Share::default(); cells],
            ..Self::default()
        }
    }

    /// How many samples are at infinity, in words, if any is.
    pub fn at_infinity(&self) -> Option<String> {
        let first = self.first_at_infinity.as_ref()?;
        Some(format!("{} of {} samples are at infinity, such as {first}", self.at_infinity, self.samples))
    }

    fn plus(mut self, other: Self) -> Self {
        self.samples += other.samples;
        self.observed.iter_mut().zip(other.observed).for_each(|(sum, n)| *sum += n);
        self.parts.add(&other.parts);
        self.serial.add(other.serial);
        self.repeats.add(other.repeats);
        self.carried.add(other.carried);
        self.none += other.none;
        self.outside_support += other.outside_support;
        self.infinite += other.infinite;
        self.beyond += other.beyond;
        self.at_infinity += other.at_infinity;
        self.first_at_infinity = self.first_at_infinity.or(other.first_at_infinity);
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

/// Densities per area of the chart, of pdfs.
enum PerArea {
    /// A factor that is the same everywhere.
    Times(f64),
    Each(Vec<f64>),
}

impl PerArea {
    #[inline]
    fn of(&self, i: usize, pdf: f64) -> f64 {
        match self {
            Self::Times(factor) => factor * pdf,
            Self::Each(densities) => densities[i],
        }
    }
}

impl Source<'_> {
    /// Batch number `batch` of the first `count` samples of random stream number `stream`.
    fn batch(&self, stream: u64, batch: u64, count: u64) -> Result<Batch> {
        self.batch_of(stream, batch, BATCH.min(count - batch * BATCH) as usize)
    }

    /// Batch number `batch` of random stream number `stream`, with `size` samples.
    pub fn batch_of(&self, stream: u64, batch: u64, size: usize) -> Result<Batch> {
        poll(self.cancelled)?;
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

    /// The first samples of a stream, atoms left out.
    pub fn drawn(&self, stream: u64, count: u64) -> Result<Vec<Point>> {
        let of_batch = |batch| {
            let (_, samples) = self.batch(stream, batch, count)?;
            let spread = samples.into_iter().flatten().filter(|sample| !sample.atom).map(|sample| sample.point);
            Ok(spread.collect::<Vec<Point>>())
        };
        Ok(each(count.div_ceil(BATCH), of_batch)?.concat())
    }

    /// The chart coordinates of samples, with the pdf there.
    pub fn probes(&self, samples: &[Point]) -> Result<Vec<Probe>> {
        let of_batch = |samples: &[Point]| {
            let charts = self.domain.charts(samples)?;
            let (points, charts): (Vec<Point>, Vec<[f64; 2]>) =
                samples.iter().zip(charts).filter(|(_, at)| !at[0].is_nan()).unzip();
            let (pdfs, per_area) = self.densities(&points, &charts)?;
            let probe = |(i, (at, pdf)): (usize, ([f64; 2], f64))| Probe { at, density: per_area.of(i, pdf) };
            let probes = charts.into_iter().zip(pdfs).enumerate().map(probe);
            // A pdf that is infinite at a single point says nothing of its surroundings.
            Ok(probes.filter(|probe| probe.density != f64::INFINITY).collect::<Vec<_>>())
        };
        Ok(each_part(samples, BATCH as usize, of_batch)?.concat())
    }

    /// The density where it is declared to be narrow: in these rectangles, and ever closer to them.
    pub fn narrow(&self) -> Result<Vec<Probe>> {
        const INSIDE: i32 = 16;
        const CLOSEST: i32 = 40;
        let mut places: Vec<[f64; 2]> = Vec::new();
        for [[x0, x1], [y0, y1]] in self.density.narrow() {
            let inside = |from: f64, to: f64, i: i32| from + (to - from) * (f64::from(i) + 0.5) / f64::from(INSIDE);
            places.extend((0..INSIDE * INSIDE).map(|i| [inside(x0, x1, i % INSIDE), inside(y0, y1, i / INSIDE)]));
            let sides = |from: f64, to: f64, d: f64| [from - d, 0.5 * (from + to), to + d];
            let around = (2..CLOSEST)
                .map(|k| 0.5f64.powi(k))
                .flat_map(|d| sides(x0, x1, d).into_iter().flat_map(move |x| sides(y0, y1, d).map(|y| [x, y])));
            places.extend(around);
        }
        let plane = self.domain.is_plane();
        places.iter_mut().filter(|_| !plane).for_each(|place| place[1] = 0.5);
        places.retain(|place| place.iter().all(|x| (0.0..1.0).contains(x)));
        let (_, values) = values_at(self.domain, self.density, &places)?;
        let probes = places.into_iter().zip(values).map(|(at, density)| Probe { at, density });
        Ok(probes.filter(|probe| probe.density.is_finite()).collect())
    }

    /// The pdf at points, and what makes it a density per area of the chart: a factor, or these densities.
    fn densities(&self, points: &[Point], charts: &[[f64; 2]]) -> Result<(Vec<f64>, PerArea)> {
        let mut pdfs = Vec::with_capacity(points.len());
        self.density.pdf(points, &mut pdfs)?;
        if self.domain.is_even() {
            return Ok((pdfs, PerArea::Times(self.domain.measure())));
        }
        let mut densities = pdfs.clone();
        let at_infinity = densities.iter_mut().zip(points).filter(|(density, _)| !density.is_finite());
        at_infinity.filter(|(_, point)| is_infinite(point)).for_each(|(density, _)| *density = 0.0);
        self.domain.per_chart_area(charts, &mut densities)?;
        Ok((pdfs, PerArea::Each(densities)))
    }

    /// Counts samples by which a mistake is named, in cells, at atoms and of "no sample", without the pdf.
    pub fn counts(&self, round: u64, count: u64, grid: &Grid, atoms: &[Atom]) -> Result<Vec<u64>> {
        let add_batch = |mut counts: Vec<u64>, batch| {
            let (_, samples) = self.batch(FOR_NAMES + round, batch, count)?;
            let (none, cells) = (grid.len() + atoms.len(), grid.len());
            counts[none] += samples.iter().filter(|sample| sample.is_none()).count() as u64;
            let (at_atoms, spread): (Vec<Sample>, Vec<Sample>) = samples.into_iter().flatten().partition(|s| s.atom);
            let charts = self.domain.charts(&spread.into_iter().map(|sample| sample.point).collect::<Vec<_>>())?;
            charts.into_iter().filter(|at| !at[0].is_nan()).for_each(|at| counts[grid.find(at)] += 1);
            let atom = |sample: &Sample| atoms.iter().position(|atom| self.domain.same(atom.point, sample.point));
            at_atoms.iter().filter_map(atom).for_each(|i| counts[cells + i] += 1);
            Ok(counts)
        };
        let plus = |mut all: Vec<u64>, other: Vec<u64>| {
            all.iter_mut().zip(other).for_each(|(sum, n)| *sum += n);
            all
        };
        sum(0..count.div_ceil(BATCH), || vec![0; grid.len() + atoms.len() + 1], add_batch, plus)
    }

    /// Counts a range of samples in cells, in their parts and at atoms, and what the integration misses at them. The range
    /// begins with a batch.
    pub fn tally(&self, stream: u64, range: Range<u64>, counters: &Counters) -> Result<Tally> {
        let add_batch = |mut tally: Tally, batch| {
            let (u, samples) = self.batch(stream, batch, range.end)?;
            self.count(batch, &u, &samples, counters, &mut tally)?;
            if batch == 0 && tally.violation.is_none() {
                tally.violation = self.inverse_violation(&u, &samples)?;
            }
            Ok(tally)
        };
        let batches = range.start / BATCH..range.end.div_ceil(BATCH);
        sum(batches, || Tally::empty(counters), add_batch, Tally::plus)
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
        tally.samples += samples.len() as u64;
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
        let all = samples.iter().enumerate().filter_map(|(i, sample)| sample.as_ref().map(|sample| (i, sample)));
        let mut spread: Vec<(usize, &Sample)> = all.filter(|(_, sample)| !sample.atom).collect();
        let mut points: Vec<Point> = spread.iter().map(|(_, sample)| sample.point).collect();
        let mut charts = self.domain.charts(&points)?;
        if charts.iter().any(|at| at[0].is_nan()) {
            let is_inside: Vec<bool> = charts.iter().map(|at| !at[0].is_nan()).collect();
            for ((i, sample), _) in spread.iter().zip(&is_inside).filter(|(_, is_inside)| !**is_inside) {
                note(*i, outside(self.domain, sample));
            }
            let [mut of_samples, mut of_points] = [is_inside.iter(), is_inside.iter()];
            spread.retain(|_| of_samples.next() == Some(&true));
            points.retain(|_| of_points.next() == Some(&true));
            charts.retain(|at| !at[0].is_nan());
        }
        let (pdfs, per_area) = self.densities(&points, &charts)?;
        if self.domain.outcomes().is_none() {
            let known = charts.iter().zip(&pdfs).enumerate().map(|(i, (at, pdf))| (*at, per_area.of(i, *pdf)));
            tally.repeats.count(batch, 1 + usize::from(self.domain.is_plane()), known);
        }

        // Check and count samples that have a density.
        let precision = self.density.precision();
        for (k, (((i, sample), at), pdf)) in spread.into_iter().zip(charts).zip(pdfs).enumerate() {
            let density = per_area.of(k, pdf);
            if let Some(violation) = invalid_pdf(sample, pdf) {
                note(i, violation);
            }
            let words = || carries_another(sample, pdf) + &sampled_from(u, i, dimension);
            tally.carried.count(sample, pdf, precision, words);
            tally.outside_support += u64::from(pdf == 0.0);
            tally.infinite += u64::from(density == f64::INFINITY);
            if is_infinite(&sample.point) {
                tally.at_infinity += 1;
                tally.first_at_infinity.get_or_insert_with(|| tuple(&sample.point) + &sampled_from(u, i, dimension));
            } else if pdf > 0.0 && is_beyond_charts(&sample.point) && self.domain.measure().is_infinite() {
                tally.beyond += 1;
            }
            let (cell, probe) = (subdivision.grid.find(at), Probe { at, density });
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
                Integration::Refined(_) if density == f64::INFINITY => 1.0,
                Integration::Refined(refinement) if refinement.reaches(cell, density) => 1.0,
                Integration::Refined(refinement) => refinement.share_within(&probe),
                Integration::Lattices(lattices) if density == f64::INFINITY || lattices.reaches(cell, density) => 1.0,
                Integration::Lattices(lattices) => lattices.share_within(&probe),
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
            tally.violation.get_or_insert(violation + &sampled_from(u, i, dimension));
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

/// The random numbers of sample number `i`, for messages; nothing where there are none.
fn sampled_from(u: &[f64], i: usize, dimension: usize) -> String {
    let from = u.get(i * dimension..(i + 1) * dimension).filter(|_| dimension > 0);
    from.map_or(String::new(), |u| format!(" (sampled from u = {})", tuple(&u)))
}

/// The seed of a batch for a sampler with a generator of its own: for each `seed` of a run this is a bijection of the
/// batches' numbers, so that no two batches share a seed.
fn batch_seed(seed: u64, number: u32) -> u32 {
    let key = mix64(seed);
    mix32(number ^ key as u32) ^ (key >> 32) as u32
}

/// A sum of numbers from 0 to 1 in units of 2⁻²⁹, so that 2³⁵ of them fit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Share(u64);

const UNIT: f64 = (1u64 << 29) as f64;

impl Share {
    /// One number, to the nearest unit.
    #[inline]
    #[must_use]
    pub fn new(value: f64) -> Self {
        Self((value.within(0.0, 1.0) * UNIT).round() as u64)
    }

    /// The sum.
    #[inline]
    #[must_use]
    pub fn sum(self) -> f64 {
        self.0 as f64 / UNIT
    }

    /// The sum of several sums.
    pub fn total(shares: impl Iterator<Item = Self>) -> f64 {
        Self(shares.map(|share| share.0).sum()).sum()
    }

    /// Adds `other` to this sum.
    #[inline]
    pub fn add(&mut self, other: Self) {
        self.0 += other.0;
    }
}

/// Adds sums to others, one by one.
pub fn add(to: &mut [Share], other: &[Share]) {
    to.iter_mut().zip(other).for_each(|(sum, share)| sum.add(*share));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_the_order() {
        let numbers: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.618_034).fract()).collect();
        let (mut up, mut down) = (Share::default(), Share::default());
        numbers.iter().for_each(|&x| up.add(Share::new(x)));
        numbers.iter().rev().for_each(|&x| down.add(Share::new(x)));
        assert!(up == down && (up.sum() - numbers.iter().sum::<f64>()).abs() < 1e-6);
        assert_eq!((Share::new(2.0).sum(), Share::new(-1.0).sum()), (1.0, 0.0));
    }
}
