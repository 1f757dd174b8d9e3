//! Pictures of the lit sphere: render beside its error, and error against samples and time.

use crate::error::Result;
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Rgb8, Shading, Stroke, contact_sheet, theme};
use crate::raster::{ToneMap, to_rgb8};
use crate::study::sphere::{Row, Shot};

/// The render and its relative error, side by side.
pub fn shot(shot: &Shot) -> Result<Drawing> {
    let image = &shot.rendered.image;
    let picture = Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops: 1.0 }));
    let limit = 0.05;
    let errors = Heatmap::new(image.width(), shot.relative_error.clone(), Shading::Diverging, "relative error")?
        .range(-limit, limit)
        .image();
    let row = &shot.row;
    Ok(contact_sheet(
        &format!("{} samples per pixel, {} light samples each", row.spp, row.light_samples),
        2,
        &[
            ("rendered, shown one stop brighter".into(), picture),
            (format!("relative error, ±5 %; RMSE {:.2} %", 100.0 * row.rel_rmse), errors),
        ],
    ))
}

/// A strategy's errors, for [`errors`].
pub struct Series<'a> {
    pub label: &'a str,
    pub rows: Vec<Row>,
}

/// Relative RMSE of PBRT-v2 on the report's scene with the Grace map at 8, 16, 32 and 64 samples per pixel, for scale.
pub const PBRT: [(u32, f64); 4] = [(8, 0.107), (16, 0.066), (32, 0.047), (64, 0.026)];

/// Error against samples and against time, both logarithmic.
#[must_use]
pub fn errors(series: &[Series<'_>], with_pbrt: bool) -> Drawing {
    let axis = || Axis::log("relative RMSE");
    let mut by_samples =
        Panel::new(Axis::log("samples per pixel").at([8.0, 16.0, 32.0, 64.0]), axis()).title("error against samples");
    let mut by_time = Panel::new(Axis::log("render time (s)"), axis()).title("error against time");
    for (i, s) in series.iter().enumerate() {
        let stroke = theme::series(i);
        let points = |x: fn(&Row) -> f64| -> Vec<Point> { s.rows.iter().map(|r| [x(r), r.rel_rmse]).collect() };
        let (samples, time) = (points(|r| f64::from(r.spp)), points(|r| r.seconds));
        by_samples = by_samples.line(s.label, stroke, samples.clone()).dots(s.label, stroke.colour, samples);
        by_time = by_time.line(s.label, stroke, time.clone()).dots(s.label, stroke.colour, time);
    }
    if with_pbrt {
        let stroke = Stroke { colour: theme::BLACK, width: theme::LINE, dash: theme::DOTTED };
        let points: Vec<Point> = PBRT.iter().map(|&(spp, e)| [f64::from(spp), e]).collect();
        by_samples = by_samples.line("PBRT-v2", stroke, points.clone()).dots("PBRT-v2", theme::BLACK, points);
    }
    Plot::new([by_samples, by_time]).draw()
}
