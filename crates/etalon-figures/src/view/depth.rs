//! Images of a Cornell box at increasing path depth, and their differences by path class; and renders in a grid, at one exposure.

use super::text::{capitalized, rounded};
use crate::figure::{Drawing, Page, Rgb8, contact_sheet, image_rows};
use etalon_bench::depth::{ALL, ClassRow, DEPTHS, Depths};
use etalon_core::raster::{Image, ToneMap, to_rgb8};

/// An image as the second report shows its own.
fn tone_mapped(image: &Image) -> Rgb8 {
    Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::SecondReport))
}

/// An image as the second report shows its own, and nothing else: ready for slides.
pub fn image(image: &Image) -> Drawing {
    Page::over(tone_mapped(image)).into()
}

/// The share of the pixels of a difference that its exposure leaves below white.
const BELOW_WHITE: f64 = 0.99;

/// The differences of consecutive depths, each at an exposure of its own, with the path classes that make it.
pub fn differences(result: &Depths) -> Drawing {
    let shown = |(image, pair): (&Image, &[u32])| {
        let image = &without_specks(image);
        let exposure = exposure(image);
        let caption = caption(result, pair[0], pair[1]) + &format!(" Exposure ×\u{a0}{}.", rounded(exposure, 2));
        let tone = ToneMap::Srgb { stops: exposure.log2() as f32 };
        (caption, Rgb8::new(image.width(), image.height(), to_rgb8(image, &tone)))
    };
    let images: Vec<(String, Rgb8)> = result.differences.iter().zip(DEPTHS.windows(2)).map(shown).collect();
    contact_sheet("What each maximum depth /{m} adds", 3, &images)
}

/// The image with no pixel brighter than the fifth brightest of its 5×5 block: paths that meet a light or a caustic by chance leave specks
/// of up to four pixels.
pub fn without_specks(image: &Image) -> Image {
    let (width, height) = (image.width(), image.height());
    let around = |i: usize, end: usize| i.saturating_sub(2)..(i + 3).min(end);
    Image::from_fn(width, height, |x, y| {
        let block = around(y, height).flat_map(|y| around(x, width).map(move |x| y * width + x));
        let mut block: Vec<f32> = block.map(|i| image.pixels()[i].max_element()).collect();
        block.sort_unstable_by(|a, b| b.total_cmp(a));
        let (pixel, limit) = (image.pixels()[y * width + x], block.get(4).copied().unwrap_or(f32::INFINITY));
        let largest = pixel.max_element();
        if largest > limit { pixel * (limit / largest) } else { pixel }
    })
}

/// The factor that brings all but the brightest pixels below 1; 1 for a black image.
fn exposure(image: &Image) -> f64 {
    let mut largest: Vec<f32> = image.pixels().iter().map(|p| p.max_element()).collect();
    largest.sort_unstable_by(f32::total_cmp);
    let at = (largest.len() as f64 * BELOW_WHITE) as usize;
    largest.get(at).copied().filter(|white| *white > 0.0).map_or(1.0, |white| 1.0 / f64::from(white))
}

/// "m = 2 minus m = 1: 20.1 % of all light. Walls lit 71 %, …": the kinds of paths, the largest first.
fn caption(result: &Depths, before: u32, depth: u32) -> String {
    let classes: Vec<&ClassRow> = result.classes.iter().filter(|r| r.depth == depth && r.seen_on == ALL).collect();
    let share: f64 = classes.iter().map(|r| r.share_of_light).sum();
    let text = format!("/{{m}} = {depth} minus /{{m}} = {before}: {:.1}\u{a0}% of all light. ", 100.0 * share);
    if depth == DEPTHS[DEPTHS.len() - 1] {
        return text + "All paths of more than five scatterings.";
    }
    let of_kind = |name: &&str| classes.iter().filter(|r| kind(&r.class) == *name).map(|r| r.share_of_difference).sum();
    let mut kinds: Vec<(&str, f64)> = KINDS.into_iter().map(|name| (name, of_kind(&name))).collect();
    kinds.retain(|(_, share)| *share >= TOLD);
    kinds.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let list: Vec<String> =
        kinds.into_iter().map(|(name, share)| format!("{name} {:.0}\u{a0}%", 100.0 * share)).collect();
    text + &capitalized(&list.join(", ")) + "."
}

/// The least share of a difference that is told.
const TOLD: f64 = 0.01;

const KINDS: [&str; 4] =
    ["walls without spheres", "walls lit by spheres", "walls seen in spheres", "area light in spheres"];

/// What a path class, such as LDSE, is in a Cornell box with a mirror and a glass sphere: one of [`KINDS`].
fn kind(class: &str) -> &'static str {
    let events = class.trim_matches(['L', 'E']);
    KINDS[match (events.contains('D'), events.contains('S'), events.ends_with('D')) {
        (true, false, _) => 0,
        (true, true, true) => 1,
        (true, true, false) => 2,
        (false, ..) => 3,
    }]
}

/// Captioned images in rows of `columns`, brightened by `stops`.
pub fn grid(title: &str, columns: usize, stops: f32, images: &[(String, &Image)]) -> Drawing {
    let shown = |(caption, image): &(String, &Image)| {
        (caption.clone(), Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops })))
    };
    image_rows(title, columns, &images.iter().map(shown).collect::<Vec<_>>())
}
