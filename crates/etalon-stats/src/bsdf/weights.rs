//! The test of weights, which needs no pdf: sums of weights over cells of directions and delta lobes against the light that the
//! BSDF scatters from there.
//!
//! For any right pair of values and samples, whatever the pdf, the mean of the weights of samples in a cell is ∫ f |cos θᵢ| over
//! the cell. So the test also works where the pdf is unknown, approximate or stochastic.

use super::light::{CellIntegrals, Pilot, integrate};
use super::mistakes::light;
use super::subject::{Subject, sphere};
use crate::diagnosis::diagnose;
use crate::domain::Domain;
use crate::error::{Result, poll};
use crate::exact::percent;
use crate::examine::{SUSPECT, SampleCount};
use crate::extremes::Extremes;
use crate::grid::Grid;
use crate::mistakes::{Kinds, of_counts};
use crate::multiple::sidak;
use crate::outcome::{Counts, Outcome};
use crate::parallel::each;
use crate::power::{FEWEST, chi_square_tail, noncentrality, samples_for};
use rand::RngExt;

/// Cells of the test: fewer than of a test of counts, since weights vary.
const CELLS: usize = 100;
/// Fewest and most samples.
const SAMPLES: [u64; 2] = [1 << 14, 1 << 24];
/// A sample with a larger share of the squares of its cell makes their sum, and so the variance, uncertain.
const LARGEST: f64 = 0.1;
/// The share of light in such cells that makes the test inconclusive.
const UNCONTROLLED: f64 = 0.05;
/// The share of light that rounding may carry over an edge of the support.
const ROUNDING: f64 = 1e-6;
/// Cells that hold fewer effective samples are put together.
const EFFECTIVE: f64 = 5.0 * FEWEST;

/// A cell, or several: the weights found, the light expected, and the variance of the difference.
#[derive(Clone, Copy, Default)]
struct Term {
    found: CellSum,
    expected: f64,
    /// The part of the variance that comes from `expected`.
    uncertainty: f64,
}

impl Term {
    fn plus(self, other: Self) -> Self {
        Self {
            found: self.found.plus(other.found),
            expected: self.expected + other.expected,
            uncertainty: self.uncertainty + other.uncertainty,
        }
    }

    /// The variance of the sum if its mean is as expected. With Poisson's number of samples it is N E\[w²\], estimated by the
    /// ratio of the squares to the sum, or by that of all cells together where there are no samples; weights that are all equal
    /// make it Pearson's.
    fn variance(&self, all: f64) -> f64 {
        let ratio = if self.found.sum > 0.0 { self.found.squares / self.found.sum } else { all };
        ratio * self.expected + self.uncertainty
    }

    /// The number of samples of equal weights that would have this variance.
    fn effective(&self, all: f64) -> f64 {
        let variance = self.variance(all);
        if variance > 0.0 { self.expected * self.expected / variance } else { 0.0 }
    }
}

/// The cells of one channel.
struct Cells {
    terms: Vec<Term>,
    /// Σ w² / Σ w over all of them.
    ratio: f64,
}

/// What the test says of one channel.
struct Tested {
    statistic: f64,
    dof: usize,
    p: f64,
    /// Σ of the effective numbers of samples.
    effective: f64,
    /// The share of light in cells whose variance is uncertain.
    uncontrolled: f64,
}

impl Cells {
    fn new(found: &[CellSum], integrals: &CellIntegrals, deltas: &[f64], count: f64) -> Self {
        let spread = integrals.values.iter().zip(&integrals.errors).zip(&integrals.variances);
        let spread = spread.map(|((value, error), variance)| (*value, error * error + variance));
        let expected = spread.chain(deltas.iter().map(|&throughput| (throughput, 0.0))).chain([(0.0, 0.0)]);
        let term = |((expected, variance), found): ((f64, f64), &CellSum)| Term {
            found: *found,
            expected: count * expected,
            uncertainty: count * count * variance,
        };
        let terms: Vec<Term> = expected.zip(found).map(term).collect();
        let all = terms.iter().fold(CellSum::default(), |sum, term| sum.plus(term.found));
        Self { terms, ratio: if all.sum > 0.0 { all.squares / all.sum } else { 0.0 } }
    }

    fn test(&self) -> Option<Tested> {
        let mut terms = self.terms.clone();
        let light: f64 = terms.iter().map(|term| term.expected).sum();
        let weights: f64 = terms.iter().map(|term| term.found.sum).sum();
        // Put cells of few effective samples together.
        terms.sort_by(|a, b| a.effective(self.ratio).total_cmp(&b.effective(self.ratio)));
        let (mut groups, mut open) = (Vec::new(), Term::default());
        for term in terms {
            open = open.plus(term);
            if open.effective(self.ratio) >= EFFECTIVE {
                groups.push(std::mem::take(&mut open));
            }
        }
        match groups.last_mut() {
            Some(last) => *last = last.plus(open),
            // Light is expected from nowhere: any weight is wrong.
            None if light == 0.0 && weights > 0.0 => {
                return Some(Tested { statistic: 0.0, dof: 0, p: 0.0, effective: 0.0, uncontrolled: 0.0 });
            }
            None => return None,
        }
        // Where a single sample decides, nothing is known of the variance.
        let is_controlled = |term: &Term| term.found.largest <= LARGEST * term.found.squares;
        let (controlled, others): (Vec<Term>, Vec<Term>) = groups.into_iter().partition(is_controlled);
        let z2 = |term: &Term| (term.found.sum - term.expected).powi(2) / term.variance(self.ratio);
        let (statistic, dof) = (controlled.iter().map(z2).sum::<f64>(), controlled.len());
        // Weights where the BSDF scatters no light.
        let dark = self.terms.iter().filter(|term| term.expected == 0.0).map(|term| term.found.sum).sum::<f64>();
        let is_dark = dark > ROUNDING * weights;
        let p = match dof {
            0 => 1.0,
            _ if is_dark => 0.0,
            _ => chi_square_tail(dof as f64, statistic),
        };
        Some(Tested {
            statistic,
            // Weights from where no light comes reject whatever the statistic is.
            dof: if is_dark { 0 } else { dof },
            p,
            effective: controlled.iter().map(|term| term.effective(self.ratio)).sum(),
            uncontrolled: others.iter().map(|term| term.expected).sum::<f64>() / light,
        })
    }

    /// The same as counts, observed and expected: `size` is the number of samples that is expected of a term.
    fn counts(&self, grid: Grid, mut atoms: Vec<String>, size: impl Fn(&Term) -> f64) -> Counts {
        let expected: Vec<f64> = self.terms.iter().map(|term| size(term).at_least(f64::MIN_POSITIVE)).collect();
        let observed = |(term, expected): (&Term, &f64)| match term.expected > 0.0 {
            true => (expected * term.found.sum / term.expected).round() as u64,
            false => (term.found.sum / self.ratio.at_least(f64::MIN_POSITIVE)).round() as u64,
        };
        let observed = self.terms.iter().zip(&expected).map(observed).chain([0]).collect();
        atoms.push("delta lobes that are not declared".to_owned());
        let expected = expected.into_iter().chain([f64::MIN_POSITIVE]).collect();
        Counts::new(&sphere(), grid, atoms, observed, expected)
    }
}

/// Compares the sums of weights with the light of every cell, for each channel that differs from the others.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.has_known_weights()? {
        return Ok(None);
    }
    let pilot = Pilot::new(subject)?;
    if let Some(unresolved) = pilot.unresolved(subject)? {
        return Ok(Some(unresolved));
    }
    let (channels, own) = (pilot.channels(subject), subject.protocol.own_level());
    let grid = pilot.grid(CELLS.min(subject.protocol.cells));
    let dof = grid.len() + subject.deltas.len();
    // As many samples as detect the error, if weights vary as much as in the pilot.
    let level = sidak(own, channels.len());
    let count = match subject.protocol.samples {
        SampleCount::Fixed(n) => n,
        SampleCount::Detect(w) => {
            let equal = samples_for(dof, level, w);
            let efficiency = sums(subject, &grid, &channels, 2 * BATCH, 5, false)?;
            let of = |cells: &Vec<CellSum>| -> f64 {
                let lit = cells.iter().filter(|cell| cell.squares > 0.0);
                lit.map(|cell| cell.sum * cell.sum / cell.squares).sum::<f64>() / (2 * BATCH) as f64
            };
            let least = efficiency.cells.iter().map(of).filter(|&share| share > 0.0).fold(1.0, f64::at_most);
            ((equal as f64 / least) as u64).clamp(SAMPLES[0], SAMPLES[1])
        }
    };
    let Sums { cells: found, violation: above_bound } = sums(subject, &grid, &channels, count, 6, true)?;
    let points = (count as usize / grid.len()).max(1 << 8);
    let (mut worst, mut violation): (Option<(Tested, Cells, usize)>, Option<String>) = (None, above_bound);
    let (mut detectable, mut uncontrolled, mut decided) = (0f64, 0f64, true);
    for (&channel, found) in channels.iter().zip(&found) {
        let integrals = integrate(subject, &pilot, &grid, [channel, points], false)?;
        let invalid = integrals.invalid.map(|at| {
            format!("{}: {} = {}", subject.at(at.point.into()), subject.properties.kind.integrand(), at.value)
        });
        violation = violation.or(invalid);
        let deltas: Vec<f64> = subject.deltas.iter().map(|lobe| lobe.throughput[channel]).collect();
        let cells = Cells::new(found, &integrals, &deltas, count as f64);
        let Some(tested) = cells.test() else {
            // A black channel scatters nothing, and no sample carries anything.
            decided &= found.iter().all(|cell| cell.sum == 0.0);
            continue;
        };
        if tested.dof > 0 {
            detectable = detectable.at_least((noncentrality(tested.dof, level) / tested.effective).sqrt());
        }
        uncontrolled = uncontrolled.at_least(tested.uncontrolled);
        if worst.as_ref().is_none_or(|(worst, ..)| tested.p < worst.p) {
            worst = Some((tested, cells, channel));
        }
    }
    let p = worst.as_ref().map(|(worst, ..)| (worst.p * channels.len() as f64).at_most(1.0));
    let reason = if !decided {
        Some("too few samples carry light".to_owned())
    } else if uncontrolled > UNCONTROLLED {
        let share = 100.0 * uncontrolled;
        Some(format!("single weights decide on {share:.0} % of the light: their tail is not controlled"))
    } else {
        let coarse = Some(detectable).filter(|&w| w > subject.protocol.coarsest());
        coarse.map(|w| format!("too few samples: an error of the weights below {} would remain undetected", percent(w)))
    };
    let counts = worst.as_ref().map(|(_, cells, channel)| {
        let of = |size: &dyn Fn(&Term) -> f64| cells.counts(grid.clone(), subject.delta_names(), size);
        // Effective numbers of samples tell chance, and light tells sizes.
        (of(&|term| term.effective(cells.ratio)), of(&|term| term.expected / cells.ratio), *channel)
    });
    let (mut mistake, mut diagnosis) = (None, None);
    if let Some((counts, light_of_cells, channel)) = counts.as_ref().filter(|_| p.is_some_and(|p| p < SUSPECT)) {
        diagnosis = diagnose(&sphere(), light_of_cells);
        if subject.is_deterministic() {
            let named = of_counts(
                &sphere(),
                &light(subject, *channel),
                counts,
                None,
                ["weights", subject.properties.kind.integrand()],
                Kinds::Local,
            )?;
            mistake = named.map(|named| named.with_suffix(&subject.channel(*channel)));
        }
    }
    Ok(Some(Outcome {
        statistic: worst.as_ref().map_or(0.0, |(worst, ..)| worst.statistic),
        dof: worst.as_ref().map_or(0, |(worst, ..)| worst.dof),
        p,
        detectable: Some(detectable),
        cells: dof,
        pooled: worst.as_ref().map_or(0, |(worst, ..)| worst.dof),
        violation,
        inconclusive_reason: reason,
        mistake,
        diagnosis,
        counts: counts.map(|(counts, ..)| counts),
        ..Outcome::open(count)
    }))
}

/// Samples taken at a time.
pub const BATCH: u64 = 1 << 13;

/// The weights of the samples in one cell.
#[derive(Debug, Clone, Copy, Default)]
pub struct CellSum {
    /// Σ w.
    pub sum: f64,
    /// Σ w².
    pub squares: f64,
    /// The largest w².
    pub largest: f64,
}

impl CellSum {
    fn add(&mut self, weight: f64) {
        let square = weight * weight;
        self.sum += weight;
        self.squares += square;
        self.largest = self.largest.at_least(square);
    }

    /// The sums of two cells, or of two batches of one cell.
    pub fn plus(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            largest: self.largest.at_least(other.largest),
        }
    }
}

/// Sums over samples.
#[derive(Default)]
pub struct Sums {
    /// For each channel and place.
    pub cells: Vec<Vec<CellSum>>,
    /// A weight above the declared bound.
    pub violation: Option<String>,
}

impl Sums {
    fn new(channels: usize, places: usize) -> Self {
        Self { cells: vec![vec![CellSum::default(); places]; channels], violation: None }
    }
}

/// Sums for each channel of `channels`: over the cells, then over the delta lobes, then over samples of delta lobes that are not
/// declared.
///
/// The number of samples is `count`, or random with this mean and Poisson's distribution (`poisson`), so that the sums of
/// different cells are independent.
pub fn sums(
    subject: &Subject,
    grid: &Grid,
    channels: &[usize],
    count: u64,
    purpose: u64,
    poisson: bool,
) -> Result<Sums> {
    let places = grid.len() + subject.deltas.len() + 1;
    let of_batch = |batch: u64| -> Result<Sums> {
        poll(subject.protocol.cancelled)?;
        let mut rng = subject.random(purpose, batch + 1);
        let mean = BATCH.min(count - batch * BATCH);
        let (mut u, mut arrival) = (Vec::with_capacity(mean as usize * subject.properties.dimension), 0.0);
        loop {
            // Poisson's numbers count arrivals whose distances are exponentially distributed.
            arrival += if poisson { -(1.0 - rng.random::<f64>()).ln() } else { 1.0 };
            if arrival > mean as f64 {
                break;
            }
            u.extend((0..subject.properties.dimension).map(|_| rng.random::<f64>()));
        }
        let mut sums = Sums::new(channels.len(), places);
        for sample in subject.sample(&u)?.into_iter().flatten() {
            sums.violation = sums.violation.or_else(|| subject.above_bound(&sample));
            let place = if sample.is_delta() {
                let known = subject.deltas.iter().position(|lobe| sphere().same(lobe.wi.into(), sample.wi.into()));
                grid.len() + known.unwrap_or(subject.deltas.len())
            } else {
                sphere().to_chart(sample.wi.into()).map_or(places - 1, |place| grid.find(place))
            };
            for (sums, &channel) in sums.cells.iter_mut().zip(channels) {
                sums[place].add(sample.weight[channel]);
            }
        }
        Ok(sums)
    };
    let batches = each(count.div_ceil(BATCH), of_batch)?;
    // Add in the order of the batches: the sums are the same for any number of threads.
    let mut total = Sums::new(channels.len(), places);
    for batch in batches {
        for (total, batch) in total.cells.iter_mut().flatten().zip(batch.cells.into_iter().flatten()) {
            *total = total.plus(batch);
        }
        total.violation = total.violation.or(batch.violation);
    }
    Ok(total)
}
