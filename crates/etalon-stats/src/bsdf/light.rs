//! The light that a BSDF scatters into each cell of the sphere: ∫ f |cos θᵢ| over the cell, with its error.

use super::contract::Direction;
use super::subject::Subject;
use super::vector::sphere;
use crate::cubature::{Integration, InvalidPdf, Probe, Refinement};
use crate::density::Density;
use crate::domain::{Directions, Domain};
use crate::error::{Result, poll};
use crate::grid::{Cell, Grid};
use rand::RngExt;
use rayon::prelude::*;

/// Samples that decide on the cells and guide the cubature; they are not counted.
const PILOT: usize = 1 << 12;
/// Values of a stochastic BSDF that are asked for at a time.
const BATCH: usize = 1 << 13;
/// Samples that tell how much light the nodes of the cubature do not predict.
const WITNESSES: usize = 1 << 14;
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
            if let Some(place) = sphere().to_chart(sample.wi) {
                places.push(place);
                weights.push(sample.weight);
            }
        }
        Ok(Self { places, weights })
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
            let rows = (0.5 * cells).sqrt().round().max(1.0);
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
        Ok(values.map(|(f, &wi)| factor(wi) * f[self.channel] * wi[2].abs()).collect())
    }
}

/// Light that samples find above what the nodes of the cubature predict.
struct Unpredicted {
    /// Of each cell.
    cells: Vec<f64>,
    /// The bound of all of it: what was found, its chance, and what as many samples do not find.
    bound: f64,
}

impl Light<'_> {
    /// The light at the directions of these samples.
    fn probes(&self, samples: &Pilot) -> Result<Vec<Probe>> {
        let points: Vec<Direction> = samples.places.iter().map(|&at| sphere().point_at(at)).collect();
        Ok(samples.places.iter().zip(self.at(&points, &[])?).map(|(&at, pdf)| Probe { at, pdf }).collect())
    }

    /// Random points, which lie where the nodes predict light, do not meet narrow tails between the nodes. Fresh samples do.
    fn unpredicted(&self, refinement: &Refinement<Directions>, grid: &Grid) -> Result<Unpredicted> {
        let samples = Pilot::of(self.subject, WITNESSES, 2)?;
        let (mut cells, mut squares, mut largest) = (vec![0.0; grid.len()], 0.0, 0f64);
        for (probe, weight) in self.probes(&samples)?.iter().zip(&samples.weights) {
            let factor = if self.power { self.subject.eta2(sphere().point_at(probe.at)) } else { 1.0 };
            let weight = factor * weight[self.channel];
            let above = weight * (1.0 - refinement.share_within(probe));
            cells[grid.find(probe.at)] += above / WITNESSES as f64;
            squares += above * above;
            largest = largest.max(weight);
        }
        // Of n samples none falls on a share of 3/n with a probability of 5 %.
        let chance = CHANCE * (squares.sqrt() + largest) / WITNESSES as f64;
        Ok(Unpredicted { bound: cells.iter().sum::<f64>() + chance, cells })
    }
}

impl Density<Direction> for Light<'_> {
    fn pdf(&self, points: &[Direction], out: &mut Vec<f64>) -> Result<()> {
        out.extend(self.at(points, &[])?);
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
    /// The bound of the sum's error.
    pub total_error: f64,
    /// A value that no BSDF can have.
    pub invalid: Option<InvalidPdf<Direction>>,
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
    let mut integration = Integration::new(&domain, &light, grid, &probes, subject.protocol.cancelled)?;
    let (mut differences, mut chance, mut invalid) = (vec![[0.0; 2]; grid.len()], 0.0, None);
    let mut unpredicted = Unpredicted { cells: vec![0.0; grid.len()], bound: 0.0 };
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
        unpredicted = light.unpredicted(refinement, grid)?;
    }
    let integrals = integration.integrals();
    let beyond_chance =
        |(error, [difference, chance]): (&f64, &[f64; 2])| error + (difference.abs() - CHANCE * chance).max(0.0);
    let errors = integrals.errors.iter().zip(&differences).map(beyond_chance);
    let errors: Vec<f64> = errors.zip(&unpredicted.cells).map(|(error, more)| error + more).collect();
    let missed: f64 = differences.iter().map(|[difference, _]| difference).sum();
    Ok(CellIntegrals {
        total_error: integrals.errors.iter().sum::<f64>() + missed.abs() + CHANCE * chance + unpredicted.bound,
        variances: vec![0.0; grid.len()],
        invalid: integrals.invalid.or(invalid),
        values: integrals.values,
        errors,
    })
}

fn by_random_points(light: &Light, grid: &Grid, points: usize) -> Result<CellIntegrals> {
    let (domain, subject) = (sphere(), light.subject);
    let of_cell = |(number, cell): (usize, Cell)| -> Result<[f64; 2]> {
        poll(subject.protocol.cancelled)?;
        let mut rng = subject.random(4, number as u64);
        let (mut sum, mut squares) = (0.0, 0.0);
        for from in (0..points).step_by(BATCH) {
            let (mut wis, mut u) = (Vec::new(), Vec::new());
            for _ in from..points.min(from + BATCH) {
                let along = |[from, to]: [f64; 2], t: f64| from + (to - from) * t;
                wis.push(domain.point_at([along(cell.x, rng.random()), along(cell.y, rng.random())]));
                u.extend((0..subject.properties.eval_dimension).map(|_| rng.random::<f64>()));
            }
            for value in light.at(&wis, &u)? {
                sum += value;
                squares += value * value;
            }
        }
        let (n, size) = (points as f64, cell.area() * domain.measure());
        let variance = (squares - sum * sum / n).max(0.0) / (n * (n - 1.0));
        Ok([size * sum / n, size * size * variance])
    };
    let all: Vec<_> = grid.cells().enumerate().collect();
    let found = all.into_par_iter().map(of_cell).collect::<Result<Vec<_>>>()?;
    let variances: Vec<f64> = found.iter().map(|found| found[1]).collect();
    Ok(CellIntegrals {
        values: found.iter().map(|found| found[0]).collect(),
        errors: vec![0.0; grid.len()],
        total_error: CHANCE * variances.iter().sum::<f64>().sqrt(),
        variances,
        invalid: None,
    })
}
