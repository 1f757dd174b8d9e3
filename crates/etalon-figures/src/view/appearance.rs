//! A BSDF of another program on spheres, beside the image by its values alone and that of the closest model, and the differences.

use super::text::{LINE, rounded, wrapped};
use crate::figure::{Drawing, Heatmap, Rgb8, Shading, contact_sheet};
use etalon_bench::appearance::{AROUND, Appearance, Difference, LEVEL, Model};
use etalon_core::raster::{Image, ToneMap, auto_exposure, to_rgb8};

/// Models with a larger difference of their values are not close.
const FAR: f64 = 0.1;

/// What the image with the BSDF is compared with.
struct Comparison<'a> {
    /// The caption of the other image.
    caption: String,
    /// In a sentence after "than".
    other: String,
    image: &'a Image,
    difference: &'a Difference,
}

/// The image by values alone and that of the model, the one first that the headline is about: the first, if the BSDF differs from it, as it does
/// where samples, pdf or weights are wrong; else that of the model, if one is close.
fn comparisons(found: &Appearance) -> [Comparison<'_>; 2] {
    let [_, by_value, of_model] = &found.images;
    let sampling = Comparison {
        caption: format!("{}, by f alone: uniform directions", found.bsdf),
        other: "its values alone make them".to_owned(),
        image: &by_value.image,
        difference: &found.sampling,
    };
    let model = Comparison {
        caption: format!("closest model: {}", named(&found.model)),
        other: format!("{}, the closest model", named(&found.model)),
        image: &of_model.image,
        difference: &found.of_model,
    };
    if found.sampling.is_seen() || !is_close(found) { [sampling, model] } else { [model, sampling] }
}

fn is_close(found: &Appearance) -> bool {
    found.model.difference <= FAR
}

/// A row for each comparison: the BSDF, the other image, and the difference in percent with its scale, which is one for both. A model that is not
/// close has none: its colours and its lobes are others, too.
pub fn drawing(found: &Appearance) -> Drawing {
    // One exposure for all, so that a difference in brightness is seen
    let own = &found.images[0].image;
    let stops = auto_exposure(&found.images[1].image);
    let shown = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops }));
    let all = comparisons(found);
    let all = if is_close(found) { &all[..] } else { &all[..1] };
    let percent = all.iter().flat_map(|comparison| &comparison.difference.percent);
    let mut sizes: Vec<f64> = percent.filter(|x| x.is_finite()).map(|x| x.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let limit = sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0).max(1.0);
    let side = 2 * AROUND + 1;
    let label =
        format!("difference in percent of the other image, over {side} × {side} pixels: blue where the BSDF is darker");
    let map = |difference: &Difference| {
        Heatmap::new(own.width(), difference.percent.clone(), Shading::Diverging, label.as_str()).range(-limit, limit)
    };
    let row = |Comparison { caption, image, difference, .. }: &Comparison| {
        let mean = signed(difference.mean_difference_percent);
        [
            (found.bsdf.clone(), shown(own)),
            (caption.clone(), shown(image)),
            (
                format!(
                    "difference, {mean} % in the mean over the spheres (standard error {:.1} %)",
                    difference.standard_error_percent
                ),
                map(difference).image(),
            ),
        ]
    };
    let cells: Vec<(String, Rgb8)> = all.iter().flat_map(row).collect();
    let title = format!("{} on {}: {}", found.bsdf, found.scene, cause(found));
    Drawing::stacked(vec![contact_sheet(&title, 3, &cells), map(all[0].difference).bar(360.0)], 0.5)
}

/// Which part of the BSDF makes the difference that is told first.
fn cause(found: &Appearance) -> String {
    match (found.sampling.is_seen(), found.of_model.is_seen() && is_close(found)) {
        (true, _) => "samples, pdf or weights change the image".into(),
        (false, true) => {
            format!("f is not that of {}; no difference found from the image by its values alone", found.model.name)
        }
        (false, false) => "no difference found from the image by its values alone".into(),
    }
}

fn named(Model { name, parameters, .. }: &Model) -> String {
    let values: Vec<String> =
        parameters.iter().map(|(name, value)| format!("{name}\u{a0}=\u{a0}{}", rounded(*value, 3))).collect();
    if values.is_empty() { name.clone() } else { format!("{name} ({})", values.join(", ")) }
}

fn signed(percent: f64) -> String {
    let rounded = (10.0 * percent).round() / 10.0;
    if rounded == 0.0 { "0.0".to_owned() } else { format!("{rounded:+.1}").replace('-', "−") }
}

/// The mean difference that tells most first, then the other.
pub fn text(found: &Appearance) -> String {
    let Appearance { bsdf, model, scene, width, height, spp, .. } = found;
    let mut text = wrapped(&format!("{bsdf}: {}", cause(found)), "", LINE);
    for Comparison { other, difference, .. } in comparisons(found) {
        let (mean, error) = (difference.mean_difference_percent, difference.standard_error_percent);
        let direction = if mean < 0.0 { "darker" } else { "brighter" };
        let of_mean = if difference.is_seen_in_mean() {
            format!(
                "it makes the spheres of {scene} {:.1} % {direction} (standard error {error:.1} %) than {other}",
                mean.abs()
            )
        } else {
            format!(
                "it is not found to make the spheres of {scene} darker or brighter than {other}: {} % in the mean (standard error {error:.1} %); \
                 {:.1} % would have been found (with 90 % probability, at a level of {} %)",
                signed(mean),
                difference.detectable_percent,
                100.0 * LEVEL
            )
        };
        let said = format!(
            "{of_mean}; pixels differ by {:.1} % in the mean, of which noise makes {:.1} %",
            difference.pixel_difference_percent, difference.pixel_noise_percent
        );
        text += &wrapped(&said, "  ", LINE);
    }
    let apart = 100.0 * model.difference;
    let name = &model.name;
    let far = if is_close(found) { "" } else { ": no model is close, and a right BSDF would differ from it, too" };
    text += &wrapped(
        &format!("its values differ by {apart:.1} % from those of {name}, the closest model{far}"),
        "  ",
        LINE,
    );
    if found.dropped > 0 {
        text += &format!("{} paths with light below 0 or not finite count as black\n", found.dropped);
    }
    text + &format!("{width}x{height}, {spp} samples per pixel: {:.1} s\n", found.seconds)
}

#[cfg(test)]
mod tests {
    use super::signed;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!([-0.04, 0.04, -0.06, 1.25, -2.0].map(signed), ["0.0", "0.0", "−0.1", "+1.3", "−2.0"]);
    }
}
