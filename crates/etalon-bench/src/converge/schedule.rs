//! The plan of a comparison: how much it measures, and whether that is possible; and the order of renders: replicate after
//! replicate, in each all contenders alternating, within the budget.

use super::answer::Convergence;
use super::contender::{Contender, Fault, Replicate, Step};
use super::curve::{Curve, FIT_FROM, FIT_LEVELS, Measured, REPLICATES_FOR_VERDICT, Run, TimeFit};
use super::doubling::Deadline;
use super::recorded;
use super::reference::Reference;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::memory;
use etalon_core::raster::{Image, compare_shown};
use etalon_core::scene::{Request, Scene};
use etalon_stats::Extremes;
use std::path::PathBuf;

/// How much to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Seconds of wall-clock time for everything.
    pub budget: f64,
    /// Samples per pixel at which every curve ends; `None` for as many as fit into the time.
    pub max_spp: Option<u32>,
    /// So many renders of each contender with seeds of their own; `None` for [`REPLICATES`], or fewer if they do not fit.
    pub replicates: Option<u32>,
    /// Seed of the first replicate; the others follow it.
    pub seed: u64,
    /// A folder for all images and their times; see [`recorded`](super::recorded).
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
    pub fn last_spp(&self) -> u32 {
        self.max_spp.unwrap_or(MOST_SPP)
    }

    /// Checks the plan for n contenders.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what is out of range, [`Error::Memory`].
    pub fn check(&self, request: &Request, strategies: usize) -> Result<()> {
        etalon_render::check_request(&Request { spp: 1, ..*request })?;
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

/// The share of the time that is reserved for evaluating errors.
const RESERVE: f64 = 0.03;
/// Replicates that may fail before a renderer is given up.
const FAILURES: usize = 2;

/// A contender and what it has done.
struct Entry<'a> {
    contender: &'a Contender,
    runs: Vec<Run>,
    failures: usize,
    given_up: bool,
}

/// A replicate that is being rendered.
struct Growing<'a> {
    replicate: Replicate<'a>,
    levels: Vec<Measured>,
    last: Option<Image>,
    goes_on: bool,
}

/// What all steps have in common.
struct Setting<'a> {
    plan: &'a Plan,
    truth: &'a Reference,
    exact: Image,
    all: &'a Deadline,
}

/// Renders replicate after replicate as long as the next one fits into the time that is left.
pub fn run(
    scene: &Scene,
    request: &Request,
    contenders: &[Contender],
    plan: &Plan,
    truth: &Reference,
    all: &Deadline,
    result: &mut Convergence,
) -> Result<()> {
    let request = Request { spp: plan.last_spp(), ..*request };
    let setting = Setting { plan, truth, exact: truth.image(), all };
    let new = |contender| Entry { contender, runs: Vec::new(), failures: 0, given_up: false };
    let mut entries: Vec<Entry> = contenders.iter().map(new).collect();
    let replicates = plan.replicates.unwrap_or(REPLICATES);
    let mut longest = 0.0_f64;
    for index in 0..replicates {
        let left_out = || format!("{} of {replicates} replicates left out", replicates - index);
        let before = all.left();
        if before < longest * (1.0 + RESERVE) {
            result.cut.extend(plan.replicates.map(|_| left_out()));
            break;
        }
        // The time of one contender in one replicate.
        let active = entries.iter().filter(|entry| !entry.given_up).count().max(1);
        let share = before * (1.0 - RESERVE) / f64::from(replicates - index) / active as f64;
        let seed = plan.seed.wrapping_add(u64::from(index));
        let mut growing = Vec::new();
        for entry in &entries {
            // To prepare a render may take seconds
            let contender = Some(entry.contender).filter(|_| !entry.given_up && !all.is_over());
            let started = contender.map(|contender| contender.start(scene, &request, seed, index)).transpose()?;
            let new = |replicate| Growing { replicate, levels: Vec::new(), last: None, goes_on: true };
            growing.push(started.flatten().map(new));
        }
        // Take more samples by all contenders, alternating, until none of them has a next level.
        while growing.iter().flatten().any(|one| one.goes_on) && !all.is_over() {
            for (entry, one) in entries.iter_mut().zip(&mut growing) {
                if let Some(one) = one.as_mut().filter(|one| one.goes_on) {
                    let fault = setting.advance(entry, one, index, share)?;
                    result.faults.extend(fault);
                }
            }
        }
        if all.is_over() {
            result.cut.extend(plan.replicates.or(Some(replicates).filter(|_| index == 0)).map(|_| left_out()));
            if index == 0 {
                longest = time_of_replicate(&growing);
            }
            break;
        }
        for (entry, one) in entries.iter_mut().zip(growing) {
            result.faults.extend(one.and_then(|one| entry.finish(one, index)));
        }
        longest = longest.at_least(before - all.left());
    }
    let has_verdicts = entries.iter().all(|entry| entry.given_up || entry.runs.len() >= REPLICATES_FOR_VERDICT);
    let may_have = replicates as usize >= REPLICATES_FOR_VERDICT;
    if may_have && !has_verdicts && longest > 0.0 && !interrupt::requested() {
        // The reference may take half of it.
        result.sufficient_budget = Some(2.0 * f64::from(replicates) * longest * (1.0 + RESERVE));
    }
    // Like compared with like: start-up counts for all renderers if it cannot be separated for one
    let fit = |entry: &Entry<'_>| TimeFit::new(&entry.runs.iter().collect::<Vec<_>>());
    let is_timed = |entry: &&Entry<'_>| entry.contender.is_timed_from_outside() && !entry.runs.is_empty();
    let unseparated: Vec<&str> =
        entries.iter().filter(is_timed).filter(|e| fit(e).is_none()).map(|e| e.contender.name()).collect();
    if !unseparated.is_empty() {
        let unknown = "its time does not grow measurably with the samples: start-up counts for every renderer, and the answer leaves \
                       them out";
        result.notes.push(format!("{}: {unknown}", unseparated.join(", ")));
    }
    let is_separated = unseparated.is_empty();
    for entry in entries {
        let times = fit(&entry).filter(|_| entry.contender.is_timed_from_outside() && is_separated);
        let Entry { contender, runs, given_up, .. } = entry;
        let name = contender.name();
        let reached = runs.first().and_then(|run| run.levels.last()).map_or(0, |level| level.spp);
        let asked = plan.max_spp.filter(|_| !given_up);
        let asked = asked.filter(|asked| reached <= asked / if contender.is_timed_from_outside() { 4 } else { 2 });
        let count = runs.len();
        let short = |asked| format!("{name}: {reached} of {asked} samples per pixel, in each of {count} replicates");
        result.cut.extend(asked.map(short));
        if let Some(dir) = &plan.keep {
            let of_run =
                |run: &Run| run.levels.iter().map(|level| (run.seed, level.spp, level.times)).collect::<Vec<_>>();
            recorded::keep_times(dir, name, runs.iter().flat_map(of_run))?;
        }
        if runs.is_empty() {
            continue;
        }
        if times.is_some() && runs.len() > 1 && TimeFit::rests_on_one(&runs) {
            let unknown = "without one of its replicates its time per sample is not told from 0, and its efficiency has no interval";
            result.notes.push(format!("{name}: {unknown}"));
        }
        result.curves.push(Curve::new(contender, runs, truth, times)?);
    }
    Ok(())
}

/// Seconds that the least levels of a whole replicate take, from those that it has; 0 if it has none.
fn time_of_replicate(growing: &[Option<Growing<'_>>]) -> f64 {
    let seconds = growing.iter().flatten().filter_map(|one| {
        let last = one.levels.last()?;
        let spp = FIT_FROM << (FIT_LEVELS - 1);
        Some(last.times.wall * f64::from(spp) / f64::from(last.spp))
    });
    let known: Vec<f64> = seconds.collect();
    let missing = growing.len() as f64 / known.len().max(1) as f64;
    known.iter().sum::<f64>() * missing
}

/// The factor by which a replicate may take more than its share of the time, for more samples per pixel: 2, with half of the replicates
/// then, if its last image took less than twice the time of its first. It is mostly start-up, and without further levels the time per
/// sample would not be told from it.
fn levels_first(levels: &[Measured]) -> f64 {
    match levels {
        [first, .., last] if last.times.wall < 2.0 * first.times.wall => 2.0,
        _ => 1.0,
    }
}

impl Setting<'_> {
    /// Takes the next level of a replicate, if there is one that fits.
    fn advance(&self, entry: &mut Entry<'_>, one: &mut Growing<'_>, index: u32, share: f64) -> Result<Option<Fault>> {
        let Growing { replicate, levels, last, goes_on } = one;
        *goes_on = false;
        let Some(spp) = replicate.next_spp().filter(|spp| *spp <= self.plan.last_spp()) else { return Ok(None) };
        let fits = match entry.runs.first() {
            // All replicates have the levels of the first one.
            Some(first) => levels.len() < first.levels.len(),
            // A curve without a slope would be of no use.
            None => {
                let fitted = levels.iter().filter(|level| level.spp >= FIT_FROM).count();
                let share = if self.plan.replicates.is_none() { share * levels_first(levels) } else { share };
                fitted < FIT_LEVELS || replicate.total_with_next() <= share
            }
        };
        if !fits {
            return Ok(None);
        }
        let (image, times) = match replicate.advance(self.all) {
            Step::Done(image, times) => (image, times),
            Step::Stopped | Step::End => return Ok(None),
            Step::Failed(failure) => {
                levels.clear();
                entry.failures += 1;
                entry.given_up |= failure.is_final || entry.failures >= FAILURES;
                return Ok(Some(entry.fault(replicate, index, spp, failure.message)));
            }
        };
        let errors = self.truth.compare(&image)?;
        if let Some(dir) = &self.plan.keep {
            recorded::keep_image(dir, entry.contender.name(), [u64::from(spp), replicate.seed], &image)?;
        }
        let is_first = entry.runs.is_empty();
        *last = Some(image.clone());
        let shown = is_first.then(|| (compare_shown(&image, &self.exact), image));
        levels.push(Measured { spp, times, errors, shown });
        *goes_on = true;
        Ok(None)
    }
}

impl Entry<'_> {
    fn fault(&self, replicate: &Replicate<'_>, index: u32, spp: u32, message: String) -> Fault {
        let strategy = self.contender.name().to_owned();
        Fault { strategy, replicate: index + 1, seed: replicate.seed, spp, message }
    }

    /// Adds a replicate whose levels are those of the others; images that are the same in two replicates of a program are a fault.
    fn finish(&mut self, one: Growing<'_>, index: u32) -> Option<Fault> {
        let Growing { replicate, levels, last, .. } = one;
        let spp_of = |levels: &[Measured]| levels.iter().map(|level| level.spp).collect::<Vec<_>>();
        let is_complete = self.runs.first().is_none_or(|first| spp_of(&first.levels) == spp_of(&levels));
        let end = levels.last().filter(|_| is_complete)?;
        let same = self.runs.iter().find(|run| run.last == last && end.errors.mse != 0.0);
        if let Some(same) = same.filter(|_| self.contender.is_timed_from_outside()) {
            let message = format!("its image is that of seed {}, to the last bit: is {{seed}} used?", same.seed);
            self.given_up = true;
            self.runs.clear();
            return Some(self.fault(&replicate, index, replicate.spp, message));
        }
        let Replicate { seed, preparation, chosen, .. } = replicate;
        self.runs.push(Run { seed, levels, last, preparation, chosen });
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::converge::doubling::Times;
    use etalon_core::math::Rgb;
    use etalon_core::raster::compare;

    #[test]
    fn what_is_mostly_start_up_takes_more_samples_in_place_of_replicates() {
        let image = Image::from_fn(1, 1, |_, _| Rgb::ONE);
        let level = |wall: f64| {
            let errors = compare(&image, &image).unwrap();
            Measured { spp: 1, times: Times { wall, cpu: wall }, errors, shown: None }
        };
        let factor = |seconds: &[f64]| levels_first(&seconds.iter().copied().map(level).collect::<Vec<_>>());
        assert_eq!((factor(&[0.3, 0.31, 0.29, 0.35]), factor(&[0.3, 0.31, 0.4, 0.7])), (2.0, 1.0));
        assert_eq!((factor(&[]), factor(&[0.3])), (1.0, 1.0), "of one image nothing is known");
    }
}
