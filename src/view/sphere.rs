//! The sphere under an environment map: the render beside its error, and error against samples and time.

use super::converge::round;
use super::converge_images::ERROR_LABEL;
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Rgb8, Shading, Stroke, contact_sheet, theme};
use crate::raster::{ToneMap, to_rgb8};
use crate::study::sphere::{Label, PBRT_RMSE, Series, SphereRender, SphereRow};

/// The render and its relative error, side by side; the scale is that of the `noisiest` of a series.
pub fn shot(shot: &SphereRender, noisiest: &SphereRender) -> Drawing {
    let image = &shot.rendered.image;
    let rendered = Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops: 1.0 }));
    let row = &shot.row;
    let limit = 100.0 * round(largest_of_most(&noisiest.relative_error));
    let percent = shot.relative_error.iter().map(|error| 100.0 * error).collect();
    let errors = Heatmap::new(image.width(), percent, Shading::Diverging, ERROR_LABEL).range(-limit, limit);
    let title = format!(
        "{} samples per pixel, {:.2} camera paths in each, {} light samples",
        row.spp, row.camera_paths_per_sample, row.light_samples
    );
    let error = format!("relative error; RMSE {:.2}\u{a0}%", 100.0 * row.rel_rmse);
    let cells = [("rendered, shown one stop brighter".into(), rendered), (error, errors.image())];
    Drawing::stacked(vec![contact_sheet(&title, 2, &cells), errors.bar(420.0)], 0.5, 2.0)
}

/// The modulus that 95 % of the errors do not exceed.
fn largest_of_most(errors: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = errors.iter().filter(|e| e.is_finite()).map(|e| e.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    sizes.get(sizes.len() * 95 / 100).copied().unwrap_or(f64::NAN)
}

pub fn rows(series: &[Series]) -> Vec<(Label, SphereRow)> {
    series.iter().flat_map(|s| s.rows.iter().map(|row| (s.label, *row))).collect()
}

/// Error against camera paths and against time, both logarithmic; on the Grace map, PBRT-v2's beside them, whose samples have one
/// path each.
pub fn errors(series: &[Series], with_pbrt: bool) -> Drawing {
    let axis = || Axis::log("relative RMSE");
    let paths = Axis::log("camera paths per pixel").at([8.0, 16.0, 32.0, 64.0, 128.0]);
    let mut by_paths = Panel::new(paths, axis()).title("Error against camera paths");
    let mut by_time = Panel::new(Axis::log("render time (s)"), axis()).title("Error against time");
    let names: Vec<&str> = series.iter().map(|s| s.label.strategy).collect();
    let colours = theme::strategies(&names);
    for (i, s) in series.iter().enumerate() {
        let (stroke, label) = (Stroke { colour: colours[i], ..theme::series(i) }, s.label.strategy);
        let points = |x: fn(&SphereRow) -> f64| -> Vec<Point> { s.rows.iter().map(|r| [x(r), r.rel_rmse]).collect() };
        let (paths, time) = (points(SphereRow::camera_paths), points(|r| r.seconds));
        by_paths = by_paths.dotted_line(label, stroke, paths);
        by_time = by_time.dotted_line(label, stroke, time);
    }
    if with_pbrt {
        let stroke = Stroke { colour: theme::REFERENCE, width: theme::LINE, dash: theme::DOTTED };
        let points: Vec<Point> = PBRT_RMSE.iter().map(|&(spp, e)| [f64::from(spp), e]).collect();
        by_paths = by_paths.dotted_line("PBRT-v2", stroke, points);
    }
    Plot::new([by_paths, by_time]).draw()
}
