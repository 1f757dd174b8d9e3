//! Sums of weights over cells, for what has no pdf to count samples by: samples of resampling and of reservoirs, whose weights estimate
//! 1/pdf, against the [`target`](crate::target); and samples of a pdf that is known by unbiased estimates alone.
//!
//! The mean of the weights of the samples in a cell is the integral of the target over it. The number of samples is random with
//! Poisson's distribution, so that the sums of different cells are independent: the covariance of a fixed number, −E\[w₁\] E\[w₂\], is gone.
//! Samples of their own decide which cells are put together: cells chosen by the sums that are tested would hold what chance made small.

use crate::counting::{BATCH, Source, streams};
use crate::cubature::{Integration, InvalidPdf, Lattices, Probe, Wanted, first_invalid, values_at};
use crate::diagnosis::{diagnose, tuple};
use crate::domain::Point;
use crate::error::{Error, Result, poll};
use crate::estimate::Estimate;
use crate::exact::{corners, outside, percent, repeated};
use crate::examine::{Protocol, SUSPECT, SampleCount, cells, shape};
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid, Subdivision};
use crate::leaves::Leaves;
use crate::mass::{Bound, Integral};
use crate::outcome::{Counts, Outcome};
use crate::parallel::each;
use crate::power::{chi_square_tail, noncentrality, samples_for};
use crate::sampler::{Atom, Mass};
use crate::stream::CounterRng;
use crate::welch::{self, Mean, deviation, two_sided};
use rand::RngExt;

/// Cells of the test: fewer than of a test of counts, since weights vary.
const CELLS: usize = 100;
/// Samples that decide on the cells and on the number of samples.
const PILOT: u64 = 1 << 14;
/// Fewest and most samples that a detectable error asks for.
const SAMPLES: [u64; 2] = [1 << 14, 1 << 22];
/// Cells are put together until they hold as much as this many samples of equal weights, and as many squares of equal size.
const EFFECTIVE: f64 = 50.0;
const EFFECTIVE_SQUARES: f64 = 100.0;
/// A sample with a larger share of the squares of its group makes their sum, and so the variance, uncertain; the share of the target in
/// such groups that makes the test inconclusive.
const LARGEST: f64 = 0.1;
const UNCONTROLLED: f64 = 0.05;
/// The share of weights that rounding may carry over an edge of the target.
const ROUNDING: f64 = 1e-6;
/// Parts of the samples by which the error of the variance is known.
const REPLICATES: usize = 32;
/// Standard errors of the sum of all weights from which it is told.
const CLEAR: f64 = 5.0;

/// Sums over the samples of one place: Σ wᵏ for k = 1 to 4, and the largest w².
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    powers: [f64; 4],
    largest: f64,
}

impl Sums {
    fn of(weight: f64) -> Self {
        let square = weight * weight;
        Self { powers: [weight, square, square * weight, square * square], largest: square }
    }

    fn plus(self, other: Self) -> Self {
        let powers = [0, 1, 2, 3].map(|k| self.powers[k] + other.powers[k]);
        Self { powers, largest: self.largest.at_least(other.largest) }
    }

    /// E\[w²\]/E\[w\], if there are weights.
    fn ratio(&self) -> Option<f64> {
        let [sum, squares, ..] = self.powers;
        (sum > 0.0).then(|| squares / sum)
    }

    /// Degrees of freedom of the [`ratio`](Self::ratio): 2 over its relative variance, infinite for equal weights.
    fn dof(&self) -> f64 {
        let [sum, squares, cubes, fourth] = self.powers;
        let variance = fourth / (squares * squares) - 2.0 * cubes / (squares * sum) + squares / (sum * sum);
        if variance > 1e-9 { 2.0 / variance } else { f64::INFINITY }
    }

    fn is_controlled(&self) -> bool {
        self.largest <= LARGEST * self.powers[1]
    }
}

/// What is expected of a place for each sample: the integral of the target, and the square of its error.
#[derive(Debug, Clone, Copy, Default)]
struct Expected {
    value: f64,
    variance: f64,
}

impl Expected {
    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, variance: self.variance + other.variance }
    }
}

/// What samples say.
#[derive(Clone)]
struct Tally {
    /// For each place: the cells, then the atoms.
    places: Vec<Sums>,
    /// The pdfs that samples carry minus those asked for, for each place: number, sum, sum of squares.
    carried: Vec<[f64; 3]>,
    /// Sums of carried pdfs, and of those asked for.
    pdfs: [f64; 2],
    /// Number of samples, Σ w and Σ w² of parts of all samples.
    replicates: [[f64; 3]; REPLICATES],
    none: u64,
    violation: Option<String>,
    /// Where samples lie, and their weights: of a pilot.
    at: Vec<([f64; 2], f64)>,
}

impl Tally {
    fn new(places: usize) -> Self {
        Self {
            places: vec![Sums::default(); places],
            carried: vec![[0.0; 3]; places],
            pdfs: [0.0; 2],
            replicates: [[0.0; 3]; REPLICATES],
            none: 0,
            violation: None,
            at: Vec::new(),
        }
    }

    fn add(&mut self, other: Self) {
        self.places.iter_mut().zip(other.places).for_each(|(all, sums)| *all = all.plus(sums));
        let add = |all: &mut [f64], more: &[f64]| all.iter_mut().zip(more).for_each(|(all, more)| *all += more);
        self.carried.iter_mut().zip(&other.carried).for_each(|(all, more)| add(all, more));
        self.replicates.iter_mut().zip(&other.replicates).for_each(|(all, more)| add(all, more));
        add(&mut self.pdfs, &other.pdfs);
        self.none += other.none;
        self.violation = self.violation.take().or(other.violation);
        self.at.extend(other.at);
    }

    fn samples(&self) -> f64 {
        self.replicates.iter().map(|[samples, ..]| samples).sum()
    }

    /// The variance of the weights over the square of their mean.
    fn variance(&self) -> Estimate {
        let variance = |parts: &[&[f64; 3]]| {
            let [n, sum, squares] = [0, 1, 2].map(|k| parts.iter().map(|part| part[k]).sum::<f64>());
            n * squares / (sum * sum) - 1.0
        };
        Estimate::jackknife(&self.replicates, variance)
    }
}

/// A number of Poisson's distribution: of arrivals whose distances are exponentially distributed.
fn poisson(mean: f64, rng: &mut CounterRng) -> usize {
    let mut arrival = 0.0;
    let mut arrives = || {
        arrival -= (1.0 - rng.random::<f64>()).ln();
        arrival <= mean
    };
    std::iter::repeat_with(&mut arrives).take_while(|arrives| *arrives).count()
}

/// Places: cells, then atoms.
struct Places<'a> {
    source: &'a Source<'a>,
    grid: &'a Grid,
    atoms: &'a [Atom],
}

impl Places<'_> {
    /// Adds up samples of random stream number `stream`, as many as `count` in the mean.
    fn tally(&self, stream: u64, count: u64, is_pilot: bool) -> Result<Tally> {
        let of_batch = |batch: u64| {
            let mean = BATCH.min(count - batch * BATCH);
            let mut rng = CounterRng::new(!self.source.seed, batch << 8 | stream);
            let size = if is_pilot { mean as usize } else { poisson(mean as f64, &mut rng) };
            let (_, samples) = self.source.batch_of(stream, batch, size)?;
            self.of_samples(&samples, is_pilot)
        };
        let batches = each(count.div_ceil(BATCH), of_batch)?;
        // In the order of the batches: sums are the same for any number of threads.
        let mut all = Tally::new(self.grid.len() + self.atoms.len());
        batches.into_iter().for_each(|batch| all.add(batch));
        Ok(all)
    }

    fn of_samples(&self, samples: &[Option<crate::Sample>], is_pilot: bool) -> Result<Tally> {
        let (domain, density) = (self.source.domain, self.source.density);
        let mut tally = Tally::new(self.grid.len() + self.atoms.len());
        let points: Vec<Point> = samples.iter().flatten().map(|sample| sample.point).collect();
        let charts = domain.charts(&points)?;
        let is_compared = !density.is_target() && samples.iter().flatten().any(|sample| sample.pdf.is_some());
        let mut asked = Vec::new();
        if is_compared {
            density.pdf(&points, &mut asked)?;
        }
        let mut next = 0;
        for (i, sample) in samples.iter().enumerate() {
            let replicate = &mut tally.replicates[i % REPLICATES];
            replicate[0] += 1.0;
            let Some(sample) = sample else {
                tally.none += 1;
                continue;
            };
            let (k, at) = (next, charts[next]);
            next += 1;
            let place = match sample.atom {
                true => match self.atoms.iter().position(|atom| domain.same(atom.point, sample.point)) {
                    Some(atom) => self.grid.len() + atom,
                    None => {
                        let what = || format!("the sample {} is at none of the atoms", tuple(&sample.point));
                        tally.violation.get_or_insert_with(what);
                        continue;
                    }
                },
                false if at[0].is_nan() => {
                    tally.violation.get_or_insert_with(|| outside(domain, sample));
                    continue;
                }
                false => self.grid.find(at),
            };
            if !(sample.weight >= 0.0 && sample.weight.is_finite()) {
                let what = || format!("the weight of the sample {} is {}", tuple(&sample.point), sample.weight);
                tally.violation.get_or_insert_with(what);
                continue;
            }
            tally.places[place] = tally.places[place].plus(Sums::of(sample.weight));
            replicate[1] += sample.weight;
            replicate[2] += sample.weight * sample.weight;
            if let (Some(carried), Some(asked)) = (sample.pdf, asked.get(k)) {
                let difference = carried - asked;
                let [n, sum, squares] = &mut tally.carried[place];
                (*n, *sum, *squares) = (*n + 1.0, *sum + difference, *squares + difference * difference);
                tally.pdfs = [tally.pdfs[0] + carried, tally.pdfs[1] + asked];
            }
            if is_pilot && !sample.atom {
                tally.at.push((at, sample.weight));
            }
        }
        Ok(tally)
    }

    /// The integrals of the target over all places for about `samples` samples, and a value that it cannot have.
    fn expected(&self, pilot: &[Probe], samples: u64, round: u64) -> Result<(Vec<Expected>, Option<InvalidPdf>)> {
        let Source { domain, leaves, density, seed, cancelled, .. } = *self.source;
        let (mut places, invalid) = if density.is_stochastic() && leaves.is_none() {
            // A stochastic pdf is asked for as often as it is sampled.
            self.by_random_points((samples / self.grid.len() as u64).max(1 << 6), round)?
        } else {
            let mut integration = match leaves {
                Some(leaves) => {
                    let (subdivision, stream) = (&Subdivision::even(self.grid, leaves.bits()), streams(round, 2)[1]);
                    let wanted = Wanted { subdivision, samples: samples as f64, known: leaves.pilot(), seed, stream };
                    Integration::Lattices(Lattices::new(leaves, density, &wanted, cancelled)?)
                }
                None => Integration::new(domain, density, self.grid, f64::INFINITY, pilot, cancelled)?,
            };
            if let Integration::Refined(refinement) = &mut integration {
                let found = refinement.check(PILOT, seed, streams(round, 2)[1])?.found;
                refinement.learn(&[found, self.source.narrow()?].concat())?;
            }
            let integrals = integration.integrals();
            let both = integrals.values.iter().zip(&integrals.errors);
            (both.map(|(&value, error)| Expected { value, variance: error * error }).collect(), integrals.invalid)
        };
        places.extend(self.atoms.iter().map(|atom| Expected { value: atom.probability, variance: 0.0 }));
        Ok((places, invalid))
    }

    /// The means of values at random points, two in each of equal parts of each cell, whose differences say the errors.
    fn by_random_points(&self, points: u64, round: u64) -> Result<(Vec<Expected>, Option<InvalidPdf>)> {
        let Source { domain, density, seed, cancelled, .. } = *self.source;
        let plane = domain.is_plane();
        let parts = 0.5 * points as f64;
        let sides = if plane { [parts.sqrt().ceil() as u64; 2] } else { [parts.ceil() as u64, 1] };
        let cells: Vec<Cell> = self.grid.cells().collect();
        let of_cell = |number: u64| {
            poll(cancelled)?;
            let cell = cells[number as usize];
            let mut rng = CounterRng::new(seed, number << 8 | streams(round, 3)[1]);
            let mut along = |[from, to]: [f64; 2], part: u64, parts: u64| {
                let share = (part as f64 + rng.random::<f64>()) / parts as f64;
                (from + (to - from) * share).at_most(to.next_down())
            };
            let parts = (0..sides[0] * sides[1]).flat_map(|part| [part; 2]);
            let places: Vec<[f64; 2]> = parts
                .map(|part| {
                    let x = along(cell.x, part % sides[0], sides[0]);
                    [x, if plane { along(cell.y, part / sides[0], sides[1]) } else { 0.5 }]
                })
                .collect();
            let (points, values) = values_at(domain, density, &places)?;
            let n = values.len() as f64;
            let squares: f64 = values.as_chunks::<2>().0.iter().map(|[a, b]| (a - b) * (a - b)).sum();
            let (area, mean) = (cell.area(), values.iter().sum::<f64>() / n);
            let expected = Expected { value: area * mean, variance: area * area * squares / (n * n) };
            Ok((expected, first_invalid(&points, &values)))
        };
        let all = each(cells.len() as u64, of_cell)?;
        let (places, invalid): (Vec<Expected>, Vec<_>) = all.into_iter().unzip();
        Ok((places, invalid.into_iter().flatten().next()))
    }
}

/// What decides whether places can be tested together, for a number of samples: what is expected of them, its variance, Σ w² and Σ w⁴.
#[derive(Clone, Copy, Default)]
struct Size([f64; 4]);

impl Size {
    fn plus(self, other: Self) -> Self {
        Self([0, 1, 2, 3].map(|k| self.0[k] + other.0[k]))
    }

    fn is_enough(self) -> bool {
        let [value, variance, squares, fourth] = self.0;
        value > 0.0 && value * value >= EFFECTIVE * variance && squares * squares >= EFFECTIVE_SQUARES * fourth
    }
}

/// The group of each place for `count` samples, by what a pilot of `pilots` samples says, and the number of groups. Places of too few
/// samples are put together; those that are too few even so have none.
fn groups(expected: &[Expected], pilot: &[Sums], pilots: f64, count: f64) -> (Vec<Option<usize>>, usize) {
    let most = pilot.iter().filter_map(Sums::ratio).fold(0.0, f64::at_least);
    let size = |(of, sums): (&Expected, &Sums)| {
        let (value, error, [_, squares, _, fourth]) = (count * of.value, count * count * of.variance, sums.powers);
        Size([value, sums.ratio().unwrap_or(most) * value + error, squares * count / pilots, fourth * count / pilots])
    };
    let sizes: Vec<Size> = expected.iter().zip(pilot).map(size).collect();
    let effective = |place: &usize| sizes[*place].0[0].powi(2) / sizes[*place].0[1].at_least(f64::MIN_POSITIVE);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    // Those that are enough by themselves come first.
    order.sort_by(|a, b| effective(a).total_cmp(&effective(b)));
    order.sort_by_key(|&place| !sizes[place].is_enough());
    let (mut group, mut open, mut last, mut known) = (vec![None; sizes.len()], Size::default(), Size::default(), 0);
    for place in order {
        open = open.plus(sizes[place]);
        group[place] = Some(known);
        if open.is_enough() {
            (last, open, known) = (open, Size::default(), known + 1);
        }
    }
    let joins = known > 0 && last.plus(open).is_enough();
    let end = |group: Option<usize>| if group == Some(known) { joins.then(|| known - 1) } else { group };
    (group.into_iter().map(end).collect(), known)
}

/// The sums of the places of each group.
fn grouped<T: Copy + Default>(
    group: &[Option<usize>],
    groups: usize,
    places: &[T],
    plus: impl Fn(T, T) -> T,
) -> Vec<T> {
    let mut all = vec![T::default(); groups];
    let known = group.iter().zip(places).filter_map(|(group, place)| Some(((*group)?, *place)));
    known.for_each(|(group, place)| all[group] = plus(all[group], place));
    all
}

/// One round of the test.
pub fn examine(source: &Source, protocol: &Protocol, round: u64) -> Result<Outcome> {
    let Source { domain, sampler, density, .. } = *source;
    if sampler.finite_len().is_some() || density.mass() == Mass::Unknown {
        let message = "weights and stochastic pdfs need a sampler that can be called, and a mass".to_owned();
        return Err(Error::parameter("mass", message, "declare the mass of the pdf"));
    }
    let (is_target, atoms) = (density.is_target(), density.atoms());

    // Choose the cells by samples that are not counted. A domain of many dimensions becomes the leaves of a tree.
    let at_corners = if is_target { None } else { corners(domain, sampler, density)?.violation };
    let [stream, _] = streams(round, 0);
    let leaves = domain.space().map(|space| Leaves::new(domain, space, &source.drawn(stream, PILOT)?, CELLS.ilog2()));
    let leaves = leaves.transpose()?;
    let domain = leaves.as_ref().map_or(domain, |leaves| leaves);
    let source = &Source { domain, leaves: leaves.as_ref(), ..*source };
    let whole = Grid::equal([1, 1], None);
    let pilot = Places { source, grid: &whole, atoms: &atoms }.tally(stream, PILOT, true)?;
    let mut probes: Vec<Probe> = pilot.at.iter().map(|(at, _)| Probe { at: *at, density: 0.0 }).collect();
    let violation =
        pilot.violation.clone().or(repeated(domain, &probes)).or(at_corners.filter(|_| !density.is_stochastic()));
    if violation.is_some() {
        return Ok(Outcome { violation, ..Outcome::open(PILOT) });
    }
    let shape = shape(domain, CELLS.min(protocol.cells));
    let grid = match &leaves {
        Some(leaves) => leaves.grid(CELLS.min(protocol.cells)),
        None => cells(domain, &probes, shape, SAMPLES[0]),
    };
    let places = Places { source, grid: &grid, atoms: &atoms };
    let mut of_pilot = vec![Sums::default(); grid.len()];
    for (at, weight) in &pilot.at {
        let sums = &mut of_pilot[grid.find(*at)];
        *sums = sums.plus(Sums::of(*weight));
    }
    of_pilot.extend(&pilot.places[1..]);
    if !density.is_stochastic() && leaves.is_none() {
        let charts: Vec<[f64; 2]> = probes.iter().map(|probe| probe.at).collect();
        let (_, values) = values_at(domain, density, &charts)?;
        probes.iter_mut().zip(values).for_each(|(probe, value)| probe.density = value);
        probes.retain(|probe| probe.density.is_finite());
    }
    let level = protocol.own_level();
    let needed = |share: f64| match protocol.samples {
        SampleCount::Fixed(n) => n,
        SampleCount::Detect(w) => {
            let equal = samples_for(grid.len() + atoms.len(), level, w) as f64;
            ((equal / share) as u64).clamp(SAMPLES[0], SAMPLES[1])
        }
    };
    let (expected, invalid) = places.expected(&probes, needed(1.0), round)?;
    let total: f64 = expected.iter().map(|place| place.value).sum();
    if !total.is_finite() && invalid.is_none() {
        let message = format!("its integral is {total}");
        return Err(Error::parameter("target", message, "declare a target with a finite integral"));
    }
    let violation = invalid.map(|at| format!("the {} at {} is {}", of(is_target), tuple(&at.point), at.value));
    if violation.is_some() {
        return Ok(Outcome { violation, ..Outcome::open(PILOT) });
    }

    // Weights that vary take more samples for the same error.
    let share = expected.iter().zip(&of_pilot).filter_map(|(place, sums)| Some(place.value / sums.ratio()?));
    let mut count = needed(share.sum::<f64>().within(1e-6, 1.0));
    let grouping = |count: u64| {
        let (group, number) = groups(&expected, &of_pilot, pilot.samples(), count as f64);
        let lost = group.iter().zip(&expected).filter(|(group, _)| group.is_none());
        let lost = lost.map(|(_, place)| place.value).sum::<f64>() / total;
        (group, number, lost)
    };
    // So do those of which few are large.
    let is_fixed = matches!(protocol.samples, SampleCount::Fixed(_));
    while !is_fixed && count < SAMPLES[1] && grouping(count).2 > UNCONTROLLED {
        count = (2 * count).min(SAMPLES[1]);
    }
    let (group, number, lost) = grouping(count);
    let n = count as f64;
    let found = places.tally(streams(round, 1)[0], count, false)?;

    // Test the groups.
    let pilots = grouped(&group, number, &of_pilot, Sums::plus);
    let sums = grouped(&group, number, &found.places, Sums::plus);
    let wanted = grouped(&group, number, &expected, Expected::plus);
    let all = found.places.iter().fold(Sums::default(), |all, sums| all.plus(*sums));
    let (mut statistic, mut effective, mut uncontrolled, mut variance) = (0.0, 0.0, lost, 0.0);
    for ((sums, wanted), pilot) in sums.iter().zip(&wanted).zip(&pilots) {
        let ratio = sums.ratio().or(pilot.ratio()).or(all.ratio()).unwrap_or(f64::NAN);
        let of_weights = ratio * n * wanted.value;
        let square = of_weights + n * n * wanted.variance;
        let t = (sums.powers[0] - n * wanted.value) / square.sqrt();
        let dof = if sums.powers[0] > 0.0 { sums.dof() * (square / of_weights).powi(2) } else { f64::INFINITY };
        let z = deviation(two_sided(t.abs(), dof), t.abs());
        statistic += z * z;
        effective += (n * wanted.value).powi(2) / square;
        variance += square;
        uncontrolled += if sums.is_controlled() { 0.0 } else { wanted.value / total };
    }
    // Weights where the target is 0, which no error of a stochastic value makes.
    let dark = expected.iter().zip(&found.places).filter(|(place, _)| place.value == 0.0);
    let dark: f64 = dark.map(|(_, sums)| sums.powers[0]).sum();
    let is_dark = !density.is_stochastic() && dark > ROUNDING * all.powers[0];
    let known = number > 0 && uncontrolled <= UNCONTROLLED;
    let p = (known || is_dark).then(|| if is_dark { 0.0 } else { chi_square_tail(number as f64, statistic) });

    // Compare the pdfs that samples carry in the mean.
    let carried = grouped(&group, number, &found.carried, |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
    let mean = |&[n, sum, squares]: &[f64; 3]| {
        let (value, spread) = (sum / n, (squares - sum * sum / n).at_least(0.0));
        [Mean { value, variance: spread / (n * (n - 1.0)), dof: n - 1.0 }, Mean::exact(0.0)]
    };
    let pairs: Vec<_> = carried.iter().filter(|[n, ..]| *n > 1.0).map(mean).collect();
    let p_of_carried = (!pairs.is_empty()).then(|| match welch::compare(&pairs, 0.0) {
        equal if equal.exact_difference > 1e-9 * found.pdfs[1] / pairs.len() as f64 => 0.0,
        compared => compared.p,
    });
    let p = match (p, p_of_carried) {
        (Some(p), Some(carried)) => Some((2.0 * p.at_most(carried)).at_most(1.0)),
        (p, _) => p,
    };

    // Say what is wrong.
    let detectable = (number > 0).then(|| (noncentrality(number, level) / effective).sqrt());
    let reason = match detectable {
        None => Some("too few samples, or too few of large weights".to_owned()),
        _ if !known => {
            let share = 100.0 * uncontrolled;
            Some(format!("single weights decide on {share:.0} % of the domain: their variance cannot be trusted"))
        }
        Some(w) if w > protocol.coarsest() => {
            Some(format!("too few samples: an error of the weights below {} would remain undetected", percent(w)))
        }
        Some(_) => None,
    };
    let size = |place: usize| {
        let ratio = found.places[place].ratio().or(of_pilot[place].ratio()).unwrap_or(1.0);
        (n * expected[place].value / ratio).at_least(f64::MIN_POSITIVE)
    };
    let sizes: Vec<f64> = (0..expected.len()).map(size).collect();
    let observed = |place: usize| match expected[place].value {
        value if value > 0.0 => (sizes[place] * found.places[place].powers[0] / (n * value)).round() as u64,
        _ => found.places[place].ratio().map_or(0, |ratio| (found.places[place].powers[0] / ratio).ceil() as u64),
    };
    let observed = (0..expected.len()).map(observed).chain([0]).collect();
    let sizes = sizes.iter().copied().chain([f64::MIN_POSITIVE]).collect();
    let counts = Counts::new(domain, grid.clone(), density.atom_names(), observed, sizes);
    let is_suspect = p.is_some_and(|p| p < SUSPECT);
    let mut told = Vec::new();
    let (mean, whole) =
        (sums.iter().map(|sums| sums.powers[0]).sum::<f64>(), wanted.iter().map(|of| n * of.value).sum::<f64>());
    let factor = mean / whole;
    if is_target && (mean - whole).abs() > CLEAR * variance.sqrt() {
        told.push(format!("the mean of all weights is {factor:.4} times the integral of the target"));
    }
    if p_of_carried.is_some_and(|p| p < SUSPECT) {
        let ratio = found.pdfs[0] / found.pdfs[1];
        told.push(format!("the pdfs that samples carry are {ratio:.4} times those asked for, in the mean"));
    }
    told.extend(diagnose(domain, &counts).map(|places| match is_target {
        true => places.replace("too many", "too much weight").replace("too few", "too little weight"),
        false => places,
    }));
    let spread = is_target.then(|| found.variance());
    let remark = spread.map(|spread| {
        format!(
            "the variance of the weights is {:.4} ± {:.4} times their squared mean",
            spread.value, spread.half_width
        )
    });
    let samples = found.samples() as u64;
    let nowhere = "sums of weights differ from what is expected, in no place clearly".to_owned();
    let told = if told.is_empty() { nowhere } else { told.join("; ") };
    Ok(Outcome {
        statistic,
        dof: if is_dark { 0 } else { number },
        p,
        detectable,
        mass: (!is_target).then(|| {
            let squares: f64 = expected.iter().map(|place| place.variance).sum();
            Integral { value: total, error: 3.0 * squares.sqrt(), bound: Bound::Statistical }
        }),
        variance_of_weights: spread,
        cells: expected.len(),
        pooled: number,
        none: found.none,
        violation: found.violation,
        inconclusive_reason: reason,
        diagnosis: is_suspect.then_some(told),
        remarks: remark.into_iter().collect(),
        counts: Some(counts),
        ..Outcome::open(samples)
    })
}

/// What samples are compared with.
fn of(is_target: bool) -> &'static str {
    if is_target { "target" } else { "pdf" }
}

#[cfg(test)]
mod tests;
