//! Median cut of maps that cannot be halved by energy: constant, black, one bright texel.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, Workload};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{MedianCut, SideRule, Split};
use etalon_core::envmap::synthetic::{ONE_HOT_RADIANCE, ONE_HOT_TEXEL, Synthetic};
use etalon_core::error::Result;
use std::f64::consts::PI;

pub const EXPERIMENT: Experiment = Experiment {
    name: "cuts",
    about: "light of the regions of a median cut of constant, black maps and maps with one bright texel; out of range: missing regions",
    figure: "stability-sums",
    bounds: &[
        Bound::possible("regions that are missing"),
        Bound {
            name: "last places of the light of all regions",
            limit: 8192.0,
            reason: "2048 texels, each rounded 3 times and added once",
            error: |row| Some(row.max_ulp),
        },
    ],
    run,
};

const REGIONS: [usize; 5] = [1, 2, 64, 1000, 2048];

fn run(_workload: &Workload, _seed: u64) -> Result<Vec<ErrorRow>> {
    let mut row = ErrorRow::new("cuts", STABLE, Precision::Double);
    for kind in [Synthetic::Constant, Synthetic::Black, Synthetic::Onehot] {
        let (map, name) = (EnvMap::new(kind.make()), kind.name());
        let exact = flux(kind, &map);
        for split in [Split::Energy, Split::Variance] {
            let cut = MedianCut::new(&map, split, SideRule::default());
            for n in REGIONS {
                let regions = cut.regions(n)?;
                let what = || format!("{name} map cut by {split:?} into {n}");
                row.compare(regions.iter().map(|r| r.flux.x).sum(), exact, 1.0, what);
                let places = regions.iter().flat_map(|r| [r.centroid.0, r.centroid.1, r.median.0, r.median.1]);
                let lost = places.filter(|x| !x.is_finite()).count();
                row.out_of_range += (regions.len().abs_diff(n) + lost) as u64;
            }
        }
    }
    Ok(vec![row])
}

/// ∫ L dω in closed form.
fn flux(kind: Synthetic, map: &EnvMap) -> f64 {
    match kind {
        Synthetic::Constant => 4.0 * PI,
        Synthetic::Onehot => {
            let ((_, y), height) = (ONE_HOT_TEXEL, map.geometry().height() as f64);
            let edge = |y: f64| (PI * y / height).cos();
            let area = (edge(y as f64) - edge(y as f64 + 1.0)) * 2.0 * PI / map.geometry().width() as f64;
            f64::from(ONE_HOT_RADIANCE.x) * area
        }
        _ => 0.0,
    }
}
