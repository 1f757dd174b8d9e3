//! Samples counted in cells against the integrals of the pdf, which are refined until their errors do not show.

use crate::chi_square::FEWEST;
use crate::cubature::{Integration, InvalidPdf, Probe, Shares};
use crate::density::Atom;
use crate::error::Result;
use crate::extremes::Extremes;
use crate::fixed::Share;
use crate::mass::Integral;
use crate::serial::Labels;
use crate::subdivision::Subdivision;
use crate::tally::{Counters, Source, Tally};

/// Random points at which integrals are checked: one for each four samples, between a least and a largest number.
const SAMPLES_PER_CHECK: u64 = 4;
const CHECKS: [u64; 2] = [1 << 14, 1 << 20];
/// Noncentrality per cell that errors of the integrals may add to the chi-square statistic. With 200 cells its mean then
/// moves by 0.025 standard deviations.
const SLACK: f64 = 0.0025;
/// Share of the pdf that samples may find above what the nodes predict before it is integrated again.
const MISSED: f64 = 1e-4;
/// Standard errors of a measured difference that count as chance.
const CHANCE: f64 = 2.0;
/// Attempts at counting, each with fresh samples.
const ATTEMPTS: u64 = 3;

/// The numbers of the random streams of an attempt: of its samples and of its checks. Attempt 0 is the pilot.
pub fn streams(round: u64, attempt: u64) -> [u64; 2] {
    let first = 2 * (round * (ATTEMPTS + 1) + attempt);
    [first, first + 1]
}

/// What is to be counted.
pub struct Counting<'a> {
    pub source: &'a Source<'a>,
    /// The cells and their parts.
    pub subdivision: &'a Subdivision<'a>,
    pub labels: Labels,
    /// The density's atoms, which are counted apart.
    pub atoms: &'a [Atom],
    pub samples: u64,
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
    /// The integrals over the parts of the cells and of the axes, and the share of samples that they are known to miss; `None`
    /// where the cells' integrals were corrected by samples, which do not tell the parts.
    pub shares: Option<(Shares, f64)>,
    pub integral: Integral,
    /// Whether errors of the cells' integrals would show in the chi-square test.
    pub uncertain: bool,
    pub invalid: Option<InvalidPdf>,
    pub tally: Tally,
}

/// What is added to each cell's integral, and the standard error of that.
type Correction = [f64; 2];

impl Counting<'_> {
    /// Integrates and counts.
    ///
    /// Where the first samples show that the integrals are too uncertain, the density is integrated again with the probes
    /// that they found. Where the second samples still show it, the missing part of the integrals is estimated from them and
    /// added. Counted samples are always fresh: they had no influence on the integrals that they are compared with.
    pub fn run(&self, pilot: &[Probe], round: u64) -> Result<Counted> {
        let Source { domain, sampler, density, seed, cancelled } = *self.source;
        let Self { subdivision, labels, atoms, .. } = *self;
        let mut integration = Integration::with_parts(domain, density, subdivision, pilot, cancelled)?;
        if let Integration::Refined(refinement) = &mut integration {
            let [_, checks] = streams(round, 0);
            let found = refinement.check(pilot.len() as u64, seed, checks)?.found;
            refinement.learn(&found)?;
        }
        let probes = (self.samples / SAMPLES_PER_CHECK).clamp(CHECKS[0], CHECKS[1]);
        let attempts = if sampler.finite_len().is_some() { 1 } else { ATTEMPTS };
        let mut corrections: Option<Vec<Correction>> = None;
        let mut attempt = 1;
        loop {
            let [stream, checks] = streams(round, attempt);
            let counters = Counters { subdivision, labels, atoms, integration: &integration };
            let tally = self.source.tally(stream, self.samples, &counters)?;
            let mut integrals = integration.integrals();
            let Integration::Refined(refinement) = &mut integration else {
                let (integral, scale) = (Integral::exact(&integrals), self.scale(&integrals.values));
                let shares = Some((integration.shares(subdivision).times(scale), 0.0));
                let (values, invalid) =
                    (integrals.values.iter().map(|value| scale * value).collect(), integrals.invalid);
                return Ok(Counted { values, shares, integral, uncertain: false, invalid, tally });
            };
            let check = refinement.check(probes, seed, checks)?;
            let integral = Integral::measured(&integrals, &check, &tally, self.risk);
            let invalid = integrals.invalid.or(check.invalid);
            let scale = self.scale(&integrals.values);
            integrals.values.iter_mut().chain(&mut integrals.errors).for_each(|integral| *integral *= scale);

            let some = self.samples - if self.normalized { tally.none } else { 0 };
            let missed = |cell: usize| tally.missed[cell].sum() / some.max(1) as f64;
            // The error of a cell's integral: what the rules say of it, and what probes and samples say beyond chance.
            let found = |cell: usize| {
                let [difference, error] = check.difference(cell);
                scale * (difference.abs() - CHANCE * error).at_least(0.0) + missed(cell)
            };
            let error = |cell: usize| match &corrections {
                Some(corrections) => corrections[cell][1],
                None => integrals.errors[cell] + found(cell),
            };
            let uncertain = self.is_uncertain(&integrals.values, error);
            // Stop when the integrals are precise enough, after the last attempt, or at an invalid pdf; apply corrections.
            let is_good = !uncertain
                && (corrections.is_some()
                    || Share::total(tally.missed.iter().copied()) <= MISSED * self.samples as f64);
            if is_good || attempt == attempts || invalid.is_some() {
                let all_found: f64 = (0..subdivision.grid.len()).map(found).sum();
                let shares = corrections.is_none().then(|| (refinement.shares(subdivision).times(scale), all_found));
                for (value, [more, _]) in integrals.values.iter_mut().zip(corrections.into_iter().flatten()) {
                    *value = (*value + more).at_least(0.0);
                }
                let scale = self.scale(&integrals.values);
                integrals.values.iter_mut().for_each(|value| *value *= scale);
                return Ok(Counted { values: integrals.values, shares, integral, uncertain, invalid, tally });
            }
            // Learn where the density is not what the nodes predict; before the last attempt estimate what is missing.
            attempt += 1;
            if attempt < attempts {
                refinement.learn(&[check.found, tally.found].concat())?;
            } else {
                let correction = |cell: usize| {
                    let ([within_reach, error], missed) = (check.difference(cell), missed(cell));
                    [scale * within_reach + missed, (scale * error).hypot((missed / self.samples as f64).sqrt())]
                };
                corrections = Some((0..subdivision.grid.len()).map(correction).collect());
            }
        }
    }

    /// What integrals are multiplied by to be probabilities.
    fn scale(&self, values: &[f64]) -> f64 {
        let total: f64 = values.iter().sum();
        let at_atoms: f64 = self.atoms.iter().map(|atom| atom.probability).sum();
        if self.normalized && total > 0.0 { (1.0 - at_atoms) / total } else { 1.0 }
    }

    /// Whether errors of the integrals over the cells add more than [`SLACK`] to the statistic; that over "no sample", if it
    /// is not declared, has the errors of all.
    fn is_uncertain(&self, values: &[f64], error: impl Fn(usize) -> f64) -> bool {
        let n = self.samples as f64;
        // Cells that expect less than this are pooled.
        let term = |value: f64, error: f64| (n * error).powi(2) / (n * value).at_least(FEWEST);
        let of_cells: f64 = values.iter().enumerate().map(|(cell, value)| term(*value, error(cell))).sum();
        let of_none = self.whole.map_or(0.0, |whole| {
            let squares: f64 = (0..values.len()).map(|cell| error(cell).powi(2)).sum();
            term(whole - values.iter().sum::<f64>(), squares.sqrt())
        });
        (of_cells + of_none).may_exceed(SLACK * values.len() as f64)
    }
}
