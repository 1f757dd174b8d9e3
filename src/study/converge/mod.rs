//! Error against run time: the error of each sampling strategy's image as its samples double.
//!
//! A replicate renders every strategy once, with a seed of its own. All strategies take each step (1, 2, 4, … samples
//! per pixel) alternating, so that a machine that slows down slows all of them, and only the rendering itself is timed.
//! Errors are relative to an exact image where there is one, else to two independent long renders whose own errors
//! cancel (see [`compare_with_halves`](crate::raster::compare_with_halves)).

pub mod curve;
pub mod depth;
pub mod doubling;
pub mod reference;
pub mod roughness;
pub mod strategy;

use crate::envmap::samplers::cut_lights;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::memory;
use crate::raster::hdr_flip;
use crate::render;
use crate::scene::{Request, Scene};
use curve::{Curve, CurveVerdict, Measured, Run};
use doubling::{Deadline, Doubling};
use reference::{Facts, Reference};
use serde::Serialize;
use std::time::Instant;
use strategy::Strategy;

/// How much to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Seconds of wall-clock time for everything.
    pub budget: f64,
    /// Samples per pixel at which every curve ends.
    pub max_spp: u32,
    /// At most so many renders of each strategy with seeds of their own.
    pub replicates: u32,
    /// Of the first replicate; the others follow it.
    pub seed: u64,
}

/// Largest budget, in seconds: a day.
const LONGEST: f64 = 86_400.0;
/// A film's bytes per pixel, and an image's.
const FILM: usize = 104;
const IMAGE: usize = 12;

impl Plan {
    fn check(&self, request: &Request, strategies: usize) -> Result<()> {
        render::check_request(&Request { spp: 1, ..*request })?;
        if !(self.budget > 0.0 && self.budget <= LONGEST) {
            return Err(Error::parameter("budget", format!("{} is not a number of seconds", self.budget))
                .with_hint("more than 0 and at most 86400"));
        }
        if self.max_spp == 0 || self.max_spp > 1 << 24 {
            return Err(Error::parameter("max_spp", format!("{} samples per pixel", self.max_spp))
                .with_hint("from 1 to 16777216"));
        }
        if !(1..=1000).contains(&self.replicates) {
            return Err(Error::parameter("replicates", format!("{}", self.replicates)).with_hint("from 1 to 1000"));
        }
        if strategies == 0 {
            return Err(Error::parameter("strategies", "none is given"));
        }
        let levels = self.max_spp.ilog2() as usize + 1;
        let each = FILM + IMAGE * (levels + self.replicates as usize);
        let bytes = request.width.saturating_mul(request.height).saturating_mul(strategies * each);
        memory::request(bytes, || {
            format!("the films of {strategies} strategies at {}x{}", request.width, request.height)
        })
    }
}

/// The curves of all strategies on one scene.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Convergence {
    /// Its name.
    pub scene: String,
    /// Columns of the images.
    pub width: usize,
    /// Rows of the images.
    pub height: usize,
    /// None if the budget was over before there was one.
    pub reference: Option<Facts>,
    /// One for each strategy, in their order.
    pub curves: Vec<Curve>,
    /// What was left out for lack of time, in words.
    pub cut: Vec<String>,
    /// Whether the process was asked to stop before the end of the budget.
    pub interrupted: bool,
    /// Wall-clock time of everything.
    pub seconds: f64,
    /// The reference of the errors.
    #[serde(skip)]
    pub truth: Option<Reference>,
}

/// Samples of each half of a rendered reference over those of the last level. With several light samples each, its mean
/// squared error is less than a tenth of that level's.
const FURTHER: u32 = 8;

/// The share of the time that is reserved for evaluating errors.
const RESERVE: f64 = 0.03;

/// Measures the strategies on a scene.
///
/// `known` is a reference to use in place of one that is made here, within half of the budget.
///
/// # Errors
/// [`Error::Parameter`] for a plan that cannot be carried out, or a strategy that the scene has no use for.
pub fn measure(
    scene: &Scene,
    request: &Request,
    strategies: &[Strategy],
    plan: &Plan,
    known: Option<&Reference>,
) -> Result<Convergence> {
    plan.check(request, strategies.len())?;
    strategies.iter().try_for_each(|strategy| strategy.check(scene))?;
    let (start, all) = (Instant::now(), Deadline::after(plan.budget));
    let mut result = Convergence {
        scene: scene.name.clone(),
        width: request.width,
        height: request.height,
        ..Convergence::default()
    };
    let truth = match known {
        Some(known) => Some(known.clone()),
        None => make_reference(scene, request, plan, &all.share(0.5))?,
    };
    if let Some(truth) = truth {
        result.reference = Some(truth.facts.clone());
        run_schedule(scene, request, strategies, plan, &truth, &all, &mut result)?;
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
    measure(scene, request, &strategies, &Plan { max_spp: CUT_SPP, ..*plan }, known)
}

fn make_reference(scene: &Scene, request: &Request, plan: &Plan, deadline: &Deadline) -> Result<Option<Reference>> {
    if let Some(exact) = Reference::exact(scene, request, deadline) {
        return Ok(Some(exact));
    }
    let max_spp = plan.max_spp.saturating_mul(FURTHER).min(1 << 24);
    Reference::rendered(scene, request, plan.seed, max_spp, deadline)
}

/// A replicate of a strategy while it is rendered.
struct Growing<'a> {
    render: Doubling<'a>,
    levels: Vec<Measured>,
    goes_on: bool,
}

/// Renders replicate after replicate as long as the next one fits into the time that is left.
fn run_schedule(
    scene: &Scene,
    request: &Request,
    strategies: &[Strategy],
    plan: &Plan,
    truth: &Reference,
    all: &Deadline,
    result: &mut Convergence,
) -> Result<()> {
    let request = Request { spp: plan.max_spp, ..*request };
    let exact = truth.image();
    let mut finished: Vec<Vec<Run>> = strategies.iter().map(|_| Vec::new()).collect();
    let mut longest = 0.0_f64;
    for replicate in 0..plan.replicates {
        let left_out = || format!("{} of {} replicates", plan.replicates - replicate, plan.replicates);
        let before = all.left();
        if before < longest * (1.0 + RESERVE) {
            result.cut.push(left_out());
            break;
        }
        // The time of one strategy in one replicate.
        let share = before * (1.0 - RESERVE) / f64::from(plan.replicates - replicate) / strategies.len() as f64;
        let seed = plan.seed.wrapping_add(u64::from(replicate));
        let start = |strategy: &Strategy| {
            let render = Doubling::new(scene, &request, &strategy.settings(seed))?;
            Ok(Growing { render, levels: Vec::new(), goes_on: true })
        };
        let mut growing = strategies.iter().map(start).collect::<Result<Vec<Growing>>>()?;
        // Double the samples of all strategies, alternating, until none of them has a next level.
        while growing.iter().any(|one| one.goes_on) && !all.is_over() {
            for (runs, one) in finished.iter().zip(&mut growing).filter(|(_, one)| one.goes_on) {
                let Growing { render, levels, goes_on } = one;
                let fits = match runs.first() {
                    // All replicates have the levels of the first one.
                    Some(first) => levels.len() < first.levels.len(),
                    None => render.preparation.wall + render.times.wall + render.next_step() <= share,
                };
                *goes_on = render.spp() <= plan.max_spp / 2 && fits && render.double(all);
                if *goes_on {
                    let image = render.image();
                    let errors = truth.compare(&image)?;
                    let shown = if replicate == 0 { Some((hdr_flip(&image, &exact), image)) } else { None };
                    levels.push(Measured { spp: render.spp(), times: render.times, errors, shown });
                }
            }
        }
        let is_complete = |(runs, one): (&Vec<Run>, &Growing)| {
            runs.first().is_none_or(|first| one.levels.len() == first.levels.len())
        };
        if all.is_over() || !finished.iter().zip(&growing).all(is_complete) {
            result.cut.push(left_out());
            break;
        }
        for (runs, Growing { render, levels, .. }) in finished.iter_mut().zip(growing) {
            runs.push(Run { levels, last: render.image(), preparation: render.preparation.wall });
        }
        longest = longest.max(before - all.left());
    }
    for (strategy, runs) in strategies.iter().zip(finished) {
        let reached = runs.first().and_then(|run| run.levels.last()).map_or(0, |level| level.spp);
        if reached <= plan.max_spp / 2 {
            result.cut.push(format!("{}: {reached} of {} samples per pixel", strategy.name, plan.max_spp));
        }
        if !runs.is_empty() {
            result.curves.push(Curve::new(strategy.clone(), runs, truth)?);
        }
    }
    Ok(())
}

impl Convergence {
    /// A strategy's curve.
    pub fn curve(&self, strategy: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.strategy.name == strategy)
    }

    /// The processor time that all strategies have had: the shortest of their last levels.
    pub fn common_seconds(&self) -> f64 {
        let last = self.curves.iter().filter_map(|curve| Some(curve.levels.last()?.cpu_seconds));
        last.fold(f64::INFINITY, f64::min)
    }

    /// The smallest RMSE that every strategy without bias has reached.
    pub fn common_rmse(&self) -> f64 {
        let unbiased = self.curves.iter().filter(|curve| curve.verdict != CurveVerdict::Biased);
        let least = |curve: &Curve| curve.levels.iter().map(curve::Level::rmse).fold(f64::INFINITY, f64::min);
        unbiased.map(least).fold(f64::NAN, f64::max)
    }

    /// Whether any strategy has a verdict.
    pub fn has_verdict(&self) -> bool {
        self.curves.iter().any(|curve| curve.verdict != CurveVerdict::Unknown)
    }
}
