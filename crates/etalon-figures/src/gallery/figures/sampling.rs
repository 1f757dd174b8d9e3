//! Importance sampling against hemisphere sampling of a metal statue: `sampling-importance`, `sampling-hemisphere`, `sampling-error`.

use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::converge::label;
use crate::view::depth;
use etalon_bench::roughness::StatueRender;
use etalon_bench::sampling_strategies::{ProfileBin, StrategyComparison, Zone, ZoneImage, compare};
use etalon_bench::table::Table;
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
    Ok(Content::of_csv(noise_and_profile(&result), csv(&result.profile)?, checks))
}

/// The profile as CSV; radiance is (R + G + B) / 3.
fn csv(profile: &[ProfileBin]) -> Result<Vec<u8>> {
    Table::of(profile)
        .field("from_px", |bin| bin.from_px)
        .field("to_px", |bin| bin.to_px)
        .field("pixels", |bin| bin.zone.importance.mean.pixels)
        .field("importance_mean", |bin| bin.zone.importance.light()[0])
        .field("hemisphere_mean", |bin| bin.zone.hemisphere.light()[0])
        .field("importance_mean_error", |bin| bin.zone.importance.light()[1])
        .field("hemisphere_mean_error", |bin| bin.zone.hemisphere.light()[1])
        .field("importance_median", |bin| bin.zone.importance.median[0])
        .field("hemisphere_median", |bin| bin.zone.hemisphere.median[0])
        .field("importance_shown", |bin| bin.zone.importance.shown[0])
        .field("hemisphere_shown", |bin| bin.zone.hemisphere.shown[0])
        .field("importance_error", |bin| bin.zone.importance.noise[0])
        .field("hemisphere_error", |bin| bin.zone.hemisphere.noise[0])
        .csv()
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
    let middle = |bin: &ProfileBin| (bin.from_px + bin.to_px) / 2.0;
    let sides: [fn(&Zone) -> &ZoneImage; 2] = [|zone| &zone.importance, |zone| &zone.hemisphere];
    let panel = |title: &str, y: Axis, of: fn(&ZoneImage) -> f64| {
        let point = |side: fn(&Zone) -> &ZoneImage| move |bin: &ProfileBin| [middle(bin), of(side(&bin.zone))];
        let [importance, hemisphere] = sides.map(|side| result.profile.iter().map(point(side)).collect::<Vec<Point>>());
        Panel::new(Axis::linear("pixels inside the silhouette (< 0: outside)"), y)
            .title(title)
            .line("visible normals", strokes[0], importance)
            .line(label("hemisphere"), strokes[1], hemisphere)
            .vertical(0.0, "")
            .with_names_on_curves()
    };
    let [importance, hemisphere] = sides.map(|side| -> Vec<[f64; 3]> {
        let around = |bin: &ProfileBin| {
            let [mean, error] = side(&bin.zone).light();
            [middle(bin), mean - 2.0 * error, mean + 2.0 * error]
        };
        result.profile.iter().map(around).collect()
    });
    // Intervals of few pixels may reach below 0, which no mean is
    let highest = hemisphere.iter().map(|[_, _, high]| *high).fold(0.0, f64::max);
    let [light, median] = [Axis::linear("mean radiance").range(0.0, 1.05 * highest), Axis::linear("median radiance")];
    Plot::new([
        panel("Mean, ± 2 standard errors", light, |image| image.light()[0])
            .band("", strokes[0].colour, importance)
            .band("", strokes[1].colour, hemisphere),
        panel("Median of the pixels", median, |image| image.median[0]),
        panel("Noise of a pixel", Axis::log("standard error of radiance"), |image| image.noise[0]),
    ])
    .frame_size(240.0, 190.0)
    .draw()
}
