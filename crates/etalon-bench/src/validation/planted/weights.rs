//! Weights of resampling that do not estimate 1/pdf: mistakes of reservoirs. Nobody knows the pdf of such samples.

use super::fault::PlantedFault;
use etalon_stats::{Line, Sample, Sampler, sampler, target};

/// What candidates are chosen by.
fn importance(x: f64) -> f64 {
    0.1 + x * x
}

/// A reservoir of two candidates between `ends[0]`, merged with one of six between `ends[1]`. The weight is Σ w over the importance of the
/// sample and `count`, the number of candidates that could have been it, from where it is.
fn merged(ends: [[f64; 2]; 2], count: impl Fn(f64) -> f64 + Sync) -> impl Sampler {
    sampler(16, move |u| {
        let (mut chosen, mut sum) = (0.0, 0.0);
        for (i, u) in u.chunks_exact(2).enumerate() {
            let [from, to] = ends[usize::from(i >= 2)];
            let x = from + (to - from) * u[0];
            let weight = importance(x) * (to - from);
            sum += weight;
            if u[1] * sum < weight {
                chosen = x;
            }
        }
        Some(Sample::with_weight(chosen, sum / (count(chosen) * importance(chosen))))
    })
}

pub fn weights() -> Vec<PlantedFault> {
    vec![
        PlantedFault::of("warp/weights/merged-without-counts", Line::UNIT, |faulty| {
            let count = if faulty { 3.0 } else { 8.0 };
            (merged([[0.0, 1.0]; 2], move |_| count), target(|_: f64| 1.0))
        })
        .mistake("a merged reservoir counts as one candidate (pbrt-v4, before commit e273b3d8)"),
        PlantedFault::of("warp/weights/normalized-by-all", Line::UNIT, |faulty| {
            let count = move |x: f64| match x {
                _ if faulty => 8.0,
                ..0.25 => 2.0,
                0.75.. => 6.0,
                _ => 8.0,
            };
            (merged([[0.0, 0.75], [0.25, 1.0]], count), target(|_: f64| 1.0))
        })
        .mistake("all candidates count, though some could not have been the sample (as in RTXDI, pull request 42)"),
        PlantedFault::of("warp/weights/importance-of-another", Line::UNIT, |faulty| {
            let moved = if faulty { 1.02 } else { 1.0 };
            let count = move |x: f64| 8.0 * importance(moved * x) / importance(x);
            (merged([[0.0, 1.0]; 2], count), target(|_: f64| 1.0))
        })
        .mistake("the importance of the sample is that of another pixel or surface"),
    ]
}
