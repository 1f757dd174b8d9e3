//! Error against run time by sampling strategy: `error-time-sphere`, `error-time-cornell`; and what the default chooses on scenes
//! of different kinds, beside what the alternatives cost: `choice`.

use crate::gallery::figure::Numbers;
use crate::gallery::prelude::*;
use crate::view::converge as view;
use crate::view::converge::sheet;
use etalon_bench::converge::answer::Answer;
use etalon_bench::converge::contender::Contender;
use etalon_bench::converge::curve::Curve;
use etalon_bench::converge::strategy::Strategy;
use etalon_bench::converge::{Convergence, Plan, measure};
use etalon_bench::table::Table;
use etalon_core::scene::{Environment, Request, Scene, builtin};

/// Standard errors beyond which a bias is seen.
const SIGMAS: f64 = 3.0;

/// Seconds after which a figure is cut short; on a machine of two cores none comes near.
pub const LIMIT: f64 = 120.0;
/// Strategies whose Sobol' points must converge faster than independent random numbers.
const FASTER_ON_SPHERE: [&str; 4] = ["light", "mis", "mis-cosine-compensated", "light-cosine"];

/// A plan of `spp` samples per pixel and replicates.
pub fn plan(inputs: &Inputs, max_spp: u32, replicates: u32) -> Plan {
    Plan { budget: LIMIT, max_spp: Some(max_spp), replicates: Some(replicates), seed: inputs.seed, keep: None }
}

/// The sphere under the map with one light sample, at the size of these figures.
pub fn sphere_scene(inputs: &Inputs) -> (Scene, Request) {
    let map = &inputs.map;
    let environment = Environment::upright(map.map.clone(), map.name.clone(), builtin::SPHERE_ENV_SCALE);
    let (scene, request) = builtin::sphere_env(environment);
    let side = inputs.effort.of(144, 48);
    (scene, Request { width: side, height: side, light_samples: 1, ..request })
}

/// A Cornell box in an image small enough to be rendered many times, with one light sample.
pub fn small(inputs: &Inputs, scene: (Scene, Request)) -> (Scene, Request) {
    of_size(scene, inputs.effort.of([96, 72], [48, 36]))
}

fn of_size((scene, request): (Scene, Request), size: [usize; 2]) -> (Scene, Request) {
    let (scene, request) = scene.resized(request, size);
    (scene, Request { light_samples: 1, ..request })
}

pub fn sphere_curves(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Convergence>> {
    let (scene, request) = sphere_scene(inputs);
    let plan = plan(inputs, 32, 5);
    studies.get("sphere", || measure(&scene, &request, &Contender::of(&Strategy::usual(&scene)), &plan, None))
}

pub fn figures() -> Vec<Maker> {
    vec![
        maker("error-time-sphere", sphere_content),
        maker("error-time-cornell", cornell_content),
        maker("choice", choice),
    ]
}

fn sphere_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let result = sphere_curves(inputs, studies)?;
    let mut checks = vec![default_against_best(&result)];
    for curve in &result.curves {
        let name = curve.strategy.as_str();
        if curve.contender.has_fixed_lights() {
            checks.push(biased(curve));
            // The error of the last level is bias and hardly anything else.
            let share = curve.levels.last().map_or(f64::NAN, |level| curve.bias2.value / level.mse.value);
            checks.push(Check::within(format!("share of bias in the squared error, {name}"), 1.0, share, 0.1));
            continue;
        }
        checks.push(unbiased(curve));
        // With uniform directions the error under a map of high contrast depends on few samples: its replicates do not
        // give an interval.
        if curve.contender.is_independent() && !name.starts_with("hemisphere") {
            checks.push(as_monte_carlo(curve));
        } else if FASTER_ON_SPHERE.contains(&name) {
            checks.push(faster(curve));
        }
    }
    let content = Content::of_csv(sheet(&result), view::csv(&[&result])?, unless_stopped(&result, checks));
    Ok(Content { numbers: names([&*result]), ..content })
}

/// What strategies are called in figures and on the command line.
fn names<'a>(results: impl IntoIterator<Item = &'a Convergence>) -> Numbers {
    let mut curves: Vec<&Curve> = Vec::new();
    for curve in results.into_iter().flat_map(|result| &result.curves) {
        if !curves.iter().any(|known| known.strategy == curve.strategy) {
            curves.push(curve);
        }
    }
    Numbers::of(
        &Table::of(&curves)
            .words("Strategy", |curve| view::shown(curve))
            .words("On the command line", |curve| &curve.strategy),
    )
}

/// The curves of mirror and glass in the box, in images large enough to recognize in print what each strategy renders.
pub fn cornell_curves(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Convergence>> {
    let (scene, request) = of_size(inputs.spheres(), inputs.effort.of([112, 84], [48, 36]));
    let plan = plan(inputs, inputs.effort.of(32, 16), inputs.effort.of(5, 4));
    studies.get("cornell", || measure(&scene, &request, &Contender::of(&Strategy::usual(&scene)), &plan, None))
}

fn cornell_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let result = cornell_curves(inputs, studies)?;
    let mut checks = vec![default_against_best(&result)];
    for curve in &result.curves {
        checks.push(unbiased(curve));
        checks.push(if curve.contender.is_independent() { as_monte_carlo(curve) } else { faster(curve) });
    }
    let last = |name: &str| result.curve(name).and_then(|c| c.levels.last()).map_or(f64::NAN, |level| level.mse.value);
    let best = last("light").min(last("bsdf"));
    checks.push(Check::at_most("squared error, mis over the better of light and bsdf", last("mis") / best, 1.1));
    let reference = result.reference.as_ref().map_or(f64::NAN, |facts| facts.rmse.powi(2));
    let least = result.curves.iter().filter_map(|c| Some(c.levels.last()?.mse.value)).fold(f64::INFINITY, f64::min);
    checks.push(Check::at_most("squared error, the reference over the least measured", reference / least, 0.1));
    let content = Content::of_csv(sheet(&result), view::csv(&[&result])?, unless_stopped(&result, checks));
    Ok(Content { numbers: names([&*result]), ..content })
}

/// Why checks are skipped of what [`LIMIT`] has cut short.
pub const STOPPED: &str = "the time limit stopped it: the machine is busy";

/// The checks of a measurement, skipped if a part of it was left out for lack of time: the load of the machine is no fault.
pub fn unless_stopped(result: &Convergence, checks: impl IntoIterator<Item = Check>) -> Vec<Check> {
    let why = (!result.cut.is_empty()).then_some(STOPPED);
    checks.into_iter().map(|check| check.unless(why)).collect()
}

/// Largest factor by which the default is less efficient than the best strategy without bias.
const WORSE: f64 = 1.15;

/// What renders by default is as efficient as the best strategy, except for [`WORSE`] and chance.
pub fn default_against_best(result: &Convergence) -> Check {
    let default = Answer::of(result, 0.99).and_then(|answer| answer.default);
    let upper = default.map_or(f64::NAN, |rival| 1.0 / rival.low);
    Check::at_least(
        "efficiency of the default over the best other strategy's, upper end of the 99 % interval",
        upper,
        1.0 / WORSE,
    )
}

/// The squared bias in units of its standard error.
fn bias(curve: &Curve) -> f64 {
    curve.bias2.value / curve.bias2.standard_error
}

/// The mean of all replicates is biased beyond chance.
pub fn biased(curve: &Curve) -> Check {
    Check::at_least(format!("squared bias (standard errors), {}", curve.strategy), bias(curve), SIGMAS)
}

/// The bias is within what chance explains.
fn unbiased(curve: &Curve) -> Check {
    Check::at_most(format!("squared bias (standard errors), {}", curve.strategy), bias(curve), 2.0 * SIGMAS)
}

/// Independent random numbers: the slope is −1/2, up to 3 of its own standard errors.
fn as_monte_carlo(curve: &Curve) -> Check {
    let name = format!("slope (−1/2 + 3 standard errors), {}", curve.strategy);
    Check::at_most(name, curve.slope.value, -0.5 + 3.0 * curve.slope.standard_error)
}

/// Sobol' points: the slope's interval is below −1/2.
fn faster(curve: &Curve) -> Check {
    Check::at_most(format!("slope, upper end of its 95 % interval, {}", curve.strategy), curve.slope.high(), -0.5)
}

/// Strategies on scenes that no other figure measures.
const UNDER_MAP: &str = "light-cosine mis mis-cosine mis-cosine-compensated mis-cosine-compensated+lt default";
const IN_BOX: &str = "light bsdf mis mis+adaptive mis+lt default";

fn choice(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let map = &inputs.map;
    let environment = Environment::upright(map.map.clone(), map.name.clone(), 1.0);
    let scenes = [
        ("Diffuse sphere under the map", sphere_curves(inputs, studies)?),
        ("Brushed metal under the map", compared(inputs, studies, builtin::brushed_metal(environment), UNDER_MAP)?),
        ("Mirror and glass in a box", cornell_curves(inputs, studies)?),
        ("Diffuse spheres in a box", compared(inputs, studies, builtin::cornell_lambert(), IN_BOX)?),
    ];
    let named = |(title, result): &(&str, Rc<Convergence>)| {
        let checks = unless_stopped(result, [default_against_best(result)]).into_iter();
        checks.map(|check| Check { name: format!("{title}: {}", check.name), ..check }).collect::<Vec<_>>()
    };
    let checks = scenes.iter().flat_map(named).collect();
    let content = Content::new(view::costs(&scenes), &view::cost_rows(&scenes), checks)?;
    Ok(Content { numbers: names(scenes.iter().map(|(_, result)| &**result)), ..content })
}

/// The curves of some strategies on a scene.
fn compared(
    inputs: &Inputs,
    studies: &mut Studies,
    scene: (Scene, Request),
    strategies: &str,
) -> Result<Rc<Convergence>> {
    let (scene, request) = small(inputs, scene);
    let plan = plan(inputs, inputs.effort.of(32, 16), 4);
    let strategies = strategies.split_whitespace().map(str::parse).collect::<Result<Vec<_>>>()?;
    studies.get(scene.name.clone(), || measure(&scene, &request, &Contender::of(&strategies), &plan, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_time_limit_stops_is_skipped_and_does_not_fail() {
        let (scene, request) = builtin::cornell_lambert();
        let (scene, request) = of_size((scene, request), [8, 6]);
        let measured = |budget: f64| {
            let plan = Plan { budget, max_spp: Some(2), replicates: Some(2), seed: 1, keep: None };
            let strategies = ["light", "bsdf"].map(|name| name.parse::<Strategy>().unwrap());
            let result = measure(&scene, &request, &Contender::of(&strategies), &plan, None).unwrap();
            unless_stopped(&result, [Check::at_most("error", f64::NAN, 1.0)])
        };
        assert!(measured(60.0)[0].failed());
        assert_eq!(measured(1e-9)[0].skipped, STOPPED);
    }
}
