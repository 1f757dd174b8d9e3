//! Sums of sample weights over cells and delta lobes.

use super::subject::Subject;
use super::vector::sphere;
use crate::domain::Domain;
use crate::error::{Result, poll};
use crate::extremes::Extremes;
use crate::grid::Grid;
use rand::RngExt;
use rayon::prelude::*;

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
    let batches = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch).collect::<Result<Vec<_>>>()?;
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
