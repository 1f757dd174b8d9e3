//! `etalon validate --planted`: every planted fault must be rejected, and every sampler without one accepted; `--museum`: faults that
//! were fixed in published software, in models of our own; what finds them, and what does not.

use crate::cli::console::Console;
use crate::cli::global::{Global, Reports, Verdict};
use etalon_bench::table::Table;
use etalon_bench::validation::Tested;
use etalon_bench::validation::museum::{self, Exhibit, Museum, Plain, Shown};
use etalon_bench::validation::planted::{self, By, Finding, Findings, PlantedFault};
use etalon_core::error::Result;
use etalon_core::files;
use etalon_figures::figure::{Style, Wanted};
use etalon_figures::output::{self, Saving};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::text::{LINE, counted, wrapped};
use etalon_figures::view::validation::{self as view, found, p_text};
use etalon_figures::view::validation_cells as cells;
use etalon_stats::Protocol;

pub use planted::all;

/// Runs planted faults; writes and prints the findings, and of each fault what the mistake is and what the test says if
/// `names` were given.
pub fn run(
    faults: Vec<PlantedFault>,
    names: &[String],
    protocol: &Protocol,
    reports: &Reports,
    global: &Global,
    console: &Console,
) -> Result<Verdict> {
    reports.check()?;
    let target = global.target();
    let path = target.file(&output::name_of_run("planted", names), "", "csv")?;
    let bar = console.progress(2 * faults.len() as u64, "planted faults", "runs");
    let findings = planted::run(faults, protocol, &|_| bar.inc(1))?;
    bar.finish_and_clear();
    let mut saving = Saving::default();
    saving.add(files::write_bytes(&path, &view::planted_csv(&findings)?).map(|()| vec![path]));
    saving.add(reports.write(&checks(&findings)));
    let (files, saved) = saving.end();
    console.saved(&findings, &target.written(files), || text(&findings, !names.is_empty()));
    saved?;
    Ok(Verdict::of(findings.is_good(), findings.interrupted))
}

/// A check for each fault, which holds if the fault is rejected and the sampler without it accepted.
fn checks(findings: &Findings) -> Checks {
    use etalon_stats::Verdict::{Accept, Inconclusive, Reject};
    let check = |test: &Finding| {
        let (group, name) = test.name.rsplit_once('/').unwrap_or(("planted", test.name));
        let verdict = match (test.outcome.verdict, test.sound) {
            (Reject, Accept) => Accept,
            (Inconclusive, _) | (_, Inconclusive) if findings.interrupted => Inconclusive,
            _ => Reject,
        };
        let without = test.sound_remark.as_ref().map_or_else(String::new, |remark| format!(" ({remark})"));
        Check {
            group: group.into(),
            name: name.into(),
            verdict: Some(verdict),
            message: format!(
                "with the fault: {}, {}; without it: {}{without}",
                test.outcome.verdict,
                found(&test.outcome),
                test.sound
            ),
            details: test.mistake.into(),
            seconds: Some(test.outcome.seconds),
        }
    };
    let checks = findings.tests.iter().map(check).collect();
    Checks { title: "etalon validate --planted".into(), list: checks, seconds: findings.seconds }
}

fn text(findings: &Findings, explain: bool) -> String {
    let tests = &findings.tests;
    let below = |test: &Finding| {
        let outcome = &test.outcome;
        let mut text = String::new();
        if explain {
            text += &wrapped(&format!("mistake: {}", test.mistake), "  ", LINE);
            let found = outcome.findings();
            found.iter().for_each(|found| text += &wrapped(&format!("found: {found}"), "  ", LINE));
        }
        if outcome.verdict != etalon_stats::Verdict::Reject {
            text += &format!("  {}\n", outcome.reason().unwrap_or_else(|| test.mistake.to_owned()));
        }
        if test.sound != etalon_stats::Verdict::Accept {
            text += &format!("  without it: {}\n", test.sound_remark.as_deref().unwrap_or("not accepted"));
        }
        text
    };
    let mut text = Table::of(tests)
        .words("planted fault", |test| test.name)
        .words("verdict", |test| test.outcome.verdict)
        .words("by", |test| test.by.map_or("-", By::name))
        .numbers("p", |test| p_text(test.outcome.p))
        .numbers("samples", |test| test.outcome.samples)
        .numbers("error", |test| test.error.map_or("-".into(), |error| format!("{:.1} %", 100.0 * error)))
        .words("without it", |test| test.sound)
        .text_with(|test, line| line + &below(test));
    text += &format!(
        "\n{} of {} rejected; tests without the fault: {} rejected, {} inconclusive; {:.1} s\n",
        findings.rejected,
        counted(tests.len(), "planted fault"),
        findings.false_alarms,
        findings.sound_inconclusive,
        findings.seconds,
    );
    if findings.interrupted {
        text += "interrupted before all tests were finished\n";
    }
    text
}

/// Runs exhibits; writes and prints what was found, and draws those that `names` choose.
pub fn run_museum(
    exhibits: Vec<Exhibit>,
    names: &[String],
    protocol: &Protocol,
    style: &Style,
    reports: &Reports,
    global: &Global,
    console: &Console,
) -> Result<Verdict> {
    reports.check()?;
    let target = global.target();
    let path = target.file(&output::name_of_run("museum", names), "", "csv")?;
    let bar = console.progress(2 * exhibits.len() as u64, "museum", "runs");
    let museum = museum::run(exhibits, protocol, &|_| bar.inc(1))?;
    bar.finish_and_clear();
    let mut saving = Saving::default();
    saving.add(files::write_bytes(&path, &view::museum_csv(&museum)?).map(|()| vec![path]));
    let mut wanted = Wanted::of(style);
    for Shown { finding, .. } in museum.tests.iter().filter(|_| !names.is_empty()) {
        let tested = Tested { name: finding.name.to_owned(), outcome: finding.outcome.clone() };
        if let Some(table) = super::numbers(&tested)? {
            let stem = target.stem("exhibit", &format!("-{}", output::file_name(finding.name)), &output::STUDY)?;
            let drawing = cells::fault(&tested, finding.mistake);
            saving.add(output::write(&stem, &drawing, &wanted.style(&drawing), &table));
        }
    }
    saving.add(wanted.check().map(|()| Vec::new()));
    saving.add(reports.write(&checks_of_museum(&museum)));
    let (files, saved) = saving.end();
    console.saved(&museum, &target.written(files), || text_of_museum(&museum));
    saved?;
    Ok(Verdict::of(museum.is_as_told(), museum.interrupted))
}

/// A check for each fault, which holds if it goes as its entry says.
fn checks_of_museum(museum: &Museum) -> Checks {
    use etalon_stats::Verdict::{Accept, Inconclusive, Reject};
    let check = |test: &Shown| {
        let (group, name) = test.finding.name.rsplit_once('/').unwrap_or(("museum", test.finding.name));
        let verdict = if test.is_as_told() { Accept } else { Reject };
        Check {
            group: group.into(),
            name: name.into(),
            verdict: Some(if museum.interrupted && verdict == Reject { Inconclusive } else { verdict }),
            message: format!("{}: {}", test.source, found(&test.finding.outcome)),
            details: test.finding.mistake.into(),
            seconds: Some(test.finding.outcome.seconds),
        }
    };
    Checks {
        title: "etalon validate --museum".into(),
        list: museum.tests.iter().map(check).collect(),
        seconds: museum.seconds,
    }
}

fn text_of_museum(museum: &Museum) -> String {
    let tests = &museum.tests;
    let below = |test: &Shown| {
        let told = [
            Some(format!("{}: {}", test.source, test.finding.mistake)),
            test.finding.outcome.reason().map(|reason| format!("says: {reason}")),
            test.would_find.map(|what| format!("would find it: {what}")),
            test.finding.sound_remark.as_ref().map(|remark| format!("the fixed twin: {remark}")),
        ];
        told.into_iter().flatten().map(|line| wrapped(&line, "  ", LINE)).collect::<String>()
    };
    let plain = |test: &Shown| match test.plain() {
        Plain::Finds => "finds",
        Plain::Misses => "misses",
        Plain::RejectsBoth => "rejects both",
        Plain::Cannot => "-",
    };
    let mut text = Table::of(tests)
        .words("fault", |test| test.finding.name)
        .words("found by", |test| test.check.filter(|_| test.is_found()).unwrap_or("nothing"))
        .words("named", |test| if test.finding.outcome.mistake.is_some() { "yes" } else { "-" })
        .numbers("s", |test| format!("{:.1}", test.finding.outcome.seconds))
        .words("twin", |test| test.finding.sound)
        .words("plain test", plain)
        .text_with(|test, line| line + &below(test));
    text += &format!(
        "\n{} of {} found; {} not accepted; the plain chi-square test finds {}; {:.1} s\n",
        museum.found,
        counted(tests.len(), "fault"),
        counted(museum.twins_not_accepted, "fixed twin"),
        museum.plain_finds,
        museum.seconds,
    );
    if museum.interrupted {
        text += "interrupted before all tests were finished\n";
    }
    text
}
