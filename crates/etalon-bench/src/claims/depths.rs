//! What the second report sees appear at each maximum depth: each path class's share of the light where it is bright.

use super::seen::{Sight, farthest, sights};
use super::{Bound, Claim, Finding, SIGMAS, Text, VISIBLE, percent, texts};
use crate::depth::{ClassRow, DEPTHS, Depths, share_with_error};
use crate::object_ids::{Kind, ObjectIdBuffer};
use crate::sampling_strategies::quotient;
use etalon_core::math::mean_rgb;
use etalon_core::raster::Image;
use etalon_core::scene::Scene;
use etalon_stats::Extremes;

/// Tests the claims on the scene of which `depths` are the images.
pub fn depth_claims(scene: &Scene, depths: &Depths) -> Vec<Claim> {
    let sights = sights(scene, &depths.request);
    let on_ceiling = |reflections: u32| -> Vec<bool> {
        let ceiling = Sight { reflections, object: farthest(scene, scene.camera.up) };
        sights.iter().map(|sight| *sight == ceiling).collect()
    };
    let ceiling = |text: Text, depth: u32, reflections: u32| {
        let place = if reflections == 0 { "the ceiling" } else { "the ceiling in the mirror" };
        let what = format!("share of paths of {depth} scatterings in the light of {place}");
        text.with([gain(what, depths, depth, &on_ceiling(reflections), VISIBLE)])
    };
    let appears = |text: Text, class: &str, on: Kind| text.with([where_bright(depths, class, on)]);
    let not_judged = |text: Text| text.with([]);
    vec![
        alone(scene, depths),
        appears(texts::WALLS, "LDE", Kind::Diffuse),
        appears(texts::LIGHT_IN_MIRROR, "LSE", Kind::Mirror),
        appears(texts::LIGHT_ON_GLASS, "LSE", Kind::Glass),
        ceiling(texts::CEILING, 2, 0),
        appears(texts::WALLS_IN_MIRROR, "LDSE", Kind::Mirror),
        appears(texts::GLASS_IN_MIRROR, "LSSE", Kind::Mirror),
        appears(texts::WALLS_ON_GLASS, "LDSE", Kind::Glass),
        not_judged(texts::WHITE_SPOT),
        ceiling(texts::CEILING_IN_MIRROR, 3, 1),
        appears(texts::WALLS_THROUGH_GLASS, "LDSSE", Kind::Glass),
        appears(texts::CAUSTIC, "LSSDE", Kind::Diffuse),
        gone(depths),
        outshone(depths),
        appears(texts::GLASS_IN_MIRROR_WALLS, "LDSSSE", Kind::Mirror),
        not_judged(texts::CAUSTIC_IN_MIRROR),
        not_judged(texts::BLUE_WALL),
        appears(texts::CAUSTIC_ON_GLASS, "LSSDSE", Kind::Glass),
        nothing_else(depths),
        glazing(scene, depths),
        not_judged(texts::GLAZING_OUTSIDE),
        brighter(depths),
    ]
}

/// A class on a kind of object, where it is bright. Without any light of it its share is 0.
fn where_bright(depths: &Depths, class: &str, on: Kind) -> Finding {
    let none = ClassRow::default();
    let ClassRow { share_of_light, share_there, error_there, .. } = depths.class(class, on.name()).unwrap_or(&none);
    let of_all = percent(*share_of_light);
    let on = on.name();
    let what = format!("share of {class} in the light where it is brightest on the {on} ({of_all} of all light)");
    Finding::estimated(what, [*share_there, *error_there], Bound::AtLeast(VISIBLE)).in_percent()
}

/// The share that a depth adds to the light of the pixels of `mask`, which must be at least `bound`.
fn gain(what: String, depths: &Depths, depth: u32, mask: &[bool], bound: f64) -> Finding {
    let [added, image] = [depths.added(depth), depths.image(depth)].map(Image::pixels);
    Finding::estimated(what, share_with_error(added, image, mask, bound), Bound::AtLeast(bound)).in_percent()
}

/// The light of classes on the glass sphere, with its standard error.
fn on_glass(depths: &Depths, of: impl Fn(&ClassRow) -> bool) -> [f64; 2] {
    let rows = depths.classes.iter().filter(|row| row.seen_on == Kind::Glass.name() && of(row));
    rows.fold([0.0; 2], |[light, error], row| [light + row.share_of_light, error.hypot(row.error)])
}

/// Walls on the outside of the glass, and through it.
const REFLECTION: &str = "LDSE";
const REFRACTION: &str = "LDSSE";

fn gone(depths: &Depths) -> Claim {
    let reflection = on_glass(depths, |row| row.class == REFLECTION);
    let [before, share] = [2, 3].map(|depth| quotient(reflection, on_glass(depths, |row| row.depth <= depth)));
    let before = percent(before[0]);
    let what = format!("share of {REFLECTION} in the light of the glass sphere at depth 3 (at depth 2: {before})");
    texts::REFLECTION_GONE.with([Finding::estimated(what, share, Bound::AtMost(VISIBLE)).in_percent()])
}

/// "Much larger" is a factor of 10.
fn outshone(depths: &Depths) -> Claim {
    let [refraction, reflection] = [REFRACTION, REFLECTION].map(|class| on_glass(depths, |row| row.class == class));
    let what = format!("light of {REFRACTION} over that of {REFLECTION}, seen on the glass");
    texts::REFRACTION.with([Finding::estimated(what, quotient(refraction, reflection), Bound::AtLeast(10.0))])
}

/// Whether longer paths brighten the top of the glass sphere more than the image.
fn glazing(scene: &Scene, depths: &Depths) -> Claim {
    const LONGEST: u32 = DEPTHS[DEPTHS.len() - 1];
    let width = depths.request.width;
    let mut top = ObjectIdBuffer::new(scene, &depths.request).mask(Kind::Glass);
    let ends = [top.iter().position(|is_glass| *is_glass), top.iter().rposition(|is_glass| *is_glass)];
    let [first, last] = ends.map(|pixel| pixel.map_or(0, |i| i / width));
    top[(first + (last - first) / 3) * width..].fill(false);
    let everywhere = 1.0 - depths.mean(5) / depths.mean(LONGEST);
    let of_image = percent(everywhere);
    let what = format!(
        "share of paths of more than 5 scatterings in the light of the sphere's upper third (of the image: {of_image})"
    );
    texts::GLAZING.with([gain(what, depths, LONGEST, &top, everywhere + VISIBLE)])
}

fn alone(scene: &Scene, depths: &Depths) -> Claim {
    let objects = ObjectIdBuffer::new(scene, &depths.request);
    // Pixels beside the light show a part of it.
    let distance = objects.depth_inside(&objects.mask(Kind::AreaLight), 2);
    let lit =
        depths.images[0].pixels().iter().zip(&distance).filter(|(p, d)| mean_rgb(**p) > 0.0 && **d < -1.5).count();
    texts::LIGHT_ALONE.with([Finding::exact("other pixels with light", lit as f64, Bound::AtMost(0.0))])
}

/// "Feature" is not defined: light with sharp outlines, and any light that brightens some blocks of pixels more than others.
fn nothing_else(depths: &Depths) -> Claim {
    const BLOCK: usize = 16;
    let place = DEPTHS.iter().position(|d| *d == 5).unwrap_or(0);
    let image = &depths.images[place];
    let (width, height) = (image.width(), image.height());
    let corners = (0..height).step_by(BLOCK).flat_map(|y| (0..width).step_by(BLOCK).map(move |x| [x, y]));
    let pixels = corners.map(|[left, top]| -> Vec<usize> {
        let row = |y: usize| (left..width.min(left + BLOCK)).map(move |x| y * width + x);
        (top..height.min(top + BLOCK)).flat_map(row).collect()
    });
    let light =
        |image: &Image, block: &[usize]| -> Vec<f64> { block.iter().map(|&i| mean_rgb(image.pixels()[i])).collect() };
    let blocks: Vec<Vec<usize>> = pixels.filter(|block| light(image, block).iter().sum::<f64>() > 0.0).collect();
    let finding = |what: &str, added: &Image, everywhere: f64| {
        let is_visible = |block: &&Vec<usize>| {
            let (n, gains) = (block.len() as f64, light(added, block));
            let [gain, all] = [&gains, &light(image, block)].map(|values| values.iter().sum::<f64>() / n);
            let variance = gains.iter().map(|v| (v - gain).powi(2)).sum::<f64>() / (n * (n - 1.0));
            (gain - SIGMAS * variance.sqrt()) / all > everywhere + VISIBLE
        };
        let n = blocks.len() as f64;
        // As many exceed three standard errors by chance, at most, with three standard errors of their number.
        let chance = 1.35e-3;
        let limit = Bound::AtMost(chance + SIGMAS * f64::sqrt(chance * (1.0 - chance) / n));
        let what = format!("blocks of {BLOCK}×{BLOCK} pixels that gain {what}");
        Finding::exact(what, blocks.iter().filter(is_visible).count() as f64 / n, limit).in_percent()
    };
    let sharp = "2 % by light reflected diffusely at most once, with sharp outlines";
    let overall = 1.0 - depths.mean(4) / depths.mean(5);
    texts::NOTHING_ELSE.with([
        finding(sharp, &depths.sharp[place - 1], 0.0),
        finding("2 % more than the image", &depths.differences[place - 1], overall),
    ])
}

fn brighter(depths: &Depths) -> Claim {
    let steps: Vec<f64> = DEPTHS.windows(2).map(|pair| depths.mean(pair[1]) / depths.mean(pair[0]) - 1.0).collect();
    let list: Vec<String> = steps.iter().map(|step| percent(*step)).collect();
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::at_most);
    let what = format!("smallest increase of {}", list.join(", "));
    texts::INCREASES.with([Finding::exact(what, smallest, Bound::AtLeast(0.0)).in_percent()])
}

#[cfg(test)]
mod tests {
    use super::super::Verdict;
    use super::*;
    use crate::depth::depths;
    use etalon_core::scene::{Request, builtin};
    use etalon_render::Settings;

    fn tested((scene, request): (Scene, Request)) -> Vec<Claim> {
        let request = Request { width: 120, height: 90, spp: 32, ..request };
        depth_claims(&scene, &depths(&scene, &request, &Settings::default()).unwrap())
    }

    #[test]
    fn what_appears_at_each_depth_is_there() {
        let claims = tested(builtin::cornell_spheres());
        let verdict = |text| claims.iter().find(|claim| claim.text == text).unwrap().verdict();
        for claim in [
            texts::WALLS,
            texts::LIGHT_IN_MIRROR,
            texts::LIGHT_ON_GLASS,
            texts::CEILING,
            texts::WALLS_IN_MIRROR,
            texts::CEILING_IN_MIRROR,
            texts::WALLS_THROUGH_GLASS,
            texts::CAUSTIC,
            texts::REFRACTION,
        ] {
            assert_eq!(verdict(claim), Verdict::Holds, "{}", claim.claim);
        }
        assert_eq!(verdict(texts::REFLECTION_GONE), Verdict::DoesNotHold);
        assert_eq!(verdict(texts::GLAZING_OUTSIDE), Verdict::NotTestable);
    }

    #[test]
    fn claims_on_mirror_and_glass_do_not_hold_without_them() {
        let claims = tested(builtin::cornell_lambert());
        let (spheres, walls): (Vec<_>, Vec<_>) =
            claims.iter().partition(|c| c.text.claim.contains("sphere") || c.text.claim.contains("glass"));
        assert!(spheres.len() > 8);
        for claim in spheres {
            assert!(![Verdict::Holds, Verdict::HoldsPartly].contains(&claim.verdict()), "{}", claim.text.claim);
        }
        assert!(walls.iter().any(|claim| claim.verdict() == Verdict::Holds), "the walls are there");
    }
}
