//! Results of tests as text: a line for each test if they are few, else one for each family and one for each test that is not
//! accepted or has a remark.

use super::text::{counted, p_is, plain_p_value, rounded, wrapped};
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Outcome, Verdict};

/// More tests than these are summarized by family.
const FEW: usize = 40;

/// What a run found.
pub fn text(validation: &Validation) -> String {
    let tests = &validation.tests;
    let mut text = String::new();
    if tests.len() <= FEW {
        text += &table(tests.iter());
    } else {
        text += &families(tests);
        let is_told = |test: &&Tested| !test.outcome.is_accepted() || !test.outcome.remarks.is_empty();
        let told: Vec<&Tested> = tests.iter().filter(is_told).collect();
        if !told.is_empty() {
            text += &format!("\n{}", table(told.into_iter()));
        }
    }
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
fn table<'a>(tests: impl Iterator<Item = &'a Tested> + Clone) -> String {
    let width = tests.clone().map(|test| test.name.len()).max().unwrap_or(0);
    let mut text = format!(
        "{:<width$}  verdict            p detects    samples  integral of the pdf             seconds\n",
        "test"
    );
    for Tested { name, outcome } in tests {
        text += &format!(
            "{name:<width$}  {:<12} {:>8} {:>7} {:>10}  {:<31} {:>7.2}\n",
            outcome.verdict,
            p_value(outcome.p),
            percent(outcome.detectable),
            outcome.samples,
            outcome.mass.filter(|mass| mass.error.is_finite()).map_or("-".into(), |mass| mass.to_string()),
            outcome.seconds
        );
        // A line for each place.
        let places = outcome.diagnosis.iter().flat_map(|places| places.split("; "));
        for line in outcome.remark().into_iter().chain(places) {
            text += &format!("  {line}\n");
        }
        for remark in &outcome.remarks {
            text += &format!("  remark: {remark}\n");
        }
        if let Some(finer) = outcome.finer().filter(|_| outcome.is_accepted()) {
            text += &wrapped(&format!("detects ripples: {finer}"), "    ", 100);
        }
    }
    text
}

/// One line for each family, in the order of the tests.
fn families(tests: &[Tested]) -> String {
    let mut groups: Vec<(String, Vec<&Tested>)> = Vec::new();
    for test in tests {
        let family = family(&test.name);
        match groups.iter_mut().find(|(name, _)| *name == family) {
            Some((_, members)) => members.push(test),
            None => groups.push((family, vec![test])),
        }
    }
    let width = groups.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = format!("{:<width$}  tests  accepted    min p detects    samples\n", "family");
    for (name, members) in &groups {
        let outcomes = || members.iter().map(|test| &test.outcome);
        let accepted = outcomes().filter(|outcome| outcome.is_accepted()).count();
        let mark = if outcomes().any(|outcome| outcome.verdict == Verdict::Reject) { "  <- rejected" } else { "" };
        text += &format!(
            "{name:<width$}  {:>5}  {accepted:>8} {:>8} {:>7} {:>10}{mark}\n",
            members.len(),
            p_value(outcomes().filter_map(|o| o.p).min_by(f64::total_cmp)),
            percent(outcomes().filter_map(|o| o.detectable).max_by(f64::total_cmp)),
            outcomes().map(|o| o.samples).sum::<u64>(),
        );
    }
    text
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
