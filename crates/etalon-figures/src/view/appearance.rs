//! A BSDF of another program on spheres, beside the closest model and their difference.

use super::text::{LINE, rounded, wrapped};
use crate::figure::{Drawing, Heatmap, Rgb8, Shading, contact_sheet};
use etalon_bench::appearance::{Appearance, Model};
use etalon_core::raster::{Image, ToneMap, auto_exposure, to_rgb8};

/// Models with a larger difference of their values are not close.
const FAR: f64 = 0.1;

/// Three panels: the BSDF, the model, and the difference in percent with its scale.
pub fn drawing(found: &Appearance) -> Drawing {
    let [a, b] = &found.images;
    // One exposure for both, so that a difference in brightness is seen
    let stops = auto_exposure(b);
    let shown = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops }));
    let mut sizes: Vec<f64> = found.percent.iter().filter(|x| x.is_finite()).map(|x| x.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let limit = sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0).max(1.0);
    let label = "difference in percent of the model's pixel: blue where the BSDF is darker";
    let map = Heatmap::new(a.width(), found.percent.clone(), Shading::Diverging, label).range(-limit, limit);
    let mean = signed(found.mean_difference_percent);
    let cells = [
        (found.bsdf.clone(), shown(a)),
        (named(&found.model), shown(b)),
        (format!("difference, {mean} % in the mean over the spheres"), map.image()),
    ];
    let title = format!("{} on {}", found.bsdf, found.scene);
    Drawing::stacked(vec![contact_sheet(&title, 3, &cells), map.bar(360.0)], 0.5)
}

/// A model with its parameters.
fn named(Model { name, parameters, .. }: &Model) -> String {
    let values: Vec<String> =
        parameters.iter().map(|(name, value)| format!("{name}\u{a0}=\u{a0}{}", rounded(*value, 3))).collect();
    if values.is_empty() { name.clone() } else { format!("{name} ({})", values.join(", ")) }
}

fn signed(percent: f64) -> String {
    format!("{percent:+.1}").replace('-', "−")
}

/// The mean difference first, then what it is compared with.
pub fn text(found: &Appearance) -> String {
    let Appearance { bsdf, model, scene, width, height, spp, .. } = found;
    let percent = found.mean_difference_percent;
    let direction = if percent < 0.0 { "darker" } else { "brighter" };
    let said = format!(
        "{bsdf} makes the spheres of {scene} {:.1} ± {:.1} % {direction} than {}, the closest model",
        percent.abs(),
        found.standard_error_percent,
        named(model)
    );
    let mut text = wrapped(&said, "", LINE);
    text += &format!(
        "pixels differ by {:.1} % in the mean; noise alone makes {:.1} %\n",
        found.pixel_difference_percent, found.pixel_noise_percent
    );
    let apart = 100.0 * model.difference;
    let far = if model.difference > FAR {
        ": no model is close, and a right BSDF would differ, too; compare images of two versions of it by `etalon compare`"
    } else {
        ""
    };
    text += &wrapped(&format!("values differ by {apart:.1} %{far}"), "", LINE);
    if found.dropped > 0 {
        text += &format!("{} paths with light below 0 or not finite count as black\n", found.dropped);
    }
    text + &format!("{width}x{height}, {spp} samples per pixel: {:.1} s\n", found.seconds)
}
