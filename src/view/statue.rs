//! Images of metal statues, and the comparison of two sampling strategies on one.

use super::depth::{SHOWN, captioned};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use crate::study::roughness::StatueRender;
use crate::study::sampling_strategies::{ProfileBin, StrategyComparison};

pub fn image(shot: &StatueRender, metal: &str) -> Drawing {
    let row = &shot.row;
    let caption = format!(
        "{metal}, /{{α}} = {}; {} samples per pixel; mean radiance of the statue {:.3}, {:.3}, {:.3}; {SHOWN}",
        row.alpha, row.spp, row.statue_r, row.statue_g, row.statue_b
    );
    captioned(caption, &shot.rendered.image)
}

/// A copper statue by one sampling strategy.
pub fn strategy(shot: &StatueRender, how: &str) -> Drawing {
    let row = &shot.row;
    let caption = format!(
        "{how}; {} samples per pixel, one light sample each; standard error on the statue {:.3}; {SHOWN}",
        row.spp, row.noise
    );
    captioned(caption, &shot.rendered.image)
}

/// Noise of both strategies over the image on one scale, and below it radiance and noise by distance from the silhouette.
pub fn errors(result: &StrategyComparison) -> Drawing {
    Drawing::stacked(vec![maps(result), profile(result)], 0.0, 2.0)
}

const SCALE: (f64, f64) = (0.003, 3.0);
/// Larger maps are averaged over blocks of pixels.
const WIDEST: usize = 240;

fn maps(result: &StrategyComparison) -> Drawing {
    let panel = |shot: &StatueRender, title: &str| {
        let error = shot.rendered.part.film.standard_error();
        let (width, height) = (error.width() as f64, error.height() as f64);
        let error = error.reduced(error.width().div_ceil(WIDEST));
        let values = error.pixels().iter().map(|p| f64::from(p.element_sum()) / 3.0).collect();
        let map = Heatmap::new(error.width(), values, Shading::Log10, "standard error").range(SCALE.0, SCALE.1);
        let (x, y) = (Axis::linear("pixel column").range(0.0, width), Axis::linear("pixel row").range(height, 0.0));
        Panel::new(x, y).title(title).heatmap(map)
    };
    let panels =
        [panel(&result.importance, "importance"), panel(&result.hemisphere, "hemisphere (grey: all samples equal)")];
    Plot::new(panels).frame_size(300.0, 225.0).draw()
}

/// Light, what the eye sees of it, and noise, at each distance from the silhouette.
fn profile(result: &StrategyComparison) -> Drawing {
    let strokes =
        [theme::IMPORTANCE_SAMPLING, theme::HEMISPHERE_SAMPLING].map(|colour| Stroke::solid(colour, theme::LINE));
    let middle = |b: &ProfileBin| (b.from_px + b.to_px) / 2.0;
    let of = |f: fn(&ProfileBin) -> f64| -> Vec<Point> { result.profile.iter().map(|b| [middle(b), f(b)]).collect() };
    let panel = |title: &str, y: Axis, importance: fn(&ProfileBin) -> f64, hemisphere: fn(&ProfileBin) -> f64| {
        Panel::new(Axis::linear("pixels inside the silhouette"), y)
            .title(title)
            .line("importance", strokes[0], of(importance))
            .line("hemisphere", strokes[1], of(hemisphere))
            .vertical(0.0, "")
    };
    let band = |mean: fn(&ProfileBin) -> f64, error: fn(&ProfileBin) -> f64| -> Vec<[f64; 3]> {
        let around = |b: &ProfileBin| [middle(b), mean(b) - 2.0 * error(b), mean(b) + 2.0 * error(b)];
        result.profile.iter().map(around).collect()
    };
    let [light, median] = [Axis::linear("mean radiance"), Axis::linear("median radiance")];
    Plot::new([
        panel("light, ± 2 standard errors", light, |b| b.importance_mean, |b| b.hemisphere_mean)
            .band("", strokes[0].colour, band(|b| b.importance_mean, |b| b.importance_mean_error))
            .band("", strokes[1].colour, band(|b| b.hemisphere_mean, |b| b.hemisphere_mean_error)),
        panel("median of the pixels", median, |b| b.importance_median, |b| b.hemisphere_median),
        panel("noise of a pixel", Axis::log("standard error"), |b| b.importance_error, |b| b.hemisphere_error),
    ])
    .frame_size(210.0, 190.0)
    .draw()
}
