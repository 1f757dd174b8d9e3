//! The first report's lit sphere, rendered with more and more samples and compared with its exact picture.

use crate::envmap::EnvMap;
use crate::envmap::irradiance::IrradianceTree;
use crate::error::Result;
use crate::render::{Rendered, Settings, Silent, render};
use crate::scene::{Environment, Request, builtin};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;
use std::sync::Arc;

/// The exact picture: (1/π) · scale · E(n) at every pixel centre on the disc, `None` off it.
pub struct Exact {
    pub size: usize,
    pub pixels: Vec<Option<DVec3>>,
}

/// Inner and outer radius of the ring in which errors are measured, in units of the sphere's. The centre is left out
/// because there the report's camera touches the sphere, the rim because its pixels are partly background.
const RING: [f64; 2] = [12.0 / 255.5, 250.0 / 255.5];

impl Exact {
    /// Computes the picture of a white sphere in `map` × `scale`, `size` pixels wide, to 10⁻⁵.
    #[must_use]
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
fn normal(x: usize, y: usize, size: usize) -> Option<DVec3> {
    let at = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let (nx, ny) = (at(x), -at(y));
    let z2 = 1.0 - nx * nx - ny * ny;
    (z2 > 0.0).then(|| DVec3::new(nx, ny, z2.sqrt()))
}

/// Errors of one render. Field names are the CSV columns; intensity is (R + G + B) / 3, and errors are taken over
/// the ring of the disc described in the module.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Row {
    pub spp: u32,
    pub light_samples: u32,
    pub seconds: f64,
    /// √ mean (I − I*)² / mean I*.
    pub rel_rmse: f64,
    /// √ mean ((I − I*) / I*)².
    pub rmse_of_ratio: f64,
    /// mean (I − I*) / mean I*.
    pub rel_bias: f64,
}

/// A render with its errors.
pub struct Shot {
    pub row: Row,
    pub rendered: Rendered,
    /// (I − I*) / I* per pixel, NaN off the disc.
    pub relative_error: Vec<f64>,
}

/// Renders the sphere at `spp` samples per pixel and compares it with the exact picture.
pub fn shoot(map: &Arc<EnvMap>, source: &str, spp: u32, exact: &Exact, settings: &Settings) -> Result<Shot> {
    let environment = Environment::upright(map.clone(), source, builtin::SPHERE_ENV_SCALE);
    let (scene, request) = builtin::sphere_env(environment);
    let request = Request { width: exact.size, height: exact.size, spp, ..request };
    let rendered = render(&scene, &request, settings, &Silent)?;
    let (mut sum, mut sum2, mut ratio2, mut truth, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut relative_error = vec![f64::NAN; exact.pixels.len()];
    for (i, pixel) in exact.pixels.iter().enumerate() {
        let Some(expected) = pixel.map(|p| p.element_sum() / 3.0) else { continue };
        let got = rendered.image.pixels()[i].as_dvec3().element_sum() / 3.0;
        relative_error[i] = if expected > 0.0 { (got - expected) / expected } else { 0.0 };
        if in_ring(i % exact.size, i / exact.size, exact.size) {
            sum += got - expected;
            sum2 += (got - expected).powi(2);
            ratio2 += relative_error[i].powi(2);
            truth += expected;
            count += 1.0;
        }
    }
    let row = Row {
        spp,
        light_samples: request.light_samples,
        seconds: rendered.seconds,
        rel_rmse: (sum2 / count).sqrt() / (truth / count),
        rmse_of_ratio: (ratio2 / count).sqrt(),
        rel_bias: sum / truth,
    };
    Ok(Shot { row, rendered, relative_error })
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
    use crate::envmap::samplers::MapSampling;
    use crate::envmap::synthetic::Synthetic;
    use crate::render::Sampling;

    #[test]
    fn the_exact_picture_of_a_constant_map_is_constant() {
        let exact = Exact::new(&EnvMap::new(Synthetic::Constant.make()), 2.0, 15);
        let covered: Vec<_> = exact.pixels.iter().flatten().collect();
        assert!(covered.len() > 150);
        assert!(covered.iter().all(|p| (**p - DVec3::splat(2.0)).length() < 1e-4));
    }

    #[test]
    fn every_strategy_converges_to_the_exact_picture() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let exact = Exact::new(&map, 8.0, 41);
        for (sampling, density, tolerance) in [
            (Sampling::Light, MapSampling::COSINE, 0.01),
            (Sampling::Light, MapSampling::MAP, 0.02),
            (Sampling::Mis, MapSampling::MAP, 0.02),
            (Sampling::Mis, MapSampling::COMPENSATED, 0.02),
        ] {
            let settings = Settings { sampling, density, ..Settings::default() };
            let shot = shoot(&map, "sun", 64, &exact, &settings).unwrap();
            assert!(shot.row.rel_rmse < tolerance, "{sampling:?} {density:?}: {:?}", shot.row);
            assert!(shot.row.rel_bias.abs() < 2e-3, "{sampling:?} {density:?}: {:?}", shot.row);
        }
    }
}
