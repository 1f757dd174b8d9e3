//! Mistakes in sampling from tables.

use super::fault::PlantedFault;
use etalon_stats::{Density, Discrete, Sample, Sampler, density, sampler};

const WEIGHTS: [f64; 8] = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];

/// The cell of a cumulative table that `u` falls into, by bisection.
fn find(cdf: &[f64], u: f64) -> usize {
    cdf.partition_point(|&end| end <= u)
}

/// Cells sampled by `cell` against probabilities in proportion to `weights`.
fn by_weight(weights: Vec<f64>, cell: impl Fn(f64) -> usize + Sync) -> (impl Sampler, impl Density) {
    let total: f64 = weights.iter().sum();
    (sampler(1, move |u| Some(Sample::new(cell(u[0])))), density(move |cell: usize| weights[cell] / total))
}

/// The ends of the cells, with sums that `round` rounds.
fn cumulative(weights: &[f64], round: impl Fn(f64) -> f64) -> Vec<f64> {
    let ends: Vec<f64> = weights
        .iter()
        .scan(0.0, |sum, weight| {
            *sum = round(*sum + weight);
            Some(*sum)
        })
        .collect();
    let total = ends[ends.len() - 1];
    ends.into_iter().map(|end| end / total).collect()
}

/// Walker's table: the share of each bucket that is its own, and the owner of the rest.
fn alias(weights: &[f64]) -> Vec<(f64, usize)> {
    let n = weights.len();
    let total: f64 = weights.iter().sum();
    let mut left: Vec<f64> = weights.iter().map(|weight| weight * n as f64 / total).collect();
    let mut table: Vec<(f64, usize)> = (0..n).map(|i| (1.0, i)).collect();
    // Fill each bucket below its share from one above it.
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| left[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = (left[s], l);
        left[l] -= 1.0 - left[s];
        if left[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    table
}

pub fn faults() -> Vec<PlantedFault> {
    let small = Discrete { outcomes: WEIGHTS.len() };
    vec![
        PlantedFault::of("table/search-off-by-one", small, |faulty| {
            let cdf = cumulative(&WEIGHTS, |sum| sum);
            by_weight(WEIGHTS.into(), move |u| find(&cdf, u).saturating_sub(usize::from(faulty)))
        })
        .mistake("the table's leading 0 forgotten: the search returns the cell before"),
        PlantedFault::of("table/alias-off-by-one", small, |faulty| {
            let table = alias(&WEIGHTS);
            by_weight(WEIGHTS.into(), move |u| {
                let scaled = u * table.len() as f64;
                let bucket = scaled as usize;
                if scaled.fract() < table[bucket].0 {
                    bucket
                } else {
                    table[(bucket + usize::from(faulty)) % table.len()].1
                }
            })
        })
        .mistake("an alias table that looks the owner up in the next bucket"),
        PlantedFault::of("table/rounded-index", small, |faulty| {
            by_weight(vec![1.0; 8], move |u| if faulty { (u * 7.0).round() as usize } else { (u * 8.0) as usize })
        })
        .mistake("one of n chosen as u (n − 1) rounded: the first and the last come half as often"),
        PlantedFault::of("table/f32-sums", Discrete { outcomes: SKY }, |faulty| {
            let mut weights = vec![1.0; SKY];
            weights[SKY / 4] = f64::from(1 << 24);
            let cdf = cumulative(&weights, |sum| if faulty { f64::from(sum as f32) } else { sum });
            by_weight(weights, move |u| find(&cdf, u))
        })
        .mistake(
            "running sums in f32: behind a sun of 2²⁴ times the sky nothing adds up any more, and is never sampled",
        ),
    ]
}

/// Texels of the sky behind whose sun f32 sums end.
const SKY: usize = 1 << 17;
