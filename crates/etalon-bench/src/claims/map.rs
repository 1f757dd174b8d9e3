//! The first report's claims on its environment map: samples, median cut, and the sphere under it.

use super::{Bound, Claim, Finding, VISIBLE, texts};
use crate::fit::log_log_slope;
use crate::median_cut::{self, Centroid, RegionRow};
use crate::proposal::Proposal;
use crate::sphere::{Exact, Series, normal};
use Bound::{AtLeast, AtMost};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{SideRule, Split};
use etalon_core::error::Result;
use etalon_core::scene::builtin::SPHERE_ENV_SCALE;
use etalon_stats::Extremes;
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

pub struct MapInputs<'a> {
    pub map: &'a EnvMap,
    pub exact: &'a Exact,
    /// Renders of the sphere by light samples of the map alone, as the report's.
    pub renders: &'a Series,
    /// Rows sampled with uniform and with Gaussian random numbers.
    pub proposal: Option<&'a Proposal>,
}

/// Tests the claims.
///
/// # Errors
/// Those of the median cut.
pub fn map_claims(inputs: &MapInputs) -> Result<Vec<Claim>> {
    let MapInputs { map, exact: sphere, renders, proposal } = *inputs;
    let cut = |centroid, regions| -> Result<Vec<RegionRow>> {
        Ok(median_cut::cut(map, &[regions], Split::Energy, SideRule::default(), centroid)?.remove(0))
    };
    let (energy, median, four) = (cut(Centroid::Energy, 64)?, cut(Centroid::Median, 64)?, cut(Centroid::Energy, 4)?);
    let exact = |what: &str, value: f64, bound: Bound| Finding::exact(what, value, bound);
    let most = |what: &str, share: f64| exact(what, share, AtLeast(0.5)).in_percent();
    let [rows, columns] = [map.geometry().height(), map.geometry().width()];
    let size = format!("rows and columns by which {rows} × {columns} differ from it");
    let p_values = proposal.map(|tested| {
        vec![
            exact("p of the sampled rows with uniform numbers", tested.uniform.p, AtLeast(1e-3)),
            exact("p with Gaussian numbers (0: too small for 64 bits)", tested.gaussian.p, AtMost(1e-6)),
        ]
    });
    let middle = |along: Along, name: &str, by_solid_angle: f64| {
        let [both, by_map] = middle_shares(map, along);
        let [constant, flat] = [by_solid_angle, by_map].map(|share| format!("{:.1} %", 100.0 * share));
        let samples = format!("of the samples, in the middle half of the {name}");
        most(&format!("{samples} (of a constant map: {constant}; by the radiance without sin θ: {flat})"), both)
    };
    let direction = |row: &RegionRow| DVec3::new(row.dir_x, row.dir_y, row.dir_z);
    let mean = |distance: &dyn Fn(&RegionRow, &RegionRow) -> f64| {
        energy.iter().zip(&median).map(|(a, b)| distance(a, b)).sum::<f64>() / energy.len() as f64
    };
    let angle = mean(&|a, b| direction(a).angle_between(direction(b)).to_degrees());
    let texels = mean(&|a, b| (a.centroid_x - b.centroid_x).hypot(a.centroid_y - b.centroid_y));
    let errors = [&median, &energy].map(|lights| sphere_error(sphere, lights));
    let [by_median, by_energy] = errors.map(|error| format!("{:.2} %", 100.0 * error));
    let lit =
        format!("error of a sphere lit from median pixels ({by_median}) over that from energy centroids ({by_energy})");
    let ends = renders.rows.first().zip(renders.rows.last());
    let fall = ends.map_or(f64::NAN, |(first, last)| first.rel_rmse / last.rel_rmse);
    let exponent = format!("exponent of the error over the samples (8 to 64 samples: {fall:.1} times less)");
    let slope = [renders.slope.value, renders.slope.standard_error];
    let seconds: Vec<[f64; 2]> = renders.rows.iter().map(|row| [f64::from(row.spp), row.seconds]).collect();
    Ok(vec![
        texts::SIZE.with([exact(&size, (rows.abs_diff(512) + columns.abs_diff(1024)) as f64, AtMost(0.0))]),
        texts::PROPOSAL.with(p_values.unwrap_or_default()),
        texts::BRIGHTER_PIXELS.with([most("of the samples, in the brighter half of the pixels", brighter_share(map))]),
        // Uniform directions: ½ (cos 45° − cos 135°) of them in the middle rows
        texts::MIDDLE_ROWS.with([middle(Along::Rows, "rows", FRAC_1_SQRT_2)]),
        texts::MIDDLE_COLUMNS.with([middle(Along::Columns, "columns", 0.5)]),
        texts::FOUR_CUTS.with([exact("cuts that make 4 regions", four.len() as f64 - 1.0, AtLeast(4.0))]),
        texts::BALANCE.with([
            exact("regions", energy.len() as f64, AtLeast(64.0)),
            exact("largest energy of a region over the mean", median_cut::imbalance(&energy), AtMost(1.0 + VISIBLE)),
        ]),
        texts::CENTROIDS.with([
            exact(
                &format!("texels between median pixel and energy centroid, mean of 64 ({angle:.2}°)"),
                texels,
                AtMost(1.0),
            ),
            exact(&lit, errors[0] / errors[1], AtMost(1.0 + VISIBLE)),
        ]),
        texts::FIGURES.with([]),
        texts::MORE_SAMPLES.with([
            Finding::estimated(exponent, slope, AtMost(0.0)),
            exact("exponent of the time", log_log_slope(&seconds), AtLeast(0.0)),
        ]),
    ])
}

/// The share of the map's energy in the brighter half of its pixels.
fn brighter_share(map: &EnvMap) -> f64 {
    let g = map.geometry();
    let texels = (0..g.height()).flat_map(|y| (0..g.width()).map(move |x| (x, y)));
    let mut values: Vec<[f64; 2]> = texels.map(|(x, y)| [map.mean_rgb(x, y), map.energy(x, y)]).collect();
    values.sort_by(|a, b| b[0].total_cmp(&a[0]));
    let energy = |values: &[[f64; 2]]| values.iter().map(|value| value[1]).sum::<f64>();
    energy(&values[..values.len() / 2]) / energy(&values)
}

/// The axis of a map along which a share is measured.
#[derive(Clone, Copy, PartialEq)]
enum Along {
    Rows,
    Columns,
}

/// The share of the map's energy in the middle half of the rows or columns, and that of its radiance without sin θ.
fn middle_shares(map: &EnvMap, along: Along) -> [f64; 2] {
    let [width, height] = [map.geometry().width(), map.geometry().height()];
    let (mut inside, mut total) = ([0.0; 2], [0.0; 2]);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        // The part of a texel in the middle half
        let (i, n) = if along == Along::Rows { (y, height) } else { (x, width) };
        let [from, to] = [0.25, 0.75].map(|edge| (edge * n as f64 - i as f64).within(0.0, 1.0));
        for (k, light) in [map.energy(x, y), map.mean_rgb(x, y)].into_iter().enumerate() {
            inside[k] += (to - from) * light;
            total[k] += light;
        }
    }
    [0, 1].map(|k| inside[k] / total[k])
}

/// Root mean square error of the sphere lit by fixed lights in place of the map, over its mean.
fn sphere_error(exact: &Exact, lights: &[RegionRow]) -> f64 {
    let (mut square, mut truth, mut count) = (0.0, 0.0, 0.0);
    for (i, pixel) in exact.pixels.iter().enumerate() {
        let (Some(expected), Some(n)) = (pixel, normal(i % exact.size, i / exact.size, exact.size)) else { continue };
        let light = |l: &RegionRow| l.energy * n.dot(DVec3::new(l.dir_x, l.dir_y, l.dir_z)).at_least(0.0);
        let got = f64::from(SPHERE_ENV_SCALE) / PI * lights.iter().map(light).sum::<f64>();
        let expected = expected.element_sum() / 3.0;
        square += (got - expected).powi(2);
        truth += expected;
        count += 1.0;
    }
    f64::sqrt(square / count) / (truth / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::synthetic::Synthetic;

    #[test]
    fn a_constant_map_has_the_shares_of_the_sphere() {
        let map = EnvMap::new(Synthetic::Constant.make());
        let ([rows, flat], [columns, _]) = (middle_shares(&map, Along::Rows), middle_shares(&map, Along::Columns));
        assert!((rows - FRAC_1_SQRT_2).abs() < 1e-12 && (columns - 0.5).abs() < 1e-12 && (flat - 0.5).abs() < 1e-12);
        assert!((brighter_share(&map) - 0.5).abs() < 1e-12, "the brightest half is the upper one");
    }

    #[test]
    fn lights_at_the_energy_centroids_are_nearer_to_the_map() {
        let map = EnvMap::new(Synthetic::Nave.make());
        let exact = Exact::new(&map, f64::from(SPHERE_ENV_SCALE), 21);
        let error = |centroid| {
            let lights = median_cut::cut(&map, &[64], Split::Energy, SideRule::default(), centroid).unwrap().remove(0);
            sphere_error(&exact, &lights)
        };
        let (energy, median) = (error(Centroid::Energy), error(Centroid::Median));
        assert!(energy < median && median < 0.05, "{energy} {median}");
    }
}
