//! The white sphere under the environment map, beside its error: `sphere-8`, `sphere-16`, `sphere-32`, `sphere-64`; and its error
//! against samples and time: `sphere-error`.

use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Rgb8, Shading, Stroke, contact_sheet, theme};
use crate::gallery::prelude::*;
use crate::view::converge::{ERROR_LABEL, GUIDE, label, round};
use etalon_bench::sphere::{self as study, AtNormal, Exact, Label, PBRT_RMSE, Series, SphereRender, SphereRow};
use etalon_core::raster::{ToneMap, to_rgb8};
use etalon_core::scene::builtin::SPHERE_ENV_SCALE;
use etalon_render::Settings;

/// Samples per pixel of the report's renders.
const SPP: [u32; 4] = [8, 16, 32, 64];

/// The exact image at a width in pixels.
fn exact(inputs: &Inputs, studies: &mut Studies, width: usize) -> Result<Rc<Exact>> {
    studies.get(width.to_string(), || Ok(Exact::new(&inputs.map.map, f64::from(SPHERE_ENV_SCALE), width)))
}

pub fn figures() -> Vec<Maker> {
    let sphere = |spp: u32| maker(format!("sphere-{spp}"), move |inputs, studies| content(inputs, studies, spp));
    SPP.map(sphere).into_iter().chain([maker("sphere-error", errors)]).collect()
}

/// The sphere at one number of samples per pixel.
fn shot(inputs: &Inputs, studies: &mut Studies, spp: u32) -> Result<Rc<SphereRender>> {
    let exact = exact(inputs, studies, inputs.effort.of(511, 127))?;
    let settings = Settings { seed: inputs.seed, ..Settings::usual() };
    studies.get(spp.to_string(), || study::render_sphere(&inputs.map, spp, &exact, &settings))
}

fn content(inputs: &Inputs, studies: &mut Studies, spp: u32) -> Result<Content> {
    // One scale for all; the noisiest of them reaches beyond it
    let [noisiest, of_scale] = [shot(inputs, studies, SPP[0])?, shot(inputs, studies, SPP[1])?];
    let shot = shot(inputs, studies, spp)?;
    let mut checks = vec![
        Check::within("relative bias", 0.0, shot.row.rel_bias, 2e-3),
        Check::equal("dropped samples", 0.0, shot.dropped.total() as f64),
    ];
    if spp > SPP[0] {
        let name =
            format!("RMSE over that of {} samples per pixel (1.1 times the root of the ratio of samples)", SPP[0]);
        let limit = 1.1 * (f64::from(SPP[0]) / f64::from(spp)).sqrt();
        checks.push(Check::at_most(name, shot.row.rel_rmse / noisiest.row.rel_rmse, limit));
    }
    // PBRT's errors were measured on the Grace map: no other map's can be compared with them.
    if let Some((_, rmse)) = PBRT_RMSE.iter().find(|(n, _)| *n == spp) {
        let check = Check::at_most("relative RMSE (half of PBRT-v2's)", shot.row.rel_rmse, rmse / 2.0);
        checks.push(check.unless(inputs.other_map()));
    }
    let content = Content::new(image_and_error(&shot, &of_scale), &[shot.row], checks)?;
    Ok(content.with_image(&shot.image, ToneMap::LinearMax))
}

/// The exact image with a ninth of the pixels, which are enough to measure errors.
pub fn small(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Exact>> {
    exact(inputs, studies, inputs.effort.of(171, 127))
}

/// Renders by each strategy; the last one is the report's.
pub fn series(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Vec<Series>>> {
    let exact = small(inputs, studies)?;
    studies.get("sphere", || study::compare(&inputs.map, &SPP, &exact, inputs.seed))
}

fn errors(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let series = series(inputs, studies)?;
    let other_map = inputs.other_map();
    let mut checks: Vec<Check> = series.iter().map(slope).collect();
    let radiances = study::against_pbrt(&inputs.map.map);
    checks.extend(radiances.iter().flat_map(radiance).map(|check| check.unless(other_map.as_deref())));
    Content::new(curves(&series, other_map.is_none()), &rows(&series), checks)
}

/// Independent random numbers have a slope of −1/2 over the camera paths; scrambled Sobol' points must not be worse.
fn slope(series: &Series) -> Check {
    let name = format!("slope of the error over camera paths (−1/2 + 3 standard errors), {}", series.label.strategy);
    Check::at_most(name, series.slope.value, -0.5 + 3.0 * series.slope.standard_error)
}

fn radiance(at: &AtNormal) -> [Check; 3] {
    let [x, y, z] = at.normal;
    [(0, "R"), (1, "G"), (2, "B")].map(|(c, channel)| {
        let name = format!("radiance at n = ({x:.3} {y:.3} {z:.3}) as PBRT renders it, {channel}");
        Check::within(name, at.pbrt[c], at.exact[c], 0.01 * at.pbrt[c])
    })
}

/// The render and its relative error, side by side, on the scale of the errors of another one.
fn image_and_error(shot: &SphereRender, of_scale: &SphereRender) -> Drawing {
    let image = &shot.image;
    let rendered = Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops: 1.0 }));
    let row = &shot.row;
    let limit = 100.0 * round(largest_of_most(&of_scale.relative_error));
    let percent = shot.relative_error.iter().map(|error| 100.0 * error).collect();
    let errors = Heatmap::new(image.width(), percent, Shading::Diverging, ERROR_LABEL).range(-limit, limit);
    let paths = f64::from(row.spp) * row.camera_paths_per_sample;
    let title = match paths.round() > f64::from(row.spp) {
        true => format!("{} samples per pixel (adaptive: {paths:.0} camera paths)", row.spp),
        false => format!("{} samples per pixel", row.spp),
    };
    let error = format!(
        "relative error, RMSE {:.2}\u{a0}%; grey: the rim, and where the camera touches the sphere",
        100.0 * row.rel_rmse
    );
    let cells = [("rendered, shown one stop brighter".into(), rendered), (error, errors.image())];
    Drawing::stacked(vec![contact_sheet(&title, 2, &cells), errors.bar(420.0)], 0.5)
}

/// The modulus that 95 % of the errors do not exceed.
fn largest_of_most(errors: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = errors.iter().filter(|e| e.is_finite()).map(|e| e.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    sizes.get(sizes.len() * 95 / 100).copied().unwrap_or(f64::NAN)
}

fn rows(series: &[Series]) -> Vec<(Label, SphereRow)> {
    series.iter().flat_map(|s| s.rows.iter().map(|row| (s.label, *row))).collect()
}

/// Error against camera paths and against time, both logarithmic; on the Grace map, PBRT-v2's beside them, whose samples have one
/// path each.
fn curves(series: &[Series], with_pbrt: bool) -> Drawing {
    let axis = || Axis::log("relative RMSE");
    let paths = Axis::log("camera paths per pixel").at([8.0, 16.0, 32.0, 64.0, 128.0]);
    let mut by_paths = Panel::new(paths, axis()).title("Error against camera paths");
    let mut by_time = Panel::new(Axis::log("render time (s)"), axis()).title("Error against time");
    let names: Vec<&str> = series.iter().map(|s| s.label.strategy).collect();
    let colours = theme::strategies(&names);
    for (i, s) in series.iter().enumerate() {
        let stroke = Stroke { colour: colours[i], ..theme::series(i) };
        let label = match &s.chosen {
            Some(chosen) => format!("{} (default)", label(&chosen.name)),
            None => label(s.label.strategy),
        };
        let points = |x: fn(&SphereRow) -> f64| -> Vec<Point> { s.rows.iter().map(|r| [x(r), r.rel_rmse]).collect() };
        let (paths, time) = (points(SphereRow::camera_paths), points(|r| r.seconds));
        by_paths = by_paths.dotted_line(label.clone(), stroke, paths);
        by_time = by_time.dotted_line(label, stroke, time);
    }
    if with_pbrt {
        let stroke = Stroke { colour: theme::REFERENCE, width: theme::LINE, dash: theme::DOTTED };
        let points: Vec<Point> = PBRT_RMSE.iter().map(|&(spp, e)| [f64::from(spp), e]).collect();
        by_paths = by_paths.dotted_line("PBRT-v2", stroke, points);
    }
    // From above all curves at the first level
    let start = series.iter().filter_map(|s| s.rows.first()).map(|row| 1.5 * row.rel_rmse).fold(0.0, f64::max);
    let guide = |from: f64, to: f64| [from, to].map(|at: f64| [at, start * (from / at).sqrt()]);
    let times = || series.iter().flat_map(|s| &s.rows).map(|row| row.seconds);
    let (first, last) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    by_paths = by_paths.line(GUIDE, theme::GUIDE, guide(8.0, 128.0));
    by_time = by_time.line(GUIDE, theme::GUIDE, guide(first, last));
    Plot::new([by_paths, by_time].map(Panel::with_names_on_curves)).draw()
}
