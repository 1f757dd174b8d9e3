//! Light missing in renders that end at some depth, and the time that this saves: `error-depth`.

use super::error_time::{LIMIT, STOPPED, small};
use crate::figure::{Axis, Drawing, Panel, Plot, theme};
use crate::gallery::prelude::*;
use crate::view::text::duration;
use etalon_bench::converge::doubling::{Deadline, Doubling};
use etalon_bench::table::Table;
use etalon_core::error::Result;
use etalon_core::raster::Image;
use etalon_core::scene::{Request, Scene, builtin};
use etalon_render::Settings;
use etalon_stats::estimate::Estimate;

pub fn figures() -> Vec<Maker> {
    vec![maker("error-depth", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let deadline = Deadline::after(LIMIT);
    let of_scene = |scene| {
        let (scene, request) = small(inputs, scene);
        let request = Request { spp: inputs.effort.of(64, 8), ..request };
        measure(&scene, &request, inputs.effort.of(4, 2), inputs.seed, &deadline)
    };
    let scenes = [of_scene(inputs.spheres())?, of_scene(builtin::cornell_lambert())?];
    let checks = scenes.iter().flat_map(checks).collect();
    Ok(Content::of_csv(depths(&scenes), csv(&scenes)?, checks))
}

/// Skipped without any depth, which the time limit may cause.
fn checks(scene: &DepthCurve) -> [Check; 2] {
    let name = &scene.scene;
    let ratios = scene.levels.windows(2).map(|pair| pair[1].missing.value / pair[0].missing.value);
    let largest = ratios.fold(f64::NAN, f64::max);
    let time = scene.levels.iter().find(|l| l.depth == 1).map_or(f64::NAN, |l| l.time_share);
    [
        Check::at_most(format!("missing light over that of the depth before, largest, {name}"), largest, 1.0),
        Check::at_most(format!("time of depth 1 over that of depth 100, {name}"), time, 1.0),
    ]
    .map(|check| check.unless(scene.levels.is_empty().then_some(STOPPED)))
}

/// DepthCurve that are measured; the last one stands for all light.
const DEPTHS: [u32; 9] = [0, 1, 2, 3, 4, 5, 7, 10, 100];

/// One depth of one scene.
#[derive(Debug, Clone, PartialEq)]
struct DepthLevel {
    /// Largest number of scatterings of a path.
    depth: u32,
    /// 1 − mean of the image over mean of the deepest image with the same random numbers.
    missing: Estimate,
    /// Mean over the replicates.
    cpu_seconds: Estimate,
    /// Processor time over that of the deepest image.
    time_share: f64,
}

/// A scene's depths.
#[derive(Debug, Clone, PartialEq)]
struct DepthCurve {
    scene: String,
    /// Renders of each depth.
    replicates: u32,
    /// Samples per pixel.
    spp: u32,
    /// One for each of [`DEPTHS`].
    levels: Vec<DepthLevel>,
}

/// Renders a scene to every depth, `replicates` times with different seeds, all depths alternating. The paths of a shallow
/// image are the beginnings of those of a deep one (see [`truncation`](etalon_bench::depth::truncation)): their noise is
/// the same, so that the difference is known far better than either of them. Without levels if the deadline comes first.
fn measure(scene: &Scene, request: &Request, replicates: u32, seed: u64, deadline: &Deadline) -> Result<DepthCurve> {
    let mut light: Vec<Vec<f64>> = vec![Vec::new(); DEPTHS.len()];
    let mut times = light.clone();
    for replicate in 0..replicates {
        let settings = Settings { seed: seed.wrapping_add(u64::from(replicate)), ..Settings::default() };
        let renders = DEPTHS.map(|max_depth| Doubling::new(scene, &Request { max_depth, ..*request }, &settings));
        let mut renders = renders.into_iter().collect::<Result<Vec<_>>>()?;
        // Double the samples of all depths, alternating.
        while renders[0].spp() <= request.spp / 2 {
            for render in &mut renders {
                render.double(deadline);
            }
        }
        if deadline.is_over() {
            break;
        }
        for ((render, light), times) in renders.iter().zip(&mut light).zip(&mut times) {
            light.push(mean(&render.image()));
            times.push(render.times.cpu);
        }
    }
    let deepest = DEPTHS.len() - 1;
    let all_time: f64 = times[deepest].iter().sum();
    let level = |i: usize| {
        let missing = light[i].iter().zip(&light[deepest]).map(|(some, all)| 1.0 - some / all);
        DepthLevel {
            depth: DEPTHS[i],
            missing: Estimate::mean(&missing.collect::<Vec<_>>()),
            cpu_seconds: Estimate::mean(&times[i]),
            time_share: times[i].iter().sum::<f64>() / all_time,
        }
    };
    let count = if light[0].is_empty() { 0 } else { DEPTHS.len() };
    Ok(DepthCurve {
        scene: scene.name.clone(),
        replicates: light[0].len() as u32,
        spp: request.spp,
        levels: (0..count).map(level).collect(),
    })
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels().iter().map(|p| p.as_dvec3().element_sum()).sum();
    sum / (3.0 * image.pixels().len() as f64)
}

/// A row for each depth of each scene, as CSV; half widths are those of 95 % intervals, shares those of the deepest image.
fn csv(scenes: &[DepthCurve]) -> Result<Vec<u8>> {
    let levels = scenes.iter().flat_map(|curve| curve.levels.iter().map(move |level| (curve, level)));
    let levels: Vec<(&DepthCurve, &DepthLevel)> = levels.collect();
    Table::of(&levels)
        .field("scene", |(curve, _)| &curve.scene)
        .field("depth", |(_, level)| level.depth)
        .field("spp", |(curve, _)| curve.spp)
        .field("replicates", |(curve, _)| curve.replicates)
        .field("missing_share", |(_, level)| level.missing.value)
        .field("missing_share_half_width", |(_, level)| level.missing.half_width)
        .field("cpu_seconds", |(_, level)| level.cpu_seconds.value)
        .field("cpu_seconds_half_width", |(_, level)| level.cpu_seconds.half_width)
        .field("time_share", |(_, level)| level.time_share)
        .csv()
}

/// Missing light over the depth, and over the time that the render takes.
fn depths(scenes: &[DepthCurve]) -> Drawing {
    let share = || Axis::log("missing light (share of all)");
    let mut over_depth = Panel::new(Axis::linear("maximum depth").range(-0.4, 10.4).every(1.0), share());
    let mut over_time = Panel::new(
        Axis::linear(format!("processor time, relative to depth {}", DEPTHS[DEPTHS.len() - 1])).range(0.0, 1.1),
        share(),
    );
    for (i, depths) in scenes.iter().enumerate() {
        let stroke = theme::series(i);
        // The deepest level misses nothing by definition: 0 has no place on a logarithmic axis
        let Some((deepest, levels)) = depths.levels.split_last() else { continue };
        let scene = match &*depths.scene {
            "cornell-lambert" => "diffuse spheres".to_owned(),
            "cornell-spheres" => "mirror and glass spheres".into(),
            other => other.replace('-', " "),
        };
        let label = format!("{scene} (depth {}: {})", deepest.depth, duration(deepest.cpu_seconds.value));
        let over =
            |at: &dyn Fn(&DepthLevel) -> f64| levels.iter().map(|l| [at(l), l.missing.value]).collect::<Vec<_>>();
        let band = |l: &DepthLevel| [f64::from(l.depth), l.missing.low(), l.missing.high()];
        let (by_depth, by_time) = (over(&|l| f64::from(l.depth)), over(&|l| l.time_share));
        let bands: Vec<_> = levels.iter().map(band).collect();
        over_depth = over_depth.band("", stroke.colour, bands).dotted_line(label, stroke, by_depth);
        over_time = over_time.dotted_line("", stroke, by_time);
        for level in levels {
            over_time = over_time.note([level.time_share, level.missing.value], level.depth.to_string(), stroke.colour);
        }
    }
    Plot::new([
        over_depth.title("Missing light by maximum depth").with_names_on_curves(),
        over_time.title("Missing light by time (labels: maximum depth)"),
    ])
    .draw()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn each_depth_has_more_light() {
        let (scene, request) = builtin::cornell_spheres();
        let request = Request { width: 40, height: 30, spp: 16, light_samples: 1, ..request };
        let depths = measure(&scene, &request, 3, 1, &Deadline::after(60.0)).unwrap();
        let missing: Vec<f64> = depths.levels.iter().map(|l| l.missing.value).collect();
        assert!(missing.windows(2).all(|pair| pair[0] > pair[1]), "{missing:?}");
        assert_eq!((missing[DEPTHS.len() - 1], depths.levels[DEPTHS.len() - 1].time_share), (0.0, 1.0));
        let none = measure(&scene, &request, 3, 1, &Deadline::after(0.0)).unwrap();
        assert!(none.levels.is_empty() && none.replicates == 0);
    }
}
