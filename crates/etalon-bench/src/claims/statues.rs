//! The second report's claims on statues: the roughness of gold, what it mirrors, and two ways to sample copper.

use super::seen::{farthest, sights};
use super::{Bound, Claim, Finding, Text, VISIBLE, texts};
use crate::object_ids::inside;
use crate::roughness::StatueRender;
use crate::sampling_strategies::{StrategyComparison, Zone, ZoneImage, quotient};
use Bound::{AtLeast, AtMost};
use etalon_core::math::mean_rgb;
use etalon_core::optics::conductor;
use etalon_core::optics::metals::GOLD;
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::sampling::warp;
use etalon_core::scene::{Request, Scene};
use etalon_stats::Extremes;
use glam::DVec3;

/// What the claims on gold are tested on.
pub struct StatueInputs<'a> {
    /// The scene of the smoothest statue.
    pub scene: &'a Scene,
    pub request: &'a Request,
    /// Statues of gold of increasing roughness.
    pub statues: &'a [&'a StatueRender],
}

/// Pixels below this share of the statue's mean are black.
const BLACK: f64 = 0.1;

pub fn statue_claims(inputs: &StatueInputs) -> Vec<Claim> {
    let [smooth, .., rough] = inputs.statues else { return Vec::new() };
    let shares: Vec<[f64; 2]> = inputs.statues.iter().map(|statue| brightest(statue)).collect();
    let list: Vec<String> = shares.iter().map(|[share, _]| format!("{:.1} %", 100.0 * share)).collect();
    let steps = shares.windows(2).map(|pair| quotient(pair[1], pair[0]));
    let largest = steps.max_by(|a, b| a[0].total_cmp(&b[0])).unwrap_or([f64::NAN; 2]);
    let [at_rough, at_smooth] = [rough, smooth].map(|statue| from_gold(statue));
    let less = |what: String, value| [Finding::estimated(what, value, AtMost(1.0))];
    let (mirrored, right_wall) =
        (sights(inputs.scene, inputs.request), farthest(inputs.scene, inputs.scene.camera.right));
    let regions = |text: Text, is_chosen: &dyn Fn(DVec3, f64) -> bool, what: [&str; 2], seen: Option<usize>| {
        let [(few, few_error), (many, error)] = [rough, smooth].map(|statue| chosen(statue, is_chosen));
        let count = |holds: &dyn Fn(usize) -> bool| (0..many.len()).filter(|&i| holds(i)).count() as f64;
        let (total, number) = (smooth.statue.pixels as f64, count(&|i| many[i]));
        let few_share = count(&|i| few[i]) / total;
        let named = format!("{} at α = 0.005 (α = 0.5: {:.1} %)", what[0], 100.0 * few_share);
        let [share, error_of_share] = [number, error.hypot(few_error)].map(|pixels| pixels / total);
        let share_of_them =
            [count(&|i| many[i] && mirrored[i].object == seen), error].map(|pixels| pixels / number.at_least(1.0));
        text.with([
            Finding::estimated(named, [share, error_of_share], AtLeast(few_share + VISIBLE)).in_percent(),
            Finding::estimated(format!("of them, those that mirror {}", what[1]), share_of_them, AtLeast(0.5))
                .in_percent(),
        ])
    };
    let is_black = |p: DVec3, mean: f64| p.element_sum() / 3.0 < BLACK * mean;
    // Gold reflects less blue than red: bluish pixels are blue by what they mirror.
    let is_blue = |p: DVec3, mean: f64| p.z > p.x && !is_black(p, mean);
    vec![
        texts::DIFFUSE.with(less(
            format!("light in the brightest hundredth ({}), over that of the smoother one, largest", list.join(", ")),
            largest,
        )),
        regions(texts::BLACK_REGIONS, &is_black, ["black pixels (below a tenth of the mean)", "the open side"], None),
        regions(texts::BLUE_REGIONS, &is_blue, ["pixels with more blue than red", "the blue wall"], right_wall),
        texts::GOLDEN.with(less(
            format!(
                "mean distance of the chromaticity from gold's at α = 0.5 ({:.3}), over that at 0.005 ({:.3})",
                at_rough[0], at_smooth[0]
            ),
            quotient(at_rough, at_smooth),
        )),
    ]
}

/// The share of the statue's light in the brightest hundredth of its pixels, with a standard error from those of the pixels.
fn brightest(statue: &StatueRender) -> [f64; 2] {
    let share = statue.row.brightest_percent;
    let estimates = inside(statue.estimates(), &statue.mask);
    let mut pixels: Vec<[f64; 2]> = estimates.map(|e| [mean_rgb(e.mean), mean_rgb(e.error)]).collect();
    pixels.sort_unstable_by(|a, b| b[0].total_cmp(&a[0]));
    let count = pixels.len().div_ceil(100);
    let total: f64 = pixels.iter().map(|[light, _]| light).sum();
    // A bright pixel adds to both parts of the quotient, another one to the whole alone
    let weight = |i: usize| if i < count { 1.0 - share } else { share };
    let variance: f64 = pixels.iter().enumerate().map(|(i, [_, error])| (weight(i) * error).powi(2)).sum();
    [share, variance.sqrt() / total]
}

/// The pixels of a statue whose colours, beside the statue's mean, are chosen, and the standard error of their number.
fn chosen(statue: &StatueRender, is_chosen: &dyn Fn(DVec3, f64) -> bool) -> (Vec<bool>, f64) {
    let mean = statue.statue.mean_rgb();
    // Pixels that two standard errors would change; a choice by chance has a variance of ¼ at most
    let changes = [DVec3::ONE, DVec3::NEG_ONE, DVec3::new(1.0, 0.0, -1.0), DVec3::new(-1.0, 0.0, 1.0)];
    let (mut pixels, mut undecided) = (Vec::new(), 0.0);
    for (estimate, inside) in statue.estimates().zip(&statue.mask) {
        let (colour, error) = (estimate.mean.as_dvec3(), estimate.error.as_dvec3());
        let holds = is_chosen(colour, mean);
        let may_change = changes.iter().any(|change| is_chosen(colour + 2.0 * *change * error, mean) != holds);
        undecided += f64::from(u8::from(*inside && may_change));
        pixels.push(*inside && holds);
    }
    (pixels, undecided.sqrt() / 2.0)
}

/// The spread of the pixels' colours around gold's: mean distance of their chromaticities, with its standard error.
fn from_gold(statue: &StatueRender) -> [f64; 2] {
    let share = |c: DVec3| c / c.element_sum();
    let gold = [0, 1, 2].map(|c| conductor::normal_reflectance(GOLD.eta[c], GOLD.k[c]));
    let gold = share(DVec3::from_array(gold));
    let lit = inside(statue.image.pixels(), &statue.mask).filter(|p| mean_rgb(**p) > 0.0);
    let distances: Vec<f64> = lit.map(|p| (share(p.as_dvec3()) - gold).length()).collect();
    let n = distances.len() as f64;
    let mean = distances.iter().sum::<f64>() / n;
    [mean, distances.iter().map(|d| (d - mean).powi(2)).sum::<f64>().sqrt() / n]
}

/// Tests the claims on a statue of copper by importance and by hemisphere sampling.
pub fn sampling_claims(sampling: &StrategyComparison) -> Vec<Claim> {
    /// The silhouette is seen at nearly 90°.
    const RIM_DEG: f64 = 85.0;
    let [rim, interior] = [&sampling.rim, &sampling.interior].map(|zone| zone.ratio(|image| image.shown));
    let line = format!(
        "brightness of the rim in the image, hemisphere over importance sampling ({:.2}), over the same of the interior \
         ({:.2}): of a line",
        rim[0], interior[0]
    );
    let median = "median radiance of the rim (3 pixels), hemisphere over importance sampling";
    let alpha = f64::from(sampling.importance.row.alpha);
    let ([angle, at_rim], [_, facing]) = (half_vectors(RIM_DEG, alpha), half_vectors(0.0, alpha));
    let from_45 = format!("mean angle of the half-vector, seen at {RIM_DEG}° ({angle:.0}°): distance from 45°");
    let above =
        format!("share of directions with D above 1 % of its peak ({:.2} %), over that seen at 0°", 100.0 * at_rim);
    let light = "mean light of the rim, hemisphere over importance sampling: no light is missing";
    let noise = |what: &str, zone: &Zone| {
        let what = format!("noise in the 8-bit values {what}, hemisphere over importance sampling");
        Finding::estimated(what, zone.ratio(|image| image.shown_noise), AtLeast(1.0))
    };
    vec![
        texts::BLACK_LINE.with([
            Finding::estimated(median, sampling.rim.ratio(|image| image.median), AtMost(0.5)),
            Finding::estimated(line, quotient(rim, interior), AtMost(1.0 - VISIBLE)),
        ]),
        texts::EXPLANATION.with([
            Finding::exact(from_45, (angle - 45.0).abs(), AtMost(5.0)).in_degrees(),
            Finding::exact(above, at_rim / facing, AtMost(0.5)),
            Finding::estimated(light, sampling.rim.ratio(ZoneImage::light), AtMost(0.5)),
        ]),
        texts::LESS_NOISE
            .with([noise("of the metal's pixels", &sampling.statue), noise("of all pixels", &sampling.picture)]),
    ]
}

/// Uniform directions of the hemisphere seen at an angle: mean angle of the half-vector in degrees, and the share of directions
/// where D is above a hundredth of its peak.
fn half_vectors(view_deg: f64, alpha: f64) -> [f64; 2] {
    const STEPS: u32 = 400;
    let (sin, cos) = view_deg.to_radians().sin_cos();
    let (wo, facets) = (DVec3::new(sin, 0.0, cos), Beckmann::new(alpha));
    let peak = facets.d([0.0, 0.0, 1.0]);
    let (mut angle, mut above) = (0.0, 0.0);
    for i in 0..STEPS * STEPS {
        let at = |n: u32| (f64::from(n) + 0.5) / f64::from(STEPS);
        let half = (wo + warp::uniform_hemisphere([at(i % STEPS), at(i / STEPS)])).normalize();
        angle += half.z.at_most(1.0).acos().to_degrees();
        above += f64::from(u8::from(facets.d(half.to_array()) > 0.01 * peak));
    }
    [angle, above].map(|sum| sum / f64::from(STEPS * STEPS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_vectors_seen_from_above_are_half_as_far_off_the_normal() {
        // The mean angle of uniform directions is 1 rad.
        let [angle, share] = half_vectors(0.0, 0.05);
        assert!((angle - 0.5f64.to_degrees()).abs() < 0.01, "{angle}");
        // D is a hundredth of its peak at tan θ = α √ln 100, except for cos⁴ θ.
        let limit = (0.05 * 100f64.ln().sqrt()).atan();
        assert!((share / (1.0 - (2.0 * limit).cos()) - 1.0).abs() < 0.05, "{share}");
    }
}
