//! The environment map: importance samples of it (`envmap-samples-64`, `-256`, `-1024` and `-only-256`); its median cut
//! (`median-cut-2`, `-4`, `-16`, `-64` and `median-cut-radiance-64`), and the error of fixed lights in place of a map, over their
//! number (`median-cut-error`); inversion with uniform and with Gaussian random numbers (`proposal`).

use super::error_time::{biased, plan, sphere_curves, sphere_scene, unless_stopped};
use crate::figure::{Axis, Drawing, Marker, Panel, Plot, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::converge::{self, guide, with_band};
use crate::view::map::Display;
use crate::view::proposal as proposal_view;
use etalon_bench::converge::curve::{Curve, Level};
use etalon_bench::converge::{CUTS, Convergence, cuts};
use etalon_bench::map_samples::{self, SampleRow};
use etalon_bench::median_cut::{self, Centroid, RegionRow};
use etalon_bench::proposal::{self, Proposal, RowBin};
use etalon_core::envmap::cut::{SideRule, Split};
use etalon_core::envmap::samplers::TexelSampler;
use glam::DVec3;

/// Side of a marker in texels, as in the report.
const SAMPLE_MARKER: usize = 5;

pub fn figures() -> Vec<Maker> {
    let on_the_map = |n: usize| {
        maker(format!("envmap-samples-{n}"), move |inputs, studies| samples(inputs, studies, n, Display::samples))
    };
    let alone =
        maker("envmap-samples-only-256", |inputs, studies| samples(inputs, studies, 256, Display::samples_only));
    let partition =
        |n: usize| maker(format!("median-cut-{n}"), move |inputs, studies| cut(inputs, studies, n, Display::partition));
    let radiance = maker("median-cut-radiance-64", |inputs, studies| {
        cut(inputs, studies, 64, |display, rows| display.lights(rows, SAMPLE_MARKER))
    });
    let samples = [64, 256, 1024].map(on_the_map).into_iter().chain([alone]);
    let cuts = [2, 4, 16, 64].map(partition).into_iter().chain([radiance, maker("median-cut-error", error_of_lights)]);
    samples.chain(cuts).chain([maker("proposal", proposal_content)]).collect()
}

fn samples(
    inputs: &Inputs,
    studies: &mut Studies,
    n: usize,
    draw: impl Fn(&Display, &[SampleRow], usize) -> Drawing,
) -> Result<Content> {
    let map = &inputs.map.map;
    let result = map_samples::draw(map, &TexelSampler::new(map.clone()), DVec3::Y, n, inputs.seed)?;
    let flux = studies.map_info(inputs)?.flux_rgb.iter().sum::<f64>() / 3.0;
    let checks = vec![
        Check::equal("pdfs that differ from pdf(direction)", 0.0, result.pdf_mismatches as f64),
        // The pdf is proportional to radiance, so that the estimator has no variance.
        Check::within("flux estimated from the samples", flux, result.flux_estimate, 1e-6 * flux),
    ];
    Content::new(draw(&*studies.map_display(inputs)?, &result.rows, SAMPLE_MARKER), &result.rows, checks)
}

fn cut(
    inputs: &Inputs,
    studies: &mut Studies,
    n: usize,
    draw: impl Fn(&Display, &[RegionRow]) -> Drawing,
) -> Result<Content> {
    let map = &inputs.map.map;
    let rows = median_cut::cut(map, &[n], Split::Energy, SideRule::default(), Centroid::Energy)?.remove(0);
    let error = median_cut::flux_error(&rows, studies.map_info(inputs)?.flux_rgb);
    let checks = vec![Check::at_most("relative error of the regions' total flux", error, 1e-9)];
    Content::new(draw(&*studies.map_display(inputs)?, &rows), &rows, checks)
}

/// Numbers of lights that the map is cut into.
const LIGHTS: [u32; 5] = [1, 4, 16, 64, 256];

fn error_of_lights(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let sampled = sphere_curves(inputs, studies)?;
    let (scene, request) = sphere_scene(inputs);
    let fixed = cuts(&scene, &request, &LIGHTS, &plan(inputs, 1, 3), sampled.truth.as_ref())?;
    let mut checks = Vec::new();
    let rmse = |cut: &str, lights: u32| {
        let curve = fixed.curve(&format!("{cut}-{lights}"));
        curve.and_then(|curve| curve.levels.last()).map_or(f64::NAN, |level| level.rmse())
    };
    for cut in CUTS {
        let ratio = rmse(cut, 256) / rmse(cut, 1);
        checks.push(Check::at_most(format!("error of 256 lights over that of one, {cut}"), ratio, 0.05));
        checks.extend(fixed.curve(&format!("{cut}-64")).map(biased));
    }
    let table = converge::csv(&[&fixed, &sampled])?;
    Ok(Content::of_csv(lights(&fixed, &sampled), table, unless_stopped(&fixed, checks)))
}

/// Error over the number of lights, and over time: fixed lights, and random light samples.
fn lights(fixed: &Convergence, sampled: &Convergence) -> Drawing {
    let mean = sampled.reference.as_ref().map_or(f64::NAN, |facts| facts.mean);
    let error = || Axis::log(format!("RMSE of radiance (mean: {mean:.3})"));
    let mut by_number = Panel::new(Axis::log("fixed lights, or light samples per pixel"), error());
    let mut by_time = Panel::new(Axis::log("processor time (s)"), error());
    let mut add = |label: &str, stroke: Stroke, marker: Marker, points: Vec<(f64, &Level)>| {
        let number: Vec<_> = points.iter().map(|(number, level)| with_band(*number, level)).collect();
        let time: Vec<_> = points.iter().map(|(_, level)| with_band(level.cpu_seconds, level)).collect();
        let marked = |panel: &Panel, points: &[[f64; 4]]| {
            let at: Vec<_> = points.iter().map(|&[x, _, value, _]| [x, value]).collect();
            panel.clone().banded_line(label, stroke, points).markers(label, stroke.colour, marker, at)
        };
        (by_number, by_time) = (marked(&by_number, &number), marked(&by_time, &time));
    };
    let names = [&CUTS[..], &SAMPLED].concat();
    let colours = theme::strategies(&names);
    let stroke = |i: usize| Stroke { colour: colours[i], ..theme::series(i) };
    let labels = ["median cut (biased)", "variance cut (biased)"];
    for ((i, cut), label) in CUTS.into_iter().enumerate().zip(labels) {
        let points = fixed.curves.iter().filter_map(|c| Some((number_of_lights(c, cut)?, c.levels.last()?)));
        add(label, stroke(i), Marker::Open, points.collect());
    }
    for ((i, name), label) in SAMPLED.into_iter().enumerate().zip(["sampled: map", "sampled: map × cosine"]) {
        let Some(curve) = sampled.curve(name) else { continue };
        let points = curve.levels.iter().map(|l| (f64::from(l.spp), l)).collect();
        let stroke = stroke(i + CUTS.len());
        add(label, stroke, theme::marker(stroke), points);
    }
    let shown: Vec<&Curve> = SAMPLED.into_iter().filter_map(|name| sampled.curve(name)).collect();
    let by_number = by_number.line("slope −1/2", theme::GUIDE, guide(&shown, &|level| f64::from(level.spp)));
    let by_time = by_time.line("slope −1/2", theme::GUIDE, guide(&shown, &|level| level.cpu_seconds));
    let panels = [by_number.title("Error against lights"), by_time.title("Error against time")];
    Plot::new(panels.map(Panel::with_names_on_curves)).frame_size(440.0, 380.0).draw()
}

/// The strategies of the sphere's curves that stand beside the fixed lights.
const SAMPLED: [&str; 2] = ["light", "light-cosine"];

/// K of "median-cut-K".
fn number_of_lights(curve: &Curve, cut: &str) -> Option<f64> {
    curve.strategy.strip_prefix(cut)?.strip_prefix('-')?.parse().ok()
}

/// Rows that are sampled with uniform and with Gaussian random numbers.
const ROWS: usize = 100_000;
/// A p-value this near to either end is evidence: of a wrong distribution, or of one that fits too well.
const LEVEL: f64 = 1e-3;

/// Both histograms, if the map has light in enough rows.
pub fn proposal(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Option<Proposal>>> {
    studies.get("proposal", || proposal::compare(&inputs.map.map, ROWS, inputs.seed))
}

fn proposal_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let tested = proposal(inputs, studies)?;
    let Some(result) = tested.as_ref() else {
        let check = Check::is_true("sampled rows against the map's distribution", false);
        let check = check.unless(Some("the map has light in too few rows for a test"));
        return Content::new(proposal_view::nothing_to_test(), &[] as &[RowBin], vec![check]);
    };
    let checks = vec![
        Check::at_least("p-value with uniform random numbers", result.uniform.p, LEVEL),
        Check::at_most("p-value with uniform random numbers (no suspiciously good fit)", result.uniform.p, 1.0 - LEVEL),
        Check::at_most("p-value with Gaussian random numbers", result.gaussian.p, 1e-6),
    ];
    Content::new(proposal_view::drawing(result), &result.bins, checks)
}
