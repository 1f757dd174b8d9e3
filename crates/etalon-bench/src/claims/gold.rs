//! The second report's claims on a dragon of gold: roughness, colour, and what it mirrors.

use super::claim::{Bound, Claim, Finding, Unit, VISIBLE};
use crate::pixel_mean::inside;
use crate::roughness::StatueRender;
use crate::sampling_strategies::quotient;
use etalon_core::math::mean_rgb;
use etalon_core::optics::metals::GOLD;
use etalon_core::scene::{Bvh, Material, Ray, Request, Scene, Shape};
use etalon_stats::Extremes;
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

/// Tests the claims on statues of gold.
pub fn statue_claims(inputs: &StatueInputs) -> Vec<Claim> {
    let [smooth, .., rough] = inputs.statues else { return Vec::new() };
    vec![diffuse(inputs.statues), black(inputs, smooth, rough), blue(inputs, smooth, rough), golden(smooth, rough)]
}

/// The share of the statue's light in the brightest hundredth of its pixels, with a standard error from those of the pixels.
fn brightest(statue: &StatueRender) -> [f64; 2] {
    let share = statue.row.brightest_percent;
    let estimates = inside(statue.rendered.part.film.estimates(), &statue.mask);
    let mut pixels: Vec<[f64; 2]> = estimates.map(|e| [mean_rgb(e.mean), mean_rgb(e.error)]).collect();
    pixels.sort_unstable_by(|a, b| b[0].total_cmp(&a[0]));
    let count = pixels.len().div_ceil(100);
    let total: f64 = pixels.iter().map(|[light, _]| light).sum();
    // A bright pixel adds to both parts of the quotient, another one to the whole alone
    let weight = |i: usize| if i < count { 1.0 - share } else { share };
    let variance: f64 = pixels.iter().enumerate().map(|(i, [_, error])| (weight(i) * error).powi(2)).sum();
    [share, variance.sqrt() / total]
}

fn diffuse(statues: &[&StatueRender]) -> Claim {
    let shares: Vec<[f64; 2]> = statues.iter().map(|statue| brightest(statue)).collect();
    let list: Vec<String> = shares.iter().map(|[share, _]| format!("{:.1} %", 100.0 * share)).collect();
    let ratios = shares.windows(2).map(|pair| quotient(pair[1], pair[0]));
    let ratio = ratios.max_by(|a, b| a[0].total_cmp(&b[0])).unwrap_or([f64::NAN; 2]);
    Claim {
        place: "Fig. 2",
        claim: "The higher the roughness, the more diffuse the dragon.",
        number: "α = 0.005, 0.05, 0.25, 0.5",
        findings: vec![Finding::estimated(
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

/// Pixels of a statue that are chosen by their colour.
struct Chosen {
    pixels: Vec<bool>,
    count: f64,
    /// Standard error of their number.
    error: f64,
    of: f64,
}

impl Chosen {
    /// Those for which `holds` of their colour and the statue's mean is true.
    fn new(statue: &StatueRender, holds: impl Fn(DVec3, f64) -> bool) -> Self {
        let mean = statue.statue.mean_rgb();
        // Pixels that two standard errors would change; a choice by chance has a variance of ¼ at most
        let changes = [DVec3::ONE, DVec3::NEG_ONE, DVec3::new(1.0, 0.0, -1.0), DVec3::new(-1.0, 0.0, 1.0)];
        let (mut pixels, mut undecided) = (Vec::new(), 0.0);
        for (estimate, inside) in statue.rendered.part.film.estimates().zip(&statue.mask) {
            let (colour, error) = (estimate.mean.as_dvec3(), estimate.error.as_dvec3());
            let chosen = *inside && holds(colour, mean);
            let may_change = changes.iter().any(|change| holds(colour + 2.0 * *change * error, mean) != chosen);
            undecided += f64::from(u8::from(*inside && may_change));
            pixels.push(chosen);
        }
        let count = pixels.iter().filter(|chosen| **chosen).count() as f64;
        Self { pixels, count, error: undecided.sqrt() / 2.0, of: statue.statue.pixels as f64 }
    }

    /// Of all pixels.
    fn share(&self) -> [f64; 2] {
        [self.count / self.of, self.error / self.of]
    }

    /// Those of them that mirror this.
    fn share_of(&self, mirrored: &[Mirrored], what: Mirrored) -> [f64; 2] {
        let count = self.pixels.iter().zip(mirrored).filter(|(chosen, m)| **chosen && **m == what).count();
        [count as f64, self.error].map(|number| number / self.count.at_least(1.0))
    }
}

/// A claim on regions of the smooth statue of which the rough one has fewer, and on what they mirror.
fn regions(
    claim: &'static str,
    [region, mirroring]: [&str; 2],
    [smooth, rough]: [&Chosen; 2],
    mirrored: [f64; 2],
) -> Claim {
    let ([share, error], [rough_share, rough_error]) = (smooth.share(), rough.share());
    let finding = |what: String, value, bound| Finding::estimated(what, value, Unit::Percent, bound);
    Claim {
        place: "Fig. 2a",
        claim,
        findings: vec![
            finding(
                format!("{region} at α = 0.005 (α = 0.5: {:.1} %)", 100.0 * rough_share),
                [share, error.hypot(rough_error)],
                Bound::AtLeast(rough_share + VISIBLE),
            ),
            finding(format!("of them, those that mirror {mirroring}"), mirrored, Bound::AtLeast(0.5)),
        ],
        evidence: &["roughness-0.005", "roughness-0.5"],
        ..Claim::default()
    }
}

fn black(inputs: &StatueInputs, smooth: &StatueRender, rough: &StatueRender) -> Claim {
    let is_black = |p: DVec3, mean: f64| p.element_sum() / 3.0 < BLACK * mean;
    let [chosen, rough] = [smooth, rough].map(|statue| Chosen::new(statue, is_black));
    let outside = chosen.share_of(&mirrored(inputs, &smooth.mask), Mirrored::Outside);
    regions(
        "At low roughness there are black regions, where the dragon mirrors the observer's side.",
        ["black pixels (below a tenth of the mean)", "the open side"],
        [&chosen, &rough],
        outside,
    )
}

fn blue(inputs: &StatueInputs, smooth: &StatueRender, rough: &StatueRender) -> Claim {
    // Gold reflects less blue than red: bluish pixels are blue by what they mirror.
    let is_blue = |p: DVec3, mean: f64| p.z > p.x && p.element_sum() / 3.0 >= BLACK * mean;
    let [chosen, rough] = [smooth, rough].map(|statue| Chosen::new(statue, is_blue));
    let wall = chosen.share_of(&mirrored(inputs, &smooth.mask), Mirrored::BlueWall);
    regions(
        "At low roughness there are blue regions, where the dragon mirrors the blue wall.",
        ["pixels with more blue than red", "the blue wall"],
        [&chosen, &rough],
        wall,
    )
}

/// The spread of the pixels' colours around gold's: mean distance of their chromaticities, with its standard error.
fn from_gold(statue: &StatueRender) -> [f64; 2] {
    let share = |c: DVec3| c / c.element_sum();
    let gold = share(DVec3::from_array([0, 1, 2].map(|c| {
        let (eta, k) = (GOLD.eta[c], GOLD.k[c]);
        etalon_core::optics::conductor::normal_reflectance(eta, k)
    })));
    let lit = inside(statue.rendered.image.pixels(), &statue.mask).filter(|p| mean_rgb(**p) > 0.0);
    let distances: Vec<f64> = lit.map(|p| (share(p.as_dvec3()) - gold).length()).collect();
    let n = distances.len() as f64;
    let mean = distances.iter().sum::<f64>() / n;
    [mean, distances.iter().map(|d| (d - mean).powi(2)).sum::<f64>().sqrt() / n]
}

fn golden(smooth: &StatueRender, rough: &StatueRender) -> Claim {
    let [smooth, rough] = [smooth, rough].map(from_gold);
    Claim {
        place: "Fig. 2d",
        claim: "At high roughness the colour is almost that of gold.",
        findings: vec![Finding::estimated(
            format!(
                "mean distance of the chromaticity from gold's at α = 0.5 ({:.3}), over that at 0.005 ({:.3})",
                rough[0], smooth[0]
            ),
            quotient(rough, smooth),
            Unit::Times,
            Bound::AtMost(1.0),
        )],
        evidence: &["roughness-0.5", "roughness-0.005"],
        ..Claim::default()
    }
}
