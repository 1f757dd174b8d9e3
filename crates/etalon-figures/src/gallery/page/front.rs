//! What surrounds the articles: what the page is, its contents, and the footer.

use super::super::check::skipped;
use super::article::{Article, Shown, join};
use super::record::Setup;
use crate::figure::escape;
use crate::view::text::{counted, duration};
use std::collections::BTreeMap;

/// What the page is and for whom; totals, and the figures whose checks have failed.
pub fn summary(shown: &[Shown<'_>]) -> String {
    let checks: usize = shown.iter().map(|s| s.record.checks.len()).sum();
    let failed: usize = shown.iter().map(Shown::failed).sum();
    let reasons = skipped(shown.iter().flat_map(|s| &s.record.checks));
    let left_out: usize = reasons.iter().map(|(count, _)| count).sum();
    let (count, passed) = (counted(shown.len(), "figure"), checks - failed - left_out);
    let time = duration(shown.iter().map(|s| s.record.seconds).sum());
    let verdict = if failed == 0 { "pass" } else { "fail" };
    let with_failures = shown.iter().filter(|s| s.failed() > 0);
    let links: String = with_failures.map(|s| format!(" <a href=\"#figure-{0}\">{0}</a>", s.figure.id)).collect();
    let failures = if failed > 0 { format!("<p class=\"fail\">Checks failed in:{links}</p>\n") } else { String::new() };
    let why: Vec<String> =
        reasons.iter().map(|(count, why)| format!("{}: {}", counted(*count, "check"), escape(why))).collect();
    let skips = if left_out > 0 { format!(" ({})", why.join("; ")) } else { String::new() };
    format!(
        r#"<header>
<h1>How light is sampled, in {count}</h1>
<p>For those who write, test or teach the sampling code of renderers: reflectance, environment maps, microfacets and paths. Each
figure says what is seen and why it matters; below it are its checks, its counterpart in print, its data, and the command that
makes it again.</p>
<p class="script" hidden="hidden">A click on a figure enlarges it, compares it with others, and goes on to the next, for a lecture.</p>
<p class="fine"><span class="{verdict}">{passed} checks passed, {failed} failed</span>, {left_out} skipped{skips}. All figures
took {time}.</p>
{failures}</header>
"#
    )
}

/// Search and buttons; a small image of every article by section, which leads to it.
pub fn contents(sections: &[&[Article<'_>]]) -> String {
    let tile = |article: &Article<'_>| {
        let (number, title, first) = (article.number, escape(article.title()), article.first());
        let id = &first.figure.id;
        let small = first.image.as_ref().map_or_else(String::new, |image| {
            let kind = if image.inverts { "chart" } else { "picture" };
            format!("<img class=\"{kind}\" src=\"{}\" alt=\"\" decoding=\"async\" />", image.thumbnail)
        });
        let mark = if article.failed() > 0 { " <span class=\"fail\">✗ failed</span>" } else { "" };
        format!("<li><a href=\"#figure-{id}\">{small}<span><b>{number}</b> {title}{mark}</span></a></li>\n")
    };
    let part = |(i, group): (usize, &&[Article<'_>])| {
        let (number, name) = (i + 1, escape(group[0].section()));
        let tiles: String = group.iter().map(tile).collect();
        format!(
            "<div><h2 id=\"contents-{number}\">{name}</h2>\n<ul aria-labelledby=\"contents-{number}\">\n{tiles}</ul></div>\n"
        )
    };
    let parts: String = sections.iter().enumerate().map(part).collect();
    format!(
        r##"<div role="search" class="tools script" hidden="hidden">
<a href="#contents">Contents</a>
<label>Find <input type="search" id="find" placeholder="mirror, fresnel, slope" /></label>
<span class="fine" id="found" role="status"></span>
<label><input type="checkbox" id="failed" /> only failed</label>
<button type="button" id="screens">One figure per screen</button>
<button type="button" id="theme">Dark or light</button>
</div>
<nav id="contents" aria-label="Figures">
{parts}</nav>
"##
    )
}

/// Program, machine, downloads and licence.
pub fn footer(shown: &[Shown<'_>]) -> String {
    let mut setups: BTreeMap<&Setup, usize> = BTreeMap::new();
    for shown in shown {
        *setups.entry(&shown.record.setup).or_default() += 1;
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
