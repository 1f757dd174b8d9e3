//! Checks of a whole BSDF as one test, and all of them for the BSDF, phase function or light of another program, at all [`places`].

use super::case::{Named, select};
use super::run::{Tested, Validation};
use crate::likeness::Claim;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_stats::bsdf::{ALL, BatchBsdf, Check, Direction, Family, Kind, UNSEEN, is_edge_on, places};
use etalon_stats::{Extremes, Outcome, Protocol, decide};
use std::time::Instant;

/// Runs all checks for every `wo`.
pub fn examine(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    of(&ALL.iter().collect::<Vec<_>>(), bsdf, wos, protocol, round)
}

pub fn exact(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> = ALL.iter().filter(|check| !check.is_statistical).collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// Runs the checks of the light that is scattered: of the energy, the albedo and the weights.
pub fn light(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> =
        ALL.iter().filter(|check| ["energy", "albedo", "weights"].contains(&check.name)).collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// The first violation decides, and statistical checks are left out after one; otherwise the smallest p-value of all does,
/// after a correction for their number.
fn of(checks: &[&Check], bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let inner = Protocol { tests: protocol.tests * checks.len() * wos.len(), ..*protocol };
    let (mut found, mut tests) = (Outcome::open(0), 0);
    let (mut detectable, mut exact) = (0f64, Vec::new());
    for check in checks {
        if check.is_statistical && found.violation.is_some() {
            break;
        }
        for &wo in wos {
            let Some(outcome) = check.examine(bsdf, wo, &inner, round)? else { continue };
            tests += usize::from(outcome.p.is_some());
            let named = |text: String| format!("{}: {text}", check.name);
            // The first violation has its mistake, and no other.
            let mistake = match &found.violation {
                Some(_) => found.mistake.take(),
                None => outcome.mistake.clone(),
            };
            let (compared, wo) = match &found.violation {
                Some(_) => (found.compared.take(), found.wo),
                None => (outcome.compared.clone(), outcome.wo.filter(|_| outcome.violation.is_some())),
            };
            let violation = found.violation.take().or(outcome.violation.clone().map(named));
            let reason = found.inconclusive_reason.take().or(outcome.inconclusive_reason.clone().map(named));
            if check.is_statistical {
                detectable = detectable.at_least(outcome.detectable.unwrap_or(0.0));
            } else {
                exact.push((outcome.detectable.unwrap_or(0.0), outcome.samples));
            }
            let (samples, seconds) = (found.samples + outcome.samples, found.seconds + outcome.seconds);
            if outcome.p.is_some_and(|p| found.p.is_none_or(|least| p < least || p.is_nan())) {
                found = Outcome { diagnosis: outcome.diagnosis.clone().map(named), ..outcome };
            }
            let wo = wo.or(found.wo);
            found =
                Outcome { mistake, violation, compared, wo, inconclusive_reason: reason, samples, seconds, ..found };
        }
    }
    found.detectable = Some(detectable.at_least(found_in_most(exact)));
    // 1 − (1 − p)ⁿ, precise for small p.
    found.p = found.p.map(|p| if p >= 1.0 { 1.0 } else { -(tests as f64 * (-p).ln_1p()).exp_m1() });
    Ok(found)
}

/// The error that nine of ten comparisons would have found, from that of several checks with their numbers of comparisons.
fn found_in_most(mut checks: Vec<(f64, u64)>) -> f64 {
    checks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = 0.9 * checks.iter().map(|(_, compared)| *compared as f64).sum::<f64>();
    let mut sum = 0.0;
    let reaches = |(_, compared): &&(f64, u64)| {
        sum += *compared as f64;
        sum >= most
    };
    checks.iter().find(reaches).map_or(0.0, |(error, _)| *error)
}

struct Test {
    name: String,
    examined: Examined,
}

enum Examined {
    /// A check for one direction, or one reference point.
    Check(&'static Check, Direction),
    /// The claim to be a model.
    Claim(Claim),
}

impl Named for Test {
    fn name(&self) -> &str {
        &self.name
    }
}

/// What none of the tests sees if one compares the BSDF with a model.
const UNSEEN_BESIDE_A_MODEL: &str =
    "these checks cannot see an error that f, pdf and samples share, except where values differ from the model's";

/// A BSDF of a family, and its tests.
pub struct WholeBsdf<F> {
    family: F,
    kind: Kind,
    values: Vec<f64>,
    tests: Vec<Test>,
}

impl<F: Family> WholeBsdf<F> {
    /// The BSDF whose parameters have these values, with all tests.
    ///
    /// # Errors
    /// Those of the BSDF.
    pub fn new(family: F, values: Vec<f64>) -> Result<Self> {
        let bsdf = family.with(&values)?;
        let (kind, places) = (bsdf.properties().kind, places(&*bsdf)?);
        drop(bsdf);
        let test = |check: &'static Check, (place, wo): &(String, Direction)| {
            let name = format!("{}/{}/{place}", family.name(), check.name);
            let is_possible = check.is_for(&kind) && (check.name == "values" || !is_edge_on(place));
            is_possible.then_some(Test { name, examined: Examined::Check(check, *wo) })
        };
        let tests =
            ALL.iter().flat_map(|check| places.iter().filter_map(|place| test(check, place)).collect::<Vec<_>>());
        let tests = tests.collect();
        Ok(Self { family, kind, values, tests })
    }

    /// The same, which is tested to be this model, too.
    #[must_use]
    pub fn like(mut self, claim: Option<Claim>) -> Self {
        self.tests.extend(claim.map(|claim| {
            let name = format!("{}/like/{}", self.family.name(), claim.name());
            Test { name, examined: Examined::Claim(claim) }
        }));
        self
    }

    /// The same with the tests alone that any of `patterns` names, as [`select`] has it, besides a comparison with a model; the name of the
    /// BSDF may be left out.
    ///
    /// # Errors
    /// Those of [`select`].
    pub fn only(self, patterns: &[String]) -> Result<Self> {
        let own = format!("{}/", self.family.name());
        let (claims, checks): (Vec<Test>, Vec<Test>) =
            self.tests.into_iter().partition(|test| matches!(test.examined, Examined::Claim(_)));
        let is_of_claim = |pattern: &&String| !claims.is_empty() && pattern.trim_start_matches(&own) == "like";
        let whole = |pattern: &String| if pattern.starts_with(&own) { pattern.clone() } else { own.clone() + pattern };
        let (of_claim, of_checks): (Vec<&String>, Vec<&String>) = patterns.iter().partition(is_of_claim);
        let mut tests = match (of_claim.is_empty(), of_checks.is_empty()) {
            (false, true) => Vec::new(),
            _ => select(checks, &of_checks.into_iter().map(whole).collect::<Vec<_>>())?,
        };
        tests.extend(claims);
        Ok(Self { tests, ..self })
    }

    pub fn name(&self) -> &str {
        self.family.name()
    }

    /// Whether it is a BSDF, a phase function or a light.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }

    /// The names of all tests, those included that do not apply to the BSDF.
    pub fn names(&self) -> Vec<String> {
        self.tests.iter().map(|test| test.name.clone()).collect()
    }

    /// Runs all checks that apply for every direction, at the level of `protocol` for all together, and calls `done` after each. What an
    /// interruption leaves unfinished is inconclusive.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an impossible protocol, and if none of the tests applies to the BSDF; those of the BSDF;
    /// [`Error::Interrupted`] if no test is finished.
    pub fn run(&self, protocol: &Protocol, done: &dyn Fn()) -> Result<Validation> {
        let start = Instant::now();
        let protocol = Protocol { tests: self.tests.len(), cancelled: interrupt::requested, ..*protocol };
        let bsdf = self.family.with(&self.values)?;
        let examine = |test: &Test, round| {
            let examined = match &test.examined {
                _ if interrupt::requested() => Err(Error::Interrupted),
                Examined::Check(check, wo) => check.examine(&*bsdf, *wo, &protocol, round).map_err(Error::from),
                Examined::Claim(claim) => claim.examine(&self.family, &self.values).map(Some),
            };
            match examined {
                Err(Error::Interrupted) => Ok(Some(Outcome::interrupted())),
                other => other,
            }
        };
        let mut applied = Vec::new();
        let mut outcomes: Vec<Outcome> = Vec::new();
        for test in &self.tests {
            if let Some(outcome) = examine(test, 0)? {
                applied.push(test);
                outcomes.push(outcome);
            }
            done();
        }
        if applied.is_empty() {
            return Err(Error::parameter("names", "none of these tests applies to the BSDF"));
        }
        if outcomes.iter().all(|outcome| outcome.interrupted) {
            return Err(Error::Interrupted);
        }
        decide(&mut outcomes, protocol.level, |i| examine(applied[i], 1).map(Option::unwrap_or_default))?;
        let both = applied.into_iter().zip(outcomes);
        let tests = both.map(|(test, outcome)| Tested { name: test.name.clone(), outcome });
        let is_compared = self.tests.iter().any(|test| matches!(test.examined, Examined::Claim(_)));
        Ok(Validation {
            unseen: Some(if is_compared { UNSEEN_BESIDE_A_MODEL } else { UNSEEN }),
            ..Validation::new(&protocol, tests.collect(), start)
        })
    }
}
