//! Pictures of metal statues, and how two ways of drawing directions compare on one.

use super::depth::{SHOWN, as_the_report};
use crate::error::Result;
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, contact_sheet, theme};
use crate::study::roughness::Shot;
use crate::study::sampling_strategies::{Bin, Comparison, errors};

/// One statue.
#[must_use]
pub fn picture(shot: &Shot, metal: &str) -> Drawing {
    let row = &shot.row;
    let caption = format!(
        "{metal}, /{{α}} = {}; {} samples per pixel; mean radiance of the statue {:.3}, {:.3}, {:.3}; {SHOWN}",
        row.alpha as f32, row.spp, row.statue_r, row.statue_g, row.statue_b
    );
    contact_sheet("", 1, &[(caption, as_the_report(&shot.rendered.image))])
}

/// A copper statue by one way of drawing directions: the picture, and its standard error on a scale that both share.
pub fn strategy(shot: &Shot, how: &str, range: [f64; 2]) -> Result<Drawing> {
    let image = &shot.rendered.image;
    let map = Heatmap::new(image.width(), errors(shot), Shading::Log10, "standard error")?.range(range[0], range[1]);
    let row = &shot.row;
    let caption = format!("{how}; {} samples per pixel, {} light sample each; {SHOWN}", row.spp, row.light_samples);
    let scale = format!(
        "standard error of each pixel, dark {} to light {}, logarithmic; over the statue {:.3} (root mean square)",
        range[0],
        range[1],
        rms(shot)
    );
    Ok(contact_sheet("", 2, &[(caption, as_the_report(image)), (scale, map.image())]))
}

/// Root mean square of the standard errors on the statue.
#[must_use]
pub fn rms(shot: &Shot) -> f64 {
    let inside = errors(shot).into_iter().zip(&shot.mask).filter(|(_, inside)| **inside);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (e, _)| (sum + e * e, count + 1.0));
    (sum / count as f64).sqrt()
}

/// What both ways show at each distance from the silhouette: light, what the eye sees of it, and noise.
#[must_use]
pub fn profile(result: &Comparison) -> Drawing {
    let importance = Stroke { colour: theme::BLUE, width: theme::LINE, dash: theme::SOLID };
    let hemisphere = Stroke { colour: theme::VERMILION, width: theme::LINE, dash: theme::SOLID };
    let of = |f: fn(&Bin) -> f64| -> Vec<Point> {
        result.profile.iter().map(|b| [(b.from_px + b.to_px) / 2.0, f(b)]).collect()
    };
    let panel = |title: &str, y: Axis, one: fn(&Bin) -> f64, other: fn(&Bin) -> f64| {
        Panel::new(Axis::linear("distance inside the silhouette (pixels)"), y)
            .title(title)
            .line("importance", importance, of(one))
            .line("hemisphere", hemisphere, of(other))
            .vertical(0.0, "")
    };
    Plot::new([
        panel("light", Axis::linear("mean radiance"), |b| b.importance_mean, |b| b.hemisphere_mean),
        panel("what is seen of it", Axis::linear("median radiance"), |b| b.importance_median, |b| b.hemisphere_median),
        panel("noise", Axis::log("standard error"), |b| b.importance_error, |b| b.hemisphere_error),
    ])
    .frame_size(270.0, 220.0)
    .draw()
}
