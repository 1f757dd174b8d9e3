//! A report: all checks of a BSDF in one configuration, judged at one level.

use super::contract::{BatchBsdf, Direction};
use super::subject::place;
use super::{ALL, Check, UNSEEN};
use crate::causes::{Finding, causes};
use crate::error::Result;
use crate::examine::Protocol;
use crate::outcome::{Outcome, Verdict, decide};
use std::fmt;

/// One check for one `wo`.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// The name of the check.
    pub check: &'static str,
    /// The direction.
    pub wo: Direction,
    /// What it found.
    pub outcome: Outcome,
}

/// What all checks say of a BSDF in one configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The BSDF with its parameters.
    pub configuration: String,
    /// One for each check that applies and each `wo`.
    pub checks: Vec<Checked>,
}

impl Report {
    /// The checks with that verdict.
    pub fn with(&self, verdict: Verdict) -> impl Iterator<Item = &Checked> {
        self.checks.iter().filter(move |checked| checked.outcome.verdict == verdict)
    }

    /// The remarks of the checks that accept, each once.
    fn remarks(&self) -> Vec<&str> {
        let all = self.with(Verdict::Accept).flat_map(|checked| &checked.outcome.remarks);
        let mut remarks: Vec<&str> = Vec::new();
        for remark in all {
            if !remarks.contains(&remark.as_str()) {
                remarks.push(remark);
            }
        }
        remarks
    }

    /// Whether every check accepts.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.checks.iter().all(|checked| checked.outcome.is_accepted())
    }
}

impl fmt::Display for Report {
    /// A line for the whole, and one for each cause of which a check does not accept.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [accepted, rejected, inconclusive] =
            [Verdict::Accept, Verdict::Reject, Verdict::Inconclusive].map(|verdict| self.with(verdict).count());
        write!(f, "{}: {accepted} checks accept, {rejected} reject, {inconclusive} inconclusive", self.configuration)?;
        let name = |Checked { check, wo, .. }: &Checked| format!("{check} for wo {}", place(*wo));
        let names: Vec<String> = self.checks.iter().map(name).collect();
        let findings = names.iter().zip(&self.checks);
        let findings = findings.map(|(name, Checked { check, outcome, .. })| Finding { name, kind: check, outcome });
        causes(&findings.collect::<Vec<_>>()).iter().try_for_each(|cause| write!(f, "\n{cause}"))?;
        self.remarks().iter().try_for_each(|remark| write!(f, "\nremark: {remark}"))?;
        if self.is_accepted() { write!(f, "\n{UNSEEN}") } else { Ok(()) }
    }
}

/// Runs all checks that apply to `bsdf` for every `wo`, at the level of `protocol` for all together. A rejected statistical check
/// is repeated once, as in [`validate`](crate::validate).
///
/// # Errors
/// As [`Check::examine`].
pub fn test(configuration: &str, bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol) -> Result<Report> {
    let protocol = Protocol { tests: protocol.tests.max(ALL.len() * wos.len()), ..*protocol };
    let (mut done, mut checks): (Vec<(&Check, Direction)>, Vec<Outcome>) = Default::default();
    for wo in wos {
        for check in &ALL {
            if let Some(outcome) = check.examine(bsdf, *wo, &protocol, 0)? {
                done.push((check, *wo));
                checks.push(outcome);
            }
        }
    }
    decide(&mut checks, protocol.level, |i| {
        let (check, wo) = done[i];
        check.examine(bsdf, wo, &protocol, 1).map(Option::unwrap_or_default)
    })?;
    let checks = done.into_iter().zip(checks);
    let checks = checks.map(|((check, wo), outcome)| Checked { check: check.name, wo, outcome }).collect();
    Ok(Report { configuration: configuration.to_owned(), checks })
}

/// Panics unless all checks accept `bsdf` for every `wo`, by the default [`Protocol`]. The message says which checks do not, what
/// they found, and for which directions.
///
/// # Panics
/// If a check rejects or is inconclusive.
#[track_caller]
pub fn assert_bsdf(configuration: &str, bsdf: &dyn BatchBsdf, wos: &[Direction]) {
    match test(configuration, bsdf, wos, &Protocol::default()) {
        Ok(report) => assert!(report.is_accepted(), "{report}"),
        Err(error) => panic!("{configuration} could not be tested: {error}"),
    }
}
