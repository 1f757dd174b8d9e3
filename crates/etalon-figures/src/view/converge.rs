//! Error against run time by strategy: curves with their slopes, efficiency, the tables, the answer in words; and images after equal
//! time: of every contender the regions where contenders differ most, enlarged, above their errors.

use super::text::{counted, duration, rounded};
use crate::figure::{Axis, Colour, Drawing, Heatmap, Marker, Panel, Plot, Rgb8, Shading, Stroke, contact_sheet, theme};
use etalon_bench::converge::Convergence;
use etalon_bench::converge::answer::{Answer, Ratio, Rival};
use etalon_bench::converge::contender::{Contender, Fault};
use etalon_bench::converge::curve::{Curve, CurveVerdict, Level, Measured, REPLICATES_FOR_VERDICT, Run};
use etalon_bench::converge::strategy::DEFAULT;
use etalon_bench::table::Table;
use etalon_core::error::Result;
use etalon_core::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use serde::Serialize;
use std::rc::Rc;

/// A row for each level of each strategy, as CSV. Errors are those of radiance, intervals of 95 %.
pub fn csv(results: &[&Convergence]) -> Result<Vec<u8>> {
    let curves = results.iter().flat_map(|result| {
        let target = result.common_rmse();
        result.curves.iter().map(move |curve| (curve, target))
    });
    let levels = curves.flat_map(|(curve, target)| curve.levels.iter().map(move |level| (curve, level, target)));
    let levels: Vec<(&Curve, &Level, _)> = levels.collect();
    Table::of(&levels)
        .field("strategy", |(curve, ..)| &curve.strategy)
        .field("spp", |(_, level, _)| level.spp)
        .field("replicates", |(curve, ..)| curve.replicates)
        .field("cpu_seconds", |(_, level, _)| level.cpu_seconds)
        .field("wall_seconds", |(_, level, _)| level.wall_seconds)
        .field("preparation_seconds", |(curve, ..)| curve.preparation_seconds)
        .field("rmse", |(_, level, _)| level.rmse())
        .field("rmse_low", |(_, level, _)| level.rmse_band()[0])
        .field("rmse_high", |(_, level, _)| level.rmse_band()[1])
        .field("rel_mse", |(_, level, _)| level.rel_mse.value)
        .field("rel_mse_half_width", |(_, level, _)| level.rel_mse.half_width)
        // Mean HDR-FLIP, PSNR in dB and SSIM are those of the first replicate
        .field("flip", |(_, level, _)| level.flip)
        .field("psnr", |(_, level, _)| level.psnr)
        .field("ssim", |(_, level, _)| level.ssim)
        // 1 / (MSE · processor seconds)
        .field("efficiency_per_second", |(_, level, _)| level.efficiency)
        // p of RMSE ∝ sppᵖ
        .field("slope", |(curve, ..)| curve.slope.value)
        .field("slope_half_width", |(curve, ..)| curve.slope.half_width)
        // The squared bias of the last level
        .field("mean_squared_bias", |(curve, ..)| curve.bias2.value)
        .field("mean_squared_bias_error", |(curve, ..)| curve.bias2.standard_error)
        .field("verdict", |(curve, ..)| word(curve.verdict))
        // Time to unit variance, MSE · processor seconds: the inverse of the efficiency
        .field("ttuv_seconds", |(_, level, _)| 1.0 / level.efficiency)
        // Mean of the last level's images over that of the reference, minus 1
        .field("mean_bias", |(curve, ..)| curve.mean_bias.value)
        .field("mean_bias_half_width", |(curve, ..)| curve.mean_bias.half_width)
        // Processor seconds until every strategy without bias has the same RMSE; empty if never
        .field("seconds_to_common_rmse", |(curve, _, target)| curve.time_to(*target))
        .csv()
}

/// A row for each image of each replicate, as CSV. Times of renderers in other programs are those of the whole process.
pub fn replicates_csv(result: &Convergence) -> Result<Vec<u8>> {
    let runs =
        result.curves.iter().flat_map(|curve| curve.runs.iter().enumerate().map(move |(i, run)| (curve, i, run)));
    let images = runs.flat_map(|(curve, i, run)| run.levels.iter().map(move |level| (curve, i, run, level)));
    let images: Vec<(&Curve, usize, &Run, &Measured)> = images.collect();
    Table::of(&images)
        .field("strategy", |(curve, ..)| &curve.strategy)
        .field("replicate", |(_, i, ..)| i + 1)
        .field("seed", |(_, _, run, _)| run.seed)
        .field("spp", |(.., level)| level.spp)
        .field("wall_seconds", |(.., level)| level.times.wall)
        .field("cpu_seconds", |(.., level)| level.times.cpu)
        .field("mse", |(.., level)| level.errors.mse)
        // Without the worst 0.1 % of channel values
        .field("mse_trimmed", |(.., level)| level.errors.mse_trimmed)
        .field("rel_mse", |(.., level)| level.errors.rel_mse)
        // The mean of the channel values of the image
        .field("mean", |(.., level)| level.errors.mean_a)
        .csv()
}

/// The methods at their last levels, those with bias and those without a level at the end; their efficiency is that of the answer, after equal time.
pub fn table(result: &Convergence) -> String {
    let target = result.common_rmse();
    let seconds = result.common_seconds();
    let efficiency = |curve: &Curve| curve.log_efficiency_at(seconds).value.exp();
    let is_biased = |curve: &Curve| curve.verdict == CurveVerdict::Biased;
    let mut last: Vec<(&str, Option<(&Curve, &Level)>)> =
        result.curves.iter().filter_map(|c| Some((c.strategy.as_str(), Some((c, c.levels.last()?))))).collect();
    last.sort_by_key(|(_, row)| row.is_some_and(|(curve, _)| is_biased(curve)));
    let failed = failures(result).into_iter().map(|(fault, _)| fault.strategy.as_str());
    last.extend(failed.filter(|name| result.curve(name).is_none()).map(|name| (name, None)));
    let known = |value: f64, text: String| if value.is_finite() { text } else { "unknown".into() };
    let cell = |row: &Option<(&Curve, &Level)>, f: &dyn Fn(&Curve, &Level) -> String| {
        row.map_or(String::new(), |(curve, level)| f(curve, level))
    };
    let mut heading = "biased: another expectation than the reference (the MSE includes the bias)\n";
    Table::of(&last)
        .words("strategy", |(name, _)| name)
        .numbers("spp", |(_, row)| cell(row, &|_, level| level.spp.to_string()))
        .numbers("time", |(_, row)| cell(row, &|_, level| duration(level.cpu_seconds)))
        .numbers("RMSE", |(_, row)| cell(row, &|_, level| rounded(level.rmse(), 3)))
        .numbers("slope", |(_, row)| {
            cell(row, &|Curve { slope, .. }, _| {
                known(slope.half_width, format!("{:.2} ± {:.2}", slope.value, slope.half_width))
            })
        })
        .words("verdict", |(_, row)| row.map_or("failed", |(curve, _)| word(curve.verdict)))
        .numbers("1/(MSE·time) †", |(_, row)| {
            cell(row, &|curve, _| known(efficiency(curve), rounded(efficiency(curve), 3)))
        })
        .numbers("time to *", |(_, row)| {
            cell(row, &|curve, _| match is_biased(curve) {
                true => String::new(),
                false => curve.time_to(target).map_or("never".into(), duration),
            })
        })
        .text_with(|(_, row), line| match row {
            Some((curve, _)) if is_biased(curve) => {
                format!("{}{line}  {}\n", std::mem::take(&mut heading), bias(result, curve))
            }
            _ => line,
        })
}

/// The first failure of each contender of which runs failed, and how many did: "2 of 2 replicates".
pub fn failures(result: &Convergence) -> Vec<(&Fault, String)> {
    let of = |name: &str| result.faults.iter().filter(|fault| fault.strategy == name).count();
    let is_first = |i: &usize| result.faults[..*i].iter().all(|other| other.strategy != result.faults[*i].strategy);
    let told = |i: usize| {
        let fault = &result.faults[i];
        let failed = of(&fault.strategy);
        let all = failed + result.curve(&fault.strategy).map_or(0, |curve| curve.replicates);
        (fault, format!("{failed} of {}", counted(all, "replicate")))
    };
    (0..result.faults.len()).filter(is_first).map(told).collect()
}

/// The bias of a curve in words.
pub fn bias(result: &Convergence, curve: &Curve) -> String {
    if !curve.is_tested() {
        let replicates = counted(curve.replicates, "replicate");
        return format!("bias not tested ({replicates}; {REPLICATES_FOR_VERDICT} are needed)");
    }
    let mean = result.reference.as_ref().map_or(f64::NAN, |facts| facts.mean);
    let parts = [curve.mean_bias.value, curve.mean_bias.half_width, curve.bias2.value.max(0.0).sqrt() / mean];
    match parts.map(|part| 100.0 * part) {
        [value, half_width, rms] if half_width.is_finite() => {
            let rms = if rms > 0.0 { format!("RMS {rms:.2} % of the mean") } else { "RMS not resolved".to_owned() };
            format!("bias: mean of all channels {value:+.2} ± {half_width:.2} %, {rms}")
        }
        _ => "bias: unknown".into(),
    }
}

/// What the tests of a curve without known bias would have found, in words; empty where that is unknown.
pub fn detectable(curve: &Curve) -> String {
    let known =
        [(curve.detectable_mean_bias, "of the image's mean"), (curve.detectable_rms_bias, "of its pixels (RMS)")];
    let parts: Vec<String> = known
        .iter()
        .filter(|(bias, _)| bias.is_finite())
        .map(|(bias, of)| format!("{} % {of}", rounded(100.0 * bias, 2)))
        .collect();
    match parts.as_slice() {
        [] => String::new(),
        parts => format!("no bias found; one of {} would have been found with 90 % probability", parts.join(" or ")),
    }
}

/// The answer in words: a line on the strategy by default, if it is compared; then the best and the others.
pub fn sentences(answer: Option<&Answer>) -> String {
    let Some(answer) = answer else {
        return "no answer: no method that was tested and has no bias has a known efficiency\n".to_owned();
    };
    let default = answer.default.as_ref().map(|rival| of_default(&answer.best, rival)).unwrap_or_default();
    default + &of_best(answer)
}

/// "light-cosine is 1.21 times (95 %: 1.12 to 1.31) as efficient as the default", "the default is the best", or that nothing
/// is known to be better.
fn of_default(best: &str, rival: &Rival) -> String {
    let Rival { rival, ratio, low, high } = rival;
    if *low > 1.0 {
        let [ratio, low, high] = [ratio, low, high].map(|value| rounded(*value, 3));
        format!("{rival} is {ratio} times (95 %: {low} to {high}) as efficient as the default\n")
    } else if best == DEFAULT && *high < 1.0 {
        "the default is the best\n".to_owned()
    } else {
        "nothing is better than the default beyond chance\n".to_owned()
    }
}

/// "best at 0.20 s: mis, 1.3 times the efficiency of light (95 %: 1.2 to 1.5), 22 times that of bsdf (18 to 27)".
fn of_best(answer: &Answer) -> String {
    let [next, others @ ..] = answer.ratios.as_slice() else {
        return format!("{} alone has no known bias\n", answer.best);
    };
    let times = |ratio: &Ratio| format!("{} times", rounded(ratio.ratio, 2));
    let ends = |ratio: &Ratio, confidence: &str| match ratio.high.is_finite() {
        true => format!("({confidence}{} to {})", rounded(ratio.low, 2), rounded(ratio.high, 2)),
        false => "(no interval)".to_owned(),
    };
    let doubt = if next.low > 1.0 { "" } else { ", not beyond chance" };
    let mut text = format!(
        "best at {}{doubt}: {}, {} the efficiency of {} {}",
        duration(answer.cpu_seconds),
        answer.best,
        times(next),
        next.over,
        ends(next, "95 %: ")
    );
    if let Some(last) = others.last() {
        text += &format!(", {} that of {} {}", times(last), last.over, ends(last, ""));
    }
    text + "\n"
}

pub fn word(verdict: CurveVerdict) -> &'static str {
    match verdict {
        CurveVerdict::Biased => "biased",
        CurveVerdict::MonteCarlo => "as 1/√N",
        CurveVerdict::Faster => "steeper",
        CurveVerdict::Slower => "flatter",
        CurveVerdict::Unknown => "unknown",
    }
}

/// Methods, samplers of environment maps, fixed lights and suffixes of strategies in words. Other names stay as they are.
const METHODS: [(&str, &str); 4] =
    [("light", "light sampling"), ("bsdf", "BSDF sampling"), ("hemisphere", "uniform directions"), ("mis", "MIS")];
const SAMPLERS: [(&str, &str); 2] =
    [("cosine-compensated", ", compensated map × cosine"), ("cosine", ", map × cosine")];
const CUTS: [(&str, &str); 2] = [("median-cut", "fixed lights"), ("variance-cut", "fixed lights by variance")];
const SUFFIXES: [(&str, &str); 4] = [
    ("lt", " and light paths"),
    ("adaptive", ", adaptive"),
    ("independent", ", independent numbers"),
    ("all-normals", ", all normals"),
];

/// A strategy's name in words, as all figures have it: "mis-cosine+lt" is "MIS, map × cosine and light paths".
pub fn label(strategy: &str) -> String {
    let in_words = |list: &[(&str, &'static str)], name: &str| {
        list.iter().find(|(known, _)| *known == name).map_or_else(|| format!(", {name}"), |(_, words)| (*words).into())
    };
    let mut parts = strategy.split('+');
    let base = parts.next().unwrap_or_default();
    let cut = CUTS.iter().find_map(|(name, words)| Some((base.strip_prefix(name)?.strip_prefix('-')?, words)));
    let method = METHODS.iter().find_map(|(name, words)| Some((base.strip_prefix(name)?, words)));
    let method = match (cut, method) {
        (Some((count, words)), _) => format!("{count} {words}"),
        (_, Some(("", words))) => (*words).to_owned(),
        (_, Some((map, words))) => format!("{words}{}", in_words(&SAMPLERS, map.trim_start_matches('-'))),
        _ => base.to_owned(),
    };
    method + &parts.map(|suffix| in_words(&SUFFIXES, suffix)).collect::<String>()
}

/// What a contender is called in figures, strategies in words, and whether it is biased.
pub fn shown(curve: &Curve) -> String {
    let name = match (&curve.contender, curve.chosen()) {
        (_, Some(chosen)) => format!("{} (default)", label(&chosen.name)),
        (Contender::Strategy(_), None) if curve.is_chosen_differently() => {
            "default (replicates chose differently)".into()
        }
        (Contender::Strategy(strategy), None) => label(&strategy.name),
        (other, None) => other.name().to_owned(),
    };
    format!("{name}{}", if curve.verdict == CurveVerdict::Biased { " (biased)" } else { "" })
}

/// The strokes of all curves: a colour for each strategy, solid for Sobol' points, dashed for independent random numbers. The default, which does
/// what one of the others does, is wider, and so is a curve on which a later one lies.
fn strokes(result: &Convergence) -> Vec<Stroke> {
    let name = |curve: &Curve| match curve.contender.is_independent() {
        true => curve.strategy.replace("+independent", ""),
        false => curve.strategy.clone(),
    };
    let names: Vec<String> = result.curves.iter().map(name).collect();
    let mut distinct: Vec<&str> = names.iter().map(String::as_str).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let colours = theme::strategies(&distinct);
    let stroke = |(i, (curve, name)): (usize, (&Curve, &String))| {
        let place = distinct.binary_search(&name.as_str()).unwrap_or(0);
        let colour = colours[place];
        // A second strategy of a colour has another pattern.
        let is_second = colours[..place].contains(&colour);
        let dash = match (curve.contender.is_independent(), is_second) {
            (true, false) => theme::DASHED,
            (true, true) => theme::DOTTED,
            (false, false) => theme::SOLID,
            (false, true) => theme::DASH_DOT,
        };
        let times = match curve.contender.is_default() {
            true => 3.0,
            false if result.curves[i + 1..].iter().any(|later| is_beneath(curve, later)) => 2.2,
            false => 1.0,
        };
        let width = times * theme::LINE;
        Stroke { dash, ..Stroke::solid(colour, width) }
    };
    result.curves.iter().zip(&names).enumerate().map(stroke).collect()
}

/// Whether two curves can hardly be distinguished: their errors differ by less than a tenth at all samples that both have.
fn is_beneath(curve: &Curve, later: &Curve) -> bool {
    let pair = |level: &Level| Some((level.rmse(), later.levels.iter().find(|other| other.spp == level.spp)?.rmse()));
    let mut pairs = curve.levels.iter().filter_map(pair).peekable();
    pairs.peek().is_some() && pairs.all(|(a, b)| (a / b).ln().abs() < 0.1)
}

/// Error against processor time and against samples; below, efficiency at equal time and the slopes, a row for each strategy.
pub fn curves(result: &Convergence) -> Drawing {
    let against = |title: &str, x: Axis, at: &dyn Fn(&Level) -> f64| {
        let mut panel = Panel::new(x, Axis::log("RMSE of radiance")).title(title);
        for (curve, stroke) in drawn(result) {
            let points: Vec<_> = curve.levels.iter().map(|level| with_band(at(level), level)).collect();
            panel = panel.banded_line(shown(curve), stroke, &points);
        }
        panel = panel.line(GUIDE, theme::GUIDE, guide(&result.curves.iter().collect::<Vec<_>>(), at));
        match &result.reference {
            Some(facts) if !facts.exact => panel.horizontal(facts.rmse, "error of the reference"),
            _ => panel,
        }
        .with_names_on_curves()
    };
    let time = against("Error against time", Axis::log("processor time (s)"), &|l| l.cpu_seconds);
    let samples = against("Error against samples", Axis::log("samples per pixel"), &|l| f64::from(l.spp));
    let rows = [vec![time, samples], vec![efficiency(result), slopes(result)]];
    Plot::grid(rows.map(|panels| (String::new(), panels))).frame_size(FRAME[0], FRAME[1]).draw()
}

/// What the axis of a value says of its interval.
const INTERVALS: &str = "bars: 95\u{a0}% intervals";
/// Size of the frames of [`curves`].
const FRAME: [f64; 2] = [350.0, 250.0];
/// The name of the guide.
pub const GUIDE: &str = "slope −1/2: independent samples";

/// A level at `x`, with the interval of its error.
pub fn with_band(x: f64, level: &Level) -> [f64; 4] {
    let [low, high] = level.rmse_band();
    [x, low, level.rmse(), high]
}

/// Two points on a line of slope −1/2 above all curves.
pub fn guide(curves: &[&Curve], at: &dyn Fn(&Level) -> f64) -> Vec<[f64; 2]> {
    let levels = || curves.iter().flat_map(|curve| &curve.levels).filter(|level| level.rmse() > 0.0);
    let scale = levels().map(|l| l.rmse() * at(l).sqrt()).fold(0.0, f64::max) * 1.4;
    let (first, last) = levels().fold((f64::INFINITY, 0.0_f64), |(lo, hi), l| (lo.min(at(l)), hi.max(at(l))));
    vec![[first, scale / first.sqrt()], [last, scale / last.sqrt()]]
}

/// The efficiency of a curve at the level nearest to a time, in its interval.
fn efficiency_after(curve: &Curve, seconds: f64) -> Option<[f64; 3]> {
    let level = &curve.levels[curve.nearest(seconds)?];
    let [a, b] = level.mse.positive().map(|mse| 1.0 / (mse * level.cpu_seconds));
    Some([a.min(b), level.efficiency, a.max(b)])
}

/// 1 / (MSE · time) of each strategy, at the level nearest to the time that all have had.
fn efficiency(result: &Convergence) -> Panel {
    let seconds = result.common_seconds();
    let at_equal_time = |curve: &Curve| efficiency_after(curve, seconds);
    let title = format!("Efficiency after about {} (larger is better)", duration(seconds));
    let axis = Axis::log(format!("1/(MSE · time) (1/s); {INTERVALS}"));
    by_strategy(drawn(result), axis, &at_equal_time, &shown).title(title)
}

/// The exponent of the error over the samples, of strategies without bias.
fn slopes(result: &Convergence) -> Panel {
    let slope = |curve: &Curve| {
        let known = curve.verdict != CurveVerdict::Biased && curve.slope.value.is_finite();
        known.then_some([curve.slope.low(), curve.slope.value, curve.slope.high()])
    };
    let count = result.curves.len() as f64;
    let axis = Axis::linear(format!("slope over samples; {INTERVALS}"));
    let panel =
        by_strategy(drawn(result), axis, &slope, &shown).title("Slope of the error (−1/2: independent samples)");
    panel.line("", theme::GUIDE, [[-0.5, 0.0], [-0.5, count]])
}

/// The curves with their strokes, the default first: it lies beneath the others, with which it may coincide. The strategy that it chose is
/// drawn once.
fn drawn(result: &Convergence) -> Vec<(&Curve, Stroke)> {
    let mut drawn: Vec<_> = result.curves.iter().zip(strokes(result)).collect();
    let chosen = result.curve(DEFAULT).and_then(Curve::chosen);
    drawn.retain(|(curve, _)| chosen.is_none_or(|chosen| chosen.name != curve.strategy));
    drawn.sort_by_key(|(curve, _)| !curve.contender.is_default());
    drawn
}

/// A row for each strategy, the biased ones below a line: a marker at a value, with its interval.
fn by_strategy(
    curves: Vec<(&Curve, Stroke)>,
    x: Axis,
    value: &dyn Fn(&Curve) -> Option<[f64; 3]>,
    shown: &dyn Fn(&Curve) -> String,
) -> Panel {
    let is_biased = |(curve, _): &(&Curve, Stroke)| curve.verdict == CurveVerdict::Biased;
    let (biased, unbiased): (Vec<_>, Vec<_>) = curves.into_iter().partition(is_biased);
    let border = unbiased.len() as f64;
    let rows = || unbiased.iter().chain(&biased);
    let mut panel = Panel::new(x, Axis::named("", rows().map(|(curve, _)| shown(curve)).collect::<Vec<_>>()));
    for (i, (curve, stroke)) in rows().enumerate() {
        let Some([low, value, high]) = value(curve) else { continue };
        let (y, biased) = (i as f64 + 0.5, is_biased(&(curve, *stroke)));
        let marker = if biased { Marker::Open } else { Marker::Disc };
        let interval = Stroke::solid(stroke.colour, theme::LINE);
        panel = panel.line("", interval, [[low, y], [high, y]]).markers("", stroke.colour, marker, [[value, y]]);
    }
    if !biased.is_empty() {
        panel = panel.horizontal(border, "");
    }
    panel
}

/// The cost of a strategy on a scene. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CostRow {
    scene: String,
    strategy: String,
    /// Time × MSE over that of the default, and its interval of 95 % (of the strategy alone).
    cost: f64,
    cost_low: f64,
    cost_high: f64,
}

/// The cost of a strategy over that of the default, at the level nearest to the time that all have had: low, value, high.
fn cost(result: &Convergence, curve: &Curve) -> Option<[f64; 3]> {
    let seconds = result.common_seconds();
    let [_, default, _] = efficiency_after(result.curve(DEFAULT)?, seconds)?;
    let [low, value, high] = efficiency_after(curve, seconds)?;
    Some([high, value, low].map(|efficiency| default / efficiency))
}

/// The costs of all strategies without bias, scene by scene.
pub fn cost_rows(scenes: &[(&str, Rc<Convergence>)]) -> Vec<CostRow> {
    let of_scene = |(scene, result): &(&str, Rc<Convergence>)| {
        let row = |curve: &Curve| {
            let [cost_low, cost, cost_high] = cost(result, curve)?;
            Some(CostRow { scene: (*scene).to_owned(), strategy: curve.strategy.clone(), cost, cost_low, cost_high })
        };
        let unbiased = result.curves.iter().filter(|curve| curve.verdict != CurveVerdict::Biased);
        unbiased.filter_map(row).collect::<Vec<_>>()
    };
    scenes.iter().flat_map(of_scene).collect()
}

/// [`cost_rows`] as a panel for each scene, the cheapest strategy at the top.
pub fn costs(scenes: &[(&str, Rc<Convergence>)]) -> Drawing {
    let panel = |scene @ (title, result): &(&str, Rc<Convergence>)| {
        let rows = cost_rows(std::slice::from_ref(scene));
        let ends = rows.iter().flat_map(|row| [row.cost_low, row.cost_high]);
        let ends = ends.filter(|end| end.is_finite() && *end > 0.0);
        let [least, most] = ends.fold([1.0f64; 2], |[least, most], end| [least.min(end), most.max(end)]);
        let value = |curve: &Curve| cost(result, curve);
        let of = |curve: &Curve| value(curve).map_or(f64::INFINITY, |[_, cost, _]| cost);
        let mut curves = drawn(result);
        curves.retain(|(curve, _)| curve.verdict != CurveVerdict::Biased);
        curves.sort_by(|(a, _), (b, _)| of(a).total_cmp(&of(b)));
        let count = curves.len() as f64;
        let named = |curve: &Curve| format!("{}: {}", shown(curve), rounded(of(curve), 2));
        let axis = Axis::log(format!("time × MSE, default = 1; {INTERVALS}")).range(0.8 * least, 1.25 * most);
        by_strategy(curves, axis, &value, &named).title(*title).line("", theme::GUIDE, [[1.0, 0.0], [1.0, count]])
    };
    let panels: Vec<Panel> = scenes.iter().map(panel).collect();
    let rows = panels.chunks(2).map(|row| (String::new(), row.to_vec()));
    let plot = Plot::grid(rows.collect::<Vec<_>>()).frame_size(FRAME[0], FRAME[1]).draw();
    plot.headed("Time for the same error, over that of the default: less is better", Vec::new())
}

/// The next of 1, 2, 5 times a power of ten.
pub fn round(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let power = 10.0_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|m| *m >= value).unwrap_or(value)
}

/// Curves above images at equal time of a few contenders.
pub fn sheet(result: &Convergence) -> Drawing {
    Drawing::stacked(vec![curves(result), images(result, COLUMNS - 1)], 0.5)
}

/// The label of the colour bar of relative errors.
pub const ERROR_LABEL: &str = "relative error (%): blue is too dark, red too bright, grey not compared";
/// Largest side of a region in pixels, and its share of the image's shorter side.
const LARGEST: usize = 128;
const SHARE: f64 = 0.4;
/// Regions of each image.
const REGIONS: usize = 2;
/// Pixels that the row of a cell's regions has at least after enlargement by a whole factor.
const WIDTH: usize = 360;
const COLUMNS: usize = 5;

/// Images after equal time, or at the most samples that all have, with their relative errors below: of all contenders, or of so many.
pub fn images(result: &Convergence, most: usize) -> Drawing {
    let seconds = result.common_seconds();
    let Some(truth) = &result.truth else { return contact_sheet("Nothing was measured", 1, &[]) };
    let truth = truth.image();
    let mean = result.reference.as_ref().map_or(f64::NAN, |facts| facts.mean);
    // Each contender at the common samples, or at the level nearest to the common time
    let with = |curve: &Curve, spp: u32| curve.levels.iter().position(|level| level.spp == spp);
    let all = result.curves.iter().flat_map(|curve| &curve.levels).map(|level| level.spp);
    let common = all.filter(|spp| result.curves.iter().all(|curve| with(curve, *spp).is_some())).max();
    let common = common.filter(|_| result.equal_samples);
    let at = |curve: &Curve| common.map_or_else(|| curve.nearest(seconds), |spp| with(curve, spp));
    let levels = result.curves.iter().filter_map(|curve| {
        let at = at(curve)?;
        Some((curve, &curve.levels[at], &curve.images[at]))
    });
    let levels = spread(levels.collect(), most);
    // One scale of errors for all: the median RMSE, rounded up
    let mut sizes: Vec<f64> = levels.iter().map(|(_, level, _)| level.rmse() / mean).collect();
    sizes.sort_by(f64::total_cmp);
    let limit = round(sizes.get(sizes.len() / 2).copied().unwrap_or(0.05));
    let tone = ToneMap::Srgb { stops: auto_exposure(&truth) };
    let scale = |width: usize, values: Vec<f64>| {
        Heatmap::new(width, values, Shading::Diverging, ERROR_LABEL).range(-100.0 * limit, 100.0 * limit)
    };
    // Relative to at least 3 % of the mean
    let relative = |image: &Image| -> Vec<f64> {
        let pairs = image.pixels().iter().zip(truth.pixels());
        let error = |(p, q): (&etalon_core::math::Rgb, &etalon_core::math::Rgb)| {
            let (got, expected) = (f64::from(p.element_sum()), f64::from(q.element_sum()));
            100.0 * (got - expected) / expected.max(0.03 * mean)
        };
        pairs.map(error).collect()
    };
    let errors: Vec<Vec<f64>> = levels.iter().map(|(.., image)| relative(image)).collect();
    let regions = regions([truth.width(), truth.height()], &errors, REGIONS);
    let tones = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &tone));
    // Pixels that are not compared have no value in the reference
    let is_unknown = |x: usize, y: usize| !truth.pixels()[y * truth.width() + x].is_finite();
    let grey = [theme::NO_VALUE.r, theme::NO_VALUE.g, theme::NO_VALUE.b];
    let toned = tones(&truth);
    let toned =
        Rgb8::from_fn(truth.width(), truth.height(), |x, y| if is_unknown(x, y) { grey } else { toned.pixel(x, y) });
    let is_whole = truth.pixels().iter().all(|pixel| pixel.is_finite());
    let caption = if is_whole {
        "reference, and the regions shown"
    } else {
        "reference, and the regions shown; grey is not compared"
    };
    let mut cells = vec![(caption.to_owned(), framed(&toned, &regions, (WIDTH / truth.width()).max(1), theme::INSET))];
    for ((curve, level, image), errors) in levels.iter().zip(errors) {
        let caption = format!(
            "{}: {}\u{a0}spp, {}, RMSE\u{a0}{}",
            shown(curve),
            level.spp,
            duration(level.cpu_seconds),
            rounded(level.rmse(), 2)
        );
        cells.push((caption, cropped([&tones(image), &scale(image.width(), errors).image()], &regions)));
    }
    let at = match common {
        Some(spp) => format!("At {} per pixel", counted(spp as usize, "sample")),
        None => format!("After about {} of processor time each", duration(seconds)),
    };
    let title = format!("{at}: image and relative error");
    let sheet = contact_sheet(&title, COLUMNS, &cells);
    let bar = scale(1, Vec::new()).bar(420.0);
    Drawing::stacked(vec![sheet, bar], 0.5)
}

/// So many of the contenders: the default, those with bias, and others evenly from the least efficient to the best.
fn spread<'a>(
    mut levels: Vec<(&'a Curve, &'a Level, &'a Image)>,
    most: usize,
) -> Vec<(&'a Curve, &'a Level, &'a Image)> {
    if levels.len() <= most {
        return levels;
    }
    levels.sort_by(|(_, a, _), (_, b, _)| a.efficiency.total_cmp(&b.efficiency));
    let always =
        |(curve, ..): &(&Curve, &Level, &Image)| curve.verdict == CurveVerdict::Biased || curve.strategy == DEFAULT;
    let (mut always, others): (Vec<_>, Vec<_>) = levels.into_iter().partition(always);
    always.truncate(most);
    let count = (most - always.len()).min(others.len());
    let evenly = (0..count).map(|i| others[i * others.len() / count]);
    evenly.chain(always).collect()
}

/// A square region of an image: its left upper corner and its side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    pub x: usize,
    pub y: usize,
    pub side: usize,
}

impl Region {
    fn overlaps(self, other: Self) -> bool {
        let apart = |a: usize, b: usize| a + self.side <= b || b + other.side <= a;
        !(apart(self.x, other.x) || apart(self.y, other.y))
    }
}

/// The side of the regions of an image.
fn side_of([width, height]: [usize; 2]) -> usize {
    ((width.min(height) as f64 * SHARE).ceil() as usize).clamp(1, LARGEST)
}

/// Overlapping regions that cover an image.
pub fn all_regions([width, height]: [usize; 2]) -> impl Iterator<Item = Region> {
    let side = side_of([width, height]);
    let starts = move |length: usize| (0..=length - side).step_by((side / 4).max(1));
    starts(height).flat_map(move |y| starts(width).map(move |x| Region { x, y, side }))
}

/// At most `count` regions, without overlap, in which the contenders differ: the first one where their mean absolute errors vary most, each
/// other one where they vary most in another way than in those before.
pub fn regions([width, height]: [usize; 2], errors: &[Vec<f64>], count: usize) -> Vec<Region> {
    let side = side_of([width, height]);
    let mut all: Vec<(Region, Vec<f64>)> = all_regions([width, height])
        .map(|region| {
            let of = |errors: &Vec<f64>| {
                let rows = (region.y..region.y + side).flat_map(|y| &errors[y * width + region.x..][..side]);
                rows.filter(|e| e.is_finite()).map(|e| e.abs()).sum::<f64>()
            };
            let sums: Vec<f64> = errors.iter().map(of).collect();
            let mean = sums.iter().sum::<f64>() / sums.len().max(1) as f64;
            (region, sums.iter().map(|sum| sum - mean).collect())
        })
        .collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut chosen: Vec<Region> = Vec::new();
    while chosen.len() < count {
        // The first of equals: `max_by` returns the last one.
        let most = all.iter().rev().max_by(|(_, a), (_, b)| product(a, a).total_cmp(&product(b, b)));
        let Some((region, found)) = most.cloned() else { break };
        chosen.push(region);
        all.retain(|(other, _)| !other.overlaps(region));
        let squares = product(&found, &found);
        for (_, of) in all.iter_mut().filter(|_| squares > 0.0) {
            let share = product(of, &found) / squares;
            of.iter_mut().zip(&found).for_each(|(value, found)| *value -= share * found);
        }
    }
    chosen.sort_by_key(|region| (region.x, region.y));
    chosen
}

/// Regions side by side, of each image in a row of its own, every pixel enlarged to a square.
fn cropped(images: [&Rgb8; 2], regions: &[Region]) -> Rgb8 {
    let Some(Region { side, .. }) = regions.first() else { return images[0].clone() };
    let zoom = WIDTH.div_ceil(side * regions.len());
    let (cell, line) = (side * zoom, 4);
    let size = |count: usize| count * (cell + line) - line;
    Rgb8::from_fn(size(regions.len()), size(images.len()), |x, y| {
        let ([column, x], [row, y]) = [x, y].map(|at| [at / (cell + line), at % (cell + line)]).into();
        if x >= cell || y >= cell {
            return [255; 3];
        }
        let region = regions[column];
        images[row].pixel(region.x + x / zoom, region.y + y / zoom)
    })
}

/// The whole image, every pixel enlarged to a square of `zoom` pixels a side, with frames around the regions.
pub fn framed(image: &Rgb8, regions: &[Region], zoom: usize, colour: Colour) -> Rgb8 {
    let frame = [colour.r, colour.g, colour.b];
    Rgb8::from_fn(image.width() * zoom, image.height() * zoom, |x, y| {
        let on_frame = |region: &Region| {
            let [left, top, side] = [region.x, region.y, region.side].map(|at| at * zoom);
            let (dx, dy) = (x.wrapping_sub(left), y.wrapping_sub(top));
            let inside = dx < side && dy < side;
            inside && (dx.min(dy) < 2 || dx.max(dy) + 2 >= side)
        };
        if regions.iter().any(on_frame) { frame } else { image.pixel(x / zoom, y / zoom) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_bench::converge::strategy::methods;

    #[test]
    fn every_strategy_has_a_colour_of_its_own() {
        let names: Vec<String> = methods().into_iter().map(|(name, _)| name).collect();
        let mut colours = Vec::new();
        for name in names.iter().map(String::as_str).chain(["mis+lt"]) {
            // Beside another that has none, and takes the first that is free.
            let [own, beside] = [vec![name], vec!["unknown", name]].map(|names| theme::strategies(&names));
            assert_eq!(own[0], beside[1], "{name} has no colour of its own");
            assert!(!colours.contains(&own[0]), "{name} shares its colour");
            colours.push(own[0]);
        }
    }

    #[test]
    fn every_strategy_has_a_name_in_words() {
        let methods: Vec<String> = methods().into_iter().map(|(name, _)| name.replace('K', "64")).collect();
        let suffixed = etalon_bench::converge::strategy::SUFFIXES.map(|(suffix, ..)| format!("mis+{suffix}"));
        for name in methods.iter().chain(&suffixed).filter(|name| *name != DEFAULT) {
            let words = label(name);
            assert!(!words.contains(['-', '+']) && words != *name, "{name}: {words}");
        }
        assert_eq!(label("mis-cosine-compensated+lt"), "MIS, compensated map × cosine and light paths");
        assert_eq!(label("light-cosine+adaptive"), "light sampling, map × cosine, adaptive");
        assert_eq!(label("median-cut-64"), "64 fixed lights");
    }

    #[test]
    fn a_ratio_without_an_interval_has_none() {
        let ratio = |over: &str, high: f64| Ratio { over: over.into(), ratio: 2.0, low: 1.5, high };
        let ratios = vec![ratio("a", f64::INFINITY), ratio("b", 2.5)];
        let text = of_best(&Answer { best: "c".into(), cpu_seconds: 1.0, ratios, default: None });
        assert!(text.contains("of a (no interval), 2.0 times that of b (1.5 to 2.5)"), "{text}");
    }

    #[test]
    fn regions_are_where_contenders_differ() {
        let (width, height) = (50, 40);
        let noise = |from: usize| -> Vec<f64> {
            (0..width * height).map(|i| if i % width >= from && i % width < from + 8 { 5.0 } else { 1.0 }).collect()
        };
        let found = regions([width, height], &[noise(40), noise(0), vec![1.0; width * height]], REGIONS);
        assert_eq!(found.len(), 2);
        assert!(found[0].x <= 4 && found[1].x >= 30 && !found[0].overlaps(found[1]), "{found:?}");
        assert_eq!(regions([1, 1], &[vec![f64::NAN]], REGIONS), [Region { x: 0, y: 0, side: 1 }]);
    }
}
