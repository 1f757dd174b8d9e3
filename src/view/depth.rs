//! Images of a Cornell box at increasing path depth, and their differences by path class.

use crate::errata::Conventions;
use crate::figure::{Drawing, Rgb8, contact_sheet};
use crate::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use crate::study::depth::{ALL, ClassRow, DEPTHS, Depths};

/// An image as the second report shows its own.
pub(super) fn by_conventions(image: &Image) -> Rgb8 {
    Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::By(Conventions::SECOND_REPORT)))
}

/// An image as the second report shows its own, and nothing else: ready for slides.
pub fn image(image: &Image) -> Drawing {
    Drawing::over(by_conventions(image))
}

/// Wider differences are averaged over blocks of pixels, for less noise and smaller files.
const WIDEST: usize = 320;

/// The differences of consecutive depths, each brightened by a power of two, with the path classes that make it.
pub fn differences(result: &Depths) -> Drawing {
    let shown = |(image, pair): (&Image, &[u32])| {
        // Darker than usual, so that caustics keep their shapes
        let factor = (auto_exposure(image).floor() - 1.0).max(0.0).exp2();
        let mut caption = caption(result, pair[0], pair[1]);
        if factor > 1.0 {
            caption += &format!(" Shown {factor}\u{a0}times brighter.");
        }
        (caption, by_conventions(&image.reduced(image.width().div_ceil(WIDEST)).map(|p| p * factor)))
    };
    let images: Vec<(String, Rgb8)> = result.differences.iter().zip(DEPTHS.windows(2)).map(shown).collect();
    let title = "What each maximum depth /{m} adds. L: light, D: diffuse reflection, S: mirror or glass, E: eye";
    contact_sheet(title, 3, &images)
}

/// "m = 2 minus m = 1: 20.1 % of all light. LDDE (from wall to wall) 71 %, …", the smaller classes summed up.
fn caption(result: &Depths, before: u32, depth: u32) -> String {
    let mut classes: Vec<&ClassRow> = result.classes.iter().filter(|r| r.depth == depth && r.seen_on == ALL).collect();
    classes.sort_by(|a, b| b.share_of_difference.total_cmp(&a.share_of_difference));
    let share: f64 = classes.iter().map(|r| r.share_of_light).sum();
    let mut text = format!("/{{m}} = {depth} minus /{{m}} = {before}: {} of all light. ", percent(share));
    if depth == DEPTHS[DEPTHS.len() - 1] {
        return text + "All classes of more than five scatterings.";
    }
    let named = &classes[..classes.len().min(NAMED)];
    let list = named.iter().map(|r| format!("{}{} {}", r.class, meaning(&r.class), percent(r.share_of_difference)));
    text += &list.collect::<Vec<_>>().join(", ");
    match &classes[named.len()..] {
        [] => text + ".",
        others => {
            let share = others.iter().map(|r| r.share_of_difference).sum();
            text + &format!(", {} others {}.", others.len(), percent(share))
        }
    }
}

const NAMED: usize = 4;

/// What a path class is in a Cornell box with a mirror and a glass sphere.
fn meaning(class: &str) -> &'static str {
    match class {
        "LDE" => " (lit walls)",
        "LSE" => " (reflected area light)",
        "LDDE" => " (from wall to wall)",
        "LDSE" => " (reflected walls)",
        "LSDE" => " (reflected onto walls)",
        "LSSE" => " (area light through glass)",
        "LDSSE" => " (walls through glass)",
        "LSSDE" => " (caustic of glass)",
        _ => "",
    }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    // No break between number and sign.
    if percent < 0.095 { format!("{percent:.2}\u{a0}%") } else { format!("{percent:.1}\u{a0}%") }
}
