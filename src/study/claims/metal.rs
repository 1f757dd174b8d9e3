//! The second report's claims on metal: indices, roughness, colour, and how it is sampled.

use super::claim::{Bound, Claim, Finding, Unit, VISIBLE};
use super::glass::squared_amplitudes_error;
use crate::math::mean_rgb;
use crate::optics::metals::{GOLD, IRON, WAVELENGTHS_NM};
use crate::optics::microfacet::{Beckmann, Microfacet};
use crate::sampling::warp;
use crate::scene::{Bvh, Material, Ray, Request, Scene, Shape};
use crate::study::metal::MetalTable;
use crate::study::pixel_mean::inside;
use crate::study::roughness::StatueRender;
use crate::study::sampling_strategies::{RIM, StrategyComparison};
use glam::DVec3;

/// What the claims on gold are tested on.
pub struct StatueInputs<'a> {
    /// The scene of the smoothest statue.
    pub scene: &'a Scene,
    /// Its request.
    pub request: &'a Request,
    /// Statues of gold of increasing roughness.
    pub statues: &'a [&'a StatueRender],
}

/// Pixels below this share of the statue's mean are black.
const BLACK: f64 = 0.1;

/// Tests the claims on formulas and indices, which no scene has a part in.
pub fn metal_claims(metals: &MetalTable) -> Vec<Claim> {
    vec![amplitude(), iron(), approximation(metals)]
}

/// Tests the claims on statues of gold.
pub fn statue_claims(inputs: &StatueInputs) -> Vec<Claim> {
    let [smooth, .., rough] = inputs.statues else { return Vec::new() };
    vec![diffuse(inputs.statues), black(inputs, smooth, rough), blue(inputs, smooth, rough), golden(smooth, rough)]
}

/// Tests the claims on a statue of copper by importance and by hemisphere sampling.
pub fn sampling_claims(sampling: &StrategyComparison) -> Vec<Claim> {
    vec![dark_line(sampling), explanation(sampling), noise(sampling)]
}

fn amplitude() -> Claim {
    Claim {
        place: "text",
        claim: "The reflectance is the square of the amplitude r.",
        findings: vec![Finding::exact(
            "largest difference from it, both sides of glass",
            squared_amplitudes_error(),
            Unit::Plain,
            Bound::AtMost(1e-12),
        )],
        evidence: &["fresnel-enter", "fresnel-exit"],
        ..Claim::default()
    }
}

fn iron() -> Claim {
    let measured = IRON.published.iter().zip(WAVELENGTHS_NM).enumerate();
    let difference = |(channel, ([low, high], nm)): (usize, (&[[f64; 3]; 2], f64))| {
        let t = (nm - low[0]) / (high[0] - low[0]);
        let [eta, k] = [1, 2].map(|i| low[i] + t * (high[i] - low[i]));
        (IRON.eta[channel] - eta).abs().max((IRON.k[channel] - k).abs())
    };
    Claim {
        place: "Table 1",
        claim: "Iron at 614, 549 and 466 nm.",
        number: "2.8851 + 3.0449i, 2.9500 + 2.9300i, 2.6500 + 2.8095i",
        findings: vec![Finding::exact(
            "largest difference of η or k from Johnson & Christy, interpolated (their last digit: 0.01)",
            measured.map(difference).fold(0.0, f64::max),
            Unit::Plain,
            Bound::AtMost(0.005),
        )],
        evidence: &["metals-table", "iron"],
        ..Claim::default()
    }
}

fn approximation(metals: &MetalTable) -> Claim {
    let percent = |what: &str, value| Finding::exact(what, value, Unit::Percent, Bound::AtMost(VISIBLE));
    Claim {
        place: "text",
        claim: "The conductor formulas for |n|² ≫ 1 do for these metals.",
        findings: vec![
            percent("largest error of a reflectance, all metals and angles", metals.approximation_error()),
            percent("largest relative error of an albedo", metals.albedo_error()),
        ],
        evidence: &["metals-table", "audit"],
        ..Claim::default()
    }
}

fn diffuse(statues: &[&StatueRender]) -> Claim {
    let shares: Vec<f64> = statues.iter().map(|s| s.row.brightest_percent).collect();
    let list: Vec<String> = shares.iter().map(|share| format!("{:.1} %", 100.0 * share)).collect();
    let ratio = shares.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
    Claim {
        place: "Fig. 2",
        claim: "The higher the roughness, the more diffuse the dragon.",
        number: "α = 0.005, 0.05, 0.25, 0.5",
        findings: vec![Finding::exact(
            format!("light in the brightest hundredth ({}), over that of the smoother one, largest", list.join(", ")),
            ratio,
            Unit::Times,
            Bound::AtMost(1.0),
        )],
        evidence: &["roughness-0.005", "roughness-0.5"],
        ..Claim::default()
    }
}

/// What the metal of a pixel mirrors.
#[derive(Clone, Copy, PartialEq)]
enum Mirrored {
    /// The open side of the box.
    Outside,
    BlueWall,
    Other,
}

/// What each pixel of the statue mirrors, along the reflected ray through its centre.
fn mirrored(inputs: &StatueInputs, mask: &[bool]) -> Vec<Mirrored> {
    const REFLECTIONS: usize = 4;
    let Request { width, height, .. } = *inputs.request;
    let shapes: Vec<&Shape> = inputs.scene.objects.iter().map(|object| &object.shape).collect();
    let bvh = Bvh::build(&shapes);
    let of_pixel = |i: usize| {
        let at = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
        let mut ray = inputs.scene.camera.ray(at[0] / width as f64, at[1] / height as f64);
        for _ in 0..=REFLECTIONS {
            let Some(hit) = bvh.nearest(&ray, f32::INFINITY) else { return Mirrored::Outside };
            match inputs.scene.objects[hit.shape as usize].material {
                Material::Conductor(_) => {
                    let surface = bvh.surface(hit.place, hit.u, hit.v);
                    let normal = surface.shading;
                    let direction = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
                    let offset = 1e-4f32.copysign(direction.dot(surface.normal));
                    ray = Ray { origin: surface.point + offset * surface.normal, direction: direction.normalize() };
                }
                Material::Diffuse { albedo } if albedo.z > 1.5 * albedo.x => return Mirrored::BlueWall,
                _ => return Mirrored::Other,
            }
        }
        Mirrored::Other
    };
    (0..mask.len()).map(|i| if mask[i] { of_pixel(i) } else { Mirrored::Other }).collect()
}

/// The share of the statue's pixels for which `holds` of their colour and the statue's mean is true, and which these are.
fn selected(statue: &StatueRender, holds: impl Fn(DVec3, f64) -> bool) -> (f64, Vec<bool>) {
    let pixels = statue.rendered.image.pixels();
    let mean = inside(pixels, &statue.mask).map(|p| mean_rgb(*p)).sum::<f64>() / statue.statue.pixels as f64;
    let chosen: Vec<bool> = pixels.iter().zip(&statue.mask).map(|(p, m)| *m && holds(p.as_dvec3(), mean)).collect();
    let count = chosen.iter().filter(|c| **c).count();
    (count as f64 / statue.statue.pixels as f64, chosen)
}

/// The share of the chosen pixels that mirror this.
fn share_of(chosen: &[bool], mirrored: &[Mirrored], what: Mirrored) -> f64 {
    let count = chosen.iter().filter(|c| **c).count().max(1) as f64;
    chosen.iter().zip(mirrored).filter(|(c, m)| **c && **m == what).count() as f64 / count
}

fn black(inputs: &StatueInputs, smooth: &StatueRender, rough: &StatueRender) -> Claim {
    let is_black = |p: DVec3, mean: f64| p.element_sum() / 3.0 < BLACK * mean;
    let ((share, chosen), (rough_share, _)) = (selected(smooth, is_black), selected(rough, is_black));
    let outside = share_of(&chosen, &mirrored(inputs, &smooth.mask), Mirrored::Outside);
    let finding = |what: String, value, bound| Finding::exact(what, value, Unit::Percent, bound);
    Claim {
        place: "Fig. 2a",
        claim: "At low roughness there are black regions, where the dragon mirrors the observer's side.",
        findings: vec![
            finding(
                format!(
                    "black pixels (below a tenth of the mean) at α = 0.005 (α = 0.5: {:.1} %)",
                    100.0 * rough_share
                ),
                share,
                Bound::AtLeast(rough_share + VISIBLE),
            ),
            finding("of them, those that mirror the open side".into(), outside, Bound::AtLeast(0.5)),
        ],
        evidence: &["roughness-0.005", "roughness-0.5"],
        ..Claim::default()
    }
}

fn blue(inputs: &StatueInputs, smooth: &StatueRender, rough: &StatueRender) -> Claim {
    // Gold reflects less blue than red: bluish pixels are blue by what they mirror.
    let is_blue = |p: DVec3, mean: f64| p.z > p.x && p.element_sum() / 3.0 >= BLACK * mean;
    let ((share, chosen), (rough_share, _)) = (selected(smooth, is_blue), selected(rough, is_blue));
    let wall = share_of(&chosen, &mirrored(inputs, &smooth.mask), Mirrored::BlueWall);
    let finding = |what: String, value, bound| Finding::exact(what, value, Unit::Percent, bound);
    Claim {
        place: "Fig. 2a",
        claim: "At low roughness there are blue regions, where the dragon mirrors the blue wall.",
        findings: vec![
            finding(
                format!("pixels with more blue than red at α = 0.005 (α = 0.5: {:.1} %)", 100.0 * rough_share),
                share,
                Bound::AtLeast(rough_share + VISIBLE),
            ),
            finding("of them, those that mirror the blue wall".into(), wall, Bound::AtLeast(0.5)),
        ],
        evidence: &["roughness-0.005", "roughness-0.5"],
        ..Claim::default()
    }
}

/// The spread of the pixels' colours around gold's: mean distance of their chromaticities.
fn from_gold(statue: &StatueRender) -> f64 {
    let share = |c: DVec3| c / c.element_sum();
    let gold = share(DVec3::from_array([0, 1, 2].map(|c| {
        let (eta, k) = (GOLD.eta[c], GOLD.k[c]);
        crate::optics::conductor::normal_reflectance(eta, k)
    })));
    let lit = inside(statue.rendered.image.pixels(), &statue.mask).filter(|p| mean_rgb(**p) > 0.0);
    let distances: Vec<f64> = lit.map(|p| (share(p.as_dvec3()) - gold).length()).collect();
    distances.iter().sum::<f64>() / distances.len() as f64
}

fn golden(smooth: &StatueRender, rough: &StatueRender) -> Claim {
    let [smooth, rough] = [smooth, rough].map(from_gold);
    Claim {
        place: "Fig. 2d",
        claim: "At high roughness the colour is almost that of gold.",
        findings: vec![Finding::exact(
            format!(
                "mean distance of the chromaticity from gold's at α = 0.5 ({rough:.3}), over that at 0.005 ({smooth:.3})"
            ),
            rough / smooth,
            Unit::Times,
            Bound::AtMost(1.0),
        )],
        evidence: &["roughness-0.5", "roughness-0.005"],
        ..Claim::default()
    }
}

fn dark_line(sampling: &StrategyComparison) -> Claim {
    Claim {
        place: "Fig. 3b",
        claim: "Hemisphere sampling shows a black line around the bunny.",
        findings: vec![Finding::exact(
            "median radiance of the rim, hemisphere over importance sampling",
            sampling.rim_median_ratio(),
            Unit::Times,
            Bound::AtMost(0.5),
        )],
        evidence: &["sampling-error", "sampling-hemisphere"],
        ..Claim::default()
    }
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
        angle += half.z.min(1.0).acos().to_degrees();
        above += f64::from(u8::from(facets.d(half.to_array()) > 0.01 * peak));
    }
    [angle, above].map(|sum| sum / f64::from(STEPS * STEPS))
}

fn explanation(sampling: &StrategyComparison) -> Claim {
    /// The silhouette is seen at nearly 90°.
    const RIM_DEG: f64 = 85.0;
    let alpha = f64::from(sampling.importance.row.alpha);
    let ([angle, at_rim], [_, facing]) = (half_vectors(RIM_DEG, alpha), half_vectors(0.0, alpha));
    // Mean of the rim by both strategies, and its error
    let rim = || sampling.profile.iter().filter(|bin| bin.from_px >= 0.0 && bin.to_px <= RIM);
    let sum = |of: &dyn Fn(&crate::study::sampling_strategies::ProfileBin) -> f64| -> f64 {
        rim().map(|bin| bin.pixels as f64 * of(bin)).sum()
    };
    let error = |of: &dyn Fn(&crate::study::sampling_strategies::ProfileBin) -> f64| -> f64 {
        rim().map(|bin| (bin.pixels as f64 * of(bin)).powi(2)).sum::<f64>().sqrt()
    };
    let (hemisphere, importance) = (sum(&|b| b.hemisphere_mean), sum(&|b| b.importance_mean));
    let relative =
        (error(&|b| b.hemisphere_mean_error) / hemisphere).hypot(error(&|b| b.importance_mean_error) / importance);
    Claim {
        place: "Fig. 3b",
        claim: "The line is black because half-vectors lie about 45° off the normal, where D is exponentially small.",
        findings: vec![
            Finding::exact(
                format!("mean angle of the half-vector, seen at {RIM_DEG}° ({angle:.0}°): distance from 45°"),
                (angle - 45.0).abs(),
                Unit::Degrees,
                Bound::AtMost(5.0),
            ),
            Finding::exact(
                format!(
                    "share of directions with D above 1 % of its peak ({:.2} %), over that seen at 0°",
                    100.0 * at_rim
                ),
                at_rim / facing,
                Unit::Times,
                Bound::AtMost(0.5),
            ),
            Finding {
                what: "mean light of the rim, hemisphere over importance sampling: no light is missing".into(),
                value: hemisphere / importance,
                error: relative * hemisphere / importance,
                unit: Unit::Times,
                bound: Bound::AtMost(0.5),
            },
        ],
        remark: "Few samples carry all of the light: noise, and not darkness.",
        evidence: &["sampling-error"],
        ..Claim::default()
    }
}

fn noise(sampling: &StrategyComparison) -> Claim {
    Claim {
        place: "Fig. 3",
        claim: "Importance sampling reduces the noise overall.",
        findings: vec![Finding::exact(
            "noise on the statue, importance over hemisphere sampling",
            sampling.noise_ratio(),
            Unit::Times,
            Bound::AtMost(1.0),
        )],
        evidence: &["sampling-error", "sampling-importance"],
        ..Claim::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_vectors_seen_from_above_are_half_as_far_off_the_normal() {
        // The mean angle of uniform directions is 1 rad.
        let [angle, share] = half_vectors(0.0, 0.05);
        assert!((angle - 0.5f64.to_degrees()).abs() < 0.01, "{angle}");
        // D is a hundredth of its peak at tan θ = α √ln 100, but for cos⁴ θ.
        let limit = (0.05 * 100f64.ln().sqrt()).atan();
        assert!((share / (1.0 - (2.0 * limit).cos()) - 1.0).abs() < 0.05, "{share}");
    }
}
