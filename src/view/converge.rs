//! Error against run time by strategy: curves with their slopes, efficiency, images at equal time, the table.

use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Rgb8, Shading, Stroke, contact_sheet, theme};
use crate::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use crate::study::converge::Convergence;
use crate::study::converge::curve::{Curve, CurveVerdict, Level};
use serde::Serialize;

/// One level of one strategy. Field names are the CSV columns; errors are those of radiance, intervals of 95 %.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Row {
    strategy: String,
    spp: u32,
    replicates: usize,
    cpu_seconds: f64,
    wall_seconds: f64,
    preparation_seconds: f64,
    rmse: f64,
    rmse_low: f64,
    rmse_high: f64,
    rel_mse: f64,
    rel_mse_half_width: f64,
    /// Mean HDR-FLIP of the first replicate.
    flip: Option<f64>,
    /// 1 / (MSE · processor seconds).
    efficiency_per_second: f64,
    /// p of RMSE ∝ sppᵖ.
    slope: f64,
    slope_half_width: f64,
    /// Of the last level.
    mean_squared_bias: f64,
    mean_squared_bias_error: f64,
    verdict: &'static str,
    /// Processor seconds until every strategy without bias has the same RMSE; empty if never.
    seconds_to_common_rmse: Option<f64>,
}

pub fn rows(result: &Convergence) -> Vec<Row> {
    let target = result.common_rmse();
    let of_curve = |curve: &Curve| {
        let Curve { strategy, replicates, slope, bias2, verdict, preparation_seconds, .. } = curve.clone();
        let seconds_to_common_rmse = curve.time_to(target);
        let row = move |level: &Level| {
            let [rmse_low, rmse_high] = level.rmse_band();
            Row {
                strategy: strategy.name.clone(),
                spp: level.spp,
                replicates,
                cpu_seconds: level.cpu_seconds,
                wall_seconds: level.wall_seconds,
                preparation_seconds,
                rmse: level.rmse(),
                rmse_low,
                rmse_high,
                rel_mse: level.rel_mse.value,
                rel_mse_half_width: level.rel_mse.half_width,
                flip: level.flip,
                efficiency_per_second: level.efficiency,
                slope: slope.value,
                slope_half_width: slope.half_width,
                mean_squared_bias: bias2.value,
                mean_squared_bias_error: bias2.standard_error,
                verdict: word(verdict),
                seconds_to_common_rmse,
            }
        };
        curve.levels.iter().map(row).collect::<Vec<_>>()
    };
    result.curves.iter().flat_map(of_curve).collect()
}

pub fn word(verdict: CurveVerdict) -> &'static str {
    match verdict {
        CurveVerdict::Biased => "biased",
        CurveVerdict::MonteCarlo => "as Monte Carlo",
        CurveVerdict::Faster => "faster",
        CurveVerdict::Slower => "slower",
        CurveVerdict::Unknown => "unknown",
    }
}

/// "light: −0.50 ± 0.02", or what is wrong with it.
fn label(curve: &Curve) -> String {
    let name = curve.strategy.name.replace('+', ", ");
    match curve.verdict {
        CurveVerdict::Biased => format!("{name}: bias {}", short(curve.bias2.value.sqrt())),
        CurveVerdict::Unknown => name,
        _ => format!("{name}: {}", signed(curve.slope.value, curve.slope.half_width)),
    }
}

/// Two digits that count: "0.0020", "0.31".
fn short(value: f64) -> String {
    let digits = (1.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

/// "−0.50 ± 0.02".
fn signed(value: f64, half_width: f64) -> String {
    let sign = if value < 0.0 { "−" } else { "" };
    let digits = if half_width < 0.0095 { 3 } else { 2 };
    format!("{sign}{:.digits$} ± {half_width:.digits$}", value.abs())
}

/// The strokes of all curves: a colour for each strategy, solid for Sobol' points, dashed for independent random numbers.
fn strokes(result: &Convergence) -> Vec<Stroke> {
    let names: Vec<String> = result.curves.iter().map(|c| c.strategy.name.replace("+independent", "")).collect();
    let mut distinct: Vec<&str> = names.iter().map(String::as_str).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let colours = theme::strategies(&distinct);
    let stroke = |(curve, name): (&Curve, &String)| {
        let dash = if curve.strategy.is_independent() { theme::DASHED } else { theme::SOLID };
        let colour = distinct.binary_search(&name.as_str()).map_or(theme::INK, |place| colours[place]);
        Stroke { dash, ..Stroke::solid(colour, theme::LINE) }
    };
    result.curves.iter().zip(&names).map(stroke).collect()
}

/// Error against processor time and against samples, and efficiency at equal time.
pub fn curves(result: &Convergence) -> Drawing {
    let against = |title: &str, x: Axis, at: &dyn Fn(&Level) -> f64| {
        let mut panel = Panel::new(x, Axis::log("RMSE of radiance")).title(title);
        for (curve, stroke) in result.curves.iter().zip(strokes(result)) {
            let points: Vec<_> = curve.levels.iter().map(|level| with_band(at(level), level)).collect();
            panel = panel.banded_line(label(curve), stroke, &points);
        }
        panel = panel.line("slope −1/2", theme::GUIDE, guide(result, at));
        match &result.reference {
            Some(facts) if !facts.exact => panel.horizontal(facts.rmse, "error of the reference"),
            _ => panel,
        }
    };
    let time = against("Error against time", Axis::log("processor time (s)"), &|l| l.cpu_seconds);
    let samples = against("Error against samples", Axis::log("samples per pixel"), &|l| f64::from(l.spp));
    Plot::new([time, samples, efficiency(result)]).frame_size(330.0, 300.0).draw()
}

/// A level at `x`, with the interval of its error.
pub fn with_band(x: f64, level: &Level) -> [f64; 4] {
    let [low, high] = level.rmse_band();
    [x, low, level.rmse(), high]
}

/// Two points on a line of slope −1/2 above all curves.
fn guide(result: &Convergence, at: &dyn Fn(&Level) -> f64) -> Vec<[f64; 2]> {
    let levels = || result.curves.iter().flat_map(|curve| &curve.levels).filter(|level| level.rmse() > 0.0);
    let scale = levels().map(|l| l.rmse() * at(l).sqrt()).fold(0.0, f64::max) * 1.4;
    let (first, last) = levels().fold((f64::INFINITY, 0.0_f64), |(lo, hi), l| (lo.min(at(l)), hi.max(at(l))));
    vec![[first, scale / first.sqrt()], [last, scale / last.sqrt()]]
}

/// 1 / (MSE · time) of each strategy, at the level nearest to the time that all have had.
fn efficiency(result: &Convergence) -> Panel {
    let seconds = result.common_seconds();
    let title = format!("Efficiency at equal time ({})", duration(seconds));
    let count = result.curves.len() as f64;
    let x = Axis::linear("strategies, in the order of the legend").range(0.0, count).at([-1.0]);
    let mut panel = Panel::new(x, Axis::log("1 / (MSE · time) (1/s)")).title(title);
    for (i, (curve, stroke)) in result.curves.iter().zip(strokes(result)).enumerate() {
        let Some(level) = curve.nearest(seconds).map(|at| &curve.levels[at]) else { continue };
        let left = i as f64;
        panel = panel.bars("", stroke.colour, vec![left + 0.15, left + 0.85], vec![level.efficiency]);
        let [low, high] = level.mse.positive().map(|mse| 1.0 / (mse * level.cpu_seconds));
        panel = panel.line("", Stroke::solid(theme::INK, 1.0), [[left + 0.5, low], [left + 0.5, high]]);
        panel = panel.line(label(curve), stroke, Vec::new());
    }
    panel.line("slope −1/2", theme::GUIDE, Vec::new())
}

/// "0.52 s", "31 ms".
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s >= 10.0 => format!("{s:.0} s"),
        s if s >= 1.0 => format!("{s:.1} s"),
        s if s >= 0.1 => format!("{s:.2} s"),
        s => format!("{:.1} ms", 1e3 * s),
    }
}

/// Every strategy's image after equal time, with its relative error beside it.
pub fn images(result: &Convergence) -> Drawing {
    let seconds = result.common_seconds();
    let Some(truth) = &result.truth else { return contact_sheet("Nothing was measured", 1, &[]) };
    let truth = truth.image();
    let mean = result.reference.as_ref().map_or(f64::NAN, |facts| facts.mean);
    // Each strategy at the level nearest to the common time
    let shown: Vec<(&Curve, &Level, &Image)> = result
        .curves
        .iter()
        .filter_map(|curve| curve.nearest(seconds).map(|at| (curve, &curve.levels[at], &curve.images[at])))
        .collect();
    // One scale of errors for all: the median RMSE, rounded up
    let mut errors: Vec<f64> = shown.iter().map(|(_, level, _)| level.rmse() / mean).collect();
    errors.sort_by(f64::total_cmp);
    let limit = round(errors.get(errors.len() / 2).copied().unwrap_or(0.05));
    let tone = ToneMap::Srgb { stops: auto_exposure(&truth) };
    let mut cells = Vec::new();
    for (curve, level, image) in shown {
        let relative = image.pixels().iter().zip(truth.pixels()).map(|(p, q)| {
            let (got, expected) = (f64::from(p.element_sum()), f64::from(q.element_sum()));
            // Relative to at least 3 % of the mean
            (got - expected) / expected.max(0.03 * mean)
        });
        let map = Heatmap::new(image.width(), relative.collect(), Shading::Diverging, "").range(-limit, limit).image();
        let shown = Rgb8::new(image.width(), image.height(), to_rgb8(image, &tone));
        let caption = format!(
            "{}: {} spp, {}, RMSE {}\u{a0}%",
            curve.strategy.name.replace('+', ", "),
            level.spp,
            duration(level.cpu_seconds),
            short(100.0 * level.rmse() / mean)
        );
        cells.push((caption, beside(&shown, &map)));
    }
    let title = format!("About {} of processor time each; relative error, ±{} %", duration(seconds), 100.0 * limit);
    contact_sheet(&title, 4, &cells)
}

fn beside(left: &Rgb8, right: &Rgb8) -> Rgb8 {
    let width = left.width();
    Rgb8::from_fn(2 * width, left.height(), |x, y| {
        let (image, x) = if x < width { (left, x) } else { (right, x - width) };
        image.pixel(x, y)
    })
}

/// The next of 1, 2, 5 times a power of ten.
fn round(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let power = 10.0_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|m| *m >= value).unwrap_or(value)
}

/// Curves above images at equal time.
pub fn sheet(result: &Convergence) -> Drawing {
    Drawing::stacked(vec![curves(result), images(result)], 0.5, 2.0)
}
