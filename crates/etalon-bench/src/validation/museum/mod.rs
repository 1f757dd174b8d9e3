//! The museum: faults that were fixed in published software, each as a model in our own words beside its fixed twin; what finds them, and
//! what a plain chi-square test says.

mod exhibits;
mod models;

pub use exhibits::all;

use super::planted::{self, Finding, PlantedFault};
use etalon_core::error::Result;
use etalon_stats::bsdf::ALL;
use etalon_stats::{Protocol, Verdict};
use rayon::prelude::*;
use serde::Serialize;

/// What of the source was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Seen {
    /// Lines of the faulty program, and the change.
    Diff,
    /// The thread, which says in words what is wrong.
    Thread,
    /// Little more than the title: the model is a guess.
    Title,
}

/// A fault of published software.
pub struct Exhibit {
    pub fault: PlantedFault,
    /// Repository and number of the issue or pull request: `mmp/pbrt-v4#250`.
    pub source: &'static str,
    pub seen: Seen,
    /// The test that finds it, if it is no test of a sampler or of a BSDF.
    by: Option<&'static str>,
    /// What would find it, if nothing does.
    would_find: Option<&'static str>,
}

impl Exhibit {
    fn new(source: &'static str, seen: Seen, fault: PlantedFault) -> Self {
        Self { fault, source, seen, by: None, would_find: None }
    }

    fn by(self, test: &'static str) -> Self {
        Self { by: Some(test), ..self }
    }

    fn missed(self, would_find: &'static str) -> Self {
        Self { would_find: Some(would_find), ..self }
    }
}

/// What the tests said of one.
#[derive(Debug, Clone, Serialize)]
pub struct Shown {
    #[serde(flatten)]
    pub finding: Finding,
    pub source: &'static str,
    pub seen: Seen,
    /// What found it: a check of BSDFs, `exact` or `chi-square` of a sampler, `compare` of images, `means` of estimators.
    pub check: Option<&'static str>,
    /// p of the plain chi-square test, with the fault and without it.
    pub plain: Option<f64>,
    pub plain_sound: Option<f64>,
    pub would_find: Option<&'static str>,
}

/// What the plain test says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plain {
    Finds,
    Misses,
    /// It rejects the right twin, too.
    RejectsBoth,
    /// There are no samples with a pdf.
    Cannot,
}

impl Shown {
    pub fn is_found(&self) -> bool {
        self.finding.outcome.verdict == Verdict::Reject
    }

    pub fn plain(&self) -> Plain {
        /// Below it the plain test rejects.
        const LEVEL: f64 = 1e-3;
        let accepts = |p: f64| p >= LEVEL;
        match (self.plain.map(accepts), self.plain_sound.map(accepts)) {
            (Some(_), Some(false)) => Plain::RejectsBoth,
            (Some(true), _) => Plain::Misses,
            (Some(false), _) => Plain::Finds,
            (None, _) => Plain::Cannot,
        }
    }

    /// Whether it went as its entry says: found, unless the entry says what would find it, and the twin accepted.
    pub fn is_as_told(&self) -> bool {
        self.is_found() == self.would_find.is_none() && self.finding.sound == Verdict::Accept
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct Museum {
    /// Probability that any of the twins is rejected.
    pub level: f64,
    /// One for each fault: those that were not found first.
    pub tests: Vec<Shown>,
    pub found: usize,
    pub not_found: usize,
    /// Twins that were not accepted: should be 0.
    pub twins_not_accepted: usize,
    /// Faults that the plain test finds, without rejecting the twin.
    pub plain_finds: usize,
    pub interrupted: bool,
    /// Wall-clock time of the run.
    pub seconds: f64,
}

impl Museum {
    pub fn is_as_told(&self) -> bool {
        self.tests.iter().all(Shown::is_as_told)
    }
}

/// Tests all of `exhibits` and their twins in one run, and calls `done` after each test.
pub fn run(exhibits: Vec<Exhibit>, protocol: &Protocol, done: &(dyn Fn(&str) + Sync)) -> Result<Museum> {
    let plain = |exhibit: &Exhibit| {
        let PlantedFault { faulty, sound, .. } = &exhibit.fault;
        Ok([faulty.plain(protocol.seed)?, sound.plain(protocol.seed)?])
    };
    let plain = exhibits.par_iter().map(plain).collect::<Result<Vec<[Option<f64>; 2]>>>()?;
    let (mut faults, mut about) = (Vec::new(), Vec::new());
    for Exhibit { fault, source, seen, by, would_find } in exhibits {
        faults.push(fault);
        about.push((source, seen, by, would_find));
    }
    let findings = planted::run(faults, protocol, done)?;
    let shown = findings.tests.into_iter().zip(about).zip(plain);
    let mut tests: Vec<Shown> = shown
        .map(|((finding, (source, seen, by, would_find)), [plain, plain_sound])| {
            let check = finding.by.map(|how| by.or_else(|| check_of(&finding)).unwrap_or(how.name()));
            Shown { finding, source, seen, check, plain, plain_sound, would_find }
        })
        .collect();
    tests.sort_by_key(Shown::is_found);
    let count = |is: fn(&Shown) -> bool| tests.iter().filter(|test| is(test)).count();
    Ok(Museum {
        level: findings.level,
        found: count(Shown::is_found),
        not_found: count(|test| !test.is_found()),
        twins_not_accepted: count(|test| test.finding.sound != Verdict::Accept),
        plain_finds: count(|test| test.plain() == Plain::Finds),
        interrupted: findings.interrupted,
        seconds: findings.seconds,
        tests,
    })
}

/// The check of a BSDF that decided, whose name what it says begins with.
fn check_of(finding: &Finding) -> Option<&'static str> {
    let said = finding.outcome.found()?.split_once(':')?.0;
    ALL.iter().map(|check| check.name).find(|name| *name == said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn exhibits_have_names_sources_and_stories_of_eight_kinds() {
        let all = all();
        let names: BTreeSet<&str> = all.iter().map(|exhibit| exhibit.fault.name).collect();
        assert!(all.len() >= 30 && names.len() == all.len());
        let kinds: BTreeSet<&str> = names.iter().filter_map(|name| name.split('/').next()).collect();
        assert_eq!(kinds.into_iter().collect::<Vec<_>>(), exhibits::KINDS);
        for Exhibit { fault, source, .. } in &all {
            let number = source.split_once('#').and_then(|(_, number)| number.parse::<u32>().ok());
            assert!(source.split('/').count() == 2 && number.is_some(), "{source}");
            assert!(fault.mistake.len() > 40, "{}", fault.name);
        }
        for (again, of, ..) in exhibits::AGAIN {
            assert!(names.contains(again), "no planted fault {of}");
        }
    }

    fn shown(names: &[&str]) -> Museum {
        let chosen = super::super::select(all(), &names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        run(chosen.unwrap(), &Protocol::default(), &|_| ()).unwrap()
    }

    #[test]
    fn a_few_are_found_by_what_the_table_says() {
        let museum =
            shown(&["pdf/reservoir-merge", "pdf/cosine-lobe-doubled", "image/luma-swapped", "weight/cosine-twice"]);
        assert!(museum.is_as_told() && museum.not_found == 0, "{museum:?}");
        let told: Vec<_> = museum.tests.iter().map(|test| (test.check, test.plain())).collect();
        use Plain::{Cannot, Finds, Misses};
        let expected =
            [(Some("exact"), Finds), (Some("exact"), Misses), (Some("formula"), Misses), (Some("compare"), Cannot)];
        assert_eq!(told, expected);
    }

    #[test]
    fn mistakes_in_pdfs_are_named() {
        let named = [
            ("pdf/cosine-lobe-doubled", "is outside of the domain: its length is "),
            ("pdf/uniform-for-cosine", "samples follow cos θ/π, not the pdf"),
        ];
        let museum = shown(&named.map(|(name, _)| name));
        for (name, named) in named {
            let finding = &museum.tests.iter().find(|test| test.finding.name == name).unwrap().finding;
            let reason = finding.outcome.reason().unwrap();
            assert!(reason.contains(named), "{name}: {reason}");
        }
    }
}
