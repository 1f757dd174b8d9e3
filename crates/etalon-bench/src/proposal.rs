//! Inversion with uniform and with Gaussian random numbers: rows of a map, as the first report samples them.
//!
//! What a proposal distribution costs: rows and columns of a map sampled by several distributions, each sample weighted by
//! 1/probability.
//!
//! A texel t with the integral f over it is sampled with probability q and estimates F = Σ f by f/q. The variance of that
//! is Σ f²/q − F², summed here over all texels: nothing is sampled. f is ∫ L dω (the map's flux) or ∫ L max(0, cos θ) dω (the
//! irradiance of a floor), with L = (R + G + B)/3.

use etalon_core::envmap::EnvMap;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::sampling::stream::{CounterRng, Independent, Stream};
use etalon_core::sampling::table::{Table1, Table2};
use etalon_stats::power::{ChiSquare, chi_square};
use rand::RngExt;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

/// One bin of rows. Field names are the CSV columns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RowBin {
    /// Where the bin begins, from the zenith.
    pub theta_from_deg: f64,
    /// Where the bin ends.
    pub theta_to_deg: f64,
    /// Share of the map's energy in these rows.
    pub target: f64,
    /// Shares of the samples.
    pub uniform: f64,
    /// With Gaussian random numbers.
    pub gaussian: f64,
}

/// Both histograms and their tests against the target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proposal {
    /// Samples of each kind.
    pub draws: usize,
    /// With uniform random numbers.
    pub uniform: ChiSquare,
    /// With Gaussian random numbers.
    pub gaussian: ChiSquare,
    /// The histograms.
    #[serde(skip)]
    pub bins: Vec<RowBin>,
}

/// Standard deviation of the Gaussian random numbers around ½; those outside \[0, 1) are rejected.
pub const SIGMA: f64 = 1.0 / 6.0;

/// Samples between two checks for an interruption.
const POLL: usize = 1 << 16;

/// Samples rows of `map` by inversion of its row CDF, `draws` times with each kind of random number.
///
/// `None` when the map has light in too few rows for a chi-square test.
///
/// # Errors
/// [`Error::Parameter`] for fewer than 1000 or more than 2²⁸ samples; [`Error::Interrupted`].
pub fn compare(map: &EnvMap, draws: usize, seed: u64) -> Result<Option<Proposal>> {
    if !(1000..=1 << 28).contains(&draws) {
        return Err(Error::parameter("draws", format!("{draws} draws")).with_hint("use 1000 to 2^28 draws"));
    }
    let g = map.geometry();
    let energies: Vec<f64> =
        (0..g.height()).map(|y| (0..g.width()).map(|x| map.mean_rgb(x, y)).sum::<f64>() * g.solid_angle(y)).collect();
    let table = Table1::new(&energies);
    let count = |random: &mut dyn FnMut() -> f64| -> Result<Vec<u64>> {
        let mut counts = vec![0; energies.len()];
        for i in 0..draws {
            if i % POLL == 0 {
                interrupt::check()?;
            }
            if let Some(draw) = table.sample(random()) {
                counts[draw.cell] += 1;
            }
        }
        Ok(counts)
    };
    let mut rng = CounterRng::new(seed, 0);
    let uniform = count(&mut || rng.random::<f64>())?;
    let normal = Normal::new(0.5, SIGMA).map_err(|e| Error::parameter("SIGMA", e.to_string()))?;
    let mut rng = CounterRng::new(seed, 1);
    let gaussian = count(&mut || {
        loop {
            let z = normal.inverse_cdf(rng.random::<f64>());
            if (0.0..1.0).contains(&z) {
                return z;
            }
        }
    })?;
    // Chi-square tests of single rows against their share of the energy.
    let expected: Vec<f64> = (0..energies.len()).map(|y| table.probability(y) * draws as f64).collect();
    let tests = chi_square(&uniform, &expected).zip(chi_square(&gaussian, &expected));
    Ok(tests.map(|(uniform_test, gaussian_test)| Proposal {
        draws,
        uniform: uniform_test,
        gaussian: gaussian_test,
        bins: bins(&energies, &uniform, &gaussian, draws),
    }))
}

/// Rows merged into at most 64 bins for the drawing; the tests use single rows.
fn bins(energies: &[f64], uniform: &[u64], gaussian: &[u64], draws: usize) -> Vec<RowBin> {
    let height = energies.len();
    let total: f64 = energies.iter().sum();
    let per_bin = height.div_ceil(64);
    (0..height)
        .step_by(per_bin)
        .map(|y0| {
            let rows = y0..(y0 + per_bin).min(height);
            let share = |counts: &[u64]| counts[rows.clone()].iter().sum::<u64>() as f64 / draws as f64;
            RowBin {
                theta_from_deg: 180.0 * rows.start as f64 / height as f64,
                theta_to_deg: 180.0 * rows.end as f64 / height as f64,
                target: energies[rows.clone()].iter().sum::<f64>() / total,
                uniform: share(uniform),
                gaussian: share(gaussian),
            }
        })
        .collect()
}

/// A distribution of rows and of columns. Places along either axis count from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Rows by their energy, and columns by that of the texels of the row.
    Map,
    /// Rows by their solid angle, columns uniformly: directions uniform over the sphere.
    Sphere,
    /// The same probability for all.
    Uniform,
    /// A Gaussian about the middle whose standard deviation is one over this, cut to the axis.
    Gaussian(u32),
}

/// All that are compared.
pub const SHAPES: [Shape; 7] = [
    Shape::Map,
    Shape::Sphere,
    Shape::Uniform,
    Shape::Gaussian(2),
    Shape::Gaussian(4),
    Shape::Gaussian(6),
    Shape::Gaussian(8),
];

impl Shape {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Map => "by the map".into(),
            Self::Sphere => "uniform over the sphere".into(),
            Self::Uniform => "uniform".into(),
            Self::Gaussian(part) => format!("Gaussian, σ = 1/{part}"),
        }
    }

    /// The probability of each of `count` equal parts of an axis, where `of_map` and `of_sphere` are those by the map and by the
    /// solid angle.
    fn probabilities(self, of_map: &[f64], of_sphere: &[f64]) -> Vec<f64> {
        let count = of_map.len();
        let weights = match self {
            Self::Map => of_map.to_vec(),
            Self::Sphere => of_sphere.to_vec(),
            Self::Uniform => vec![1.0; count],
            Self::Gaussian(part) => {
                let normal = Normal::new(0.5, 1.0 / f64::from(part)).expect("a positive deviation");
                let edge = |i: usize| normal.cdf(i as f64 / count as f64);
                (0..count).map(|i| edge(i + 1) - edge(i)).collect()
            }
        };
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / sum).collect()
    }
}

/// What a proposal is used for; what it is not used for follows the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Along {
    /// Rows.
    #[default]
    Rows,
    Columns,
    /// Rows and columns.
    Both,
}

impl Along {
    /// All, in the order of the results.
    pub const ALL: [Self; 3] = [Self::Rows, Self::Columns, Self::Both];
}

/// The cost of one proposal. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Cost {
    /// The distribution.
    pub proposal: String,
    /// The axes that it samples.
    pub along: Along,
    /// Variance of one sample's estimate of a floor's irradiance, over the squared irradiance.
    pub irradiance_variance: f64,
    /// Variance of one sample's estimate of the map's flux, over the squared flux.
    pub flux_variance: f64,
}

/// The costs of all proposals under one map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Costs {
    /// For each proposal, in the order of [`Along::ALL`].
    pub costs: Vec<Cost>,
    /// The mean of `samples` samples by each proposal for both axes, minus the exact irradiance, in units of the exact standard
    /// error: the largest.
    pub largest_z: f64,
    /// The probabilities of the rows by each of [`SHAPES`].
    #[serde(skip)]
    pub rows: Vec<Vec<f64>>,
    /// The same of the columns, over all rows.
    #[serde(skip)]
    pub columns: Vec<Vec<f64>>,
}

/// A map's texels, as the estimators need them.
struct Texels<'a> {
    map: &'a EnvMap,
    /// Energy of each row, solid angle of its texels, and their ∫ max(0, cos θ) dω over their solid angle.
    rows: Vec<[f64; 3]>,
}

impl Texels<'_> {
    fn energy(&self, x: usize, y: usize) -> f64 {
        self.map.mean_rgb(x, y) * self.rows[y][1]
    }

    /// The probability of column `x` in row `y`; `columns` holds those of all rows, if they have the same.
    fn column(&self, columns: Option<&[f64]>, x: usize, y: usize) -> f64 {
        columns.map_or_else(|| self.energy(x, y) / self.rows[y][0], |columns| columns[x])
    }

    /// Σ f²/(q F²) − 1 with f the energy times the row's `factor`.
    fn variance(&self, rows: &[f64], columns: Option<&[f64]>, factor: impl Fn(usize) -> f64) -> f64 {
        let width = self.map.geometry().width();
        let (mut total, mut second) = (0.0, 0.0);
        for (y, [energy, ..]) in self.rows.iter().enumerate() {
            total += energy * factor(y);
            let lit = (0..width).filter(|&x| self.energy(x, y) > 0.0);
            let squares: f64 = lit.map(|x| self.energy(x, y).powi(2) / self.column(columns, x, y)).sum();
            // A row without light counts nothing, whatever its probability
            second += if squares > 0.0 { squares * factor(y).powi(2) / rows[y] } else { 0.0 };
        }
        // Rounding may leave less than nothing of a variance of 0.
        (second / (total * total) - 1.0).max(0.0)
    }
}

/// Computes the costs of all proposals under `map`, and checks them by `samples` samples of each.
///
/// `None` for a map without light above the horizon.
#[must_use]
pub fn costs(map: &EnvMap, samples: u32, seed: u64) -> Option<Costs> {
    let g = map.geometry();
    let row = |y: usize| {
        let light: f64 = (0..g.width()).map(|x| map.mean_rgb(x, y)).sum();
        [light * g.solid_angle(y), g.solid_angle(y), g.row_moment(y)[1].max(0.0) / g.solid_angle(y)]
    };
    let texels = Texels { map, rows: (0..g.height()).map(row).collect() };
    let irradiance: f64 = texels.rows.iter().map(|[energy, _, cosine]| energy * cosine).sum();
    if irradiance <= 0.0 {
        return None;
    }
    let row_energies: Vec<f64> = texels.rows.iter().map(|row| row[0]).collect();
    let solid_angles: Vec<f64> = texels.rows.iter().map(|row| row[1]).collect();
    let column_energies: Vec<f64> =
        (0..g.width()).map(|x| (0..g.height()).map(|y| texels.energy(x, y)).sum()).collect();
    let rows: Vec<_> = SHAPES.iter().map(|shape| shape.probabilities(&row_energies, &solid_angles)).collect();
    let alike = vec![1.0; g.width()];
    let columns: Vec<_> = SHAPES.iter().map(|shape| shape.probabilities(&column_energies, &alike)).collect();

    // Columns by the map depend on the row
    let of_rows = |shape: usize| (SHAPES[shape] != Shape::Map).then(|| &*columns[shape]);
    let mut costs = Vec::new();
    let mut largest_z: f64 = 0.0;
    for (i, shape) in SHAPES.iter().enumerate() {
        for along in Along::ALL {
            let (rows, columns) = match along {
                Along::Rows => (&rows[i], None),
                Along::Columns => (&rows[0], of_rows(i)),
                Along::Both => (&rows[i], of_rows(i)),
            };
            costs.push(Cost {
                proposal: shape.name(),
                along,
                irradiance_variance: texels.variance(rows, columns, |y| texels.rows[y][2]),
                flux_variance: texels.variance(rows, columns, |_| 1.0),
            });
        }
        // Samples of both axes
        let probability = |x: usize, y: usize| rows[i][y] * texels.column(of_rows(i), x, y);
        let table = Table2::new(g.width(), g.height(), |x, y| if rows[i][y] > 0.0 { probability(x, y) } else { 0.0 });
        let estimate = |sample: u32| {
            let draw = table.sample(Independent::new(seed, i as u64, sample).pair(0))?;
            let (x, y) = (draw.x.cell, draw.y.cell);
            Some(texels.energy(x, y) * texels.rows[y][2] / probability(x, y) / irradiance)
        };
        let mean = (0..samples).filter_map(estimate).sum::<f64>() / f64::from(samples);
        let error = (costs[costs.len() - 1].irradiance_variance / f64::from(samples)).sqrt();
        // A single lit texel leaves no error
        if error > 0.0 {
            largest_z = largest_z.max((mean - 1.0).abs() / error);
        }
    }
    Some(Costs { costs, largest_z, rows, columns })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::math::Rgb;
    use etalon_core::raster::Image;
    use std::f64::consts::PI;

    #[test]
    fn uniform_random_numbers_fit_and_gaussian_ones_do_not() {
        let result = compare(&EnvMap::new(Synthetic::Constant.make()), 20_000, 1).unwrap().unwrap();
        assert!(result.uniform.p > 1e-4, "{:?}", result.uniform);
        assert!(result.gaussian.p < 1e-12, "{:?}", result.gaussian);
        let sums = result.bins.iter().fold([0.0; 3], |s, b| [s[0] + b.target, s[1] + b.uniform, s[2] + b.gaussian]);
        assert!(sums.iter().all(|s| (s - 1.0).abs() < 1e-12));
    }

    #[test]
    fn too_little_to_test_is_an_error() {
        assert!(compare(&EnvMap::new(Synthetic::Constant.make()), 3, 1).is_err());
        assert_eq!(compare(&EnvMap::new(Synthetic::Black.make()), 1000, 1).unwrap(), None);
        assert_eq!(compare(&EnvMap::new(Synthetic::Onehot.make()), 1000, 1).unwrap(), None);
    }

    fn of(costs: &Costs, shape: Shape, along: Along) -> &Cost {
        costs.costs.iter().find(|cost| cost.proposal == shape.name() && cost.along == along).unwrap()
    }

    #[test]
    fn a_uniform_sky_has_costs_in_closed_form() {
        // The formulas are those of the limit of fine maps.
        let costs = costs(&EnvMap::new(Image::from_fn(512, 256, |_, _| Rgb::ONE)), 10_000, 1).unwrap();
        // Uniform rows and columns: 2π² ∫∫ sin² cos² dθ dφ / π² − 1 over the upper half, and of the flux 2π² ∫∫ sin² dθ dφ / 16π² − 1.
        let uniform = of(&costs, Shape::Uniform, Along::Both);
        assert!((uniform.irradiance_variance - (PI * PI / 4.0 - 1.0)).abs() < 1e-3, "{uniform:?}");
        assert!((uniform.flux_variance - (PI * PI / 8.0 - 1.0)).abs() < 1e-3, "{uniform:?}");
        // By the map or the sphere: half of the samples are below, E[cos²] is a third.
        for shape in [Shape::Map, Shape::Sphere] {
            let cost = of(&costs, shape, Along::Both);
            assert!((cost.irradiance_variance - 5.0 / 3.0).abs() < 1e-3 && cost.flux_variance < 1e-12, "{cost:?}");
        }
        // Columns of a uniform sky: uniform is right, and a narrow Gaussian is worse than a wide one.
        assert!(of(&costs, Shape::Uniform, Along::Columns).flux_variance < 1e-12);
        let gaussian = |part| of(&costs, Shape::Gaussian(part), Along::Columns).flux_variance;
        assert!(gaussian(2) < gaussian(4) && gaussian(4) < gaussian(8));
        assert!(costs.largest_z < 4.5, "{}", costs.largest_z);
    }

    #[test]
    fn samples_confirm_the_sums_and_darkness_is_no_error() {
        let map = EnvMap::new(Synthetic::Sun.make());
        assert!(costs(&map, 10_000, 2).unwrap().largest_z < 4.5);
        assert_eq!(costs(&EnvMap::new(Synthetic::Black.make()), 10, 1), None);
    }
}
