//! The first report's environment map: its weights of rows, its directions, its random numbers.
//!
//! With a map of 32×16 the errors are percents; with 1024×512 they would be in the fourth digit. The image is a floor under
//! a uniform sky.

use super::{Erratum, ErratumCurves, Nature, Suspect};
use crate::proposal::SIGMA;
use crate::validation::{Case, direction_density, direction_sampler};
use etalon_core::envmap::samplers::{ErrataSampler, SurfaceSampler, TexelSampler};
use etalon_core::envmap::{EnvMap, LatLong};
use etalon_core::errata::images::{PLACE_IN_TEXEL, row_weight, row_without_sums};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::sampling::table::{Table1, Table2};
use etalon_stats::{Density, Directions, Discrete, Pole, Sample, density, sampler};
use glam::DVec3;
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::PI;
use std::sync::Arc;

const WIDTH: usize = 32;
const HEIGHT: usize = 16;

fn uniform_sky() -> Arc<EnvMap> {
    Arc::new(EnvMap::new(Image::from_fn(WIDTH, HEIGHT, |_, _| Rgb::ONE)))
}

/// cos θ at the edge of a row.
fn edge(y: usize) -> f64 {
    (PI * y as f64 / HEIGHT as f64).cos()
}

/// The share of a floor's light that comes from a row above it.
fn of_floor(y: usize) -> f64 {
    if 2 * y < HEIGHT { edge(y).powi(2) - edge(y + 1).powi(2) } else { 0.0 }
}

/// `pdf` of directions, constant over texels.
fn by_texel(pdf: impl Fn(DVec3) -> f64 + Sync) -> impl Density {
    direction_density(pdf).with_steps(LatLong::new(WIDTH, HEIGHT).edges())
}

/// The test of directions under a uniform sky by a table of rows, uniformly inside their texels.
fn by_rows(name: &str, weight: fn(&LatLong, usize) -> f64) -> Case {
    Case::of(format!("audit/{name}"), Directions::sphere(Pole::Y), move || {
        let map = uniform_sky();
        let g = map.geometry().clone();
        let table = Table2::new(WIDTH, HEIGHT, |_, y| weight(&g, y));
        let draw = move |u: [f64; 2]| {
            let draw = table.sample(u)?;
            Some(g.direction_in_texel(draw.x.cell, draw.y.cell, draw.x.offset, draw.y.offset))
        };
        let right = TexelSampler::new(map);
        (direction_sampler(draw), by_texel(move |w| right.pdf_for(w, DVec3::Y)))
    })
}

/// Shares of the samples by row, as steps.
fn shares_of_rows(printed: impl Fn(usize) -> f64, right: impl Fn(usize) -> f64) -> ErratumCurves {
    let steps = |share: &dyn Fn(usize) -> f64| {
        (0..HEIGHT).flat_map(|y| [[y as f64, share(y)], [(y + 1) as f64, share(y)]]).collect()
    };
    ErratumCurves {
        x: "row",
        every: 4.0,
        y: "share of the samples",
        printed: steps(&printed),
        right: steps(&right),
        scattered: false,
    }
}

/// The share of uniform directions in a row.
fn right_share(y: usize) -> f64 {
    0.5 * (edge(y) - edge(y + 1))
}

pub fn pole_rows() -> Suspect {
    let total: f64 = (0..HEIGHT).map(|y| row_weight(y, HEIGHT)).sum();
    let erratum = Erratum {
        title: "weights of rows at the poles",
        report: "first report",
        printed: "row h weighs sin(hπ/(H − 1)), for the samples and again for the cuts",
        right: "row h weighs cos θₕ − cos θₕ₊₁",
        test: "chi-square of the directions, uniform sky of 32×16",
        error_in_picture: -of_floor(0),
        error_of: "light on a floor, 16 rows",
        curves: Some(shares_of_rows(|y| row_weight(y, HEIGHT) / total, right_share)),
        ..Erratum::default()
    };
    let printed = by_rows("pole-rows/printed", |_, y| row_weight(y, HEIGHT));
    (erratum, [printed, by_rows("pole-rows/right", LatLong::solid_angle)])
}

pub fn corners() -> Suspect {
    // The mean of the report's estimator: Σ L cos θ/p over the corners, each sampled with its probability.
    let corners: f64 = (0..HEIGHT / 2).map(|y| row_weight(y, HEIGHT) * edge(y)).sum::<f64>() * 2.0 * PI / HEIGHT as f64;
    let printed = Case::of("audit/corners/printed", Directions::sphere(Pole::Y), || {
        let draw = ErrataSampler::new(uniform_sky());
        let claim = TexelSampler::new(uniform_sky());
        (
            direction_sampler(move |u| draw.sample_for(u, DVec3::Y).map(|sample| sample.wi)),
            by_texel(move |w| claim.pdf_for(w, DVec3::Y)),
        )
    });
    // Four by four texels.
    let shown = |offset: fn(u32) -> [f64; 2]| -> Vec<[f64; 2]> {
        let at = |i: u32| {
            let [dx, dy] = offset(i);
            [f64::from(i % 4) + dx, f64::from(i / 4 % 4) + 4.0 + dy]
        };
        (0..160).map(at).collect()
    };
    let erratum = Erratum {
        title: "samples at corners of texels alone",
        report: "first report (its course)",
        printed: "the direction of the sampled texel's corner",
        right: "a direction anywhere in the texel, uniformly by solid angle",
        test: "chi-square of the directions, and distinct points among them",
        error_in_picture: corners - 1.0,
        error_of: "light on a floor, 16 rows",
        curves: Some(ErratumCurves {
            x: "column",
            every: 1.0,
            y: "row",
            printed: shown(|_| PLACE_IN_TEXEL),
            right: shown(|i| Independent::new(1, 0, i).pair(0)),
            scattered: true,
        }),
        ..Erratum::default()
    };
    (erratum, [printed, by_rows("corners/right", LatLong::solid_angle)])
}

pub fn gaussian_numbers() -> Result<Suspect> {
    let normal = Normal::new(0.5, SIGMA).map_err(|e| Error::parameter("SIGMA", e.to_string()))?;
    let (low, high) = (normal.cdf(0.0), normal.cdf(1.0));
    let share = move |from: f64, to: f64| (normal.cdf(to) - normal.cdf(from)) / (high - low);
    let rows: Vec<f64> = (0..HEIGHT).map(right_share).collect();
    let test = |name: &str, gaussian: bool| {
        let rows = rows.clone();
        Case::of(format!("audit/numbers/{name}"), Discrete { outcomes: HEIGHT }, move || {
            let (table, claim) = (Table1::new(&rows), Table1::new(&rows));
            let draw = move |u: &[f64]| {
                let u = if gaussian {
                    normal.inverse_cdf(low + u[0] * (high - low)).clamp(0.0, 1f64.next_down())
                } else {
                    u[0]
                };
                Some(Sample::new(table.sample(u)?.cell))
            };
            (sampler(1, draw), density(move |row: usize| claim.probability(row)))
        })
    };
    // Shares of rows under Gaussian random numbers, and the light on the floor by them.
    let ends: Vec<f64> = (0..=HEIGHT).map(|y| rows[..y].iter().sum()).collect();
    let gaussian: Vec<f64> = (0..HEIGHT).map(|y| share(ends[y], ends[y + 1])).collect();
    let floor: f64 = (0..HEIGHT).map(|y| of_floor(y) * gaussian[y] / rows[y]).sum();
    let erratum = Erratum {
        title: "inversion of Gaussian random numbers",
        report: "first report",
        printed: "rows sampled by inversion of Gaussian random numbers",
        right: "rows sampled by inversion of uniform random numbers",
        test: "chi-square of the sampled rows, uniform sky of 16 rows",
        error_in_picture: floor - 1.0,
        error_of: "light on a floor",
        curves: Some(shares_of_rows(|y| gaussian[y], |y| rows[y])),
        ..Erratum::default()
    };
    Ok((erratum, [test("printed", true), test("right", false)]))
}

/// The first report's text divides the sums of the rows by their total and calls the result a CDF, without summing it up.
pub fn rows_without_sums() -> Suspect {
    let rows: Vec<f64> = (0..HEIGHT).map(right_share).collect();
    let test = |name: &str, select: fn(&[f64], f64) -> Option<usize>| {
        let rows = rows.clone();
        Case::of(format!("audit/sums/{name}"), Discrete { outcomes: HEIGHT }, move || {
            let (rows, claim) = (rows.clone(), Table1::new(&rows));
            let draw = move |u: &[f64]| select(&rows, u[0]).map(Sample::new);
            (sampler(1, draw), density(move |row: usize| claim.probability(row)))
        })
    };
    let by_sums = |rows: &[f64], u: f64| Table1::new(rows).sample(u).map(|draw| draw.cell);
    // A row is selected by numbers above those of all rows before.
    let above = |y: usize| (rows[y] - rows[..y].iter().copied().fold(0.0, f64::max)).max(0.0);
    let floor: f64 = (0..HEIGHT).map(|y| of_floor(y) * above(y) / rows[y]).sum();
    let erratum = Erratum {
        title: "CDF without sums",
        report: "first report",
        nature: Nature::Misprint,
        printed: "1D CDF: the sum of each row over the total; the first row whose entry is at least u",
        right: "1D CDF: the sums of all rows up to each, over the total; the first row whose entry is at least u",
        test: "chi-square of the sampled rows, uniform sky of 16 rows",
        error_in_picture: floor - 1.0,
        error_of: "light on a floor",
        ..Erratum::default()
    };
    (erratum, [test("printed", row_without_sums), test("right", by_sums)])
}
