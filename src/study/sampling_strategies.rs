//! Directions sampled in proportion to the BSDF, and uniformly over the hemisphere: the same mean, but very different medians
//! and noise. Measured by distance from the statue's silhouette, where the second report saw a dark rim.

use super::object_ids::Kind;
use super::pixel_mean::{Mean, inside};
use super::roughness::{StatueRender, render_statue};
use crate::bsdf::NormalSampling;
use crate::errata::Conventions;
use crate::error::Result;
use crate::raster::{Image, ToneMap, to_rgb8};
use crate::render::Settings;
use crate::scene::{Request, Scene};
use serde::Serialize;

/// How far from the silhouette the profile goes, in pixels: into the statue, and out of it.
const INSIDE: i32 = 24;
const OUTSIDE: i32 = 6;
/// Width of the statue's rim in pixels.
pub const RIM: f64 = 3.0;

/// All pixels at about the same distance from the silhouette. Field names are the CSV columns. Distances are negative
/// outside the statue; radiance is (R + G + B) / 3.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ProfileBin {
    /// Lower end of the distances.
    pub from_px: f64,
    /// Upper end of the distances.
    pub to_px: f64,
    /// Pixels at these distances.
    pub pixels: usize,
    /// Mean radiance by importance sampling.
    pub importance_mean: f64,
    /// Mean radiance by hemisphere sampling.
    pub hemisphere_mean: f64,
    /// Standard errors of these means.
    pub importance_mean_error: f64,
    /// By hemisphere sampling.
    pub hemisphere_mean_error: f64,
    /// Half of the pixels are darker.
    pub importance_median: f64,
    /// By hemisphere sampling.
    pub hemisphere_median: f64,
    /// Mean 8-bit value of the tone-mapped image.
    pub importance_shown: f64,
    /// By hemisphere sampling.
    pub hemisphere_shown: f64,
    /// Root of the mean square of the pixels' standard errors.
    pub importance_error: f64,
    /// By hemisphere sampling.
    pub hemisphere_error: f64,
}

/// Both images and their profile.
pub struct StrategyComparison {
    /// By importance sampling.
    pub importance: StatueRender,
    /// By hemisphere sampling.
    pub hemisphere: StatueRender,
    /// By distance from the silhouette.
    pub profile: Vec<ProfileBin>,
    /// Difference of the means over the whole image, the statue, and the statue's rim, in units of its standard error.
    pub z_picture: f64,
    /// Over the statue.
    pub z_statue: f64,
    /// Over its rim.
    pub z_rim: f64,
}

impl StrategyComparison {
    /// The sum of the medians over the statue's rim, hemisphere sampling over importance sampling.
    pub fn rim_median_ratio(&self) -> f64 {
        let rim = || self.profile.iter().filter(|bin| bin.from_px >= 0.0 && bin.to_px <= RIM);
        rim().map(|bin| bin.hemisphere_median).sum::<f64>() / rim().map(|bin| bin.importance_median).sum::<f64>()
    }

    /// Noise on the statue, importance sampling over hemisphere sampling.
    pub fn noise_ratio(&self) -> f64 {
        self.importance.row.noise / self.hemisphere.row.noise
    }
}

/// Renders the scene twice, with independent random numbers.
pub fn compare(scene: &Scene, request: &Request, settings: &Settings) -> Result<StrategyComparison> {
    let shot = |normals: NormalSampling, offset: u64| {
        let mut settings = Settings { seed: settings.seed.wrapping_add(offset), ..*settings };
        settings.model.normals = normals;
        render_statue(scene, request, &settings)
    };
    let (importance, hemisphere) = (shot(NormalSampling::Vndf, 0)?, shot(NormalSampling::Hemisphere, 1)?);
    let z = |mask: &[bool]| {
        let [one, other] = [&importance, &hemisphere].map(|s| Mean::of(&s.rendered.part.film, mask));
        one.z(&other)
    };
    // Signed distances from the silhouette give the rim and the bins of the profile.
    let depth = importance.objects.depth_inside(&importance.mask, (INSIDE + 1) as usize);
    let rim: Vec<bool> = depth.iter().map(|d| (0.0..RIM).contains(&from_silhouette(*d))).collect();
    let (z_picture, z_statue, z_rim) = (z(&vec![true; depth.len()]), z(&importance.mask), z(&rim));
    let profile = profile(&importance, &hemisphere, &depth);
    Ok(StrategyComparison { importance, hemisphere, profile, z_picture, z_statue, z_rim })
}

/// The silhouette runs half-way between the centres of a pixel of the statue and its neighbour outside.
fn from_silhouette(depth: f64) -> f64 {
    if depth > 0.0 { depth - 0.5 } else { depth + 0.5 }
}

/// Both images at each distance from the silhouette.
fn profile(importance: &StatueRender, hemisphere: &StatueRender, depth: &[f64]) -> Vec<ProfileBin> {
    let shown: Vec<bool> =
        importance.objects.pixels.iter().map(|k| matches!(k, Some(Kind::Metal | Kind::Diffuse))).collect();
    let bins = (-OUTSIDE..INSIDE).filter_map(|from| {
        let (from_px, to_px) = (f64::from(from), f64::from(from + 1));
        let mask: Vec<bool> = depth
            .iter()
            .zip(&shown)
            .map(|(&d, &here)| here && (from_px..to_px).contains(&from_silhouette(d)))
            .collect();
        if !mask.contains(&true) {
            return None;
        }
        let [a, b] = [importance, hemisphere].map(|s| Side::of(s, &mask));
        Some(ProfileBin {
            from_px,
            to_px,
            pixels: a.mean.pixels,
            importance_mean: a.mean.mean_rgb(),
            hemisphere_mean: b.mean.mean_rgb(),
            importance_mean_error: a.mean_error(),
            hemisphere_mean_error: b.mean_error(),
            importance_median: a.median,
            hemisphere_median: b.median,
            importance_shown: a.shown,
            hemisphere_shown: b.shown,
            importance_error: a.error,
            hemisphere_error: b.error,
        })
    });
    bins.collect()
}

struct Side {
    mean: Mean,
    median: f64,
    shown: f64,
    error: f64,
}

impl Side {
    fn mean_error(&self) -> f64 {
        // The channels of a sample are correlated: their errors do not average out.
        self.mean.error.iter().sum::<f64>() / 3.0
    }

    fn of(shot: &StatueRender, mask: &[bool]) -> Self {
        let film = &shot.rendered.part.film;
        let mean = Mean::of(film, mask);
        let mut values = Vec::with_capacity(mean.pixels);
        let mut square = 0.0;
        for estimate in inside(film.estimates(), mask) {
            values.push(estimate.mean);
            square += (f64::from(estimate.error.element_sum()) / 3.0).powi(2);
        }
        let shown =
            to_rgb8(&Image::from_pixels(values.len(), 1, values.clone()), &ToneMap::By(Conventions::SECOND_REPORT));
        // Median and mean 8-bit value of the pixels.
        let mut light: Vec<f64> = values.iter().map(|v| f64::from(v.element_sum()) / 3.0).collect();
        light.sort_unstable_by(f64::total_cmp);
        Self {
            mean,
            median: light[light.len() / 2],
            shown: shown.iter().map(|&v| f64::from(v)).sum::<f64>() / shown.len() as f64,
            error: (square / values.len() as f64).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn both_agree_and_one_is_noisier() {
        let (scene, request) = builtin::find("cornell-statue-cu").unwrap().make(None, None).unwrap();
        let request = Request { width: 64, height: 48, spp: 16, light_samples: 1, ..request };
        let result = compare(&scene, &request, &Settings::default()).unwrap();
        assert!(result.z_picture.abs() < 4.0 && result.z_statue.abs() < 4.0 && result.z_rim.abs() < 4.0);
        assert!(result.hemisphere.row.noise > 2.0 * result.importance.row.noise);
        let rim: Vec<&ProfileBin> = result.profile.iter().filter(|b| b.from_px >= 0.0 && b.to_px <= RIM).collect();
        assert_eq!(rim.len(), 3);
        assert!(rim.iter().all(|b| b.hemisphere_median < 0.5 * b.importance_median), "{rim:?}");
        let total: usize = result.profile.iter().map(|b| b.pixels).sum();
        assert!(total > 500 && total < 64 * 48);
    }
}
