//! Samples of an environment map: direction, pdf, radiance.

use etalon_core::envmap::EnvMap;
use etalon_core::envmap::samplers::{EnvSample, SurfaceSampler};
use etalon_core::error::{Error, Result};
use etalon_core::math::mean_rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use glam::DVec3;
use serde::Serialize;

/// One sample. Field names are the CSV columns; x and y are continuous texel coordinates from the top left corner. The sample
/// stands for a solid angle of 1 / (n pdf), and so for a flux of radiance times that.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SampleRow {
    pub x: f64,
    pub y: f64,
    pub dir_x: f64,
    /// Direction, y (up).
    pub dir_y: f64,
    pub dir_z: f64,
    /// Per solid angle.
    pub pdf: f64,
    pub solid_angle: f64,
    /// Radiance, red.
    pub r: f32,
    /// Radiance, green.
    pub g: f32,
    /// Radiance, blue.
    pub b: f32,
}

#[derive(Debug, Clone)]
pub struct MapSamples {
    pub rows: Vec<SampleRow>,
    /// Estimate of the map's intensity flux ∫ I dω from these samples: mean of I / pdf.
    pub flux_estimate: f64,
    /// Its standard error; NaN for one sample.
    pub flux_standard_error: f64,
    /// Samples whose pdf is not, bit for bit, the one that the sampler's `pdf` gives for their direction.
    pub pdf_mismatches: usize,
}

/// Largest number of samples that can be asked for at once.
pub const MAX_SAMPLES: usize = 1 << 16;

/// Takes `n` samples of the map by one of its samplers, for a surface of that normal (in the map's frame; samplers of all
/// directions ignore it), with independent random numbers.
///
/// # Errors
/// [`Error::Parameter`] for 0 samples and for more than [`MAX_SAMPLES`].
pub fn draw(map: &EnvMap, sampler: &dyn SurfaceSampler, normal: DVec3, n: usize, seed: u64) -> Result<MapSamples> {
    if n == 0 || n > MAX_SAMPLES {
        return Err(
            Error::parameter("n", format!("{n} samples")).with_hint(format!("ask for 1 to {MAX_SAMPLES} samples"))
        );
    }
    let random = (0..n).map(|i| Independent::new(seed, 0, i as u32).pair(0));
    let samples: Vec<EnvSample> = random.filter_map(|u| sampler.sample_for(u, normal)).collect();
    // Monte Carlo estimate of the flux; random numbers without a sample contribute 0.
    let estimates: Vec<f64> = samples.iter().map(|s| mean_rgb(s.radiance) / s.pdf).collect();
    let count = n as f64;
    let mean = estimates.iter().sum::<f64>() / count;
    let without = (n - estimates.len()) as f64;
    let squares = estimates.iter().map(|x| (x - mean).powi(2)).sum::<f64>() + without * mean * mean;
    let row = |s: &EnvSample| {
        let (x, y) = map.geometry().position(s.wi);
        SampleRow {
            x,
            y,
            dir_x: s.wi.x,
            dir_y: s.wi.y,
            dir_z: s.wi.z,
            pdf: s.pdf,
            solid_angle: 1.0 / (count * s.pdf),
            r: s.radiance.x,
            g: s.radiance.y,
            b: s.radiance.z,
        }
    };
    Ok(MapSamples {
        flux_estimate: mean,
        flux_standard_error: (squares / (count * (count - 1.0))).sqrt(),
        pdf_mismatches: samples.iter().filter(|s| s.pdf.to_bits() != sampler.pdf_for(s.wi, normal).to_bits()).count(),
        rows: samples.iter().map(row).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::samplers::{ALL, ErrataSampler, MapSampling};
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::math::Rgb;
    use etalon_core::raster::Image;
    use etalon_core::sampling::warp::uniform_sphere;
    use std::f64::consts::PI;
    use std::sync::Arc;

    fn draw_by(sampling: MapSampling, map: &Arc<EnvMap>, n: usize, seed: u64) -> Result<MapSamples> {
        draw(map, &*sampling.sampler(map.clone())?, DVec3::Y, n, seed)
    }

    struct Uniform(Arc<EnvMap>);

    impl SurfaceSampler for Uniform {
        fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample> {
            let wi = uniform_sphere(u);
            Some(EnvSample { wi, pdf: self.pdf_for(wi, normal), radiance: self.0.radiance(wi) })
        }

        fn map(&self) -> &EnvMap {
            &self.0
        }

        fn pdf_in_texel(&self, _: (usize, usize), _: DVec3) -> f64 {
            0.25 / PI
        }

        fn has_samples(&self) -> bool {
            true
        }
    }

    #[test]
    fn every_sampler_takes_as_many_samples_as_asked() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        for sampling in ALL.iter().map(|entry| MapSampling::new(entry)).filter(|sampling| !sampling.has_fixed_lights())
        {
            let samples = draw_by(sampling, &map, 256, 1).unwrap();
            assert!(samples.rows.len() == 256 || sampling.needs_normal());
            assert_eq!(samples.rows, draw_by(sampling, &map, 256, 1).unwrap().rows);
            assert_eq!(samples.pdf_mismatches, 0, "{sampling}");
        }
        let corners = ErrataSampler::new(map.clone());
        assert!(draw(&map, &corners, DVec3::Y, 256, 1).unwrap().pdf_mismatches > 0);
        assert!(draw_by(MapSampling::MAP, &map, 0, 1).is_err());
    }

    #[test]
    fn a_perfect_pdf_estimates_the_flux_without_noise() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let info = etalon_core::envmap::info::Info::of(&map);
        let flux = info.flux_rgb.iter().sum::<f64>() / 3.0;
        let by_radiance = draw_by(MapSampling::MAP, &map, 16, 7).unwrap();
        let estimate = by_radiance.flux_estimate;
        assert!((estimate / flux - 1.0).abs() < 1e-6, "{estimate} against {flux}");
        assert!(by_radiance.flux_standard_error < 1e-6 * flux);
        assert!(draw_by(MapSampling::MAP, &map, 1, 7).unwrap().flux_standard_error.is_nan());
    }

    #[test]
    fn the_standard_error_is_that_of_the_estimates() {
        // Radiance from 1 to 2, so that the mean of 1024 samples is normally distributed.
        let map = Arc::new(EnvMap::new(Image::from_fn(64, 32, |x, _| Rgb::splat(1.0 + x as f32 / 63.0))));
        let info = etalon_core::envmap::info::Info::of(&map);
        let flux = info.flux_rgb.iter().sum::<f64>() / 3.0;
        let uniform = Uniform(map.clone());
        // By chance, the sum of 64 squares with mean 1 is below 24 or above 120 with a probability of 10⁻⁵.
        let squares = (0..64).map(|seed| {
            let samples = draw(&map, &uniform, DVec3::Y, 1024, seed).unwrap();
            ((samples.flux_estimate - flux) / samples.flux_standard_error).powi(2)
        });
        let sum: f64 = squares.sum();
        assert!((24.0..120.0).contains(&sum), "{sum}");
    }

    #[test]
    fn a_black_map_has_no_samples() {
        let map = Arc::new(EnvMap::new(Synthetic::Black.make()));
        assert!(draw_by(MapSampling::MAP, &map, 64, 1).unwrap().rows.is_empty());
    }
}
