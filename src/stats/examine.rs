//! One test of a sampler against a density: exact checks first, then counts in cells.

use super::chi_square::{FEWEST, chi_square};
use super::counting::{Counted, Counting, streams};
use super::cubature::{Fault, Place};
use super::density::{Density, Mass};
use super::domain::Domain;
use super::draws::{Draws, Tally, corners};
use super::grid::{Cell, Grid};
use super::multiple::sidak;
use super::outcome::{Counts, Outcome, decide};
use super::power::{POWER, chi_square_tail, detectable, samples_for};
use super::repeatable;
use super::sampler::Sampler;
use crate::error::{Error, Result};
use std::time::Instant;

/// How many samples a test takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Samples {
    Count(u64),
    /// As many as find a relative density error of this size with 90 % probability.
    Detect(f64),
}

/// How tests are done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Protocol {
    pub seed: u64,
    pub samples: Samples,
    /// Probability that a run in which every claim is true rejects any of them.
    pub level: f64,
    /// Tests of the run.
    pub tests: usize,
    /// Cells of a domain's chart, about.
    pub cells: usize,
}

impl Default for Protocol {
    /// A single test at 1 % that finds errors of 2 %, with 200 cells.
    fn default() -> Self {
        Self { seed: 1, samples: Samples::Detect(0.02), level: 0.01, tests: 1, cells: 200 }
    }
}

/// A test that would miss density errors of this size is no test.
const COARSEST: f64 = 0.1;
/// Most samples of one test.
const MOST: u64 = 1 << 34;
/// What the integral of a density may differ from its declared mass by, beyond the integral's own error bound.
const MASS: f64 = 1e-4;
/// Share of samples that rounding may carry over an edge of the support.
const ROUNDING: f64 = 1e-7;
/// Samples that decide on the cells, apart from those that are counted.
const PILOT: u64 = 1 << 14;
/// The share of a test's level that the bound of the mass may fail with.
const RISK: f64 = 0.1;

impl Protocol {
    /// Refuses values that no test can be done with.
    pub fn check(&self) -> Result<()> {
        let fault = |name: &str, message: String, hint: &str| Err(Error::parameter(name, message).with_hint(hint));
        if !(self.level > 0.0 && self.level < 1.0) {
            return fault("--level", format!("level {}", self.level), "use a probability such as 0.01");
        }
        if !(2..=1 << 20).contains(&self.cells) {
            return fault("--cells", format!("{} cells", self.cells), "use 2 to 2^20 cells");
        }
        match self.samples {
            Samples::Count(n) if !(1..=MOST).contains(&n) => {
                fault("--samples", format!("{n} samples"), "use 1 to 2^34 samples")
            }
            Samples::Detect(w) if !(w > 0.0 && w <= 1.0) => {
                fault("--detect", format!("error {w}"), "use a relative error such as 0.01")
            }
            Samples::Detect(w) if samples_for(self.cells - 1, self.own_level(), w) > MOST => {
                fault("--detect", format!("error {w} takes more than 2^34 samples"), "use a larger error")
            }
            _ => Ok(()),
        }
    }

    /// The level of one test among all of the run.
    #[must_use]
    pub fn own_level(&self) -> f64 {
        sidak(self.level, self.tests)
    }

    /// The number of samples for that many degrees of freedom.
    fn count(&self, dof: usize) -> u64 {
        match self.samples {
            Samples::Count(n) => n,
            Samples::Detect(w) => samples_for(dof, self.own_level(), w).min(MOST),
        }
    }

    /// The density error that a test must be able to find.
    fn coarsest(&self) -> f64 {
        match self.samples {
            Samples::Count(_) => COARSEST,
            Samples::Detect(w) => w.max(COARSEST),
        }
    }
}

/// Tests whether `sampler` draws from `density` over `domain`, with one repetition if it seems not.
///
/// Fails only for an impossible `protocol` and where the sampler or density is a program that breaks down.
pub fn validate<D: Domain>(
    domain: &D,
    sampler: &dyn Sampler<D::Point>,
    density: &dyn Density<D::Point>,
    protocol: &Protocol,
) -> Result<Outcome> {
    let mut outcome = [examine(domain, sampler, density, protocol, 0)?];
    decide(&mut outcome, protocol.own_level(), |_| examine(domain, sampler, density, protocol, 1))?;
    let [outcome] = outcome;
    Ok(outcome)
}

/// One round of a test, its verdict still open: see [`decide`]. Each `round` has random numbers of its own.
pub fn examine<D: Domain>(
    domain: &D,
    sampler: &dyn Sampler<D::Point>,
    density: &dyn Density<D::Point>,
    protocol: &Protocol,
    round: u64,
) -> Result<Outcome> {
    protocol.check()?;
    let start = Instant::now();
    let draws = Draws { domain, sampler, density, seed: protocol.seed };
    // Samples that are used up leave none for the corners, and few for a pilot.
    let supply = sampler.supply();
    let corner_fault = if supply.is_none() { corners(domain, sampler, density)? } else { None };
    let pilots = supply.map_or(PILOT, |supply| PILOT.min(supply / 4));
    let count = |dof| supply.map_or_else(|| protocol.count(dof), |supply| supply - pilots);
    let pilot = draws.places(streams(round, 0)[0], pilots)?;
    // Nothing can be said of integrals and counts then.
    if let Some(fault) = repeatable::changes(domain, density, &pilot)? {
        return Ok(Outcome { fault: Some(fault), seconds: start.elapsed().as_secs_f64(), ..Outcome::open(pilots) });
    }
    let atoms = density.atoms();
    let shape = shape(domain, protocol.cells);
    let grid = cells(domain, &pilot, shape, count(shape[0] * shape[1] + atoms.len()));
    let samples = count(grid.len() + atoms.len());
    let n = samples as f64;
    let at_atoms: f64 = atoms.iter().map(|atom| atom.probability).sum();
    let whole = (density.mass() == Mass::AtMostOne).then_some(1.0 - at_atoms);
    let risk = RISK * protocol.own_level();
    let counting = Counting { draws: &draws, grid: &grid, atoms: &atoms, samples, whole, risk };
    let Counted { values, integral, uncertain, fault, tally } = counting.run(&pilot, round)?;

    let mass = integral.plus(at_atoms);
    let tolerated = MASS + mass.error;
    let (none_expected, mass_fault) = match density.mass() {
        Mass::Exactly(m) => (1.0 - m, (mass.value - m).abs() > tolerated),
        Mass::AtMostOne => {
            // Where the integral is not exact, "no sample" is never known to be impossible.
            let least = if mass.error > 0.0 { 0.5 / n } else { 0.0 };
            ((1.0 - at_atoms - values.iter().sum::<f64>()).max(least), mass.value > 1.0 + tolerated)
        }
    };
    let mass_fault = mass_fault.then(|| match density.mass() {
        Mass::Exactly(m) => format!("the density integrates to {mass}, not to {m}"),
        Mass::AtMostOne => format!("the density integrates to {mass}, more than 1"),
    });
    let density_fault = fault.map(|Fault { point, value }| format!("the density at {point:?} is {value}"));

    let none_expected = n * none_expected.max(0.0);
    let expected: Vec<f64> = values
        .iter()
        .copied()
        .chain(atoms.iter().map(|atom| atom.probability))
        .map(|share| (n * share).max(f64::MIN_POSITIVE))
        .chain([none_expected.max(f64::MIN_POSITIVE)])
        .collect();
    let Tally { mut observed, none, impossible, fault: draw_fault, .. } = tally;
    // No sample where there must always be one is as impossible as a sample of density 0.
    let impossible = impossible + if none_expected == 0.0 { none } else { 0 };
    observed.push(none);

    // A claim that leaves nothing to chance (a mirror, a black map): what is left to find are impossible samples.
    let certain =
        expected.iter().filter(|e| **e >= 1.0).count() == 1 && expected.iter().all(|e| *e >= 1.0 || *e < 1e-300);
    let test = chi_square(&observed, &expected);
    let chance = if certain { Some(1.0) } else { test.map(|test| test.p) };
    let p = chance.filter(|_| !uncertain && density_fault.is_none()).map(|p| both(p, impossible, n * ROUNDING));
    let finds = match test {
        _ if certain => Some(strays(n)),
        _ => test.map(|test| detectable(test.dof, protocol.own_level(), samples)),
    };
    let doubt = if uncertain {
        Some("the density's integrals are too uncertain for that many samples".to_owned())
    } else {
        match finds {
            None => Some("too few samples: all cells had to be pooled".to_owned()),
            Some(w) if w > protocol.coarsest() => {
                Some(format!("too few samples: an error of the density below {:.0} % would go unnoticed", 100.0 * w))
            }
            Some(_) => None,
        }
    };
    Ok(Outcome {
        statistic: test.map_or(0.0, |test| test.statistic),
        dof: test.map_or(0, |test| test.dof),
        p,
        detectable: finds,
        seconds: start.elapsed().as_secs_f64(),
        mass: Some(mass),
        cells: observed.len(),
        pooled: test.map_or(0, |test| test.dof + 1),
        none,
        fault: density_fault.or(mass_fault).or(corner_fault).or(draw_fault).or_else(|| discrete(domain, &pilot)),
        doubt,
        counts: Some(Counts { axes: domain.axes(), grid, observed, expected, atoms: atoms.len() }),
        ..Outcome::open(samples)
    })
}

/// What is wrong with samples of a continuous set that keep coming back to the same few places.
///
/// Every fourth may be new: numbers of 13 bits, or of four digits, still count as continuous.
fn discrete<D: Domain>(domain: &D, pilot: &[Place]) -> Option<String> {
    if domain.outcomes().is_some() || pilot.len() < 1000 {
        return None;
    }
    let mut places: Vec<[u64; 2]> = pilot.iter().map(|place| place.at.map(f64::to_bits)).collect();
    places.sort_unstable();
    places.dedup();
    let (points, samples) = (places.len(), pilot.len());
    (4 * points < samples)
        .then(|| format!("this sampler is discrete: only {points} distinct points in {samples} samples"))
}

/// Rows and columns of about that many cells: rows half as many as columns.
fn shape<D: Domain>(domain: &D, cells: usize) -> [usize; 2] {
    if let Some(n) = domain.outcomes() {
        return [cells.min(n), 1];
    }
    if !domain.is_plane() {
        return [cells, 1];
    }
    let rows = ((cells as f64 / 2.0).sqrt().round() as usize).max(1);
    [rows, cells.div_ceil(rows)]
}

/// Cells of equal area where the pilot fills at least half of them; otherwise cells that adapt to it.
fn cells<D: Domain>(domain: &D, pilot: &[Place], shape: [usize; 2], samples: u64) -> Grid {
    let equal = Grid::equal(shape, domain.outcomes());
    let mut seen = vec![0u64; equal.len()];
    let pilot: Vec<[f64; 2]> = pilot.iter().map(|place| place.at).collect();
    pilot.iter().for_each(|&at| seen[equal.find(at)] += 1);
    let enough = FEWEST * pilot.len() as f64 / samples as f64;
    let filled = seen.iter().filter(|&&n| n > 0 && n as f64 >= enough).count();
    if 2 * filled >= equal.len() { equal } else { Grid::adapted(&pilot, shape, Cell::WHOLE, domain.outcomes()) }
}

/// The share of impossible samples that is found with probability [`POWER`] among `n`, one being enough to reject.
fn strays(n: f64) -> f64 {
    -(1.0 - POWER).ln() / n
}

/// The p-value of the counts and of `impossible` samples where rounding explains `allowed` on average.
fn both(p: f64, impossible: u64, allowed: f64) -> f64 {
    if impossible == 0 {
        return p;
    }
    // P(Poisson(m) ≥ k) = P(χ²(2k) ≤ 2m).
    let chance = 1.0 - chi_square_tail(2.0 * impossible as f64, 2.0 * allowed);
    (2.0 * p.min(chance)).min(1.0)
}
