//! Error against run time: the error of each contender's image as its samples grow.
//!
//! A replicate renders by every contender once, with a seed of its own. All contenders take each step (1, 2, 4, … samples
//! per pixel; renderers in other programs 1, 4, 16, …) alternating, so that a machine that slows down slows all of them. Of our
//! strategies the rendering itself is timed; of other programs the process, and start-up is separated by a fit.
//! Errors are relative to an exact image where there is one, else to two independent long renders whose own errors
//! cancel (see [`compare_with_halves`](crate::raster::compare_with_halves)).

pub mod answer;
pub mod contender;
pub mod curve;
pub mod depth;
pub mod doubling;
pub mod flip;
pub mod recorded;
pub mod reference;
pub mod roughness;
mod schedule;
pub mod strategy;

use crate::envmap::samplers::cut_lights;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::memory;
use crate::render;
use crate::scene::{Request, Scene};
use contender::{Contender, Fault};
use curve::{Curve, CurveVerdict};
use doubling::Deadline;
use reference::{Facts, Reference};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;
use strategy::Strategy;

/// How much to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Seconds of wall-clock time for everything.
    pub budget: f64,
    /// Samples per pixel at which every curve ends; `None` for as many as fit into the time.
    pub max_spp: Option<u32>,
    /// So many renders of each contender with seeds of their own; `None` for [`REPLICATES`], or fewer if they do not fit.
    pub replicates: Option<u32>,
    /// Of the first replicate; the others follow it.
    pub seed: u64,
    /// A folder for all images and their times; see [`recorded`].
    pub keep: Option<PathBuf>,
}

/// Replicates of a plan that does not say how many.
pub const REPLICATES: u32 = 8;
/// Largest number of samples per pixel of a plan that does not say how many.
const MOST_SPP: u32 = 1 << 16;

/// Largest budget, in seconds: a day.
const LONGEST: f64 = 86_400.0;
/// A film's bytes per pixel, and an image's.
const FILM: usize = 104;
const IMAGE: usize = 12;

impl Plan {
    /// Samples per pixel at which every curve ends.
    fn last_spp(&self) -> u32 {
        self.max_spp.unwrap_or(MOST_SPP)
    }

    fn check(&self, request: &Request, strategies: usize) -> Result<()> {
        render::check_request(&Request { spp: 1, ..*request })?;
        if !(self.budget > 0.0 && self.budget <= LONGEST) {
            return Err(Error::parameter("budget", format!("{} is not a number of seconds", self.budget))
                .with_hint("more than 0 and at most 86400"));
        }
        let (max_spp, replicates) = (self.last_spp(), self.replicates.unwrap_or(REPLICATES));
        if max_spp == 0 || max_spp > 1 << 24 {
            return Err(
                Error::parameter("max_spp", format!("{max_spp} samples per pixel")).with_hint("from 1 to 16777216")
            );
        }
        if !(1..=1000).contains(&replicates) {
            return Err(Error::parameter("replicates", format!("{replicates}")).with_hint("from 1 to 1000"));
        }
        if strategies == 0 {
            return Err(Error::parameter("strategies", "none is given"));
        }
        let levels = max_spp.ilog2() as usize + 1;
        let each = FILM + IMAGE * (levels + replicates as usize);
        let bytes = request.width.saturating_mul(request.height).saturating_mul(strategies * each);
        memory::request(bytes, || {
            format!("the films of {strategies} strategies at {}x{}", request.width, request.height)
        })
    }
}

/// The curves of all contenders on one scene.
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
    /// One for each contender, in their order.
    pub curves: Vec<Curve>,
    /// What was asked for and left out for lack of time, in words.
    pub cut: Vec<String>,
    /// Runs of renderers that failed.
    pub faults: Vec<Fault>,
    /// What else must be known of the result, in words.
    pub notes: Vec<String>,
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

/// Where a reference comes from that is not the exact image or rendered by our default strategy.
#[derive(Debug, Clone, Copy)]
pub enum Asked<'a> {
    /// It is at hand.
    Known(&'a Reference),
    /// Two long renders by a contender, within half of the budget.
    By(&'a Contender),
}

/// Measures the contenders on a scene.
///
/// Without a reference that is `asked` for, one is made here, within half of the budget.
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
    let (start, all) = (Instant::now(), Deadline::after(plan.budget));
    let mut result = Convergence {
        scene: scene.name.clone(),
        width: request.width,
        height: request.height,
        ..Convergence::default()
    };
    if let Some(truth) = make_reference(scene, request, plan, asked, &all.share(0.5))? {
        result.reference = Some(truth.facts.clone());
        schedule::run(scene, request, contenders, plan, &truth, &all, &mut result)?;
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

fn make_reference(
    scene: &Scene,
    request: &Request,
    plan: &Plan,
    asked: Option<Asked<'_>>,
    deadline: &Deadline,
) -> Result<Option<Reference>> {
    let max_spp = plan.last_spp().saturating_mul(FURTHER).min(1 << 24);
    match asked {
        Some(Asked::Known(known)) => return Ok(Some(known.clone())),
        Some(Asked::By(contender)) => return Reference::by(contender, scene, request, plan.seed, max_spp, deadline),
        None => {}
    }
    // An exact image that takes more than half of the time leaves the rest to a rendered one.
    if let Some(exact) = Reference::exact(scene, request, &deadline.share(0.5)) {
        return Ok(Some(exact));
    }
    Reference::rendered(scene, request, plan.seed, max_spp, deadline)
}

impl Convergence {
    /// A contender's curve.
    pub fn curve(&self, name: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.strategy == name)
    }

    /// The processor time that all contenders have had: the shortest of their last levels.
    pub fn common_seconds(&self) -> f64 {
        let last = self.curves.iter().filter_map(|curve| Some(curve.levels.last()?.cpu_seconds));
        last.fold(f64::INFINITY, f64::min)
    }

    /// The smallest RMSE that every contender without bias has reached.
    pub fn common_rmse(&self) -> f64 {
        let unbiased = self.curves.iter().filter(|curve| curve.verdict != CurveVerdict::Biased);
        let least = |curve: &Curve| curve.levels.iter().map(curve::Level::rmse).fold(f64::INFINITY, f64::min);
        unbiased.map(least).fold(f64::NAN, f64::max)
    }

    /// Whether any contender has a verdict.
    pub fn has_verdict(&self) -> bool {
        self.curves.iter().any(|curve| curve.verdict != CurveVerdict::Unknown)
    }
}
