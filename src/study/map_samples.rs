//! Samples of an environment map: direction, pdf, radiance.

use crate::envmap::EnvMap;
use crate::envmap::batch::EnvSamples;
use crate::envmap::latlong::intensity;
use crate::envmap::report_model::ReportSampler;
use crate::envmap::sampler::{AliasSampler, CdfSampler, CompensatedSampler, DirectionSampler, EnvSample};
use crate::error::{Error, Result};
use crate::sampling::alias::AliasTable;
use crate::sampling::stream::{Independent, Stream};
use crate::sampling::table::Table2;
use serde::Serialize;
use std::sync::Arc;

/// How to sample the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Row CDF, then column CDF.
    #[default]
    Cdf,
    /// One alias table over all texels.
    Alias,
    /// The MIS-compensated pdf, by CDF.
    Compensated,
    /// As the first report does it: weights of 0 at the poles, texel corners.
    Report,
}

/// One sample. Field names are the CSV columns; x and y are continuous texel coordinates from the top left corner.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Row {
    /// Column.
    pub x: f64,
    /// Row.
    pub y: f64,
    /// Direction, x.
    pub dir_x: f64,
    /// Direction, y (up).
    pub dir_y: f64,
    /// Direction, z.
    pub dir_z: f64,
    /// Per solid angle.
    pub pdf: f64,
    /// Radiance, red.
    pub r: f32,
    /// Radiance, green.
    pub g: f32,
    /// Radiance, blue.
    pub b: f32,
}

/// Samples of a map.
#[derive(Debug, Clone)]
pub struct MapSamples {
    /// A row for each sample.
    pub rows: Vec<Row>,
    /// Estimate of the map's intensity flux ∫ I dω from these samples: mean of I / pdf.
    pub flux_estimate: f64,
    /// Samples whose pdf is not, bit for bit, the one that the sampler's `pdf` gives for their direction.
    pub pdf_mismatches: usize,
}

/// Largest number of samples that can be asked for at once.
pub const MAX_SAMPLES: usize = 1 << 16;

/// Takes `n` samples with independent random numbers.
///
/// # Errors
/// No sample or too many, or too little memory.
pub fn draw(map: &Arc<EnvMap>, method: Method, n: usize, seed: u64) -> Result<MapSamples> {
    if n == 0 || n > MAX_SAMPLES {
        return Err(
            Error::parameter("n", format!("{n} samples")).with_hint(format!("ask for 1 to {MAX_SAMPLES} samples"))
        );
    }
    let bytes = if method == Method::Alias { AliasTable::BYTES } else { Table2::BYTES };
    map.request(bytes, "the sampling table")?;
    let sampler: Box<dyn DirectionSampler> = match method {
        Method::Cdf => Box::new(CdfSampler::new(map.clone())),
        Method::Alias => Box::new(AliasSampler::new(map.clone())),
        Method::Compensated => Box::new(CompensatedSampler::new(map.clone())),
        Method::Report => Box::new(ReportSampler::new(map.clone())),
    };
    let numbers: Vec<[f64; 2]> = (0..n).map(|i| Independent::new(seed, 0, i as u32).pair(0)).collect();
    let mut sampled = EnvSamples::default();
    sampler.sample_many(&numbers, &mut sampled);
    let samples: Vec<EnvSample> = sampled.iter().collect();
    let estimate = |s: &EnvSample| intensity(s.radiance) / s.pdf;
    let row = |s: &EnvSample| {
        let (x, y) = map.geometry().position(s.wi);
        Row {
            x,
            y,
            dir_x: s.wi.x,
            dir_y: s.wi.y,
            dir_z: s.wi.z,
            pdf: s.pdf,
            r: s.radiance.x,
            g: s.radiance.y,
            b: s.radiance.z,
        }
    };
    Ok(MapSamples {
        flux_estimate: samples.iter().map(estimate).sum::<f64>() / n as f64,
        pdf_mismatches: samples.iter().filter(|s| s.pdf.to_bits() != sampler.pdf(s.wi).to_bits()).count(),
        rows: samples.iter().map(row).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::synthetic::Synthetic;

    #[test]
    fn every_method_takes_as_many_samples_as_asked() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        for method in [Method::Cdf, Method::Alias, Method::Compensated, Method::Report] {
            let samples = draw(&map, method, 256, 1).unwrap();
            assert_eq!(samples.rows.len(), 256);
            assert_eq!(samples.rows, draw(&map, method, 256, 1).unwrap().rows);
            assert!(method == Method::Report || samples.pdf_mismatches == 0);
        }
        assert!(draw(&map, Method::Cdf, 0, 1).is_err());
    }

    #[test]
    fn a_perfect_pdf_estimates_the_flux_without_noise() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let info = crate::envmap::info::Info::of(&map);
        let flux = info.flux_rgb.iter().sum::<f64>() / 3.0;
        let estimate = draw(&map, Method::Cdf, 16, 7).unwrap().flux_estimate;
        assert!((estimate / flux - 1.0).abs() < 1e-6, "{estimate} against {flux}");
    }

    #[test]
    fn a_black_map_has_no_samples() {
        let map = Arc::new(EnvMap::new(Synthetic::Black.make()));
        assert!(draw(&map, Method::Cdf, 64, 1).unwrap().rows.is_empty());
    }
}
