//! Importance sampling against hemisphere sampling of a metal statue: `sampling-importance`, `sampling-hemisphere`, `sampling-error`.

use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::converge::label;
use crate::view::depth;
use etalon_bench::roughness::StatueRender;
use etalon_bench::sampling_strategies::{ProfileBin, StrategyComparison, compare};
use etalon_core::raster::ToneMap;

/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// Both renders and their profile.
pub fn both(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<StrategyComparison>> {
    let (scene, request) = inputs.copper()?;
    studies.get("copper", || compare(&scene, &request, &inputs.settings()))
}

pub fn figures() -> Vec<Maker> {
    vec![
        maker("sampling-importance", |inputs, studies| render(inputs, studies, true)),
        maker("sampling-hemisphere", |inputs, studies| render(inputs, studies, false)),
        maker("sampling-error", errors),
    ]
}

fn render(inputs: &Inputs, studies: &mut Studies, importance: bool) -> Result<Content> {
    let result = both(inputs, studies)?;
    let shot = if importance { &result.importance } else { &result.hemisphere };
    let name = |what: &str| format!("{what} by importance sampling minus by hemisphere sampling (standard errors)");
    let checks = vec![
        Check::equal("dropped samples", 0.0, shot.dropped.total() as f64),
        Check::within(name("image"), 0.0, result.picture.z, SIGMAS),
        Check::within(name("statue"), 0.0, result.statue.z, SIGMAS),
    ];
    let content = Content::new(depth::image(&shot.image), std::slice::from_ref(&shot.row), checks)?;
    Ok(content.with_image(&shot.image, ToneMap::SecondReport))
}

fn errors(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let result = both(inputs, studies)?;
    let rim = "rim by importance sampling minus by hemisphere sampling (standard errors)";
    let mut checks = vec![
        Check::within(rim, 0.0, result.rim.z, SIGMAS),
        Check::at_most(
            "median of the rim, hemisphere over importance sampling",
            result.rim.ratio(|image| image.median)[0],
            0.5,
        ),
    ];
    // The light of the report's scene has no surface: only light samples find it, and highlights are nearly as noisy in both.
    let limit = if inputs.originals.is_some() { 1.0 } else { 4.0 };
    let name = "noise on the statue, hemisphere over importance sampling";
    checks.push(Check::at_least(name, result.statue.ratio(|image| image.noise)[0], limit));
    Content::new(noise_and_profile(&result), &result.profile, checks)
}

/// Noise of both strategies over the image on one scale, and below it radiance and noise by distance from the silhouette.
fn noise_and_profile(result: &StrategyComparison) -> Drawing {
    Drawing::stacked(vec![maps(result), profile(result)], 0.5)
}

const SCALE: (f64, f64) = (0.003, 3.0);

fn maps(result: &StrategyComparison) -> Drawing {
    let panel = |shot: &StatueRender, title: &str| {
        let error = &shot.standard_error;
        let (width, height) = (error.width() as f64, error.height() as f64);
        let values = error.pixels().iter().map(|p| f64::from(p.element_sum()) / 3.0).collect();
        let map =
            Heatmap::new(error.width(), values, Shading::Log10, "standard error of radiance (grey: all samples equal)")
                .range(SCALE.0, SCALE.1);
        let (x, y) = (Axis::linear("pixel column").range(0.0, width), Axis::linear("pixel row").range(height, 0.0));
        Panel::new(x, y).title(title).heatmap(map)
    };
    let uniform = format!("Noise: {}", label("hemisphere"));
    let panels = [panel(&result.importance, "Noise: visible normals"), panel(&result.hemisphere, &uniform)];
    Plot::new(panels).frame_size(400.0, 300.0).draw()
}

/// Light, what the eye sees of it, and noise, at each distance from the silhouette.
fn profile(result: &StrategyComparison) -> Drawing {
    let strokes =
        [theme::IMPORTANCE_SAMPLING, theme::HEMISPHERE_SAMPLING].map(|colour| Stroke::solid(colour, theme::LINE));
    let middle = |b: &ProfileBin| (b.from_px + b.to_px) / 2.0;
    let of = |f: fn(&ProfileBin) -> f64| -> Vec<Point> { result.profile.iter().map(|b| [middle(b), f(b)]).collect() };
    let panel = |title: &str, y: Axis, importance: fn(&ProfileBin) -> f64, hemisphere: fn(&ProfileBin) -> f64| {
        Panel::new(Axis::linear("pixels inside the silhouette (< 0: outside)"), y)
            .title(title)
            .line("visible normals", strokes[0], of(importance))
            .line(label("hemisphere"), strokes[1], of(hemisphere))
            .vertical(0.0, "")
            .with_names_on_curves()
    };
    let band = |mean: fn(&ProfileBin) -> f64, error: fn(&ProfileBin) -> f64| -> Vec<[f64; 3]> {
        let around = |b: &ProfileBin| [middle(b), mean(b) - 2.0 * error(b), mean(b) + 2.0 * error(b)];
        result.profile.iter().map(around).collect()
    };
    // Intervals of few pixels may reach below 0, which no mean is
    let highest = result.profile.iter().map(|b| b.hemisphere_mean + 2.0 * b.hemisphere_mean_error).fold(0.0, f64::max);
    let [light, median] = [Axis::linear("mean radiance").range(0.0, 1.05 * highest), Axis::linear("median radiance")];
    Plot::new([
        panel("Mean, ± 2 standard errors", light, |b| b.importance_mean, |b| b.hemisphere_mean)
            .band("", strokes[0].colour, band(|b| b.importance_mean, |b| b.importance_mean_error))
            .band("", strokes[1].colour, band(|b| b.hemisphere_mean, |b| b.hemisphere_mean_error)),
        panel("Median of the pixels", median, |b| b.importance_median, |b| b.hemisphere_median),
        panel(
            "Noise of a pixel",
            Axis::log("standard error of radiance"),
            |b| b.importance_error,
            |b| b.hemisphere_error,
        ),
    ])
    .frame_size(240.0, 190.0)
    .draw()
}
