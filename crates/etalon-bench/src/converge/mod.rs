//! Error against run time: the error of each contender's image as its samples grow.
//!
//! A replicate renders by every contender once, with a seed of its own. All contenders take each step (1, 2, 4, … samples
//! per pixel; renderers in other programs 1, 4, 16, …) alternating, so that a machine that slows down slows all of them. Of our
//! strategies the rendering itself is timed; of other programs the process, and start-up is separated by a fit.
//! Errors are relative to an exact image where there is one, else to two independent long renders whose own errors
//! cancel (see [`compare_with_halves`](etalon_core::raster::compare_with_halves)).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod answer;
pub mod contender;
pub mod curve;
pub mod doubling;
pub mod recorded;
pub mod reference;
mod schedule;
pub mod strategy;

pub use answer::Convergence;
pub use schedule::{Plan, REPLICATES};

use contender::Contender;
use doubling::Deadline;
use etalon_core::envmap::samplers::cut_lights;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::scene::{Request, Scene};
use reference::Reference;
use std::time::Instant;
use strategy::Strategy;

/// Samples of each half of a rendered reference over those of the last level. With several light samples each, its mean
/// squared error is less than a tenth of that level's.
const FURTHER: u32 = 8;

/// Where a reference comes from that is not the exact image or rendered by our default strategy.
#[derive(Debug, Clone, Copy)]
pub enum Asked<'a> {
    Known(&'a Reference),
    /// Two long renders by a contender, within half of the budget.
    By(&'a Contender),
}

/// The most of the budget that the reference may take.
const REFERENCE: f64 = 0.5;

/// Measures the contenders on a scene.
///
/// Without a reference that is `asked` for, it is the exact image where one is known, which is no part of the budget, else a long render
/// within half of it.
///
/// # Errors
/// [`Error::Parameter`] for a plan that cannot be carried out, two contenders of one name, or a strategy that the scene has no
/// use for.
pub fn measure(
    scene: &Scene,
    request: &Request,
    contenders: &[Contender],
    plan: &Plan,
    asked: Option<Asked<'_>>,
) -> Result<Convergence> {
    plan.check(request, contenders.len())?;
    for (i, contender) in contenders.iter().enumerate() {
        if contenders[..i].iter().any(|other| other.name() == contender.name()) {
            let message = format!("two of them are called {}", contender.name());
            return Err(Error::parameter("strategies", message).with_hint("give each renderer a name of its own"));
        }
        if let Contender::Strategy(strategy) = contender {
            strategy.check(scene)?;
        }
    }
    // Of kept runs that are the reference, too, some are that and the others are measured
    let (mut asked, mut contenders) = (asked, contenders.to_vec());
    let by_kept = match asked {
        Some(Asked::By(Contender::Recorded(kept))) => Some(kept.split()?.map(Contender::Recorded)),
        _ => None,
    };
    if let Some([by, others]) = &by_kept {
        asked = Some(Asked::By(by));
        contenders.iter_mut().filter(|contender| contender.name() == others.name()).for_each(|of| *of = others.clone());
    }
    let start = Instant::now();
    let exact = if asked.is_none() { Reference::exact(scene, request) } else { None };
    let exact_seconds = if exact.is_some() { start.elapsed().as_secs_f64() } else { 0.0 };
    let all = Deadline::after(plan.budget);
    let mut result = Convergence {
        scene: scene.name.clone(),
        width: request.width,
        height: request.height,
        exact_seconds,
        ..Convergence::default()
    };
    let truth = match exact {
        Some(exact) => Some(exact),
        None => make_reference(scene, request, plan, asked, &all.share(REFERENCE))?,
    };
    if let Some(truth) = truth {
        result.reference = Some(truth.facts.clone());
        schedule::run(scene, request, &contenders, plan, &truth, &all, &mut result)?;
        result.truth = Some(truth);
    } else {
        result.cut.push("the reference: nothing was measured".into());
    }
    result.interrupted = interrupt::requested();
    result.seconds = start.elapsed().as_secs_f64();
    Ok(result)
}

/// The ways of cutting a map, by the beginning of their strategies' names.
pub const CUTS: [&str; 2] = [cut_lights::MEDIAN_CUT.name, cut_lights::VARIANCE_CUT.name];

/// Samples per pixel of [`cuts`]: some, because radiance varies within a pixel.
const CUT_SPP: u32 = 4;

/// Measures the bias of fixed lights in place of an environment, which no number of samples reduces: both cuts into each of the
/// numbers of lights; a curve each, the cuts one after the other.
pub fn cuts(
    scene: &Scene,
    request: &Request,
    counts: &[u32],
    plan: &Plan,
    known: Option<&Reference>,
) -> Result<Convergence> {
    let name = |cut: &'static str| counts.iter().map(move |k| format!("{cut}-{k}").parse());
    let strategies = CUTS.into_iter().flat_map(name).collect::<Result<Vec<Strategy>>>()?;
    let plan = Plan { max_spp: Some(CUT_SPP), ..plan.clone() };
    measure(scene, request, &Contender::of(&strategies), &plan, known.map(Asked::Known))
}

/// The reference that is asked for, else a long render; `None` if the deadline comes first.
fn make_reference(
    scene: &Scene,
    request: &Request,
    plan: &Plan,
    asked: Option<Asked<'_>>,
    deadline: &Deadline,
) -> Result<Option<Reference>> {
    let max_spp = plan.last_spp().saturating_mul(FURTHER).min(1 << 24);
    match asked {
        Some(Asked::Known(known)) => Ok(Some(known.clone())),
        Some(Asked::By(contender)) => Reference::by(contender, scene, request, plan.seed, max_spp, deadline),
        None => Reference::rendered(scene, request, plan.seed, max_spp, deadline),
    }
}

#[cfg(test)]
mod tests {
    use super::curve::CurveVerdict;
    use super::*;
    use etalon_core::scene::builtin;
    use statrs::distribution::{Binomial, DiscreteCDF};

    #[test]
    #[ignore = "takes minutes: cargo test --release --lib right_methods -- --ignored --nocapture"]
    fn right_methods_are_called_biased_at_the_level() {
        const RUNS: u64 = 1000;
        let (scene, request) = builtin::cornell_lambert();
        let request = Request { width: 16, height: 12, light_samples: 1, ..request };
        let strategies: Vec<Strategy> = ["mis", "light", "bsdf+independent"].map(|name| name.parse().unwrap()).into();
        let (mut biased, mut total) = (0, 0);
        for run in 0..RUNS {
            let plan = Plan { budget: 600.0, max_spp: Some(16), replicates: Some(8), seed: 100 * run, keep: None };
            let found = measure(&scene, &request, &Contender::of(&strategies), &plan, None).unwrap();
            total += found.curves.len() as u64;
            biased += found.curves.iter().filter(|curve| curve.verdict == CurveVerdict::Biased).count() as u64;
        }
        // Two tests for each method.
        let limit = Binomial::new(2.0 * curve::BIAS_LEVEL, total).unwrap().inverse_cdf(0.999);
        println!("{biased} of {total} called biased, limit {limit}");
        assert!(biased <= limit && total == 3 * RUNS, "{biased} of {total}, limit {limit}");
    }
}
