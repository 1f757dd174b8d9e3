//! The first report's sphere under an environment map: renders of it against its exact image, by sampling strategy.

use crate::converge::strategy::{DEFAULT, Strategy};
use crate::fit;
use etalon_core::envmap::irradiance::IrradianceTree;
use etalon_core::envmap::{EnvMap, NamedMap};
use etalon_core::error::Result;
use etalon_core::raster::Image;
use etalon_core::scene::{Environment, Request, Scene, builtin};
use etalon_render::{Dropped, Settings, Silent, render};
use etalon_stats::estimate::Estimate;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The exact image: (1/π) · scale · E(n) at every pixel centre on the disc, `None` off it.
pub struct Exact {
    /// Width and height.
    pub size: usize,
    /// Radiance at the centre of each pixel.
    pub pixels: Vec<Option<DVec3>>,
}

/// Inner and outer radius of the ring in which errors are measured, in units of the sphere's. The centre is left out
/// because there the report's camera touches the sphere, the rim because its pixels are partly background.
const RING: [f64; 2] = [12.0 / 255.5, 250.0 / 255.5];

impl Exact {
    /// Computes the image of a white sphere in `map` × `scale`, `size` pixels wide, to 10⁻⁵.
    pub fn new(map: &EnvMap, scale: f64, size: usize) -> Self {
        let tree = IrradianceTree::new(map);
        let pixels = (0..size * size)
            .into_par_iter()
            .map(|i| {
                let n = normal(i % size, i / size, size)?;
                Some(tree.irradiance(n).value * (scale / PI))
            })
            .collect();
        Self { size, pixels }
    }
}

/// The sphere's normal at the centre of pixel (x, y), if the sphere covers it.
pub(super) fn normal(x: usize, y: usize, size: usize) -> Option<DVec3> {
    let at = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let (nx, ny) = (at(x), -at(y));
    let z2 = 1.0 - nx * nx - ny * ny;
    (z2 > 0.0).then(|| DVec3::new(nx, ny, z2.sqrt()))
}

/// Errors of one render. Field names are the CSV columns; intensity is (R + G + B) / 3, and errors are taken over
/// the ring of the disc described in the module.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SphereRow {
    pub spp: u32,
    /// Light samples at the hit of a camera path.
    pub light_samples: u32,
    /// Mean number of camera paths of a sample; above 1 by adaptive sampling.
    pub camera_paths_per_sample: f64,
    /// Wall-clock time of the render.
    pub seconds: f64,
    /// √ mean (I − I*)² / mean I*.
    pub rel_rmse: f64,
    /// √ mean ((I − I*) / I*)².
    pub rmse_of_ratio: f64,
    /// mean (I − I*) / mean I*.
    pub rel_bias: f64,
}

impl SphereRow {
    /// Mean number of camera paths of a pixel.
    pub fn camera_paths(&self) -> f64 {
        f64::from(self.spp) * self.camera_paths_per_sample
    }
}

pub struct SphereRender {
    pub row: SphereRow,
    pub image: Image,
    /// The strategy, as it was chosen for the scene.
    pub strategy: Option<Strategy>,
    pub dropped: Dropped,
    /// (I − I*) / I* per pixel of the ring, NaN elsewhere.
    pub relative_error: Vec<f64>,
    /// Σ (I − I*)² over disjoint sets of pixels, whose random numbers are independent.
    group_errors: [f64; GROUPS],
}

/// Sets of pixels: replicates of one another.
const GROUPS: usize = 16;

/// The scene.
fn scene(map: &NamedMap) -> (Scene, Request) {
    builtin::sphere_env(Environment::upright(map.map.clone(), map.name.clone(), builtin::SPHERE_ENV_SCALE))
}

/// Renders the sphere at `spp` samples per pixel and compares it with the exact image.
pub fn render_sphere(map: &NamedMap, spp: u32, exact: &Exact, settings: &Settings) -> Result<SphereRender> {
    let (scene, request) = scene(map);
    let request = Request { width: exact.size, height: exact.size, spp, ..request };
    let rendered = render(&scene, &request, settings, &Silent)?;
    // Sums of the error, its square and the square of its ratio over the ring.
    let (mut sum, mut sum2, mut ratio2, mut truth, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut relative_error = vec![f64::NAN; exact.pixels.len()];
    let mut group_errors = [0.0; GROUPS];
    for (i, pixel) in exact.pixels.iter().enumerate() {
        let Some(expected) = pixel.map(|p| p.element_sum() / 3.0) else { continue };
        if in_ring(i % exact.size, i / exact.size, exact.size) {
            let got = rendered.image.pixels()[i].as_dvec3().element_sum() / 3.0;
            relative_error[i] = if expected > 0.0 { (got - expected) / expected } else { 0.0 };
            sum += got - expected;
            sum2 += (got - expected).powi(2);
            group_errors[i % GROUPS] += (got - expected).powi(2);
            ratio2 += relative_error[i].powi(2);
            truth += expected;
            count += 1.0;
        }
    }
    let row = SphereRow {
        spp,
        light_samples: request.light_samples,
        camera_paths_per_sample: rendered.part.camera_paths_per_sample().unwrap_or(f64::NAN),
        seconds: rendered.seconds,
        rel_rmse: (sum2 / count).sqrt() / (truth / count),
        rmse_of_ratio: (ratio2 / count).sqrt(),
        rel_bias: sum / truth,
    };
    let strategy = Strategy::of(&rendered.settings, &scene);
    let (image, dropped) = (rendered.image, rendered.dropped);
    Ok(SphereRender { row, image, strategy, dropped, relative_error, group_errors })
}

/// A strategy by its label, and the column of that name in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Label {
    /// Its name in the registry of strategies.
    pub strategy: &'static str,
}

/// The errors of one strategy at several numbers of samples per pixel.
pub struct Series {
    pub label: Label,
    /// The strategy that the default chose on this map; `None` for others.
    pub chosen: Option<Strategy>,
    /// In the order of the numbers of samples.
    pub rows: Vec<SphereRow>,
    /// p of RMSE ∝ nᵖ over the camera paths n of a pixel, its error from disjoint sets of pixels. Adaptive sampling has more paths in
    /// each sample after the first ones: over the samples the error would fall faster for that alone.
    pub slope: Estimate,
}

/// The strategies that are compared, by their names in the registry; the last one is the report's.
const STRATEGIES: [&str; 5] = [DEFAULT, "light-cosine", "mis-cosine", "mis", "light"];

/// Renders the sphere by every strategy at each number of samples per pixel.
pub fn compare(map: &NamedMap, spp: &[u32], exact: &Exact, seed: u64) -> Result<Vec<Series>> {
    let series = |strategy: &'static str| {
        let settings = strategy.parse::<Strategy>()?.settings(seed);
        let shots = spp.iter().map(|&spp| render_sphere(map, spp, exact, &settings)).collect::<Result<Vec<_>>>()?;
        let errors: Vec<_> = shots.iter().map(|shot| (shot.row.camera_paths(), shot.group_errors)).collect();
        let rows = shots.iter().map(|shot| shot.row).collect();
        let chosen = shots.into_iter().next_back().and_then(|shot| shot.strategy).filter(|_| strategy == DEFAULT);
        Ok(Series { label: Label { strategy }, chosen, rows, slope: slope(&errors) })
    };
    STRATEGIES.into_iter().map(series).collect()
}

/// The slope of √Σ (I − I*)² over the camera paths of a pixel: one line for each set of pixels, and their mean.
fn slope(errors: &[(f64, [f64; GROUPS])]) -> Estimate {
    let of_group = |group: usize| {
        let points = errors.iter().map(|(paths, errors)| [*paths, errors[group].sqrt()]);
        fit::log_log_slope(&points.collect::<Vec<_>>())
    };
    Estimate::mean(&(0..GROUPS).map(of_group).collect::<Vec<_>>())
}

/// Relative RMSE of PBRT-v2 on the report's scene with the Grace map at 8, 16, 32 and 64 samples per pixel.
pub const PBRT_RMSE: [(u32, f64); 4] = [(8, 0.107), (16, 0.066), (32, 0.047), (64, 0.026)];

/// Radiance of the sphere at one normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtNormal {
    pub normal: [f64; 3],
    /// As PBRT renders it under the Grace map, R, G, B.
    pub pbrt: [f64; 3],
    /// Under `map`, exact.
    pub exact: [f64; 3],
}

/// Radiance of the sphere under `map`, which should be the Grace map, beside that of a render by PBRT.
pub fn against_pbrt(map: &EnvMap) -> Vec<AtNormal> {
    const S: f64 = FRAC_1_SQRT_2;
    const PBRT: [([f64; 3], [f64; 3]); 6] = [
        ([0.0, S, S], [0.33820, 0.19120, 0.26335]),
        ([0.0, -S, S], [0.16658, 0.04898, 0.01052]),
        ([S, 0.0, S], [0.36022, 0.16219, 0.17004]),
        ([-S, 0.0, S], [0.12029, 0.04990, 0.04182]),
        ([0.0, 1.0, 0.0], [0.26653, 0.20347, 0.32621]),
        ([0.0, 0.0, 1.0], [0.28311, 0.10953, 0.08941]),
    ];
    let tree = IrradianceTree::new(map);
    let scale = f64::from(builtin::SPHERE_ENV_SCALE) / PI;
    let at = |(normal, pbrt)| AtNormal {
        normal,
        pbrt,
        exact: (tree.irradiance(DVec3::from_array(normal)).value * scale).to_array(),
    };
    PBRT.into_iter().map(at).collect()
}

fn in_ring(x: usize, y: usize, size: usize) -> bool {
    normal(x, y, size).is_some_and(|n| {
        let r = n.x.hypot(n.y);
        r > RING[0] && r < RING[1]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::samplers::MapSampling;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_render::Sampling;
    use std::sync::Arc;

    #[test]
    fn the_exact_image_of_a_constant_map_is_constant() {
        let exact = Exact::new(&EnvMap::new(Synthetic::Constant.make()), 2.0, 15);
        let covered: Vec<_> = exact.pixels.iter().flatten().collect();
        assert!(covered.len() > 150);
        assert!(covered.iter().all(|p| (**p - DVec3::splat(2.0)).length() < 1e-4));
    }

    #[test]
    fn every_strategy_converges_to_the_exact_image() {
        let map = NamedMap { map: Arc::new(EnvMap::new(Synthetic::Sun.make())), name: "sun".into() };
        let exact = Exact::new(&map.map, 8.0, 41);
        for (sampling, density, tolerance) in [
            (Sampling::Light, MapSampling::COSINE, 0.01),
            (Sampling::Light, MapSampling::MAP, 0.02),
            (Sampling::Mis, MapSampling::MAP, 0.02),
            (Sampling::Mis, MapSampling::COSINE_COMPENSATED, 0.02),
        ] {
            let settings = Settings { sampling, density: Some(density), ..Settings::default() };
            let shot = render_sphere(&map, 64, &exact, &settings).unwrap();
            assert!(shot.row.rel_rmse < tolerance, "{sampling:?} {density:?}: {:?}", shot.row);
            assert!(shot.row.rel_bias.abs() < 2e-3, "{sampling:?} {density:?}: {:?}", shot.row);
        }
    }

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let errors = |noise: f64| -> Vec<(f64, [f64; GROUPS])> {
            let at = |paths: f64| std::array::from_fn(|i| paths.powf(-1.4 + noise * (i % 2) as f64));
            [8.0, 16.0, 32.0].map(|paths| (paths, at(paths))).into()
        };
        let exact = slope(&errors(0.0));
        assert!((exact.value + 0.7).abs() < 1e-12 && exact.standard_error < 1e-12, "{exact:?}");
        // Half of the sets have −0.7, half −0.6: s² = 0.1²/4 · 16/15.
        let spread = slope(&errors(0.2));
        assert!((spread.value + 0.65).abs() < 1e-12, "{spread:?}");
        assert!((spread.standard_error - 0.05 / 15.0_f64.sqrt()).abs() < 1e-12, "{spread:?}");
    }
}
