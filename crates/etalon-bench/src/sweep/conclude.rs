//! The decision on a sweep, and what it says of every family and check.

use super::computed::Computed;
use super::plan::Plan;
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_stats::Extremes;
use etalon_stats::bsdf::ALL;
use etalon_stats::sweep::{Decided, State, Survivor, Survivors, confirm, decide, shrink};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What one check says of one family.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Group {
    pub family: String,
    pub check: String,
    /// Configurations to which the check applies.
    pub configurations: u64,
    /// Where nothing speaks against the BSDF.
    pub accepted: u64,
    /// Where it is wrong: certainly, or by the fresh p-value.
    pub rejected: u64,
    /// Where the check cannot say.
    pub inconclusive: u64,
    /// Tests with p < 10⁻³, which were run again.
    pub survivors: u64,
    pub min_p: Option<f64>,
    /// Tests of the screen that would have found the asked error with 90 % probability.
    pub powered: u64,
}

/// A failure of a check of a family, shrunk if its p-value allows that.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Failure {
    pub family: String,
    pub check: String,
    pub configurations: u64,
    pub example: String,
    /// Whether simpler configurations were tried; otherwise the p-value is not below
    /// [`CONFIRM_LEVEL`](etalon_stats::sweep::CONFIRM_LEVEL), so that the check might accept simpler ones by chance.
    pub shrunk: bool,
    /// The simplest one that was found, or the same, as `etalon sweep --replay` takes it.
    pub replay: String,
    /// What the check says there.
    pub message: String,
    /// The p-value there, of a statistical check.
    pub p: Option<f64>,
}

/// A test that was run again. Field names are the CSV columns.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SurvivorRow {
    number: u64,
    family: String,
    check: String,
    configuration: String,
    screen_p: f64,
    fresh_p: Option<f64>,
    verdict: String,
    message: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conclusion {
    pub families: usize,
    pub configurations: u64,
    /// Checks that were run, exact ones included.
    pub checks: u64,
    /// Configurations in which a check rejects.
    pub rejected: u64,
    /// Configurations in which none rejects and one cannot say.
    pub inconclusive: u64,
    /// Tests that survived the screen and were run again.
    pub survivors: usize,
    /// Tests that survived the screen and were too many to be run again.
    pub left_out: u64,
    pub expected_survivors: f64,
    pub min_fresh_p: Option<f64>,
    /// For each check of each family.
    pub groups: Vec<Group>,
    pub failures: Vec<Failure>,
    /// Tests that were run again.
    #[serde(skip)]
    pub rows: Vec<SurvivorRow>,
}

/// A configuration with a violation, or a rejected one.
struct Failed {
    number: u64,
    configurations: u64,
    p: Option<f64>,
    message: String,
}

/// Sums over the configurations of a sweep.
struct Sums {
    groups: BTreeMap<(usize, usize), Group>,
    failed: BTreeMap<(usize, usize), Failed>,
    survivors: Survivors,
    /// Numbers of configurations with an inconclusive check, and with a violation.
    inconclusive: u64,
    violated: BTreeSet<u64>,
    configurations: u64,
}

impl Sums {
    fn of(plan: &Plan, computed: &Computed) -> Self {
        let mut sums = Self {
            groups: BTreeMap::new(),
            failed: BTreeMap::new(),
            survivors: Survivors::new(plan.largest()),
            inconclusive: 0,
            violated: BTreeSet::new(),
            configurations: 0,
        };
        for (number, cells, message) in computed.rows() {
            let (family, _) = plan.get(number);
            sums.configurations += 1;
            let any = |state: State| cells.iter().any(|cell| cell.state == state);
            sums.inconclusive += u64::from(any(State::Inconclusive) && !any(State::Violated));
            if any(State::Violated) {
                sums.violated.insert(number);
            }
            for cell in &cells {
                let group = sums.groups.entry((family, cell.check)).or_default();
                group.configurations += 1;
                group.min_p = [group.min_p, cell.p].into_iter().flatten().reduce(f64::at_most);
                let found = cell.detectable.is_some_and(|error| error <= 1.01 * plan.description.detect());
                group.powered += u64::from(found);
                match cell.state {
                    State::Holds => group.accepted += 1,
                    State::Inconclusive => group.inconclusive += 1,
                    State::Suspicious => {
                        group.survivors += 1;
                        sums.survivors.add(Survivor { family, number, check: cell.check, p: cell.p.unwrap_or(0.0) });
                    }
                    State::Violated => {
                        group.rejected += 1;
                        let new = || Failed { number, configurations: 0, p: None, message: message.to_owned() };
                        let failed = sums.failed.entry((family, cell.check)).or_insert_with(new);
                        failed.configurations += 1;
                        if number < failed.number {
                            *failed = Failed { number, message: message.to_owned(), ..*failed };
                        }
                    }
                }
            }
        }
        sums
    }
}

/// Decides on the sweep, of which `computed` has all configurations.
///
/// # Errors
/// Those of the checks that are run again.
pub fn conclude(plan: &Plan, computed: &Computed, done: &(dyn Fn(u64, u64) + Sync)) -> Result<Conclusion> {
    let mut sums = Sums::of(plan, computed);
    let detect = plan.description.detect();
    let (survivors, left_out) = sums.survivors.chosen();
    let all = survivors.len();
    let again = |survivor: &Survivor| {
        let (family, configuration) = plan.get(survivor.number);
        let found = confirm(plan.family(family), &configuration, survivor.check, detect, interrupt::requested);
        done(1, all as u64);
        found
    };
    let decided = decide(survivors, plan.description.level(), true, again)?;
    let mut rejected = std::mem::take(&mut sums.violated);
    let mut undecided = BTreeSet::new();
    for Decided { survivor, fresh, is_rejected } in decided.iter().filter(|d| d.is_rejected || d.is_inconclusive()) {
        let Some(group) = sums.groups.get_mut(&(survivor.family, survivor.check)) else { continue };
        if !is_rejected {
            group.inconclusive += 1;
            undecided.insert(survivor.number);
            continue;
        }
        group.rejected += 1;
        rejected.insert(survivor.number);
        let p = fresh.as_ref().and_then(|fresh| fresh.p);
        let message = fresh.as_ref().and_then(|fresh| fresh.message.clone()).unwrap_or_default();
        let new = || Failed { number: survivor.number, configurations: 0, p: Some(1.0), message: String::new() };
        let failed = sums.failed.entry((survivor.family, survivor.check)).or_insert_with(new);
        failed.configurations += 1;
        if p < failed.p {
            *failed = Failed { number: survivor.number, p, message, ..*failed };
        }
    }
    for decided in decided.iter().filter(|decided| !decided.is_rejected && !decided.is_inconclusive()) {
        if let Some(group) = sums.groups.get_mut(&(decided.survivor.family, decided.survivor.check)) {
            group.accepted += 1;
        }
    }
    let failures = sums.failed.into_iter().map(|((family, check), failed)| failure(plan, family, check, failed));
    let failures = failures.collect::<Result<Vec<_>>>()?;
    let named = |((family, check), group): ((usize, usize), Group)| Group {
        family: plan.family(family).name().to_owned(),
        check: ALL[check].name.to_owned(),
        ..group
    };
    let tests: u64 =
        sums.groups.iter().filter(|((_, check), _)| ALL[*check].is_statistical).map(|(_, g)| g.configurations).sum();
    Ok(Conclusion {
        families: plan.description.families().count(),
        configurations: sums.configurations,
        checks: sums.groups.values().map(|group| group.configurations).sum(),
        rejected: rejected.len() as u64,
        inconclusive: sums.inconclusive + undecided.difference(&rejected).count() as u64,
        survivors: all,
        left_out,
        expected_survivors: etalon_stats::sweep::SCREEN_LEVEL * tests as f64,
        min_fresh_p: decided.iter().filter_map(|d| d.fresh.as_ref()?.p).min_by(f64::total_cmp),
        groups: sums.groups.into_iter().map(named).collect(),
        failures,
        rows: decided.iter().map(|decided| row(plan, decided)).collect(),
    })
}

/// The failure, in the simplest configuration if it can be shrunk.
fn failure(plan: &Plan, family: usize, check: usize, failed: Failed) -> Result<Failure> {
    let (_, configuration) = plan.get(failed.number);
    let family = plan.family(family);
    let name = ALL[check].name;
    let detect = plan.description.detect();
    let shrunk = shrink(family, &configuration, check, detect, interrupt::requested)?;
    let is_shrunk = shrunk.is_some();
    let (simplest, message, p) = match shrunk {
        Some(shrunk) => (shrunk.configuration, shrunk.finding.message.unwrap_or_default(), shrunk.finding.p),
        None => (configuration.clone(), failed.message, failed.p),
    };
    Ok(Failure {
        family: family.name().to_owned(),
        check: name.to_owned(),
        configurations: failed.configurations,
        example: configuration.text(family),
        shrunk: is_shrunk,
        replay: format!("{} check={name}", simplest.text(family)),
        message,
        p,
    })
}

fn row(plan: &Plan, decided: &Decided) -> SurvivorRow {
    let Survivor { family, number, check, p } = decided.survivor;
    let (_, configuration) = plan.get(number);
    let family = plan.family(family);
    let verdict = match decided {
        Decided { is_rejected: true, .. } => "reject",
        decided if decided.is_inconclusive() => "inconclusive",
        _ => "accept",
    };
    let fresh = decided.fresh.as_ref();
    SurvivorRow {
        number,
        family: family.name().to_owned(),
        check: ALL[check].name.to_owned(),
        configuration: configuration.text(family),
        screen_p: p,
        fresh_p: fresh.and_then(|fresh| fresh.p),
        verdict: verdict.to_owned(),
        message: fresh.and_then(|fresh| fresh.message.clone()).unwrap_or_default(),
    }
}
