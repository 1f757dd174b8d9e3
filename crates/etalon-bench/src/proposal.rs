//! Inversion with uniform and with Gaussian random numbers: rows of a map, as the first report samples them.

use etalon_core::envmap::EnvMap;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::sampling::stream::CounterRng;
use etalon_core::sampling::table::Table1;
use etalon_stats::power::{ChiSquare, chi_square};
use rand::RngExt;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

/// One bin of rows. Field names are the CSV columns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RowBin {
    /// Where the bin begins, from the zenith.
    pub theta_from_deg: f64,
    pub theta_to_deg: f64,
    /// Share of the map's energy in these rows.
    pub target: f64,
    /// Shares of the samples.
    pub uniform: f64,
    pub gaussian: f64,
}

/// Both histograms and their tests against the target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proposal {
    /// Samples of each kind.
    pub draws: usize,
    pub uniform: ChiSquare,
    pub gaussian: ChiSquare,
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

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::synthetic::Synthetic;

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
}
