//! A run of tests as a table and as a drawing of its p-values; the table of planted faults; results as text: a line for each test
//! if they are few, else one for each family and one for each test that needs a look.

use super::text::{LINE, counted, p_is, p_value, plain_p_value, rounded, wrapped};
use super::validation_cells;
use crate::figure::{Axis, Drawing, Marker, Panel, Plot, Point, Stroke, theme};
use etalon_bench::table::Table;
use etalon_bench::validation::museum::{Museum, Seen};
use etalon_bench::validation::planted::{By, Findings};
use etalon_bench::validation::{Tested, Validation};
use etalon_core::error::Result;
use etalon_stats::{Outcome, Verdict};

pub fn csv(validation: &Validation) -> Result<Vec<u8>> {
    Table::of(&validation.tests)
        .field("name", |test| &test.name)
        .field("verdict", |test| test.outcome.verdict.to_string())
        .field("statistic", |test| test.outcome.statistic)
        .field("dof", |test| test.outcome.dof)
        .field("p", |test| test.outcome.p)
        .field("samples", |test| test.outcome.samples)
        // The relative error of the pdf (root mean square) that is detected with 90 % probability
        .field("detectable", |test| test.outcome.detectable)
        .field("mass", |test| test.outcome.mass.map(|mass| mass.value))
        .field("mass_error", |test| test.outcome.mass.map(|mass| mass.error))
        .field("mass_bound", |test| test.outcome.mass.map(|mass| mass.bound.to_string()))
        .field("cells", |test| test.outcome.cells)
        // Cells put together for lack of expected samples
        .field("pooled", |test| test.outcome.pooled)
        // Samples without a direction
        .field("none", |test| test.outcome.none)
        .field("repeated", |test| test.outcome.repeated)
        .field("seconds", |test| test.outcome.seconds)
        // The usual mistake that explains a rejection
        .field("named", |test| test.outcome.mistake.as_ref().map(ToString::to_string))
        // Why the test does not accept
        .field("remark", |test| test.outcome.reason())
        // Where samples and pdf differ most, of a rejected test
        .field("diagnosis", |test| test.outcome.diagnosis.as_deref())
        // What users should know though it does not decide
        .field("remarks", |test| test.outcome.remarks.join("; "))
        // What is detected between the cells
        .field("finer", |test| test.outcome.finer())
        .csv()
}

/// A single test; or why tests are not accepted, what the first rejected one looked at, and the checks of one BSDF, or the p-values of all.
pub fn drawing(validation: &Validation) -> Drawing {
    match validation.tests.as_slice() {
        [test] => validation_cells::drawing(test),
        tests => {
            // Why first, then what shows the first cause that can be shown
            let is_shown = |test: &&Tested| {
                let Outcome { counts, compared, .. } = &test.outcome;
                test.outcome.is_rejected_by_p() && counts.is_some() || compared.is_some()
            };
            let causes = validation.causes();
            let of = |cause: &String| {
                let is_of = |test: &&Tested| cause.strip_prefix(&*test.name).is_some_and(|rest| rest.starts_with(':'));
                tests.iter().find(is_of)
            };
            let told: Vec<&Tested> = causes.iter().filter_map(of).collect();
            // The headline is of the test whose counts are shown
            let shown = told.iter().copied().chain(tests).find(is_shown);
            let all = checks(validation).unwrap_or_else(|| match tests.len() {
                ..MANY => verdicts(validation),
                _ => p_values(validation),
            });
            let why = validation_cells::reasons(validation, shown.or(told.first().copied()));
            let rows = why.into_iter().chain(shown.map(validation_cells::pictured)).chain([all]);
            Drawing::stacked(rows.collect(), 0.5)
        }
    }
}

/// Tests from which on the distribution of their p-values tells something.
const MANY: usize = 10;

/// A line for each of a few tests: what it said.
fn verdicts(validation: &Validation) -> Drawing {
    let lines = validation.tests.iter().map(validation_cells::of_test).collect();
    let count = [
        (validation.accepted, "accepted"),
        (validation.rejected, "rejected"),
        (validation.inconclusive, "inconclusive"),
    ];
    let count = count.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}"));
    let title = format!("{}: {}", counted(validation.tests.len(), "test"), count.collect::<Vec<_>>().join(", "));
    Drawing::stacked(Vec::new(), 0.5).headed(title, lines)
}

/// The frame of the verdicts: its width, and the height of a row.
const WIDE: f64 = 420.0;
const ROW: f64 = 26.0;

/// The verdict of each check of one BSDF for each angle of `wo`; `None` of other tests.
fn checks(validation: &Validation) -> Option<Drawing> {
    validation.unseen?;
    let mut names: Vec<String> = Vec::new();
    let mut tests: Vec<(Verdict, Point)> = Vec::new();
    for Tested { name, outcome } in &validation.tests {
        let Some((check, angle)) = validation_cells::check_of(name) else { continue };
        let row = names.iter().position(|known| known == check).unwrap_or(names.len());
        if row == names.len() {
            names.push(check.to_owned());
        }
        tests.push((outcome.verdict, [angle, row as f64 + 0.5]));
    }
    if tests.is_empty() {
        return None;
    }
    let mut angles: Vec<f64> = tests.iter().map(|(_, [angle, _])| *angle).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let title = format!(
        "{} accepted, {} rejected, {} inconclusive",
        validation.accepted, validation.rejected, validation.inconclusive
    );
    let x = Axis::linear("angle of /{ω}_{o} with the normal (degrees)").range(-10.0, 160.0).at(angles);
    let height = ROW * (names.len() + 1) as f64;
    let panel = Panel::new(x, Axis::named("", names)).title(title);
    let kinds = [
        ("accepted", theme::ACCEPTED.faded(0.5), Marker::Disc, Verdict::Accept),
        ("rejected", theme::REJECTED, Marker::Square, Verdict::Reject),
        ("inconclusive", theme::INCONCLUSIVE, Marker::Triangle, Verdict::Inconclusive),
    ];
    let with = |panel: Panel, (name, colour, marker, verdict): (&str, _, _, Verdict)| {
        let of: Vec<Point> = tests.iter().filter(|(known, _)| *known == verdict).map(|(_, at)| *at).collect();
        if of.is_empty() { panel } else { panel.markers(name, colour, marker, of) }
    };
    Some(Plot::new([kinds.into_iter().fold(panel, with)]).frame_size(WIDE, height).draw())
}

/// The run's p-values in ascending order against those of true claims, on linear and logarithmic axes.
fn p_values(validation: &Validation) -> Drawing {
    let tests = validation.ranked();
    let (n, total) = (tests.len(), validation.tests.len());
    // p-values of 0 and below what a double can hold are at the lower end of the logarithmic axis.
    const LEAST: f64 = 1e-20;
    let dots = |verdict: Verdict, least: f64| -> Vec<Point> {
        tests.iter().filter(|test| test.verdict == verdict).map(|test| [test.expected, test.p.max(least)]).collect()
    };
    let band: Vec<[f64; 3]> = tests.iter().map(|t| [t.expected, t.interval[0], t.interval[1]]).collect();
    let line: Vec<Point> = tests.iter().map(|t| [t.expected, t.expected]).collect();
    let holm: Vec<Point> = tests.iter().map(|t| [t.expected, t.threshold]).collect();
    let panel = |x: Axis, y: Axis, least: f64| {
        let panel = Panel::new(x, y)
            .band("99 % of correct samplers at each rank", theme::INTERVAL, band.clone())
            .line("expected of correct samplers", Stroke::solid(theme::EXPECTED, theme::THIN), line.clone())
            .line(
                "rejected below",
                Stroke { dash: theme::DASHED, ..Stroke::solid(theme::REJECTED, theme::THIN) },
                holm.clone(),
            )
            .dots("accepted", theme::ACCEPTED.faded(0.5), dots(Verdict::Accept, least));
        [("rejected", theme::REJECTED, Verdict::Reject), ("inconclusive", theme::INCONCLUSIVE, Verdict::Inconclusive)]
            .into_iter()
            .filter(|(.., verdict)| tests.iter().any(|test| test.verdict == *verdict))
            .fold(panel, |panel, (name, colour, verdict)| panel.dots(name, colour, dots(verdict, least)))
    };
    // The logarithmic panel starts a decade below the smallest p-value and threshold
    let smallest = tests.first().map_or(LEAST, |test| test.p.clamp(LEAST, 1.0));
    let foot = 10f64.powf(smallest.min(holm.first().map_or(1.0, |p| p[1])).log10().floor() - 1.0);
    let first = tests.first().map_or(1.0, |test| test.expected);
    let uniformity = validation.uniformity;
    let of_rejections = if validation.rejected == 0 { "none".to_owned() } else { validation.rejected.to_string() };
    let title = format!("{}: {of_rejections} rejected", counted(total, "test"));
    let others = || {
        format!(
            "/{{p}}-values of {n} tests: the others have exact checks alone, or /{{p}}-values of few possible values"
        )
    };
    Plot::new([
        panel(Axis::linear("rank / (tests + 1)").range(0.0, 1.0), Axis::linear("/{p}-value").range(0.0, 1.0), 0.0)
            .title(format!("/{{p}}-values along the diagonal: correct samplers (uniform: {})", p_value(uniformity.p))),
        panel(Axis::log("rank / (tests + 1)").range(0.8 * first, 1.0), Axis::log("/{p}-value").range(foot, 1.0), foot)
            .title(format!(
                "{} accepted, {} rejected, {} inconclusive",
                validation.accepted, validation.rejected, validation.inconclusive
            )),
    ])
    .draw()
    .headed(title, (total > n).then(others).into_iter().collect())
}

/// A row for each planted fault, as CSV.
pub fn planted_csv(findings: &Findings) -> Result<Vec<u8>> {
    Table::of(&findings.tests)
        .field("name", |test| test.name)
        .field("mistake", |test| test.mistake)
        .field("verdict", |test| test.outcome.verdict.to_string())
        .field("by", |test| test.by.map(By::name))
        // The usual mistake that the test names
        .field("named", |test| test.outcome.mistake.as_ref().map(ToString::to_string))
        .field("violation", |test| test.outcome.violation.as_deref())
        .field("diagnosis", |test| test.outcome.diagnosis.as_deref())
        .field("statistic", |test| test.outcome.statistic)
        .field("dof", |test| test.outcome.dof)
        .field("p", |test| test.outcome.p)
        .field("samples", |test| test.outcome.samples)
        .field("detectable", |test| test.outcome.detectable)
        .field("error", |test| test.error)
        .field("verdict_without", |test| test.sound.to_string())
        .field("p_without", |test| test.sound_p)
        .field("remark_without", |test| test.sound_remark.as_deref())
        .csv()
}

/// A row for each fault of published software, as CSV.
pub fn museum_csv(museum: &Museum) -> Result<Vec<u8>> {
    Table::of(&museum.tests)
        .field("name", |test| test.finding.name)
        .field("source", |test| test.source)
        // What of the source was read
        .field("seen", |test| match test.seen {
            Seen::Diff => "diff",
            Seen::Thread => "thread",
            Seen::Title => "title",
        })
        .field("story", |test| test.finding.mistake)
        .field("verdict", |test| test.finding.outcome.verdict.to_string())
        .field("check", |test| test.check)
        .field("named", |test| test.finding.outcome.mistake.as_ref().map(ToString::to_string))
        .field("reason", |test| test.finding.outcome.reason())
        .field("would_find", |test| test.would_find)
        .field("p", |test| test.finding.outcome.p)
        .field("samples", |test| test.finding.outcome.samples)
        .field("seconds", |test| test.finding.outcome.seconds)
        .field("verdict_without", |test| test.finding.sound.to_string())
        .field("plain_p", |test| test.plain)
        .field("plain_p_without", |test| test.plain_sound)
        .csv()
}

/// What a run found: of several tests the verdict and why first, then those that need a look, and those that were accepted by family, or, if
/// `all`, a line for each.
pub fn text(validation: &Validation, all: bool) -> String {
    let tests = &validation.tests;
    let summary = format!(
        "{} at level {} together, seed {}: {} accepted, {} rejected, {} inconclusive; {:.1} s\n",
        counted(tests.len(), "test"),
        rounded(validation.level, 3).parse().unwrap_or(validation.level),
        validation.seed,
        validation.accepted,
        validation.rejected,
        validation.inconclusive,
        validation.seconds
    );
    let is_single = tests.len() == 1;
    let is_told = |test: &&Tested| all || is_single || !test.outcome.is_accepted() || !test.outcome.remarks.is_empty();
    let told: Vec<&Tested> = tests.iter().filter(is_told).collect();
    let rows = Some(table(&told, is_single)).filter(|_| !told.is_empty());
    let parts: Vec<String> = if is_single {
        rows.into_iter().chain([summary]).collect()
    } else {
        let causes = validation.causes().into_iter().map(|cause| wrapped(&cause, "  ", LINE));
        let folded = Some(match validation.unseen {
            Some(_) => of_one_subject(tests),
            None => families(tests),
        });
        [summary].into_iter().chain(causes).chain(rows).chain(folded.filter(|_| !all)).collect()
    };
    let mut text = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n");
    if validation.interrupted {
        text += "interrupted before all tests were finished\n";
    }
    if let (0, 0, Some(unseen)) = (validation.rejected, validation.inconclusive, validation.unseen) {
        text += &format!("{unseen}\n");
    }
    text
}

/// One line for each test, and below it, of a single one, why and where it failed; its remarks, and what it detects between the
/// cells.
fn table(tests: &[&Tested], is_single: bool) -> String {
    let below = |outcome: &Outcome| {
        let stopped = outcome.is_stopped().then(|| outcome.taken());
        let findings = if is_single { outcome.findings().into_iter().chain(stopped).collect() } else { Vec::new() };
        let lines = findings.into_iter().map(|line| format!("  {line}\n"));
        let remarks = outcome.remarks.iter().map(|remark| format!("  remark: {remark}\n"));
        let finer = outcome.finer().filter(|_| outcome.is_accepted());
        let ripples = finer.map(|finer| wrapped(&format!("detects ripples: {finer}"), "    ", LINE));
        lines.chain(remarks).chain(ripples).collect::<String>()
    };
    Table::of(tests)
        .words("test", |test| &test.name)
        .words("verdict", |test| test.outcome.verdict)
        .numbers("p", |test| p_text(test.outcome.p))
        .numbers("detects", |test| percent(test.outcome.detectable))
        .numbers("samples", |test| test.outcome.samples)
        .words("integral of the pdf", |test| {
            let mass = test.outcome.mass.filter(|mass| mass.error.is_finite());
            mass.map_or("-".into(), |mass| mass.to_string().replace(" statistical", ""))
        })
        .text_with(|test, line| line + &below(&test.outcome))
}

/// The accepted tests of one sampler or BSDF, how many of each kind, and what they detect.
fn of_one_subject(tests: &[Tested]) -> String {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    let accepted = || tests.iter().filter(|test| test.outcome.is_accepted());
    for test in accepted() {
        let kind = test.name.rsplit('/').nth(1).unwrap_or(&test.name);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((kind, 1)),
        }
    }
    if kinds.is_empty() {
        return String::new();
    }
    let counts: Vec<String> = kinds.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
    let detected = percent(accepted().filter_map(|test| test.outcome.detectable).max_by(f64::total_cmp));
    wrapped(
        &format!("accepted: {}; in these, errors of {detected} would have been found", counts.join(", ")),
        "  ",
        100,
    )
}

/// One line for each family, in the order of the tests.
fn families(tests: &[Tested]) -> String {
    let mut groups: Vec<(String, Vec<&Outcome>)> = Vec::new();
    for test in tests {
        let family = family(&test.name);
        match groups.iter_mut().find(|(name, _)| *name == family) {
            Some((_, members)) => members.push(&test.outcome),
            None => groups.push((family, vec![&test.outcome])),
        }
    }
    Table::of(&groups)
        .words("family", |(name, _)| name)
        .numbers("tests", |(_, all)| all.len())
        .numbers("accepted", |(_, all)| all.iter().filter(|outcome| outcome.is_accepted()).count())
        .numbers("min p", |(_, all)| p_text(all.iter().filter_map(|outcome| outcome.p).min_by(f64::total_cmp)))
        .numbers("detects", |(_, all)| percent(all.iter().filter_map(|o| o.detectable).max_by(f64::total_cmp)))
        .numbers("samples", |(_, all)| all.iter().map(|outcome| outcome.samples).sum::<u64>())
        .words("", |(_, all)| if all.iter().any(|o| o.verdict == Verdict::Reject) { "<- rejected" } else { "" })
        .text()
}

/// The first two words of a name, or the first of a name of two.
fn family(name: &str) -> String {
    let words: Vec<&str> = name.split('/').collect();
    words[..(words.len() - 1).min(2)].join("/")
}

/// What a test found: why it does not accept, else its p-value; and where samples and pdf differ most.
pub fn found(outcome: &Outcome) -> String {
    let findings = outcome.findings();
    if findings.is_empty() { outcome.p.map_or_else(String::new, p_is) } else { findings.join("; ") }
}

/// The p-value of a test that has one.
pub fn p_text(p: Option<f64>) -> String {
    p.map_or("-".into(), plain_p_value)
}

fn percent(share: Option<f64>) -> String {
    const LEAST: f64 = 1e-6;
    share.map_or("-".into(), |w| match 100.0 * w {
        0.0 => "0 %".into(),
        percent if percent >= 1e4 => format!("{percent:.0e} %"),
        percent if percent >= 0.01 => format!("{percent:.2} %"),
        percent if percent >= LEAST => format!("{} %", rounded(percent, 1)),
        _ => format!("< {LEAST} %"),
    })
}
