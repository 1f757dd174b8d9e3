//! The density of samples by the derivatives of the sampler's map from random numbers to points: exact where the map is one to one.

use super::{BATCH, EQUAL, FEWEST_PAIRS, Pair, asked};
use crate::derivative::{Derivative, STEPS, derivative, moved, on_raster};
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};
use crate::sampler::{Density, Sample, Sampler};
use crate::stream::CounterRng;
use rand::RngExt;

/// Samples at which derivatives are taken, and most random numbers of each.
pub const SAMPLES: usize = 256;
const MOST_NUMBERS: usize = 8;
/// Rows and columns of the cells whose counts must agree with the density.
const SHAPE: [usize; 2] = [12, 8];
/// By at most this factor samples are denser than the map says, at this share of the points: two places of the random numbers that lead to
/// one point would make it 2.
const DENSER: f64 = 1.8;
const MOST_POINTS: f64 = 0.9;
/// Quantiles of the factor that must be near to a whole number, if that is more than 1, and how near.
const QUANTILES: [f64; 2] = [0.2, 0.8];
const TOLERANCE: f64 = 0.25;

/// Points of samples, each with the density of samples there and the pdf, if samples are a function of as many of their random numbers as the
/// domain has dimensions, and of none of the others. Where several of these lead to one point, by a symmetry, the density is as many times as
/// high: as far as the counts of `charts` tell, the samples of other `draws`.
///
/// # Errors
/// Those of the sampler, the density and a chart that is computed in another process.
pub fn of(
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    density: &dyn Density,
    charts: &[[f64; 2]],
    draws: u64,
    seed: u64,
) -> Result<Option<Vec<Pair>>> {
    let numbers = sampler.dimension();
    if !(1..=MOST_NUMBERS).contains(&numbers) || sampler.finite_len().is_some() || domain.outcomes().is_some() {
        return Ok(None);
    }
    let mut rng = CounterRng::new(seed, STREAM);
    let u: Vec<f64> = (0..SAMPLES * numbers).map(|_| on_raster(rng.random())).collect();
    let all: Vec<f64> = u
        .chunks_exact(numbers)
        .flat_map(|u| u.iter().copied().chain((0..numbers).flat_map(|axis| moved(u, axis))).collect::<Vec<f64>>())
        .collect();
    let mut samples = Vec::with_capacity(all.len() / numbers);
    all.chunks(BATCH * numbers).try_for_each(|batch| sampler.sample(batch, &mut samples))?;
    if samples.iter().flatten().any(|sample| sample.atom) {
        return Ok(None);
    }
    let points: Vec<Point> = samples.iter().flatten().map(|sample| sample.point).collect();
    let mut found = domain.charts(&points)?.into_iter();
    let at = |sample: &Option<Sample>| sample.and_then(|_| found.next()).filter(|at| !at[0].is_nan());
    let charts_of: Vec<Option<[f64; 2]>> = samples.iter().map(at).collect();
    // The random numbers that change where samples lie
    let is_used = |axis: &usize| {
        let changes = |charts: &[Option<[f64; 2]>]| {
            let moved = &charts[1 + axis * 2 * STEPS..][..2 * STEPS];
            moved.iter().any(|chart| *chart != charts[0])
        };
        charts_of.chunks_exact(1 + numbers * 2 * STEPS).any(changes)
    };
    let used: Vec<usize> = (0..numbers).filter(is_used).collect();
    if used.len() != 1 + usize::from(domain.is_plane()) {
        return Ok(None);
    }
    let (mut places, mut areas) = (Vec::new(), Vec::new());
    for (charts, u) in charts_of.chunks_exact(1 + numbers * 2 * STEPS).zip(u.chunks_exact(numbers)) {
        let of = |axis: &usize| derivative(u[*axis], &charts[1 + axis * 2 * STEPS..][..2 * STEPS], f64::EPSILON);
        let derivatives: Option<Vec<Derivative<2>>> = used.iter().map(of).collect();
        let (Some(at), Some(derivatives)) = (charts[0], derivatives) else { continue };
        if let Some(area) = area(&derivatives) {
            places.push(at);
            areas.push(area);
        }
    }
    if places.len() < FEWEST_PAIRS {
        return Ok(None);
    }
    let Some(times) = multiplicity(domain, charts, draws, &places, &areas) else { return Ok(None) };
    let points = domain.points_at(&places)?;
    domain.per_chart_area(&places, &mut areas)?;
    let pdfs = asked(density, &points)?;
    Ok(Some(points.into_iter().zip(areas.into_iter().zip(pdfs).map(|(area, pdf)| [times / area, pdf])).collect()))
}

/// Which of one or two random numbers changes none of [`SAMPLES`], as where another is used in its place.
///
/// # Errors
/// As [`of`].
pub fn unused(sampler: &dyn Sampler, seed: u64) -> Result<Option<usize>> {
    let numbers = sampler.dimension();
    if !(1..=2).contains(&numbers) || sampler.finite_len().is_some() {
        return Ok(None);
    }
    let mut rng = CounterRng::new(seed, STREAM);
    let [u, others] = [0; 2].map(|_| (0..SAMPLES * numbers).map(|_| rng.random()).collect::<Vec<f64>>());
    let sampled = |u: &[f64]| {
        let mut samples = Vec::new();
        sampler.sample(u, &mut samples).map(|()| samples)
    };
    let here = sampled(&u)?;
    for axis in 0..numbers {
        let changed: Vec<f64> = (0..u.len()).map(|i| if i % numbers == axis { others[i] } else { u[i] }).collect();
        if sampled(&changed)? == here {
            return Ok(Some(axis));
        }
    }
    Ok(None)
}

/// The stream of the random numbers, apart from those of tests.
const STREAM: u64 = u64::MAX;

/// The area of the chart per area of random numbers, if it is precise.
fn area(derivatives: &[Derivative<2>]) -> Option<f64> {
    let (area, error) = match derivatives {
        [a] => (a.value[0].abs(), a.error),
        [a, b] => {
            let length = |a: &Derivative<2>| a.value[0].hypot(a.value[1]);
            let area = (a.value[0] * b.value[1] - a.value[1] * b.value[0]).abs();
            (area, a.error * length(b) + b.error * length(a))
        }
        _ => return None,
    };
    (error <= 0.1 * EQUAL * area).then_some(area)
}

/// How many places of the random numbers lead to one point, by how much denser samples are near most of `places` than the areas tell;
/// nothing where that is no whole number.
fn multiplicity(
    domain: &dyn Domain,
    charts: &[[f64; 2]],
    draws: u64,
    places: &[[f64; 2]],
    areas: &[f64],
) -> Option<f64> {
    let [rows, columns] = SHAPE;
    let shape = if domain.is_plane() { SHAPE } else { [rows * columns, 1] };
    let grid = Grid::adapted(charts, shape, Cell::WHOLE, None);
    let mut counts = vec![0u64; grid.len()];
    charts.iter().for_each(|&at| counts[grid.find(at)] += 1);
    let sizes: Vec<f64> = grid.cells().map(|cell| cell.area()).collect();
    let denser = |(&at, area): (&[f64; 2], &f64)| {
        let cell = grid.find(at);
        area * counts[cell] as f64 / (sizes[cell] * draws as f64)
    };
    let mut ratios: Vec<f64> = places.iter().zip(areas).map(denser).collect();
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[(share * ratios.len() as f64) as usize];
    let times = at(0.5).round().at_least(1.0);
    let is_whole = times == 1.0 || QUANTILES.iter().all(|share| (at(*share) - times).abs() <= TOLERANCE * times);
    (is_whole && at(MOST_POINTS) <= DENSER * times).then_some(times)
}

#[cfg(test)]
mod tests {
    use crate::{
        Directions, Domain, Line, Pole, Protocol, Sample, Sampler, Square, Verdict, density, sampler, validate,
    };
    use std::f64::consts::PI;

    fn told(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn crate::Density) -> String {
        let outcome = validate(domain, sampler, density, &Protocol::default()).unwrap();
        assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
        outcome.to_string()
    }

    #[test]
    fn a_branch_that_is_wrong_is_named_with_its_place() {
        // Two halves of a tent, of which the second is not sampled by what is left of the random number
        let tent = density(|x: f64| if x < 0.5 { 4.0 * x } else { 4.0 * (1.0 - x) });
        let draw = |u: f64| if u < 0.5 { (0.5 * u).sqrt() } else { 0.5 + 0.5 * u };
        let text = told(&Line::UNIT, &sampler(1, move |u| Some(Sample::new(draw(u[0])))), &tent);
        let [known, other] =
            ["the density of samples is the pdf up to about x = 0.49", ", and another function beyond"];
        assert!(text.contains(known) && text.contains(other), "{text}");
        // A random number that is not used changes nothing; one that chooses makes several maps
        let unused = told(&Line::UNIT, &sampler(2, move |u| Some(Sample::new(draw(u[1])))), &tent);
        assert!(unused.contains(known), "{unused}");
        let two = sampler(2, move |u| Some(Sample::new(if u[0] < 0.3 { draw(u[1]) } else { u[1] })));
        let text = told(&Line::UNIT, &two, &tent);
        assert!(!text.contains("the density of samples"), "{text}");
    }

    #[test]
    fn factors_are_exact_and_points_may_be_met_twice() {
        let square = density(|[x, y]: [f64; 2]| 4.0 * x * y);
        let power = sampler(2, |u| Some(Sample::new([u[0].powf(0.2), u[1].powf(0.2)])));
        let text = told(&Square, &power, &square);
        assert!(text.contains("samples follow 6.25 times the pdf times (x)^3, times (y)^3, not the pdf"), "{text}");
        // Half of the turn, twice
        let half = sampler(2, |u| {
            let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
            let x = r * phi.cos();
            Some(Sample::new([x.abs(), r * phi.sin(), (1.0 - r * r).sqrt()]))
        });
        let text = told(&Directions::hemisphere(Pole::Z), &half, &density(|w: [f64; 3]| w[2] / PI));
        assert!(text.contains("the pdf is 0.5 = 1/2 times as large as samples say"), "{text}");
    }

    #[test]
    fn a_random_number_that_changes_nothing_is_told() {
        let normal = density(|x: f64| (-0.5 * x * x).exp() / (2.0 * PI).sqrt());
        let once = sampler(2, |u| Some(Sample::new((-2.0 * (1.0 - u[0]).ln()).sqrt() * (2.0 * PI * u[0]).cos())));
        let text = told(&crate::RealLine::UNIT, &once, &normal);
        assert!(text.contains("none of 256 samples changed with the random number u1"), "{text}");
        // The same samples for u and 1 - u
        let symmetric = sampler(1, |u| Some(Sample::new((2.0 * u[0] - 1.0).powi(2))));
        let text = told(&Line::UNIT, &symmetric, &density(|x: f64| 2.0 - 2.0 * x));
        assert!(!text.contains("changed with the random number"), "{text}");
    }

    #[test]
    fn draws_without_a_sample_make_no_factor() {
        // Half of the draws are no sample, as the pdf has it; the density is 3/2 √x too high
        let drawn = sampler(2, |u| (u[1] < 0.5).then(|| Sample::new(u[0].powf(2.0 / 3.0))));
        let half = density(|_: f64| 0.5).with_mass(crate::Mass::Exactly(0.5));
        let text = told(&Line::UNIT, &drawn, &half);
        assert!(!text.contains("follow 3 times"), "{text}");
    }
}
