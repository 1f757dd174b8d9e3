//! The tables of the reports' errors and claims.

use super::article::Article;
use crate::figure::escape;
use crate::gallery::figure::{Claim, Erratum};
use crate::view::text::counted;

/// The errors in the order of their severity, each with a link to the panel that shows it.
pub fn errata(articles: &[Article<'_>]) -> String {
    let row = |(id, erratum): (&str, &Erratum)| {
        let Erratum { printed, right, test, p_value: p, picture_error, place } = erratum;
        let [printed, right] = [printed, right].map(|text| with_whole_formulas(text));
        let [test, error] = [test, picture_error].map(|text| escape(text).replace(" %", "\u{a0}%"));
        let p = p_value(*p);
        let panel = match place {
            Some(place) => format!("<a href=\"#{id}-{0}\">panel {0}</a>", place.panel),
            None => format!("<a href=\"#figure-{id}\">{id}</a>"),
        };
        format!(
            "<tr><td data-label=\"as printed\">{printed}</td><td data-label=\"corrected\">{right}</td>\
             <td data-label=\"detected by\">{test}</td><td class=\"number\" data-label=\"p-value\">{p}</td>\
             <td data-label=\"error in an image\">{error}</td><td class=\"number\">{panel}</td></tr>\n"
        )
    };
    let all = articles.iter().flat_map(|a| a.record.errata.iter().map(|erratum| (a.figure.id.as_str(), erratum)));
    let rows: String = all.map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        r#"<section>
<h2 id="errata">Errors in the reports, and the tests that reveal them</h2>
<p class="fine">The most severe first: errors before approximations before misprints, each by the error that it makes
in an image.</p>
<div class="panel"><table class="cards">
<thead><tr><th scope="col">As printed</th><th scope="col">Corrected</th><th scope="col">Detected by</th>
<th scope="col">p-value</th><th scope="col">Error in an image</th><th scope="col">Shown in</th></tr></thead>
<tbody>
{rows}</tbody></table></div>
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
    let row = |claim: &Claim| {
        let [report, place, text, number, verdict] =
            [&claim.report, &claim.place, &claim.claim, &claim.number, &claim.verdict].map(|text| escape(text));
        let measured = claim.measured.iter().map(|text| escape(text)).collect::<Vec<_>>().join("<br />");
        let evidence = claim.evidence.iter().map(link).collect::<Vec<_>>().join(", ");
        format!(
            "<tr><td>{text}</td><td data-label=\"in the\">{report}, {place}</td><td data-label=\"its number\">{number}</td>\
             <td data-label=\"measured\">{measured}</td><td data-label=\"verdict\"><strong>{verdict}</strong></td>\
             <td data-label=\"evidence\">{evidence}</td></tr>\n"
        )
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
    let rows: String = all.into_iter().map(row).collect();
    format!(
        r#"<section>
<h2 id="claims">What the reports claim</h2>
<details class="panel"><summary>{count}, of which {held} hold{unjudged}</summary><table class="cards">
<thead><tr><th scope="col">Claim</th><th scope="col">In the report</th><th scope="col">Its number</th>
<th scope="col">Measured, and what the claim demands</th><th scope="col">Verdict</th><th scope="col">Evidence</th></tr></thead>
<tbody>
{rows}</tbody></table></details>
</section>
"#
    )
}

/// A p-value as text; below the smallest number that f64 holds in full it is only known to be small.
fn p_value(p: Option<f64>) -> String {
    match p {
        None => "exact".to_owned(),
        Some(p) if p < f64::MIN_POSITIVE => "&lt; 1e-307".to_owned(),
        Some(p) => format!("{p:.1e}"),
    }
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
