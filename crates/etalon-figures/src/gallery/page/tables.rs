//! Tables of the page: checks, the numbers that a report prints, its errors and its claims.

use super::article::Shown;
use crate::figure::escape;
use crate::gallery::check::Check;
use crate::gallery::figure::{Claim, Erratum, Numbers, Printed};
use crate::view::text::{counted, plain_p_value};
use etalon_bench::table::Table;

pub fn checks(checks: &[Check]) -> String {
    let verdict = |check: &Check| match check.pass {
        Some(true) => "<span class=\"pass\">✓ pass</span>",
        Some(false) => "<span class=\"fail\">✗ FAIL</span>",
        None => "skipped",
    };
    let table = Table::of(checks)
        .words("Verdict", verdict)
        .words("Check", |check| match check.pass {
            None => format!("{} <span class=\"fine\">({})</span>", escape(&check.name), escape(&check.skipped)),
            Some(_) => escape(&check.name),
        })
        .numbers("Measured", |check| format!("<span title=\"{}\">{}</span>", check.got, escape(&check.measured())))
        .numbers("Must be", |check| escape(&check.demand()));
    if checks.is_empty() { String::new() } else { table.html("cards checks") }
}

pub fn numbers(numbers: &Numbers) -> String {
    let Numbers { headings, rows } = numbers;
    if rows.is_empty() {
        return String::new();
    }
    let columns = headings.iter().enumerate();
    let table = columns.fold(Table::of(rows), |table, (i, heading)| match i {
        0 => table.words(escape(heading), |row| escape(&row[0])),
        _ => table.numbers(escape(heading), move |row| escape(&row[i])),
    });
    format!(
        "<details class=\"wide\"><summary>Table of {}</summary>\n{}</details>\n",
        counted(rows.len(), "row"),
        table.html("cards")
    )
}

/// The report's numbers beside ours.
pub fn printed(printed: &[Printed]) -> String {
    if printed.is_empty() {
        return String::new();
    }
    Table::of(printed)
        .words("Quantity", |number| escape(&number.quantity))
        .numbers("The report prints", |number| escape(&number.report))
        .numbers("Computed here", |number| escape(&number.ours))
        .html("cards printed")
}

/// The errors that the figure `id` demonstrates in the order of their severity, each with a link to the panel that shows it.
pub fn errata(id: &str, errata: &[Erratum]) -> String {
    if errata.is_empty() {
        return String::new();
    }
    let words = |text: &str| escape(text).replace(" %", "\u{a0}%");
    let table = Table::of(errata)
        .words("As printed", |erratum| with_whole_formulas(&erratum.printed))
        .words("Corrected", |erratum| with_whole_formulas(&erratum.right))
        .words("Detected by", |erratum| words(&erratum.test))
        .numbers("p-value", |erratum| erratum.p_value.map_or("exact".into(), |p| escape(&plain_p_value(p))))
        .words("Error in an image", |erratum| words(&erratum.picture_error))
        .numbers("Shown in", |erratum| match &erratum.place {
            Some(place) => format!("<a href=\"#{id}-{0}\">panel {0}</a>", place.panel),
            None => format!("<a href=\"#figure-{id}\">{id}</a>"),
        })
        .html("cards");
    let count = counted(errata.len(), "formula");
    format!(
        "<details class=\"wide\"><summary>Table of {count}, the most severe first</summary>\n<p class=\"fine\">Errors before \
         approximations before misprints, each by the error that it makes in an image.</p>\n{table}</details>\n"
    )
}

/// The claims with their verdicts; those of the figures `all` that they name are linked.
pub fn claims(claims: &[Claim], all: &[Shown<'_>]) -> String {
    if claims.is_empty() {
        return String::new();
    }
    let link = |id: &String| {
        let shown = escape(id);
        let known = all.iter().any(|other| other.figure.id == *id);
        if known { format!("<a href=\"#figure-{shown}\">{shown}</a>") } else { shown }
    };
    let (count, held) =
        (counted(claims.len(), "claim"), claims.iter().filter(|claim| claim.verdict == "holds").count());
    let elsewhere = claims.iter().filter(|claim| claim.verdict.starts_with("measured on ")).count();
    let unjudged = if elsewhere > 0 {
        format!("; {elsewhere} are not judged: their input is not the report's")
    } else {
        String::new()
    };
    let table = Table::of(claims)
        .words("Claim", |claim| escape(&claim.claim))
        .words("In the report", |claim| escape(&claim.place))
        .words("Its number", |claim| escape(&claim.number))
        .words("Measured, and what the claim demands", |claim| {
            claim.measured.iter().map(|measured| escape(measured)).collect::<Vec<_>>().join("<br />")
        })
        .words("Verdict", |claim| format!("<strong>{}</strong>", escape(&claim.verdict)))
        .words("Evidence", |claim| claim.evidence.iter().map(link).collect::<Vec<_>>().join(", "))
        .html("cards");
    format!(
        "<details class=\"wide\"><summary>Table of {count}, of which {held} hold{unjudged}</summary>\n{table}</details>\n"
    )
}

/// Words between which a formula must not break.
const OPERATORS: [&str; 15] = ["=", "+", "−", "·", "≤", "≥", "<", ">", "∝", "½", "cos", "sin", "erf", "sin²", "cos²"];

/// Escaped text in which lines break outside of formulas only: not beside operators, nor between brackets.
pub fn with_whole_formulas(text: &str) -> String {
    let mut runs: Vec<Vec<&str>> = Vec::new();
    let (mut depth, mut joined) = (0_i32, false);
    for word in text.split(' ') {
        let operator = OPERATORS.contains(&word);
        match runs.last_mut() {
            Some(run) if joined || operator || depth > 0 => run.push(word),
            _ => runs.push(vec![word]),
        }
        depth += word.matches('(').count() as i32 - word.matches(')').count() as i32;
        joined = operator;
    }
    let shown = |run: Vec<&str>| {
        let text = escape(&run.join(" "));
        let prose = run.len() == 1 && run[0].chars().all(|c| c.is_ascii_alphanumeric() || ",:.'-".contains(c));
        if prose { text } else { format!("<span class=\"formula\">{text}</span>") }
    };
    runs.into_iter().map(shown).collect::<Vec<_>>().join(" ")
}
