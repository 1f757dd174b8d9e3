//! Directions sampled in proportion to the BSDF, and uniformly over the hemisphere: the same mean, but very different medians
//! and noise. Measured by distance from the statue's silhouette, where the second report saw a dark rim.

use super::roughness::{StatueRender, render_statue};
use crate::object_ids::{Kind, PixelMean, inside};
use etalon_core::bsdf::NormalSampling;
use etalon_core::error::Result;
use etalon_core::raster::{Image, ToneMap, to_rgb8};
use etalon_core::scene::{Request, Scene};
use etalon_render::Settings;

/// How far from the silhouette the profile goes, in pixels: into the statue, and out of it.
const INSIDE: i32 = 24;
const OUTSIDE: i32 = 6;
/// Width of the statue's rim in pixels.
pub const RIM: f64 = 3.0;
/// Pixels of the statue deeper than this are its interior.
const INTERIOR: f64 = 2.0 * RIM;

/// All pixels at about the same distance from the silhouette, in pixels; it is negative outside the statue.
pub struct ProfileBin {
    pub from_px: f64,
    pub to_px: f64,
    pub zone: Zone,
}

pub struct StrategyComparison {
    pub importance: StatueRender,
    pub hemisphere: StatueRender,
    /// By distance from the silhouette.
    pub profile: Vec<ProfileBin>,
    /// The whole image.
    pub picture: Zone,
    pub statue: Zone,
    /// The pixels of the statue next to its silhouette.
    pub rim: Zone,
    /// Its pixels away from the silhouette.
    pub interior: Zone,
}

/// Some of the pixels by importance sampling and by hemisphere sampling.
pub struct Zone {
    pub importance: ZoneImage,
    pub hemisphere: ZoneImage,
    /// Difference of the means in units of its standard error.
    pub z: f64,
}

impl Zone {
    /// The row of two images by either strategy.
    fn of(pairs: &[Pair; 2], mask: &[bool]) -> Self {
        let [importance, hemisphere] = pairs.each_ref().map(|pair| ZoneImage::of(pair, mask));
        let z = importance.mean.z(&hemisphere.mean);
        Self { importance, hemisphere, z }
    }

    /// A quantity by hemisphere sampling over that by importance sampling, with its standard error.
    pub fn ratio(&self, of: impl Fn(&ZoneImage) -> [f64; 2]) -> [f64; 2] {
        quotient(of(&self.hemisphere), of(&self.importance))
    }
}

/// The quotient of two independent numbers with standard errors.
pub fn quotient([a, a_error]: [f64; 2], [b, b_error]: [f64; 2]) -> [f64; 2] {
    let ratio = a / b;
    [ratio, (a_error / b).hypot(ratio * b_error / b)]
}

/// Renders the scene twice by either strategy, with independent random numbers.
pub fn compare(scene: &Scene, request: &Request, settings: &Settings) -> Result<StrategyComparison> {
    let shot = |normals: NormalSampling, offset: u64| {
        let mut settings = Settings { seed: settings.seed.wrapping_add(offset), ..*settings };
        settings.model.normals = normals;
        render_statue(scene, request, &settings)
    };
    let (importance, hemisphere) = (shot(NormalSampling::Vndf, 0)?, shot(NormalSampling::Hemisphere, 1)?);
    let again = [shot(NormalSampling::Vndf, 2)?, shot(NormalSampling::Hemisphere, 3)?];
    let pairs = [Pair::new(&importance, &again[0]), Pair::new(&hemisphere, &again[1])];
    let zone = |mask: &[bool]| Zone::of(&pairs, mask);
    // Signed distances from the silhouette give the rim and the bins of the profile.
    let depth = importance.objects.depth_inside(&importance.mask, (INSIDE + 1) as usize);
    let rim: Vec<bool> = depth.iter().map(|d| (0.0..RIM).contains(&from_silhouette(*d))).collect();
    let interior: Vec<bool> = depth.iter().map(|d| from_silhouette(*d) >= INTERIOR).collect();
    let [picture, statue] = [&vec![true; depth.len()], &importance.mask].map(|mask| zone(mask));
    let [rim, interior] = [rim, interior].map(|mask| zone(&mask));
    let profile = profile(&pairs, &depth);
    Ok(StrategyComparison { importance, hemisphere, profile, picture, statue, rim, interior })
}

/// The silhouette runs half-way between the centres of a pixel of the statue and its neighbour outside.
fn from_silhouette(depth: f64) -> f64 {
    if depth > 0.0 { depth - 0.5 } else { depth + 0.5 }
}

/// Both images at each distance from the silhouette.
fn profile(pairs: &[Pair; 2], depth: &[f64]) -> Vec<ProfileBin> {
    let shown: Vec<bool> =
        pairs[0].shot.objects.pixels.iter().map(|k| matches!(k, Some(Kind::Metal | Kind::Diffuse))).collect();
    let bins = (-OUTSIDE..INSIDE).filter_map(|from| {
        let (from_px, to_px) = (f64::from(from), f64::from(from + 1));
        let mask: Vec<bool> = depth
            .iter()
            .zip(&shown)
            .map(|(&d, &here)| here && (from_px..to_px).contains(&from_silhouette(d)))
            .collect();
        mask.contains(&true).then(|| ProfileBin { from_px, to_px, zone: Zone::of(pairs, &mask) })
    });
    bins.collect()
}

/// Two images by one strategy.
struct Pair<'a> {
    shot: &'a StatueRender,
    /// Mean 8-bit values of the tone-mapped pixels of either.
    brightness: [Vec<f64>; 2],
}

impl<'a> Pair<'a> {
    fn new(shot: &'a StatueRender, other: &StatueRender) -> Self {
        Self { shot, brightness: [shot, other].map(|shot| brightness(&shot.image)) }
    }
}

/// Some of the pixels of one image: numbers with standard errors. Those of median, brightness and noise are upper bounds: they count
/// the differences between pixels as chance, too.
pub struct ZoneImage {
    pub mean: PixelMean,
    /// Median radiance of the pixels.
    pub median: [f64; 2],
    /// Mean 8-bit value of the tone-mapped pixels.
    pub shown: [f64; 2],
    /// Root of the mean square of the pixels' standard errors.
    pub noise: [f64; 2],
    /// The noise that is seen: root of the mean square of the 8-bit values' difference from those of the other image, over √2.
    pub shown_noise: [f64; 2],
}

/// The root of the mean of `n` squares, of their sum and the sum of their squares, with its standard error at most.
fn root_mean(sum: f64, sum_of_squares: f64, n: f64) -> [f64; 2] {
    let root = (sum / n).sqrt();
    // The root halves the relative error of the mean
    [root, if sum > 0.0 { 0.5 * root * sum_of_squares.sqrt() / sum } else { 0.0 }]
}

/// Mean 8-bit values of tone-mapped pixels.
fn brightness(image: &Image) -> Vec<f64> {
    let bytes = to_rgb8(image, &ToneMap::SecondReport);
    bytes.chunks_exact(3).map(|rgb| rgb.iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0).collect()
}

impl ZoneImage {
    pub fn light(&self) -> [f64; 2] {
        // The channels of a sample are correlated: their errors do not average out.
        [self.mean.mean_rgb(), self.mean.error.iter().sum::<f64>() / 3.0]
    }

    fn of(pair: &Pair, mask: &[bool]) -> Self {
        let mean = PixelMean::of(pair.shot.estimates(), mask);
        let n = mean.pixels as f64;
        let (mut light, mut variance, mut squares) = (Vec::with_capacity(mean.pixels), 0.0, 0.0);
        for estimate in inside(pair.shot.estimates(), mask) {
            light.push(f64::from(estimate.mean.element_sum()) / 3.0);
            let square = (f64::from(estimate.error.element_sum()) / 3.0).powi(2);
            variance += square;
            squares += square * square;
        }
        let [shown, seen] =
            pair.brightness.each_ref().map(|all| inside(all.iter().copied(), mask).collect::<Vec<f64>>());
        let differences = || shown.iter().zip(&seen).map(|(a, b)| (a - b).powi(2) / 2.0);
        let shown_noise = root_mean(differences().sum(), differences().map(|d| d * d).sum(), n);
        let mean_shown = shown.iter().sum::<f64>() / n;
        let shown_error = shown.iter().map(|v| (v - mean_shown).powi(2)).sum::<f64>().sqrt() / n;
        // The number of pixels below the median has a standard deviation of √n/2
        light.sort_unstable_by(f64::total_cmp);
        let (middle, ranks) = (light.len() / 2, (n.sqrt() / 2.0).ceil() as usize);
        let [low, high] = [middle.saturating_sub(ranks), (middle + ranks).min(light.len() - 1)];
        Self {
            mean,
            median: [light[middle], 0.5 * (light[high] - light[low])],
            shown: [mean_shown, shown_error],
            noise: root_mean(variance, squares, n),
            shown_noise,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn a_quotient_has_the_relative_errors_of_both() {
        assert_eq!(quotient([6.0, 0.0], [2.0, 0.2]), [3.0, 3.0 * 0.1]);
        assert_eq!(quotient([0.0, 0.5], [2.0, 0.2]), [0.0, 0.25]);
    }

    #[test]
    fn both_agree_and_one_is_noisier() {
        let (scene, request) = builtin::find("cornell-statue-cu").unwrap().make(None, None).unwrap();
        let request = Request { width: 64, height: 48, spp: 16, light_samples: 1, ..request };
        let result = compare(&scene, &request, &Settings::default()).unwrap();
        assert!([&result.picture, &result.statue, &result.rim].iter().all(|zone| zone.z.abs() < 4.0));
        assert!(result.statue.ratio(|image| image.noise)[0] > 2.0);
        assert_eq!(result.statue.importance.noise[0], result.importance.row.noise);
        let rim: Vec<&ProfileBin> = result.profile.iter().filter(|b| b.from_px >= 0.0 && b.to_px <= RIM).collect();
        assert_eq!(rim.len(), 3);
        let medians = rim.iter().map(|b| b.zone.ratio(|image| image.median)[0]);
        assert!(medians.clone().all(|ratio| ratio < 0.5), "{:?}", medians.collect::<Vec<_>>());
        let total: usize = result.profile.iter().map(|b| b.zone.importance.mean.pixels).sum();
        assert!(total > 500 && total < 64 * 48);
    }
}
