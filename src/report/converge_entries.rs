//! The figures of error against run time: how each is made and what it must meet.

use super::check::Check;
use super::context::{Context, GOLD};
use super::converge::{self as view, rows};
use super::converge_series as series;
use super::entries::entry;
use super::output;
use super::registry::{Entry, Made};
use crate::error::Result;
use crate::scene::{Environment, Request, Scene, builtin};
use crate::study::converge::curve::{Curve, SIGMAS};
use crate::study::converge::doubling::Deadline;
use crate::study::converge::lights::{self, CUTS};
use crate::study::converge::strategy::Strategy;
use crate::study::converge::{Convergence, Plan, depth, measure, roughness};
use std::sync::Arc;

/// Seconds after which a figure is cut short; on a machine of two cores none comes near.
const LIMIT: f64 = 120.0;
/// Numbers of lights that the map is cut into.
const LIGHTS: [u32; 6] = [1, 4, 16, 64, 256, 1024];

/// Widths of the lobe whose efficiency is measured, and those of a quick run.
const ALPHAS: [f32; 6] = [0.02, 0.05, 0.1, 0.25, 0.5, 1.0];
const QUICK_ALPHAS: [f32; 3] = [0.05, 0.25, 1.0];

pub(super) fn all() -> Vec<Entry> {
    vec![
        entry(
            "error-time-sphere",
            "Error of the lit sphere against run time, by strategy",
            "first report: equal-time comparison",
            |c| error_time(&*sphere(c)?, sphere_checks),
        ),
        entry(
            "error-time-cornell",
            "Error of the room against run time, by strategy",
            "second report: equal-time comparison",
            |c| error_time(&cornell(c)?, cornell_checks),
        ),
        entry(
            "error-time-roughness",
            "Efficiency over roughness, by the way of drawing normals",
            "second report: importance sampling, over alpha",
            by_roughness,
        ),
        entry(
            "error-depth",
            "Light that each maximum depth leaves out, and the time that it saves",
            "second report: max_ray_depth",
            by_depth,
        ),
        entry(
            "median-cut-error",
            "Error of the lights that stand for a map",
            "first report: median cut, its error",
            median_cut,
        ),
    ]
}

fn plan(context: &Context, spp: u32, replicates: u32) -> Plan {
    Plan { budget: LIMIT, max_spp: spp, replicates, seed: context.seed }
}

fn sphere_scene(context: &Context) -> (Scene, Request) {
    let source = &context.source;
    let environment = Environment::upright(source.map.clone(), source.name.clone(), builtin::SPHERE_ENV_SCALE);
    let (scene, request) = builtin::sphere_env(environment);
    let side = context.size(80, 32);
    (scene, Request { width: side, height: side, light_samples: 1, ..request })
}

fn sphere(context: &Context) -> Result<Arc<Convergence>> {
    context.convergences.get("sphere", || {
        let (scene, request) = sphere_scene(context);
        let plan = plan(context, context.size(128, 32), context.size(5, 4));
        measure(&scene, &request, &Strategy::usual(&scene), &plan, None)
    })
}

fn cornell(context: &Context) -> Result<Convergence> {
    let (scene, request) = context.spheres();
    let (width, height) = (context.size(96, 48), context.size(72, 36));
    let (scene, request) = scene.resized(request, [width, height]);
    let plan = plan(context, context.size(128, 16), context.size(5, 4));
    measure(&scene, &Request { light_samples: 1, ..request }, &Strategy::usual(&scene), &plan, None)
}

fn error_time(result: &Convergence, checks: fn(&Convergence) -> Vec<Check>) -> Result<Made> {
    Ok(Made {
        drawing: view::sheet(result)?,
        table: output::table(&rows(result))?,
        picture: None,
        checks: [
            vec![Check::near("strategies stopped by the time limit", 0.0, result.cut.len() as f64, 0.0)],
            checks(result),
        ]
        .concat(),
    })
}

/// Twice the half width of the 95 % interval: with this many checks, one in hundreds may be beyond by chance.
fn as_monte_carlo(curve: &Curve) -> Check {
    let slope = curve.slope;
    Check::near(format!("slope, {}", curve.strategy.name), -0.5, slope.value, (2.0 * slope.half_width).min(0.2))
}

/// The slope, which must be below −1/2 by more than its interval: the check is on the interval's upper end.
fn steeper(curve: &Curve) -> Check {
    Check::near(format!("slope's upper end, {}: below −1/2", curve.strategy.name), -1.0, curve.slope.high(), 0.499)
}

/// Standard errors of the mean squared bias, which must be chance.
fn without_bias(curve: &Curve) -> Check {
    let sigmas = curve.bias2.value / curve.bias2.standard_error;
    Check::near(format!("squared bias in standard errors, {}", curve.strategy.name), 0.0, sigmas, 2.0 * SIGMAS)
}

fn sphere_checks(result: &Convergence) -> Vec<Check> {
    let mut checks = Vec::new();
    for curve in &result.curves {
        let name = curve.strategy.name.as_str();
        if curve.strategy.has_fixed_lights() {
            let sigmas = curve.bias2.value / curve.bias2.standard_error;
            checks.push(Check::at_most(
                format!("3 standard errors over the squared bias, {name}"),
                SIGMAS / sigmas,
                1.0,
            ));
            // The error of the last level is bias and hardly anything else.
            let share = curve.levels.last().map_or(f64::NAN, |level| curve.bias2.value / level.mse.value);
            checks.push(Check::near(format!("share of bias in the squared error, {name}"), 1.0, share, 0.1));
        } else {
            checks.push(without_bias(curve));
            // Spread evenly, the error under a map of such contrast hangs on a few hits: no interval from replicates holds.
            let heavy = name.starts_with("hemisphere");
            if curve.strategy.is_independent() && !heavy {
                checks.push(as_monte_carlo(curve));
            } else if ["light", "mis", "mis-compensated", "light-cosine"].contains(&name) {
                checks.push(steeper(curve));
            }
        }
    }
    checks
}

fn cornell_checks(result: &Convergence) -> Vec<Check> {
    let mut checks = Vec::new();
    for curve in &result.curves {
        checks.push(without_bias(curve));
        checks.push(if curve.strategy.is_independent() { as_monte_carlo(curve) } else { steeper(curve) });
    }
    let last = |name: &str| result.curve(name).and_then(|c| c.levels.last()).map_or(f64::NAN, |level| level.mse.value);
    let best = last("light").min(last("bsdf"));
    checks.push(Check::at_most("squared error of mis over the best of light and bsdf", last("mis") / best, 1.1));
    let reference = result.reference.as_ref().map_or(f64::NAN, |facts| facts.rmse.powi(2));
    let least = result.curves.iter().filter_map(|c| Some(c.levels.last()?.mse.value)).fold(f64::INFINITY, f64::min);
    checks.push(Check::at_most("squared error of the reference over the least measured", reference / least, 0.1));
    checks
}

fn by_roughness(context: &Context) -> Result<Made> {
    let (scene, request) = context.statue(GOLD, 0.25)?;
    let (scene, request) = scene.resized(request, [context.size(96, 48), context.size(72, 36)]);
    let request = Request { spp: context.size(32, 8), light_samples: 1, ..request };
    let replicates = context.size(4, 2);
    let alphas = context.size(&ALPHAS[..], &QUICK_ALPHAS[..]);
    let levels = roughness::measure(&scene, &request, alphas, replicates, context.seed, &Deadline::after(LIMIT))?;
    let expected = alphas.len() * roughness::NORMALS.len();
    let mut checks = vec![Check::near("rows", expected as f64, levels.len() as f64, 0.0)];
    for three in levels.chunks_exact(roughness::NORMALS.len()) {
        let [visible, all, _] = three else { continue };
        let alpha = visible.alpha;
        let z = visible.light.z(&all.light);
        checks.push(Check::near(
            format!("metal by visible normals less by all (standard errors), α = {alpha}"),
            0.0,
            z,
            4.0,
        ));
        // Where the lobe is narrow both densities are the same, and only chance tells them apart.
        let chance = visible.mse.positive()[0] / all.mse.positive()[1];
        let rough = alpha >= 0.25;
        let ratio = if rough { visible.mse.value / all.mse.value } else { chance };
        let name = if rough { "squared error" } else { "least squared error over the largest" };
        checks.push(Check::at_most(format!("{name}, visible over all normals, α = {alpha}"), ratio, 1.0));
    }
    let table = output::table(&series::roughness_rows(&levels))?;
    Ok(Made { drawing: series::roughness(&levels), table, picture: None, checks })
}

fn by_depth(context: &Context) -> Result<Made> {
    let replicates = context.size(4, 2);
    let deadline = Deadline::after(LIMIT);
    let size = [context.size(96, 48), context.size(72, 36)];
    let series_of = |(scene, request): (Scene, Request)| {
        let (scene, request) = scene.resized(request, size);
        let request = Request { spp: context.size(64, 8), light_samples: 1, ..request };
        depth::measure(&scene, &request, replicates, context.seed, &deadline)
    };
    let scenes = [series_of(context.spheres())?, series_of(builtin::cornell_lambert())?];
    let mut checks = Vec::new();
    for scene in &scenes {
        let name = &scene.scene;
        checks.push(Check::near(format!("depths, {name}"), depth::DEPTHS.len() as f64, scene.levels.len() as f64, 0.0));
        let falls = scene.levels.windows(2).filter(|pair| pair[0].missing.value > pair[1].missing.value).count();
        let pairs = (depth::DEPTHS.len() - 1) as f64;
        checks.push(Check::near(
            format!("depths with less light missing than the one before, {name}"),
            pairs,
            falls as f64,
            0.0,
        ));
        let saved = scene.levels.iter().find(|l| l.depth == 1).map_or(f64::NAN, |l| l.time_share);
        checks.push(Check::at_most(format!("time of depth 1 over that of depth 100, {name}"), saved, 1.0));
    }
    let table = output::table(&series::depth_rows(&scenes))?;
    Ok(Made { drawing: series::depths(&scenes), table, picture: None, checks })
}

fn median_cut(context: &Context) -> Result<Made> {
    let (scene, request) = sphere_scene(context);
    let sampled = sphere(context)?;
    let plan = plan(context, 1, 3);
    let fixed = lights::cuts(&scene, &request, &LIGHTS, &plan, sampled.truth.as_ref())?;
    let mut checks = vec![Check::near("strategies stopped by the time limit", 0.0, fixed.cut.len() as f64, 0.0)];
    for cut in CUTS {
        let errors: Vec<f64> = fixed
            .curves
            .iter()
            .filter(|curve| series::number_of_lights(curve, cut).is_some())
            .map(|curve| curve.levels.last().map_or(f64::NAN, |level| level.rmse()))
            .collect();
        let [few, many] = [errors.first(), errors.last()].map(|e| e.copied().unwrap_or(f64::NAN));
        checks.push(Check::at_most(format!("error of {} lights over that of one, {cut}", LIGHTS[5]), many / few, 0.05));
        checks.push(Check::at_most(format!("its bias under 3 standard errors, {cut}-64"), below(&fixed, cut), 1.0));
    }
    Ok(Made {
        drawing: series::lights(&fixed, &sampled),
        table: output::table(&[rows(&fixed), rows(&sampled)].concat())?,
        picture: None,
        checks,
    })
}

/// 3 standard errors over the squared bias of 64 lights: less than 1 where the bias is real.
fn below(fixed: &Convergence, cut: &str) -> f64 {
    let curve = fixed.curve(&format!("{cut}-64"));
    curve.map_or(f64::NAN, |curve| SIGMAS * curve.bias2.standard_error / curve.bias2.value)
}
