//! Results of tests as text: a line for each test if they are few, else one for each family and one for each test that is not
//! accepted or has a remark.

use super::text::{counted, p_is, plain_p_value, rounded, wrapped};
use etalon_bench::table::Table;
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Outcome, Verdict};

/// More tests than these are summarized by family.
const FEW: usize = 40;

/// What a run found.
pub fn text(validation: &Validation) -> String {
    let tests = &validation.tests;
    let is_told =
        |test: &&Tested| tests.len() <= FEW || !test.outcome.is_accepted() || !test.outcome.remarks.is_empty();
    let told: Vec<&Tested> = tests.iter().filter(is_told).collect();
    let mut text = match told.len() {
        _ if tests.len() <= FEW => table(&told),
        0 => families(tests),
        _ => format!("{}\n{}", families(tests), table(&told)),
    };
    text += &format!(
        "\n{} at level {} together, seed {}: {} accepted, {} rejected, {} inconclusive; {:.1} s\n",
        counted(tests.len(), "test"),
        rounded(validation.level, 3).parse().unwrap_or(validation.level),
        validation.seed,
        validation.accepted,
        validation.rejected,
        validation.inconclusive,
        validation.seconds
    );
    if validation.interrupted {
        text += "interrupted before all tests were finished\n";
    }
    text
}

/// One line for each test, and below it why and where it failed, its remarks, and what it detects between the cells.
fn table(tests: &[&Tested]) -> String {
    let below = |outcome: &Outcome| {
        // A line for each place.
        let places = outcome.diagnosis.iter().flat_map(|places| places.split("; "));
        let lines = outcome.remark().into_iter().chain(places).map(|line| format!("  {line}\n"));
        let remarks = outcome.remarks.iter().map(|remark| format!("  remark: {remark}\n"));
        let finer = outcome.finer().filter(|_| outcome.is_accepted());
        let ripples = finer.map(|finer| wrapped(&format!("detects ripples: {finer}"), "    ", 100));
        lines.chain(remarks).chain(ripples).collect::<String>()
    };
    Table::of(tests)
        .words("test", |test| &test.name)
        .words("verdict", |test| test.outcome.verdict)
        .numbers("p", |test| p_value(test.outcome.p))
        .numbers("detects", |test| percent(test.outcome.detectable))
        .numbers("samples", |test| test.outcome.samples)
        .words("integral of the pdf", |test| {
            let mass = test.outcome.mass.filter(|mass| mass.error.is_finite());
            mass.map_or("-".into(), |mass| mass.to_string())
        })
        .numbers("seconds", |test| format!("{:.2}", test.outcome.seconds))
        .text_with(|test, line| line + &below(&test.outcome))
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
        .numbers("min p", |(_, all)| p_value(all.iter().filter_map(|outcome| outcome.p).min_by(f64::total_cmp)))
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

/// What a test found: a violation or why it is inconclusive, else its p-value; and where samples and pdf differ most.
pub fn found(outcome: &Outcome) -> String {
    let why = outcome.remark().map(str::to_owned).or(outcome.p.map(p_is));
    why.into_iter().chain(outcome.diagnosis.clone()).collect::<Vec<_>>().join("; ")
}

/// The p-value of a test that has one.
pub fn p_value(p: Option<f64>) -> String {
    p.map_or("-".into(), plain_p_value)
}

fn percent(share: Option<f64>) -> String {
    share.map_or("-".into(), |w| if w >= 1e-4 { format!("{:.2} %", 100.0 * w) } else { format!("{:.0e} %", 100.0 * w) })
}
