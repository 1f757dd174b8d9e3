//! Error and time over a quantity: missing light over depth, efficiency over roughness, error over a number of lights.

use super::converge::{duration, with_band};
use crate::figure::{Axis, Drawing, Marker, Panel, Plot, Stroke, theme};
use crate::study::converge::curve::{Curve, Level};
use crate::study::converge::depth::{DepthCurve, DepthLevel};
use crate::study::converge::roughness::{self, NORMALS};
use crate::study::converge::{CUTS, Convergence};
use etalon_stats::estimate::Estimate;
use serde::Serialize;

/// One depth of one scene. Field names are the CSV columns; half widths are those of 95 % intervals.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct DepthRow {
    scene: String,
    depth: u32,
    spp: u32,
    replicates: u32,
    /// Of the light of the deepest image.
    missing_share: f64,
    missing_share_half_width: f64,
    cpu_seconds: f64,
    cpu_seconds_half_width: f64,
    /// Of the time of the deepest image.
    time_share: f64,
}

pub fn depth_rows(scenes: &[DepthCurve]) -> Vec<DepthRow> {
    let of_scene = |depths: &DepthCurve| {
        let DepthCurve { scene, replicates, spp, levels } = depths.clone();
        levels.into_iter().map(move |level| DepthRow {
            scene: scene.clone(),
            depth: level.depth,
            spp,
            replicates,
            missing_share: level.missing.value,
            missing_share_half_width: level.missing.half_width,
            cpu_seconds: level.cpu_seconds.value,
            cpu_seconds_half_width: level.cpu_seconds.half_width,
            time_share: level.time_share,
        })
    };
    scenes.iter().flat_map(of_scene).collect()
}

/// Missing light over the depth, and over the time that the render takes.
pub fn depths(scenes: &[DepthCurve]) -> Drawing {
    let share = || Axis::log("missing light (share of all)");
    let mut over_depth = Panel::new(Axis::linear("maximum depth").range(-0.4, 10.4).every(1.0), share());
    let mut over_time = Panel::new(Axis::linear("processor time (1: that of the deepest)").range(0.0, 1.1), share());
    for (i, depths) in scenes.iter().enumerate() {
        let stroke = theme::series(i);
        // The deepest level misses nothing by definition: 0 has no place on a logarithmic axis
        let Some((deepest, levels)) = depths.levels.split_last() else { continue };
        let label = format!("{} (depth {}: {})", depths.scene, deepest.depth, duration(deepest.cpu_seconds.value));
        let over =
            |at: &dyn Fn(&DepthLevel) -> f64| levels.iter().map(|l| [at(l), l.missing.value]).collect::<Vec<_>>();
        let band = |l: &DepthLevel| [f64::from(l.depth), l.missing.low(), l.missing.high()];
        let (by_depth, by_time) = (over(&|l| f64::from(l.depth)), over(&|l| l.time_share));
        let bands: Vec<_> = levels.iter().map(band).collect();
        over_depth = over_depth.band("", stroke.colour, bands).dotted_line(label.clone(), stroke, by_depth);
        over_time = over_time.dotted_line(label, stroke, by_time);
        for level in levels {
            over_time = over_time.note([level.time_share, level.missing.value], level.depth.to_string(), stroke.colour);
        }
    }
    Plot::new([
        over_depth.title("Missing light by maximum depth"),
        over_time.title("Missing light by time (labels: maximum depth)"),
    ])
    .draw()
}

/// One way of sampling normals at one roughness. Field names are the CSV columns; mse is that of the metal's radiance.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RoughnessRow {
    alpha: f32,
    normals: &'static str,
    spp: u32,
    replicates: u32,
    mse: f64,
    mse_half_width: f64,
    cpu_seconds: f64,
    cpu_seconds_half_width: f64,
    /// 1 / (MSE · processor seconds).
    efficiency_per_second: f64,
    efficiency_half_width: f64,
}

pub fn roughness_rows(levels: &[roughness::RoughnessLevel]) -> Vec<RoughnessRow> {
    let row = |l: &roughness::RoughnessLevel| RoughnessRow {
        alpha: l.alpha,
        normals: l.normals,
        spp: l.spp,
        replicates: l.replicates,
        mse: l.mse.value,
        mse_half_width: l.mse.half_width,
        cpu_seconds: l.cpu_seconds.value,
        cpu_seconds_half_width: l.cpu_seconds.half_width,
        efficiency_per_second: l.efficiency.value,
        efficiency_half_width: l.efficiency.half_width,
    };
    levels.iter().map(row).collect()
}

/// Noise and efficiency over the roughness, with 95 % intervals, a curve for each way of sampling normals.
pub fn roughness(levels: &[roughness::RoughnessLevel]) -> Drawing {
    let mut alphas: Vec<f64> = levels.iter().map(|l| f64::from(l.alpha)).collect();
    alphas.dedup();
    let alpha = || Axis::log("roughness /{α}").at(alphas.clone());
    let mut noise = Panel::new(alpha(), Axis::log("RMSE of the metal's radiance"));
    let mut efficiency = Panel::new(alpha(), Axis::log("1 / (MSE · processor time) (1/s)"));
    let colours = theme::strategies(&NORMALS.map(|(name, _)| name));
    for (i, (name, _)) in NORMALS.iter().enumerate() {
        let stroke = Stroke { colour: colours[i], ..theme::series(i) };
        let add = |panel: Panel, of: &dyn Fn(&roughness::RoughnessLevel) -> [f64; 3]| {
            let mine = || levels.iter().filter(|l| l.normals == *name).map(|l| (f64::from(l.alpha), of(l)));
            // Beside each other: an interval for each point
            let shift = 1.04f64.powi(i as i32 - 1);
            let interval = Stroke::solid(stroke.colour, theme::THIN);
            let line: Vec<_> = mine().map(|(x, [_, value, _])| [shift * x, value]).collect();
            let panel = mine().fold(panel, |panel, (x, [low, _, high])| {
                panel.line("", interval, [[shift * x, low], [shift * x, high]])
            });
            panel.dotted_line(*name, stroke, line)
        };
        let with_ends = |e: Estimate| [e.positive()[0], e.value, e.positive()[1]];
        noise = add(noise, &|l| with_ends(l.mse).map(f64::sqrt));
        efficiency = add(efficiency, &|l| with_ends(l.efficiency));
    }
    let spp = levels.first().map_or(0, |l| l.spp);
    Plot::new([noise.title(format!("Noise at {spp} samples per pixel")), efficiency.title("Efficiency")]).draw()
}

/// Error over the number of lights, and over time: fixed lights, and random light samples.
pub fn lights(fixed: &Convergence, sampled: &Convergence) -> Drawing {
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
pub fn number_of_lights(curve: &Curve, cut: &str) -> Option<f64> {
    curve.strategy.strip_prefix(cut)?.strip_prefix('-')?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::theme;
    use crate::study::converge::strategy::methods;

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
}
