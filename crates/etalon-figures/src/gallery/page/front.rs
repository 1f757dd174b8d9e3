//! What surrounds the articles: summary, contents, thumbnails and footer; the tables of the reports' errors and claims.

use super::super::check::skipped;
use super::super::figure::{Claim, Erratum};
use super::article::{Article, join};
use super::record::Setup;
use crate::figure::escape;
use crate::view::text::{counted, duration, plain_p_value};
use etalon_bench::table::Table;
use std::collections::BTreeMap;

/// Title, totals, and the figures whose checks have failed.
pub fn summary(articles: &[Article<'_>]) -> String {
    let checks: usize = articles.iter().map(|a| a.record.checks.len()).sum();
    let failed: usize = articles.iter().map(Article::failed).sum();
    let reasons = skipped(articles.iter().flat_map(|a| &a.record.checks));
    let left_out: usize = reasons.iter().map(|(count, _)| count).sum();
    let (figures, passed) = (articles.len(), checks - failed - left_out);
    let count = counted(figures, "figure");
    let time = duration(articles.iter().map(|a| a.record.seconds).sum());
    let verdict = if failed == 0 { "none" } else { "fail" };
    let with_failures = articles.iter().filter(|a| a.failed() > 0);
    let links: String = with_failures.map(|a| format!(" <a href=\"#figure-{0}\">{0}</a>", a.figure.id)).collect();
    let failures = if failed > 0 { format!("<p class=\"fail\">Checks failed in:{links}</p>\n") } else { String::new() };
    let why: Vec<String> =
        reasons.iter().map(|(count, why)| format!("{}: {}", counted(*count, "check"), escape(why))).collect();
    let skips = if left_out > 0 { format!("<p>Checks skipped. {}.</p>\n", why.join("; ")) } else { String::new() };
    format!(
        r#"<header>
<h1>How light is sampled, in {count}</h1>
<p>Reflectance, environment maps, microfacets and paths: each figure says what is seen and why it matters, where its
counterpart was published, which values it is checked against, and which command reproduces it.</p>
<dl class="totals"><div><dt>Figures</dt><dd>{figures}</dd></div>
<div><dt>Checks passed</dt><dd class="pass">{passed}</dd></div>
<div><dt>Checks failed</dt><dd class="{verdict}">{failed}</dd></div>
<div><dt>Checks skipped</dt><dd>{left_out}</dd></div><div><dt>Total time</dt><dd>{time}</dd></div></dl>
{failures}{skips}</header>
"#
    )
}

/// Search, and the titles of all figures by section.
pub fn contents(articles: &[Article<'_>], sections: &[&[Article<'_>]]) -> String {
    let wrong = articles.iter().any(|a| !a.record.errata.is_empty());
    let claimed = articles.iter().any(|a| !a.record.claims.is_empty());
    let link = |there: bool, id: &str, text: &str| {
        if there { format!("<p><a href=\"#{id}\">{text}</a></p>\n") } else { String::new() }
    };
    let front = link(true, "overview", "Overview")
        + &link(wrong, "errata", "Errors in the reports")
        + &link(claimed, "claims", "Claims of the reports");
    let entry = |article: &Article<'_>| {
        let mark = if article.failed() > 0 { " <span class=\"fail\">✗ failed</span>" } else { "" };
        let (id, number, title) = (&article.figure.id, article.number, escape(&article.figure.title));
        format!("<li data-id=\"{id}\"><a href=\"#figure-{id}\"><span>{number}</span>{title}</a>{mark}</li>\n")
    };
    let part = |(i, group): (usize, &&[Article<'_>])| {
        let (number, name) = (i + 1, escape(&group[0].figure.section));
        let entries: String = group.iter().map(entry).collect();
        format!("<div class=\"part\"><p><a href=\"#part-{number}\">{name}</a></p>\n<ul>\n{entries}</ul></div>\n")
    };
    let parts: String = sections.iter().enumerate().map(part).collect();
    format!(
        r#"<nav aria-label="Figures">
<div class="tools" hidden="hidden">
<label>Find <input type="search" id="find" placeholder="mirror, fresnel, slope" /></label>
<label><input type="checkbox" id="failed" /> only failed</label><button type="button" id="theme">Dark or light</button>
<p class="fine" id="found" role="status"></p></div>
<details open="open"><summary>Contents</summary>
{front}{parts}</details>
</nav>
"#
    )
}

/// A small image of every figure, which leads to it.
pub fn thumbnails(sections: &[&[Article<'_>]]) -> String {
    let tile = |article: &Article<'_>| {
        let (id, number, title) = (&article.figure.id, article.number, escape(&article.figure.title));
        let (source, kind) = (&article.image.thumbnail, article.image.thumbnail_kind());
        format!(
            "<li data-id=\"{id}\"><a href=\"#figure-{id}\"><span class=\"tile {kind}\"><img src=\"{source}\" alt=\"\" \
             decoding=\"async\" /></span><span><b>{number}</b> {title}</span></a></li>\n"
        )
    };
    let part = |group: &&[Article<'_>]| {
        let (name, tiles) = (escape(&group[0].figure.section), group.iter().map(tile).collect::<String>());
        format!("<div class=\"part\"><h3>{name}</h3>\n<ul class=\"tiles\">\n{tiles}</ul></div>\n")
    };
    let parts: String = sections.iter().map(part).collect();
    format!("<section class=\"overview\">\n<h2 id=\"overview\">Overview</h2>\n{parts}</section>\n")
}

/// Program, machine, downloads and licence.
pub fn footer(articles: &[Article<'_>]) -> String {
    let mut setups: BTreeMap<&Setup, usize> = BTreeMap::new();
    for article in articles {
        *setups.entry(&article.record.setup).or_default() += 1;
    }
    let setup = |(setup, count): (&Setup, usize)| {
        let Setup { version, commit, date, seed, map, options, originals, cpu, cores, threads, system } = setup;
        let (figures, command) = (counted(count, "figure"), escape(&join("etalon reproduce", options)));
        let built = if commit.is_empty() { String::new() } else { format!(" (commit {commit})") };
        let day = if date.is_empty() { String::new() } else { format!(", {date}") };
        let run = escape(&format!("etalon {version}{built}{day}, seed {seed}, map {map}"));
        let machine = format!("{cpu}, {}, {}, {system}", counted(*cores, "core"), counted(*threads, "thread"));
        let known = if originals.is_empty() {
            "none of the reports' own files".to_owned()
        } else {
            format!("the reports' own files, recognised by checksums: {}", originals.join(", "))
        };
        format!("<p>{figures} by <code>{command}</code>: {run}; {}; {}</p>\n", escape(&known), escape(&machine))
    };
    let setups: String = setups.into_iter().map(setup).collect();
    let repository = env!("CARGO_PKG_REPOSITORY");
    let source = if repository.is_empty() {
        "Sources and book come with the program.".to_owned()
    } else {
        format!("<a href=\"{repository}\">Sources and book</a>.")
    };
    format!(
        r#"<footer class="fine">
{setups}<p>A commit names what the program was built on; changes after it are not recorded. The time of a render that
figures share is counted with the first of them.</p>
<p>This page is complete without other files: charts are vector graphics, large images are compressed. In full, as SVG, PNG,
PDF and EXR with their data as CSV, they are in the folder that <code>etalon reproduce</code> writes, beside this page, with
<a href="checks.csv">checks.csv</a> and <a href="reproduce.json">reproduce.json</a>, which have all numbers with all
digits.</p>
<p>{source} Licence: {licence}.</p>
</footer>
"#,
        licence = env!("CARGO_PKG_LICENSE"),
    )
}

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
