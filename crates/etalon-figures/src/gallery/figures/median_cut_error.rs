//! Error of fixed lights in place of a map, over their number: `median-cut-error`.

use super::error_time::{biased, plan, sphere_curves, sphere_scene, stopped};
use crate::figure::{Axis, Drawing, Marker, Panel, Plot, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::converge::{self, with_band};
use etalon_bench::converge::curve::{Curve, Level};
use etalon_bench::converge::{CUTS, Convergence, cuts};

/// Numbers of lights that the map is cut into.
const LIGHTS: [u32; 5] = [1, 4, 16, 64, 256];

pub fn figures() -> Vec<Maker> {
    vec![maker("median-cut-error", content)]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let sampled = sphere_curves(inputs, studies)?;
    let (scene, request) = sphere_scene(inputs);
    let fixed = cuts(&scene, &request, &LIGHTS, &plan(inputs, 1, 3), sampled.truth.as_ref())?;
    let mut checks = vec![stopped(&fixed)];
    let rmse = |cut: &str, lights: u32| {
        let curve = fixed.curve(&format!("{cut}-{lights}"));
        curve.and_then(|curve| curve.levels.last()).map_or(f64::NAN, |level| level.rmse())
    };
    for cut in CUTS {
        let ratio = rmse(cut, 256) / rmse(cut, 1);
        checks.push(Check::at_most(format!("error of 256 lights over that of one, {cut}"), ratio, 0.05));
        checks.extend(fixed.curve(&format!("{cut}-64")).map(biased));
    }
    let rows = [converge::rows(&fixed), converge::rows(&sampled)].concat();
    Content::new(lights(&fixed, &sampled), &rows, checks)
}

/// Error over the number of lights, and over time: fixed lights, and random light samples.
fn lights(fixed: &Convergence, sampled: &Convergence) -> Drawing {
    let error = || Axis::log("RMSE of radiance");
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
    let labels = ["median-cut: fixed lights, biased", "variance-cut: fixed lights, biased"];
    for ((i, cut), label) in CUTS.into_iter().enumerate().zip(labels) {
        let points = fixed.curves.iter().filter_map(|c| Some((number_of_lights(c, cut)?, c.levels.last()?)));
        add(label, stroke(i), Marker::Open, points.collect());
    }
    for (i, name) in SAMPLED.into_iter().enumerate() {
        let Some(curve) = sampled.curve(name) else { continue };
        let points = curve.levels.iter().map(|l| (f64::from(l.spp), l)).collect();
        let stroke = stroke(i + CUTS.len());
        add(&format!("{name}: sampled at each hit"), stroke, theme::marker(stroke), points);
    }
    Plot::new([by_number.title("Error against lights"), by_time.title("Error against time")]).draw()
}

/// The strategies of the sphere's curves that stand beside the fixed lights.
const SAMPLED: [&str; 2] = ["light", "light-cosine"];

/// K of "median-cut-K".
fn number_of_lights(curve: &Curve, cut: &str) -> Option<f64> {
    curve.strategy.strip_prefix(cut)?.strip_prefix('-')?.parse().ok()
}
