//! The test that most renderers have, for comparison: Pearson's χ² of 10⁵ samples in 10 × 20 fixed cells, against N ∫ p by quadrature.

use etalon_core::error::Result;
use etalon_stats::bsdf::{Bsdf, BsdfSample, Direction};
use etalon_stats::stream::CounterRng;
use etalon_stats::{Density, Directions, Domain, Extremes, Pole, Sample, Sampler, density, sampler};
use rand::RngExt;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SAMPLES: usize = 100_000;
const CELLS: [usize; 2] = [10, 20];
/// Nodes of the midpoint rule along each side of a cell.
const NODES: usize = 16;
/// Cells in which fewer samples are expected are put together.
const FEWEST: f64 = 5.0;

/// p of that test; `None` for a density with atoms. Samples outside of the domain are in no cell, and neither are those that are no numbers.
pub fn p_value(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density, seed: u64) -> Result<Option<f64>> {
    if !density.atoms().is_empty() {
        return Ok(None);
    }
    let [rows, columns] = match domain.outcomes() {
        Some(outcomes) => [outcomes, 1],
        None if domain.is_plane() => CELLS,
        None => [CELLS[0] * CELLS[1], 1],
    };
    let mut rng = CounterRng::new(seed, 0);
    let mut samples = Vec::with_capacity(SAMPLES);
    match sampler.dimension() {
        0 => sampler.sample_seeded(SAMPLES, seed as u32, &mut samples)?,
        dimension => {
            let numbers: Vec<f64> = (0..dimension * SAMPLES).map(|_| rng.random()).collect();
            sampler.sample(&numbers, &mut samples)?;
        }
    }
    let mut observed = vec![0.0; rows * columns];
    for [x, y] in samples.into_iter().flatten().filter_map(|sample| domain.to_chart(sample.point)) {
        let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        observed[at(x, rows) * columns + at(y, columns)] += 1.0;
    }
    // N ∫ p of each cell
    let expected = (0..rows * columns).map(|cell| -> Result<f64> {
        let node = |i: usize, k: usize, n: usize| (i as f64 + (k as f64 + 0.5) / NODES as f64) / n as f64;
        let [row, column] = [cell / columns, cell % columns];
        let charts: Vec<[f64; 2]> =
            (0..NODES * NODES).map(|k| [node(row, k / NODES, rows), node(column, k % NODES, columns)]).collect();
        let mut pdfs = Vec::with_capacity(charts.len());
        density.pdf(&domain.points_at(&charts)?, &mut pdfs)?;
        domain.per_chart_area(&charts, &mut pdfs)?;
        Ok(SAMPLES as f64 * pdfs.iter().sum::<f64>() / (charts.len() * observed.len()) as f64)
    });
    Ok(Some(pearson(&observed, &expected.collect::<Result<Vec<f64>>>()?)))
}

/// The least p over these `wo`.
pub fn p_value_of_bsdf(bsdf: &dyn Bsdf, wos: &[Direction], seed: u64) -> Result<Option<f64>> {
    let domain = Directions { pole: Pole::Z, half: !bsdf.properties().transmission };
    let mut least = None;
    for &wo in wos {
        let draw = |u: &[f64]| bsdf.sample(wo, u).filter(|s: &BsdfSample| !s.is_delta()).map(|s| Sample::new(s.wi));
        let pdf = density(|wi: Direction| bsdf.pdf(wo, wi));
        let p = p_value(&domain, &sampler(3, draw), &pdf, seed)?;
        least = p.map(|p| least.map_or(p, |least: f64| p.at_most(least)));
    }
    Ok(least)
}

/// p of Σ (O − E)²/E, with the cells of few expected samples as one.
fn pearson(observed: &[f64], expected: &[f64]) -> f64 {
    let (few, mut groups): (Vec<_>, Vec<_>) =
        observed.iter().zip(expected).map(|(o, e)| (*o, *e)).partition(|(_, e)| *e < FEWEST);
    groups.extend(few.into_iter().reduce(|(o, e), (p, f)| (o + p, e + f)).filter(|group| *group != (0.0, 0.0)));
    let statistic: f64 = groups.iter().map(|(o, e)| (o - e).powi(2) / e).sum();
    let distribution = ChiSquared::new(groups.len().saturating_sub(1) as f64);
    distribution.map_or(f64::NAN, |of| if statistic.is_finite() { of.sf(statistic) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_stats::Line;

    #[test]
    fn it_tells_a_square_from_a_root() {
        let p = |power: f64| {
            let draw = move |u: &[f64]| Some(Sample::new(u[0].powf(power)));
            p_value(&Line::UNIT, &sampler(1, draw), &density(|x: f64| 2.0 * x), 1).unwrap().unwrap()
        };
        assert!(p(0.5) > 1e-3 && p(2.0) < 1e-9, "{} {}", p(0.5), p(2.0));
        assert_eq!(pearson(&[10.0, 3.0], &[10.0, 0.0]), 0.0);
    }
}
