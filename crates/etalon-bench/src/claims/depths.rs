//! What the second report sees appear at each maximum depth: where each class is, and how it stands out there.

use super::claim::{Agreement, Bound, Claim, Finding, SIGMAS, Share, Unit, VISIBLE, percent};
use super::events::{Event, World, word};
use super::feature::{ClassImage, Place, PlacePicture, View};
use super::features::{And, Feature, features};
use super::glazing::glazing;
use crate::depth::{DEPTHS, Depths};
use crate::object_ids::{Kind, ObjectIdBuffer};
use crate::sampling_strategies::quotient;
use Event::{BlueWall, Ceiling, Diffuse, Mirror, Reflected, Refracted};
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_core::math::mean_rgb;
use etalon_core::raster::Image;
use etalon_core::scene::Scene;
use etalon_stats::Extremes;
use glam::DVec3;

/// How many paths are traced.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// From the eye in each pixel, for classes that end at a diffuse surface, where the light is sampled.
    pub to_diffuse: u32,
    /// From the eye in each pixel, for classes that end at a mirror or glass, where paths must meet the light.
    pub to_specular: u32,
    /// From the eye in each pixel of walls, of which there are many.
    pub from_walls: u32,
    /// From the light.
    pub from_light: u32,
}

/// Side of the blocks of pixels in which features are looked for.
const BLOCK: usize = 16;

/// The claims on depths, what is seen of them, and how well the study agrees with the renderer.
#[derive(Default)]
pub struct DepthClaims {
    /// In the order of the report.
    pub claims: Vec<Claim>,
    /// Of the claims that are about a place.
    pub pictures: Vec<PlacePicture>,
    /// Places of which there is no picture: no light of their class was found.
    pub unseen: Vec<&'static str>,
    /// Of classes that both measure.
    pub agreement: Vec<Agreement>,
}

/// Tests the claims on the scene of which `depths` are the images.
///
/// # Errors
/// [`Error::Interrupted`](etalon_core::error::Error::Interrupted).
pub fn depth_claims(scene: &Scene, depths: &Depths, effort: Effort, seed: u64) -> Result<DepthClaims> {
    let Some(world) = World::new(scene) else { return Ok(untestable()) };
    let view = View { scene, world, request: &depths.request, seed };
    let mut done = DepthClaims { claims: vec![alone(scene, depths)], ..DepthClaims::default() };
    let light: f64 = depths.mean(DEPTHS[DEPTHS.len() - 1]) * (depths.request.width * depths.request.height) as f64;
    let mut classes = Vec::new();
    for feature in features() {
        interrupt::check()?;
        let class = class_image(&view, feature.events, effort);
        let found = class.place();
        let place = found.unwrap_or_default();
        let here = class.light_in(&view, &place, feature.depth, effort.to_specular);
        let share = Share::of(here[0], here[1]);
        let of_all = class.total()[0] / light;
        let what = format!("share of {} in the light there ({} of all light)", class.word, percent(of_all));
        let mut findings = vec![Finding::estimated(
            what,
            [share.value, share.error_at(VISIBLE)],
            Unit::Percent,
            Bound::AtLeast(VISIBLE),
        )];
        findings.extend(also(&class, feature.and));
        done.claims.push(Claim {
            place: feature.place,
            claim: feature.claim,
            findings,
            evidence: feature.evidence,
            ..Claim::default()
        });
        match feature.picture {
            Some(title) if found.is_some() => {
                done.pictures.push(PlacePicture::new(title, &class, place, here, (feature.depth, depths)));
            }
            unseen => done.unseen.extend(unseen),
        }
        if feature.events == REFLECTION {
            let here = class.light_in(&view, &place, 3, effort.to_specular);
            let title = "the reflection that is “gone”";
            done.pictures.push(PlacePicture::new(title, &class, place, here, (3, depths)));
        }
        classes.push(class);
    }
    // In the order of the report: after the features of depth 3
    let third = done.claims.iter().rposition(|claim| claim.place == "Fig. 1d").map_or(0, |i| i + 1);
    done.claims.splice(third..third, [gone(&view, &classes, effort), outshone(&classes)]);
    done.claims.push(nothing_else(scene, depths));
    let (glazing, picture, long) = glazing(&view, depths, effort.to_diffuse);
    done.claims.extend(glazing);
    done.pictures.extend(picture);
    done.claims.push(brighter(depths));
    done.agreement = agreement(&view, depths, &classes, light, effort);
    done.agreement.extend(long);
    Ok(done)
}

/// The claims of a scene whose light this study does not know.
fn untestable() -> DepthClaims {
    let claim = |feature: Feature| Claim {
        place: feature.place,
        claim: feature.claim,
        remark: "The scene has no rectangle that emits light.",
        evidence: feature.evidence,
        ..Claim::default()
    };
    let unseen = features().into_iter().filter_map(|feature| feature.picture).collect();
    DepthClaims { claims: features().into_iter().map(claim).collect(), unseen, ..DepthClaims::default() }
}

fn class_image(view: &View, events: &'static [Event], effort: Effort) -> ClassImage {
    let spp = match events {
        [Diffuse | BlueWall, _, ..] => return ClassImage::from_light(view, events, effort.from_light),
        [Diffuse | Ceiling, ..] => effort.from_walls,
        [.., Diffuse] => effort.to_diffuse,
        _ => effort.to_specular,
    };
    ClassImage::from_eye(view, events, spp)
}

/// The findings on colour and position.
fn also(class: &ClassImage, and: And) -> Vec<Finding> {
    let ([middle_x, middle_y], [[x, x_error], [y, y_error]]) = (class.middle(), class.centroid());
    let pixels = |what: &str, value: f64, error: f64, bound| Finding {
        what: what.into(),
        value,
        error,
        unit: Unit::Plain,
        bound,
    };
    match and {
        And::Nothing => Vec::new(),
        And::WhiteAndLeft => {
            let sum: DVec3 = class.pixels.iter().sum();
            let colour = (sum / (sum.element_sum() / 3.0) - 1.0).abs().max_element();
            vec![
                pixels("its column minus the sphere's middle (pixels)", x - middle_x, x_error, Bound::AtMost(0.0)),
                Finding::exact(
                    "largest difference of a channel from white",
                    colour,
                    Unit::Percent,
                    Bound::AtMost(VISIBLE),
                ),
            ]
        }
        And::Low => {
            vec![pixels("its row minus the wall's middle (pixels)", y - middle_y, y_error, Bound::AtLeast(0.0))]
        }
    }
}

fn alone(scene: &Scene, depths: &Depths) -> Claim {
    let objects = ObjectIdBuffer::new(scene, &depths.request);
    // Pixels beside the light show a part of it.
    let distance = objects.depth_inside(&objects.mask(Kind::AreaLight), 2);
    let lit =
        depths.images[0].pixels().iter().zip(&distance).filter(|(p, d)| mean_rgb(**p) > 0.0 && **d < -1.5).count();
    Claim {
        place: "Fig. 1a",
        claim: "Depth 0 shows the area light alone.",
        findings: vec![Finding::exact("other pixels with light", lit as f64, Unit::Plain, Bound::AtMost(0.0))],
        evidence: &["depth-0"],
        ..Claim::default()
    }
}

/// Walls on the outside of the glass, and through it.
const REFLECTION: &[Event] = &[Reflected, Diffuse];
const REFRACTION: &[Event] = &[Refracted, Refracted, Diffuse];

fn find<'a>(classes: &'a [ClassImage], events: &[Event]) -> Option<&'a ClassImage> {
    classes.iter().find(|class| class.word == word(events))
}

fn gone(view: &View, classes: &[ClassImage], effort: Effort) -> Claim {
    let findings = find(classes, REFLECTION).map(|class| {
        let whole = Place { from: [0, 0], to: [view.request.width, view.request.height] };
        let [before, share] = [2, 3].map(|depth| {
            let [part, rest] = class.light_in(view, &whole, depth, effort.to_diffuse);
            Share::of(part, rest)
        });
        let before = percent(before.value);
        let what =
            format!("share of {} in the light of the glass sphere at depth 3 (at depth 2: {before})", class.word);
        Finding::estimated(what, [share.value, share.error_at(VISIBLE)], Unit::Percent, Bound::AtMost(VISIBLE))
    });
    Claim {
        place: "Fig. 1d",
        claim: "At depth 3 the faint reflection of floor and walls on the glass is gone.",
        findings: findings.into_iter().collect(),
        remark: "The same light is there; what comes through the glass outshines it.",
        evidence: &["depth-3", "claims-places"],
        ..Claim::default()
    }
}

fn outshone(classes: &[ClassImage]) -> Claim {
    /// "Much larger".
    const MUCH: f64 = 10.0;
    let findings = find(classes, REFRACTION).zip(find(classes, REFLECTION)).map(|(refraction, reflection)| {
        let what = format!("light of {} over that of {}", refraction.word, reflection.word);
        let ratio = quotient(refraction.total(), reflection.total());
        Finding::estimated(what, ratio, Unit::Times, Bound::AtLeast(MUCH))
    });
    Claim {
        place: "Fig. 1d",
        claim: "Refraction by the glass sphere is much more intense than reflection.",
        findings: findings.into_iter().collect(),
        evidence: &["depth-3"],
        ..Claim::default()
    }
}

/// The share of the blocks that `added` brightens visibly more than by `everywhere`, by what most of their pixels show (mirror, glass,
/// room), and the number of blocks.
fn visible_blocks(added: &Image, image: &Image, everywhere: f64, objects: &ObjectIdBuffer) -> ([f64; 3], f64) {
    let (width, height) = (image.width(), image.height());
    let kinds = [Kind::Mirror, Kind::Glass, Kind::Diffuse];
    let (mut visible, mut blocks) = ([0.0; 3], 0.0);
    for top in (0..height).step_by(BLOCK) {
        for left in (0..width).step_by(BLOCK) {
            let pixels: Vec<usize> = (top..height.min(top + BLOCK))
                .flat_map(|y| (left..width.min(left + BLOCK)).map(move |x| y * width + x))
                .collect();
            let n = pixels.len() as f64;
            let light = pixels.iter().map(|&i| mean_rgb(image.pixels()[i])).sum::<f64>() / n;
            let values: Vec<f64> = pixels.iter().map(|&i| mean_rgb(added.pixels()[i])).collect();
            let mean = values.iter().sum::<f64>() / n;
            let error = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
            if light <= 0.0 {
                continue;
            }
            blocks += 1.0;
            if (mean - SIGMAS * error) / light > everywhere + VISIBLE {
                let count = |kind: Kind| pixels.iter().filter(|&&i| objects.pixels[i] == Some(kind)).count();
                let most = (0..kinds.len()).max_by_key(|&k| count(kinds[k])).unwrap_or(0);
                visible[most] += 1.0;
            }
        }
    }
    (visible.map(|count| count / blocks), blocks)
}

/// "Feature" is not defined: light with sharp outlines, and any light that brightens some places more than others.
fn nothing_else(scene: &Scene, depths: &Depths) -> Claim {
    let place = DEPTHS.iter().position(|d| *d == 5).unwrap_or(0);
    let (image, objects) = (&depths.images[place], ObjectIdBuffer::new(scene, &depths.request));
    let finding = |what: &str, added: &Image, everywhere: f64| {
        let (visible, blocks) = visible_blocks(added, image, everywhere, &objects);
        let [mirror, glass, room] = visible.map(percent);
        // As many exceed three standard errors by chance, at most, with three standard errors of their number.
        let chance = 1.35e-3;
        let limit = chance + SIGMAS * f64::sqrt(chance * (1.0 - chance) / blocks);
        let what =
            format!("blocks of {BLOCK}×{BLOCK} pixels that gain {what} (mirror {mirror}, glass {glass}, room {room})");
        Finding::exact(what, visible.iter().sum(), Unit::Percent, Bound::AtMost(limit))
    };
    let overall = 1.0 - depths.mean(4) / depths.mean(5);
    Claim {
        place: "Fig. 1f",
        claim: "Depth 5 adds no other significant feature.",
        findings: vec![
            finding(
                "2 % by light reflected diffusely at most once, with sharp outlines",
                &depths.sharp[place - 1],
                0.0,
            ),
            finding("2 % more than the image", &depths.differences[place - 1], overall),
        ],
        evidence: &["depth-5", "depth-differences"],
        ..Claim::default()
    }
}

fn brighter(depths: &Depths) -> Claim {
    let steps: Vec<f64> = DEPTHS.windows(2).map(|pair| depths.mean(pair[1]) / depths.mean(pair[0]) - 1.0).collect();
    let list: Vec<String> = steps.iter().map(|step| percent(*step)).collect();
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::at_most);
    Claim {
        place: "Fig. 1",
        claim: "The overall intensity increases at every step.",
        findings: vec![Finding::exact(
            format!("smallest increase of {}", list.join(", ")),
            smallest,
            Unit::Percent,
            Bound::AtLeast(0.0),
        )],
        evidence: &["depth-differences", "error-depth"],
        ..Claim::default()
    }
}

/// Classes that the renderer measures, too, which does not distinguish what is specular.
fn agreement(view: &View, depths: &Depths, classes: &[ClassImage], light: f64, effort: Effort) -> Vec<Agreement> {
    const LIGHT: &[Event] = &[Refracted, Refracted];
    const MIRROR: &[Event] = &[Reflected, Mirror, Diffuse];
    let more = [MIRROR, LIGHT].map(|events| class_image(view, events, effort));
    let compared: [(_, _, _, &[&[Event]]); 4] = [
        ("LDSE on the mirror sphere, event by event minus the renderer", "LDSE", "mirror", &[&[Mirror, Diffuse]]),
        ("LDSE on the glass sphere, event by event minus the renderer", "LDSE", "glass", &[REFLECTION]),
        ("LDSSE on the glass sphere, event by event minus the renderer", "LDSSE", "glass", &[REFRACTION, MIRROR]),
        (
            "LSSE on the glass sphere, event by event minus the renderer",
            "LSSE",
            "glass",
            &[&[Reflected, Mirror], LIGHT],
        ),
    ];
    let z = |(name, class, on, parts): (&'static str, &str, &str, &[&[Event]])| {
        let parts = || {
            parts
                .iter()
                .filter_map(|events| find(classes, events).or_else(|| find(&more, events)))
                .map(ClassImage::total)
        };
        let (sum, variance) = parts().fold((0.0, 0.0), |(sum, variance), [s, e]| (sum + s, variance + e * e));
        let rendered = depths.class(class, on).map_or(f64::NAN, |row| row.share_of_light * light);
        // The renderer takes more samples: its variance is no larger.
        Agreement { name, z: (sum - rendered) / (2.0 * variance).sqrt() }
    };
    compared.map(z).into()
}
