//! The first report's claims on its environment map: samples, median cut, and the sphere under it.

use super::claim::{Agreement, Bound, Claim, Finding, Unit, VISIBLE};
use crate::fit::log_log_slope;
use crate::map_samples::{self, SampleRow};
use crate::median_cut::{self, Centroid, RegionRow};
use crate::proposal::Proposal;
use crate::sphere::{Exact, Series, normal};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{SideRule, Split};
use etalon_core::envmap::samplers::TexelSampler;
use etalon_core::error::Result;
use etalon_core::scene::builtin::SPHERE_ENV_SCALE;
use etalon_stats::Extremes;
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::Arc;

/// What the claims are tested on.
pub struct MapInputs<'a> {
    /// The map.
    pub map: &'a EnvMap,
    /// The exact image of the sphere under it.
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
    let cut = |centroid, regions| -> Result<Vec<RegionRow>> {
        Ok(median_cut::cut(inputs.map, &[regions], Split::Energy, SideRule::default(), centroid)?.remove(0))
    };
    let (energy, median) = (cut(Centroid::Energy, 64)?, cut(Centroid::Median, 64)?);
    Ok(vec![
        size(inputs.map),
        proposal(inputs.proposal),
        brighter(inputs.map),
        middle(inputs.map, true),
        middle(inputs.map, false),
        four_cuts(&cut(Centroid::Energy, 4)?),
        balance(&energy),
        centroids(inputs, &energy, &median),
        Claim {
            place: "text",
            claim: "The cuts are in Figures 7, 8, 14 and 15.",
            number: "7, 8, 14, 15",
            remark: "An error of print: they are Figures 7 to 10; 14 and 15 are spheres.",
            evidence: &["median-cut-2", "median-cut-64"],
            ..Claim::default()
        },
        noise(inputs.renders),
    ])
}

fn size(map: &EnvMap) -> Claim {
    let [rows, columns] = [map.geometry().height(), map.geometry().width()];
    let difference = rows.abs_diff(512) + columns.abs_diff(1024);
    Claim {
        place: "text",
        claim: "The map has 512 rows and 1024 columns.",
        number: "(512, 1024, 3)",
        findings: vec![Finding::exact(
            format!("rows and columns by which {rows} × {columns} differ from it"),
            difference as f64,
            Unit::Plain,
            Bound::AtMost(0.0),
        )],
        evidence: &["envmap-samples-1024"],
        ..Claim::default()
    }
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

fn brighter(map: &EnvMap) -> Claim {
    Claim {
        place: "text",
        claim: "Pixels of higher intensity are easier to be sampled.",
        findings: vec![Finding::exact(
            "of the samples, in the brighter half of the pixels",
            brighter_share(map),
            Unit::Percent,
            Bound::AtLeast(0.5),
        )],
        evidence: &["envmap-samples-1024"],
        ..Claim::default()
    }
}

fn four_cuts(regions: &[RegionRow]) -> Claim {
    Claim {
        place: "text",
        claim: "The cuts of both halves make 4 cuts.",
        number: "4 cuts",
        findings: vec![Finding::exact(
            format!("cuts that make {} regions", regions.len()),
            regions.len() as f64 - 1.0,
            Unit::Plain,
            Bound::AtLeast(4.0),
        )],
        remark: "The sentence counts regions. Captions of Figures 7 to 10 count levels: 1, 2, 4 and 6 of them make 2, 4, 16 and 64 \
                 regions, by 1, 3, 15 and 63 cuts.",
        evidence: &["median-cut-4"],
        ..Claim::default()
    }
}

fn proposal(tested: Option<&Proposal>) -> Claim {
    let finding = |what: &str, value, bound| Finding::exact(what, value, Unit::Plain, bound);
    let findings = tested.map(|tested| {
        vec![
            finding("p of the sampled rows with uniform numbers", tested.uniform.p, Bound::AtLeast(1e-3)),
            finding("p with Gaussian numbers (0: too small for 64 bits)", tested.gaussian.p, Bound::AtMost(1e-6)),
        ]
    });
    Claim {
        place: "text",
        claim: "Of the proposals tried, uniform is the most appropriate, not Gaussian.",
        findings: findings.unwrap_or_default(),
        evidence: &["proposal", "audit"],
        ..Claim::default()
    }
}

/// The share of the map's energy in the middle half of the rows or columns, and that of its radiance without sin θ.
fn middle_shares(map: &EnvMap, of_rows: bool) -> [f64; 2] {
    let g = map.geometry();
    let (width, height) = (g.width(), g.height());
    let (mut inside, mut total, mut inside_flat, mut total_flat) = (0.0, 0.0, 0.0, 0.0);
    for y in 0..height {
        for x in 0..width {
            // The part of a texel in the middle half
            let (i, n) = if of_rows { (y, height) } else { (x, width) };
            let [from, to] = [0.25, 0.75].map(|edge| (edge * n as f64 - i as f64).within(0.0, 1.0));
            inside += (to - from) * map.energy(x, y);
            total += map.energy(x, y);
            inside_flat += (to - from) * map.mean_rgb(x, y);
            total_flat += map.mean_rgb(x, y);
        }
    }
    [inside / total, inside_flat / total_flat]
}

/// The shares of the middle rows and columns among `n` sampled directions, compared with the exact ones.
///
/// # Errors
/// Too few or too many samples.
pub fn sampled_shares(map: &Arc<EnvMap>, n: usize, seed: u64) -> Result<[Agreement; 2]> {
    let samples = map_samples::draw(map, &TexelSampler::new(map.clone()), DVec3::Y, n, seed)?.rows;
    let size = [map.geometry().width(), map.geometry().height()].map(|side| side as f64);
    let names = ["samples in the middle rows minus their share", "samples in the middle columns minus their share"];
    Ok([(true, names[0]), (false, names[1])].map(|(of_rows, name)| {
        let is_inside = |row: &&SampleRow| {
            let at = if of_rows { row.y / size[1] } else { row.x / size[0] };
            (0.25..0.75).contains(&at)
        };
        let ([share, _], count) = (middle_shares(map, of_rows), samples.len() as f64);
        let inside = samples.iter().filter(is_inside).count() as f64;
        Agreement { name, z: (inside / count - share) / (share * (1.0 - share) / count).sqrt() }
    }))
}

/// Samples in the middle half of the rows or of the columns: by solid angle alone, and by the map.
fn middle(map: &EnvMap, of_rows: bool) -> Claim {
    let [both, by_map] = middle_shares(map, of_rows);
    // Uniform directions: ½ (cos 45° − cos 135°) of them in the middle rows.
    let by_solid_angle = if of_rows { FRAC_1_SQRT_2 } else { 0.5 };
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let what = format!(
        "of the samples, in the middle half of the {} (of a constant map: {}; by the radiance without sin θ: {})",
        if of_rows { "rows" } else { "columns" },
        percent(by_solid_angle),
        percent(by_map)
    );
    let findings = vec![Finding::exact(what, both, Unit::Percent, Bound::AtLeast(0.5))];
    let claim = if of_rows {
        "Pixels in the middle of the image are more likely than those at the edge: rows."
    } else {
        "Pixels in the middle of the image are more likely than those at the edge: columns."
    };
    Claim { place: "text", claim, findings, evidence: &["envmap-samples-1024"], ..Claim::default() }
}

fn balance(regions: &[RegionRow]) -> Claim {
    let imbalance = median_cut::imbalance(regions);
    Claim {
        place: "Fig. 10",
        claim: "Six cuts, of every region at its median pixel into halves of the same energy, make 64 regions.",
        number: "6 cuts",
        findings: vec![
            Finding::exact("regions", regions.len() as f64, Unit::Plain, Bound::AtLeast(64.0)),
            Finding::exact(
                "largest energy of a region over the mean",
                imbalance,
                Unit::Times,
                Bound::AtMost(1.0 + VISIBLE),
            ),
        ],
        remark: "A cut falls between two texels.",
        evidence: &["median-cut-64"],
        ..Claim::default()
    }
}

fn centroids(inputs: &MapInputs, energy: &[RegionRow], median: &[RegionRow]) -> Claim {
    let pairs = || energy.iter().zip(median);
    let count = energy.len() as f64;
    let texels =
        pairs().map(|(a, b)| (a.centroid_x - b.centroid_x).hypot(a.centroid_y - b.centroid_y)).sum::<f64>() / count;
    let direction = |row: &RegionRow| DVec3::new(row.dir_x, row.dir_y, row.dir_z);
    let angle = pairs().map(|(a, b)| direction(a).angle_between(direction(b)).to_degrees()).sum::<f64>() / count;
    let [by_energy, by_median] = [energy, median].map(|lights| sphere_error(inputs.exact, lights));
    Claim {
        place: "Fig. 7–11",
        claim: "The median pixels of the last cut are centroids.",
        findings: vec![
            Finding::exact(
                format!("texels between median pixel and energy centroid, mean of 64 ({angle:.2}°)"),
                texels,
                Unit::Plain,
                Bound::AtMost(1.0),
            ),
            Finding::exact(
                format!(
                    "error of a sphere lit from median pixels ({:.2} %) over that from energy centroids ({:.2} %)",
                    100.0 * by_median,
                    100.0 * by_energy
                ),
                by_median / by_energy,
                Unit::Times,
                Bound::AtMost(1.0 + VISIBLE),
            ),
        ],
        evidence: &["median-cut-64", "median-cut-error"],
        ..Claim::default()
    }
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

fn noise(renders: &Series) -> Claim {
    let rows = &renders.rows;
    let times: Vec<[f64; 2]> = rows.iter().map(|row| [f64::from(row.spp), row.seconds]).collect();
    let ends = rows.first().zip(rows.last());
    let fall = ends.map_or(f64::NAN, |(first, last)| first.rel_rmse / last.rel_rmse);
    Claim {
        place: "Fig. 12–15",
        claim: "More samples take longer and have less noise.",
        number: "8 to 64 samples",
        findings: vec![
            Finding {
                what: format!("exponent of the error over the samples (8 to 64 samples: {fall:.1} times less)"),
                value: renders.slope.value,
                error: renders.slope.standard_error,
                unit: Unit::Plain,
                bound: Bound::AtMost(0.0),
            },
            Finding::exact("exponent of the time", log_log_slope(&times), Unit::Plain, Bound::AtLeast(0.0)),
        ],
        evidence: &["sphere-error", "sphere-8", "sphere-64"],
        ..Claim::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::synthetic::Synthetic;

    #[test]
    fn a_constant_map_has_the_shares_of_the_sphere() {
        let map = Arc::new(EnvMap::new(Synthetic::Constant.make()));
        let ([rows, flat], [columns, _]) = (middle_shares(&map, true), middle_shares(&map, false));
        assert!((rows - FRAC_1_SQRT_2).abs() < 1e-12 && (columns - 0.5).abs() < 1e-12 && (flat - 0.5).abs() < 1e-12);
        assert!((brighter_share(&map) - 0.5).abs() < 1e-12, "the brightest half is the upper one");
        assert!(sampled_shares(&map, 4096, 1).unwrap().iter().all(|agreement| agreement.z.abs() < 4.0));
        assert!(sampled_shares(&map, 0, 1).is_err());
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
