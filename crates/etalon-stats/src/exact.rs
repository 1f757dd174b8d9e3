//! Deterministic checks: what must hold for every sample and every value of the pdf.

use crate::cubature::Probe;
use crate::density::Density;
use crate::domain::Domain;
use crate::error::Result;
use crate::sampler::{Sample, Sampler};
use crate::text::tuple;
use std::fmt::Debug;

/// What is wrong with a sample and `pdf`, the density's value at its point: a value that no pdf can have, or a sample that
/// carries another one.
pub fn pdf_violation<P: Debug>(sample: &Sample<P>, pdf: f64) -> Option<String> {
    if !(pdf.is_finite() && pdf >= 0.0) {
        return Some(format!("the pdf at the sample {} is {pdf}", tuple(&sample.point)));
    }
    let claimed = sample.pdf?;
    (claimed.to_bits() != pdf.to_bits()).then(|| {
        format!("the sample {} carries the pdf {claimed:e}, but the density says {pdf:e}", tuple(&sample.point))
    })
}

/// What is wrong with a sample that has no chart coordinates.
pub fn outside<P: Debug>(sample: &Sample<P>) -> String {
    format!("the sample {} is outside of the domain", tuple(&sample.point))
}

/// Tests the sampler with random numbers at the edges of \[0, 1), which a generator hardly ever returns.
pub fn corners<D: Domain>(
    domain: &D,
    sampler: &dyn Sampler<D::Point>,
    density: &dyn Density<D::Point>,
) -> Result<Option<String>> {
    const EDGES: [f64; 4] = [0.0, 0.5, 1.0 / (1u64 << 53) as f64, 1.0 - 1.0 / (1u64 << 53) as f64];
    let dimension = sampler.dimension();
    if dimension == 0 {
        return Ok(None);
    }
    // All corners of the cube in few dimensions; in many, those where all but one random number are ½.
    let corner = |i: usize| -> Vec<f64> {
        if dimension <= 4 {
            (0..dimension).map(|d| EDGES[i >> (2 * d) & 3]).collect()
        } else {
            (0..dimension).map(|d| if i / 4 == d { EDGES[i % 4] } else { 0.5 }).collect()
        }
    };
    let count = if dimension <= 4 { 1 << (2 * dimension) } else { 4 * dimension };
    let numbers: Vec<Vec<f64>> = (0..count).map(corner).collect();
    let mut samples = Vec::with_capacity(count);
    sampler.sample(&numbers.concat(), &mut samples)?;
    let some: Vec<(&Vec<f64>, Sample<D::Point>)> =
        numbers.iter().zip(samples).filter_map(|(u, sample)| Some((u, sample?))).collect();
    let points: Vec<D::Point> = some.iter().map(|(_, sample)| sample.point).collect();
    let mut pdfs = Vec::with_capacity(points.len());
    density.pdf(&points, &mut pdfs)?;
    Ok(some.iter().zip(pdfs).find_map(|((u, sample), pdf)| {
        let violation = match domain.to_chart(sample.point) {
            None => Some(outside(sample)),
            Some(_) if sample.atom => None,
            Some(_) => pdf_violation(sample, pdf),
        };
        violation.map(|violation| format!("{violation} (sampled from u = {})", tuple(u)))
    }))
}

/// Tests whether the density returns the same values when asked again at the points of some probes.
pub fn repeatable<D: Domain>(domain: &D, density: &dyn Density<D::Point>, probes: &[Probe]) -> Result<Option<String>> {
    const POINTS: usize = 64;
    let points: Vec<D::Point> = probes.iter().take(POINTS).map(|probe| domain.point_at(probe.at)).collect();
    let ask = || -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(points.len());
        density.pdf(&points, &mut values).map(|()| values)
    };
    let (first, second) = (ask()?, ask()?);
    let differ = |a: f64, b: f64| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan());
    let found = points.iter().zip(first.iter().zip(&second)).find(|(_, (a, b))| differ(**a, **b));
    Ok(found.map(|(point, (a, b))| {
        format!("the pdf at {} is not the same when asked again: {a:e}, then {b:e}", tuple(point))
    }))
}

/// Finds a sampler of a continuous domain that returns the same few points again and again.
///
/// One distinct point in four samples is enough: coordinates of 13 bits, or of four digits, still count as continuous.
pub fn discrete<D: Domain>(domain: &D, probes: &[Probe]) -> Option<String> {
    if domain.outcomes().is_some() || probes.len() < 1000 {
        return None;
    }
    let mut points: Vec<[u64; 2]> = probes.iter().map(|probe| probe.at.map(f64::to_bits)).collect();
    points.sort_unstable();
    points.dedup();
    let (points, samples) = (points.len(), probes.len());
    (4 * points < samples)
        .then(|| format!("this sampler is discrete: only {points} distinct points in {samples} samples"))
}
