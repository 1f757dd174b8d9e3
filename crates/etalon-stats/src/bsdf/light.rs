//! The light that a BSDF scatters into each cell of the sphere: ∫ f |cos θᵢ| over the cell, with its error.

use super::contract::{Direction, Kind, Spectrum};
use super::subject::{Subject, directions, sphere};
use crate::cubature::{Integration, InvalidPdf, Probe, Refinement, first_invalid};
use crate::domain::{Domain, Point};
use crate::error::{Result, poll};
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};
use crate::outcome::Outcome;
use crate::parallel::each;
use crate::sampler::Density;
use rand::RngExt;

/// Samples that decide on the cells and guide the cubature; they are not counted.
const PILOT: usize = 1 << 12;
/// Values of a stochastic BSDF that are asked for at a time.
const BATCH: usize = 1 << 13;
/// Samples that measure the light of a BSDF between the nodes of the cubature; a phase function has as many as the pilot.
const SAMPLES: usize = 1 << 14;
/// Random points at which integrals are checked.
const CHECKS: u64 = 1 << 12;
/// Standard errors of a measured difference that count as chance.
const CHANCE: f64 = 3.0;

/// Directions that the BSDF samples, delta lobes left out, in the chart of the sphere, with their weights.
pub struct Pilot {
    /// Chart coordinates.
    pub places: Vec<[f64; 2]>,
    /// Their weights.
    pub weights: Vec<[f64; 3]>,
}

impl Pilot {
    pub fn new(subject: &Subject) -> Result<Self> {
        Self::of(subject, PILOT, 0)
    }

    /// So many samples; each `batch` has random numbers of its own.
    fn of(subject: &Subject, samples: usize, batch: u64) -> Result<Self> {
        let mut rng = subject.random(3, batch);
        let u: Vec<f64> = (0..samples * subject.properties.dimension).map(|_| rng.random::<f64>()).collect();
        let (mut places, mut weights) = (Vec::new(), Vec::new());
        for sample in subject.sample(&u)?.into_iter().flatten().filter(|sample| !sample.is_delta()) {
            if let Some(place) = sphere().to_chart(sample.wi.into()) {
                places.push(place);
                weights.push(sample.weight);
            }
        }
        Ok(Self { places, weights })
    }

    /// Why values cannot be integrated: in the mean over samples they change by more than the coarsest error that a test may
    /// leave undetected when a coordinate of `wi` moves by its last place. Such a lobe is about as narrow as the distance of the
    /// directions that its arithmetic can tell apart.
    pub fn unresolved(&self, subject: &Subject) -> Result<Option<Outcome>> {
        const SAMPLES: usize = 1 << 8;
        if !subject.is_deterministic() {
            return Ok(None);
        }
        let step = 1.0 + subject.properties.precision;
        let moved = |wi: Direction, axis: usize| {
            let mut wi = wi;
            wi[axis] *= step;
            wi
        };
        let of_sample = |&at: &[f64; 2]| {
            let wi = sphere().direction_at(at);
            [wi, moved(wi, 0), moved(wi, 1), moved(wi, 2)]
        };
        let wis: Vec<Direction> = self.places.iter().take(SAMPLES).flat_map(of_sample).collect();
        let values = subject.bsdf.eval(&subject.pairs(&wis), &[])?;
        let changed = |[f, moved @ ..]: &[Spectrum; 4]| {
            let change = |other: &Spectrum| {
                (other[0] - f[0]).abs() / f[0].abs().at_least(other[0].abs()).at_least(f64::MIN_POSITIVE)
            };
            moved.iter().map(change).fold(0.0, f64::at_least)
        };
        let (of_samples, _) = values.as_chunks::<4>();
        let mean = of_samples.iter().map(changed).sum::<f64>() / of_samples.len().max(1) as f64;
        let reason = || format!("the rounding of directions changes values by {:.0} %", 100.0 * mean);
        let is_coarse = mean > subject.protocol.coarsest();
        Ok(is_coarse.then(|| Outcome { inconclusive_reason: Some(reason()), ..Outcome::open(SAMPLES as u64) }))
    }

    /// The channels whose weights differ from those of the channels before.
    pub fn channels(&self, subject: &Subject) -> Vec<usize> {
        let is_new = |&channel: &usize| {
            (0..channel).all(|other| {
                let same = self.weights.iter().all(|weight| weight[channel] == weight[other]);
                let same = same && subject.deltas.iter().all(|d| d.throughput[channel] == d.throughput[other]);
                !same
            })
        };
        (0..subject.properties.channels).filter(is_new).collect()
    }

    /// About `count` cells, adapted to these directions. The horizon, at which most BSDFs end, is an edge.
    pub fn grid(&self, count: usize) -> Grid {
        let half = |from: f64| {
            let within = Cell { x: [from, from + 0.5], y: [0.0, 1.0] };
            let places: Vec<[f64; 2]> =
                self.places.iter().copied().filter(|&[x, _]| (within.x[0]..within.x[1]).contains(&x)).collect();
            let cells = count as f64 * places.len() as f64 / self.places.len().max(1) as f64;
            let rows = (0.5 * cells).sqrt().round().at_least(1.0);
            let shape = [rows as usize, ((cells / rows) as usize).max(1)];
            Grid::adapted(&places, shape, within, None)
        };
        half(0.0).followed_by(half(0.5))
    }
}

/// f |cos θᵢ| of one channel; of power, that is times η², if asked.
struct Light<'a> {
    subject: &'a Subject<'a>,
    channel: usize,
    power: bool,
}

impl Light<'_> {
    fn at(&self, wis: &[Direction], u: &[f64]) -> Result<Vec<f64>> {
        let factor = |wi: Direction| if self.power { self.subject.eta2(wi) } else { 1.0 };
        let values = self.subject.bsdf.eval(&self.subject.pairs(wis), u)?.into_iter().zip(wis);
        Ok(values.map(|(f, &wi)| factor(wi) * f[self.channel] * self.subject.properties.kind.cos(wi)).collect())
    }
}

/// The light that the rules of the cubature miss, as samples measure it: what f |cos θᵢ| exceeds their polynomials by.
struct MissedLight {
    /// Values of each cell.
    cells: Vec<f64>,
    /// The standard error of the sum.
    deviation: f64,
    /// What the heaviest sample contributes to the sum.
    largest: f64,
}

/// The error of the sum over all cells: a systematic part, and a part by chance whose distribution is bounded.
#[derive(Debug, Clone, Copy, Default)]
pub struct Uncertainty {
    /// The bound of the systematic part: errors of rules and what was measured of them.
    pub systematic: f64,
    /// The standard error.
    pub deviation: f64,
    /// The light that a single random number of the estimate may carry.
    pub single: f64,
}

impl Uncertainty {
    /// The error that is exceeded with a probability of 3 e⁻ᵗ at most: systematic + √(2t) deviation + t single.
    ///
    /// For means of random values this is the empirical Bernstein bound (Maurer and Pontil, "Empirical Bernstein Bounds and
    /// Sample Variance Penalization", COLT 2009, theorem 4) with 7/3 of the largest value's contribution as `single`: one
    /// event for the variance, one for each sign of the error. It holds for sums over strata too. It assumes that no value
    /// is larger than the largest one found. For measured errors of cubature the mean difference is taken as normally
    /// distributed, whose tail is below e⁻ᵗ at √(2t) standard errors; and n samples all miss the places that hold a share
    /// t/n of them with probability e⁻ᵗ.
    pub fn bound(&self, t: f64) -> f64 {
        self.systematic + (2.0 * t).sqrt() * self.deviation + t * self.single
    }

    /// The largest probability with which an error reaches `error`.
    pub fn p_value(&self, error: f64) -> f64 {
        let excess = error - self.systematic;
        if excess <= 0.0 {
            return 1.0;
        }
        // Solve √(2t) deviation + t single = excess for √t.
        let linear = 2f64.sqrt() * self.deviation;
        let root = 2.0 * excess / (linear + (linear * linear + 4.0 * self.single * excess).sqrt());
        (3.0 * (-root * root).exp()).at_most(1.0)
    }

    /// The error that a test by [`p_value`](Self::p_value) at `level` finds with 90 % probability.
    pub fn detectable(&self, level: f64) -> f64 {
        // P(Z < 1.2816) = 90 % for the standard normal distribution.
        self.bound((3.0 / level).ln()) + 1.2816 * self.deviation
    }

    /// Whether nothing is left to chance.
    pub fn is_deterministic(&self) -> bool {
        self.deviation == 0.0 && self.single == 0.0
    }
}

impl Light<'_> {
    /// The light at the directions of these samples.
    fn probes(&self, samples: &Pilot) -> Result<Vec<Probe>> {
        let points: Vec<Direction> = samples.places.iter().map(|&at| sphere().direction_at(at)).collect();
        Ok(samples
            .places
            .iter()
            .zip(self.at(&points, &[])?)
            .map(|(&at, light)| Probe { at, density: light * sphere().measure() })
            .collect())
    }

    /// The random points of [`Refinement::check`] lie where the nodes predict light and do not meet narrow tails between
    /// the nodes. Fresh samples do.
    fn missed(&self, refinement: &Refinement, grid: &Grid) -> Result<MissedLight> {
        let count = if self.subject.properties.kind == Kind::Surface { SAMPLES } else { PILOT };
        let samples = Pilot::of(self.subject, count, 2)?;
        let (n, mut squares, mut largest) = (count as f64, 0.0, 0f64);
        let mut cells = vec![0.0; grid.len()];
        for (probe, weight) in self.probes(&samples)?.iter().zip(&samples.weights) {
            let factor = if self.power { self.subject.eta2(sphere().direction_at(probe.at)) } else { 1.0 };
            let weight = factor * weight[self.channel];
            let above = weight * (1.0 - refinement.share_within(probe));
            cells[grid.find(probe.at)] += above / n;
            squares += above * above;
            largest = largest.at_least(weight);
        }
        Ok(MissedLight { cells, deviation: squares.sqrt() / n, largest: largest / n })
    }
}

impl Density for Light<'_> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend(self.at(&directions(points), &[])?);
        Ok(())
    }
}

/// Integrals over cells.
pub struct CellIntegrals {
    /// The integrals.
    pub values: Vec<f64>,
    /// Bounds of their errors: of cubature.
    pub errors: Vec<f64>,
    /// The squares of their standard errors: of stochastic values.
    pub variances: Vec<f64>,
    /// The error of the sum.
    pub uncertainty: Uncertainty,
    /// A value that no BSDF can have.
    pub invalid: Option<InvalidPdf>,
}

impl CellIntegrals {
    /// The sum over all cells.
    pub fn total(&self) -> f64 {
        self.values.iter().sum()
    }
}

/// The light of one channel that is scattered from each cell of `grid`: by cubature, or for stochastic values by the mean of
/// values at `points` random points in each cell.
pub fn integrate(
    subject: &Subject,
    pilot: &Pilot,
    grid: &Grid,
    [channel, points]: [usize; 2],
    power: bool,
) -> Result<CellIntegrals> {
    let (domain, light) = (sphere(), Light { subject, channel, power });
    if !subject.is_deterministic() {
        return by_random_points(&light, grid, points);
    }
    let probes = light.probes(pilot)?;
    let mut integration = Integration::new(&domain, &light, grid, f64::INFINITY, &probes, subject.protocol.cancelled)?;
    let (mut differences, mut chance, mut invalid) = (vec![[0.0; 2]; grid.len()], 0.0, None);
    let mut missed = MissedLight { cells: vec![0.0; grid.len()], deviation: 0.0, largest: 0.0 };
    if let Integration::Refined(refinement) = &mut integration {
        // Learn where the nodes missed something, and measure with fresh points what is still missed.
        let seed = subject.protocol.seed;
        let mut found = refinement.check(CHECKS, seed, 0xf0 | subject.round)?.found;
        let more = light.probes(&Pilot::of(subject, PILOT, 1)?)?;
        found.extend(more.into_iter().filter(|probe| refinement.share_within(probe) < 1.0));
        refinement.learn(&found)?;
        let check = refinement.check(CHECKS, seed, 0xf8 | subject.round)?;
        differences = (0..grid.len()).map(|cell| check.difference(cell)).collect();
        chance = differences.iter().map(|[_, error]| error * error).sum::<f64>().sqrt();
        invalid = check.invalid;
        missed = light.missed(refinement, grid)?;
    }
    let integrals = integration.integrals();
    let beyond_chance =
        |(error, [difference, chance]): (&f64, &[f64; 2])| error + (difference.abs() - CHANCE * chance).at_least(0.0);
    let errors = integrals.errors.iter().zip(&differences).map(beyond_chance);
    let errors: Vec<f64> = errors.zip(&missed.cells).map(|(error, more)| error + more).collect();
    let difference: f64 = differences.iter().map(|[difference, _]| difference).sum();
    let systematic = integrals.errors.iter().chain(&missed.cells).sum::<f64>() + difference.abs();
    Ok(CellIntegrals {
        uncertainty: Uncertainty { systematic, deviation: chance.hypot(missed.deviation), single: missed.largest },
        variances: vec![0.0; grid.len()],
        invalid: integrals.invalid.or(invalid),
        values: integrals.values,
        errors,
    })
}

/// The mean of values at random points in one cell.
struct CellMean {
    value: f64,
    variance: f64,
    /// What the largest value contributes.
    largest: f64,
    invalid: Option<InvalidPdf>,
}

fn by_random_points(light: &Light, grid: &Grid, points: usize) -> Result<CellIntegrals> {
    let (domain, subject) = (sphere(), light.subject);
    let cells: Vec<Cell> = grid.cells().collect();
    let of_cell = |number: u64| -> Result<CellMean> {
        poll(subject.protocol.cancelled)?;
        let (mut rng, cell) = (subject.random(4, number), cells[number as usize]);
        let (mut sum, mut squares, mut largest, mut invalid) = (0.0, 0.0, 0f64, None);
        for from in (0..points).step_by(BATCH) {
            let (mut wis, mut u) = (Vec::new(), Vec::new());
            for _ in from..points.min(from + BATCH) {
                let along = |[from, to]: [f64; 2], t: f64| from + (to - from) * t;
                wis.push(domain.direction_at([along(cell.x, rng.random()), along(cell.y, rng.random())]));
                u.extend((0..subject.properties.eval_dimension).map(|_| rng.random::<f64>()));
            }
            let values = light.at(&wis, &u)?;
            invalid = invalid.or(first_invalid(&wis, &values));
            for value in values {
                sum += value;
                squares += value * value;
                largest = largest.at_least(value);
            }
        }
        let (n, size) = (points as f64, cell.area() * domain.measure());
        let variance = (squares - sum * sum / n).at_least(0.0) / (n * (n - 1.0));
        Ok(CellMean { value: size * sum / n, variance: size * size * variance, largest: size * largest / n, invalid })
    };
    let found = each(cells.len() as u64, of_cell)?;
    let variances: Vec<f64> = found.iter().map(|cell| cell.variance).collect();
    let largest = found.iter().map(|cell| cell.largest).fold(0.0, f64::at_least);
    Ok(CellIntegrals {
        values: found.iter().map(|cell| cell.value).collect(),
        errors: vec![0.0; grid.len()],
        uncertainty: Uncertainty {
            systematic: 0.0,
            deviation: variances.iter().sum::<f64>().sqrt(),
            single: 7.0 / 3.0 * largest,
        },
        variances,
        invalid: found.iter().find_map(|cell| cell.invalid),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_invert_the_bound() {
        for [systematic, deviation, single] in [[0.0, 1e-3, 0.0], [1e-4, 0.0, 1e-5], [1e-3, 2e-3, 1e-4]] {
            let uncertainty = Uncertainty { systematic, deviation, single };
            for t in [2.0, 8.0, 40.0] {
                let p = uncertainty.p_value(uncertainty.bound(t));
                assert!((p / (3.0 * f64::exp(-t)) - 1.0).abs() < 1e-9, "{uncertainty:?} {t}: {p}");
            }
            assert_eq!(uncertainty.p_value(0.9 * systematic), 1.0);
        }
        let exact = Uncertainty { systematic: 1e-3, ..Uncertainty::default() };
        assert!(exact.is_deterministic() && exact.p_value(1.1e-3) == 0.0 && exact.p_value(1e-3) == 1.0);
    }

    #[test]
    fn p_values_hold_for_rare_large_values() {
        // The mean of 500 values that are 100 in one of 100 cases, and 0 otherwise: the standard error alone is misleading.
        let (n, rate, size, runs) = (500, 0.01, 100.0, 20_000);
        let p_value = |seed: u64| {
            let mut rng = crate::stream::CounterRng::new(seed, 0);
            let hits = (0..n).filter(|_| rng.random::<f64>() < rate).count() as f64;
            let (n, mean) = (f64::from(n), hits * size / f64::from(n));
            let variance = (hits * size * size - n * mean * mean) / (n * (n - 1.0));
            let single = 7.0 / 3.0 * size / n;
            let uncertainty = Uncertainty { systematic: 0.0, deviation: variance.sqrt(), single };
            // Too large alone: where no value is found, the largest is not known.
            uncertainty.p_value(mean - rate * size)
        };
        let p: Vec<f64> = (0..runs).map(p_value).collect();
        for level in [0.1, 0.01, 1e-3] {
            let share = p.iter().filter(|p| **p < level).count() as f64 / f64::from(runs as u32);
            assert!(share <= level, "{share} at {level}");
        }
    }
}
