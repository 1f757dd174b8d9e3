//! The tables of the reports' errors and claims.

use super::article::Article;
use crate::figure::escape;
use crate::gallery::figure::{Claim, Erratum};
use crate::view::text::{counted, plain_p_value};
use etalon_bench::table::Table;

/// The errors in the order of their severity, each with a link to the panel that shows it.
pub fn errata(articles: &[Article<'_>]) -> String {
    let all = articles.iter().flat_map(|a| a.record.errata.iter().map(|erratum| (a.figure.id.as_str(), erratum)));
    let all: Vec<(&str, &Erratum)> = all.collect();
    if all.is_empty() {
        return String::new();
    }
    let words = |text: &str| escape(text).replace(" %", "\u{a0}%");
    let table = Table::of(&all)
        .words("As printed", |(_, erratum)| with_whole_formulas(&erratum.printed))
        .words("Corrected", |(_, erratum)| with_whole_formulas(&erratum.right))
        .words("Detected by", |(_, erratum)| words(&erratum.test))
        .numbers("p-value", |(_, erratum)| erratum.p_value.map_or("exact".into(), |p| escape(&plain_p_value(p))))
        .words("Error in an image", |(_, erratum)| words(&erratum.picture_error))
        .numbers("Shown in", |(id, erratum)| match &erratum.place {
            Some(place) => format!("<a href=\"#{id}-{0}\">panel {0}</a>", place.panel),
            None => format!("<a href=\"#figure-{id}\">{id}</a>"),
        })
        .html("cards");
    format!(
        r#"<section>
<h2 id="errata">Errors in the reports, and the tests that reveal them</h2>
<p class="fine">The most severe first: errors before approximations before misprints, each by the error that it makes
in an image.</p>
<div class="panel">{table}</div>
</section>
"#
    )
}

/// The claims with their verdicts; figures that are on the page are linked.
pub fn claims(articles: &[Article<'_>]) -> String {
    let link = |id: &String| {
        let shown = escape(id);
        let known = articles.iter().any(|article| article.figure.id == *id);
        if known { format!("<a href=\"#figure-{shown}\">{shown}</a>") } else { shown }
    };
    let all: Vec<&Claim> = articles.iter().flat_map(|article| &article.record.claims).collect();
    if all.is_empty() {
        return String::new();
    }
    let (count, held) = (counted(all.len(), "claim"), all.iter().filter(|claim| claim.verdict == "holds").count());
    let elsewhere = all.iter().filter(|claim| claim.verdict.starts_with("measured on ")).count();
    let unjudged = if elsewhere > 0 {
        format!("; {elsewhere} are not judged: their input is not the report's")
    } else {
        String::new()
    };
    let table = Table::of(&all)
        .words("Claim", |claim| escape(&claim.claim))
        .words("In the report", |claim| escape(&format!("{}, {}", claim.report, claim.place)))
        .words("Its number", |claim| escape(&claim.number))
        .words("Measured, and what the claim demands", |claim| {
            escape(&claim.measured.join("\n")).replace('\n', "<br />")
        })
        .words("Verdict", |claim| format!("<strong>{}</strong>", escape(&claim.verdict)))
        .words("Evidence", |claim| claim.evidence.iter().map(link).collect::<Vec<_>>().join(", "))
        .html("cards");
    format!(
        r#"<section>
<h2 id="claims">What the reports claim</h2>
<details class="panel"><summary>{count}, of which {held} hold{unjudged}</summary>{table}</details>
</section>
"#
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
