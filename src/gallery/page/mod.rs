//! The page that shows all figures: one HTML file that works alone and offline.

mod article;
mod embedded;
mod record;

pub use record::{Record, Records, Setup, read_records, without_folder};

use super::figure::{Claim, Erratum, Figure};
use crate::error::Result;
use crate::figure::escape;
use crate::files;
use crate::view::text::{capitalized, counted, seconds};
use article::{Article, join};
use embedded::EmbeddedImage;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

pub const FILE: &str = "index.html";

/// Writes the records and the page of those figures in `folder` that have one.
///
/// # Errors
/// When an image is missing or damaged, or a file cannot be written.
pub fn write(folder: &Path, figures: &[Figure], records: &Records) -> Result<()> {
    let articles = articles(folder, figures, records)?;
    record::write_records(folder, records)?;
    files::write_bytes(&folder.join(FILE), document(&articles, folder).as_bytes())
}

fn articles<'a>(folder: &Path, figures: &'a [Figure], records: &'a Records) -> Result<Vec<Article<'a>>> {
    figures
        .par_iter()
        .enumerate()
        .filter_map(|(i, figure)| Some((i + 1, figure, records.get(figure.id)?)))
        .map(|(number, figure, record)| {
            let beside = figure.beside.filter(|id| records.contains_key(*id));
            Ok(Article { figure, number, record, image: EmbeddedImage::read(folder, figure.id)?, beside })
        })
        .collect()
}

/// The page: summary, contents, errors of the reports, and the articles by report.
fn document(articles: &[Article<'_>], folder: &Path) -> String {
    // Reports in the order of their first articles
    let mut sorted: Vec<&Article<'_>> = articles.iter().collect();
    sorted.sort_by_key(|a| articles.iter().position(|first| first.figure.report == a.figure.report));
    let reports: Vec<&[&Article<'_>]> = sorted.chunk_by(|a, b| a.figure.report == b.figure.report).collect();
    let part = |(i, group): (usize, &&[&Article<'_>])| {
        let (number, report) = (i + 1, group[0].figure.report);
        let citation: String =
            report.citations().iter().map(|text| format!("<p class=\"fine\">{text}</p>\n")).collect();
        let articles: String = group.iter().map(|article| article.html(folder)).collect();
        let heading = format!("<h2 id=\"part-{number}\">{}</h2>", capitalized(report.name()));
        format!("<section>\n{heading}\n{citation}{articles}</section>\n")
    };
    let parts: String = reports.iter().enumerate().map(part).collect();
    let (style, script) = (include_str!("page.css"), include_str!("page.js"));
    let (summary, contents) = (summary(articles), contents(articles, &reports));
    let (claims, errata) = (claims(articles), errata(articles));
    format!(
        r##"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1" />
<meta name="color-scheme" content="light dark" />
<title>etalon: figures and checks</title>
<link rel="icon" href="data:," />
<style>
{style}</style>
</head>
<body>
<a class="skip" href="#main">Skip to the figures</a>
{summary}{contents}<main id="main" tabindex="-1">
{claims}{errata}{parts}</main>
<dialog aria-label="Enlarged figure"></dialog>
<script>
//<![CDATA[
{script}//]]>
</script>
</body>
</html>
"##
    )
}

fn summary(articles: &[Article<'_>]) -> String {
    let checks: usize = articles.iter().map(|a| a.record.checks.len()).sum();
    let failed: usize = articles.iter().map(Article::failed).sum();
    let (figures, passed) = (articles.len(), checks - failed);
    let time = seconds(articles.iter().map(|a| a.record.seconds).sum());
    let verdict = if failed == 0 { "none" } else { "some" };
    let with_failures = articles.iter().filter(|a| a.failed() > 0);
    let links: String = with_failures.map(|a| format!(" <a href=\"#figure-{0}\">{0}</a>", a.figure.id)).collect();
    let failures = if failed > 0 { format!("<p class=\"fail\">Checks failed in:{links}</p>\n") } else { String::new() };
    let mut setups: BTreeMap<&Setup, usize> = BTreeMap::new();
    for article in articles {
        *setups.entry(&article.record.setup).or_default() += 1;
    }
    let setup = |(setup, count): (&Setup, usize)| {
        let Setup { version, seed, map, options, cpu, cores, threads, system } = setup;
        let (figures, command) = (counted(count, "figure"), escape(&join("etalon reproduce", options)));
        let run = escape(&format!("etalon {version}, seed {seed}, map {map}"));
        let machine = format!("{cpu}, {}, {}, {system}", counted(*cores, "core"), counted(*threads, "thread"));
        format!("<p class=\"fine\">{figures}: <code>{command}</code>, {run}; {}</p>\n", escape(&machine))
    };
    let setups: String = setups.into_iter().map(setup).collect();
    format!(
        r#"<header>
<h1>etalon: figures and checks</h1>
<p>Figures about the sampling of light, each with its counterpart in a published report, the checks that its numbers must
pass, and the command that reproduces it.</p>
<dl class="totals"><div><dt>Figures</dt><dd>{figures}</dd></div>
<div><dt>Checks passed</dt><dd class="pass">{passed}</dd></div>
<div><dt>Checks failed</dt><dd class="{verdict}">{failed}</dd></div><div><dt>Total time</dt><dd>{time}</dd></div></dl>
{failures}{setups}<p class="fine">The time of a render that figures share is given for the first of them. Large images are
compressed here; the files beside this page are exact. <a href="checks.csv">checks.csv</a> and
<a href="reproduce.json">reproduce.json</a> have all numbers with all digits.</p>
</header>
"#
    )
}

fn contents(articles: &[Article<'_>], reports: &[&[&Article<'_>]]) -> String {
    let wrong = articles.iter().any(|a| !a.record.errata.is_empty());
    let claimed = articles.iter().any(|a| !a.record.claims.is_empty());
    let claimed = if claimed { "<p><a href=\"#claims\">What the reports claim</a></p>\n" } else { "" };
    let wrong = if wrong { "<p><a href=\"#errata\">Where the reports are wrong</a></p>\n" } else { "" };
    let entry = |article: &&Article<'_>| {
        let mark = if article.failed() > 0 { " <span class=\"fail\">✗ failed</span>" } else { "" };
        let (id, number) = (article.figure.id, article.number);
        format!("<li data-id=\"{id}\"><a href=\"#figure-{id}\">{number}. {id}</a>{mark}</li>\n")
    };
    let part = |(i, group): (usize, &&[&Article<'_>])| {
        let (number, name) = (i + 1, capitalized(group[0].figure.report.name()));
        let entries: String = group.iter().map(entry).collect();
        format!("<p><a href=\"#part-{number}\">{name}</a></p>\n<ul>\n{entries}</ul>\n")
    };
    let parts: String = reports.iter().enumerate().map(part).collect();
    format!(
        r#"<nav aria-label="Figures">
<div class="tools" hidden="hidden">
<label>Find <input type="search" id="find" placeholder="mirror, fresnel, slope" /></label>
<label><input type="checkbox" id="failed" /> only failed</label><button type="button" id="theme">Dark or light</button>
<p class="fine" id="found" role="status"></p></div>
<details open="open"><summary>Contents</summary>
{claimed}{wrong}{parts}</details>
</nav>
"#
    )
}

fn errata(articles: &[Article<'_>]) -> String {
    let row = |(id, erratum): (&str, &Erratum)| {
        let Erratum { printed, right, test, p_value: p, picture_error } = erratum;
        let [printed, right, test, error] = [printed, right, test, picture_error].map(|text| escape(text));
        let p = p_value(*p);
        format!(
            "<tr><td>{printed}</td><td>{right}</td><td>{test}</td><td class=\"number\">{p}</td><td>{error}</td>\
             <td><a href=\"#figure-{id}\">{id}</a></td></tr>\n"
        )
    };
    let all = articles.iter().flat_map(|a| a.record.errata.iter().map(|erratum| (a.figure.id, erratum)));
    let rows: String = all.map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        r#"<section>
<h2 id="errata">Where the reports are wrong</h2>
<div class="wide" tabindex="0"><table>
<thead><tr><th scope="col">As printed</th><th scope="col">Corrected</th><th scope="col">Detected by</th>
<th scope="col">p-value</th><th scope="col">Error in an image</th><th scope="col">Figure</th></tr></thead>
<tbody>
{rows}</tbody></table></div>
</section>
"#
    )
}

/// The claims with their verdicts; figures that are on the page are linked.
fn claims(articles: &[Article<'_>]) -> String {
    let link = |id: &String| {
        let shown = escape(id);
        let known = articles.iter().any(|article| article.figure.id == id);
        if known { format!("<a href=\"#figure-{shown}\">{shown}</a>") } else { shown }
    };
    let row = |claim: &Claim| {
        let [report, place, text, number, verdict] =
            [&claim.report, &claim.place, &claim.claim, &claim.number, &claim.verdict].map(|text| escape(text));
        let measured = claim.measured.iter().map(|text| escape(text)).collect::<Vec<_>>().join("<br />");
        let evidence = claim.evidence.iter().map(link).collect::<Vec<_>>().join(", ");
        format!(
            "<tr><td>{text}</td><td>{report}, {place}</td><td>{number}</td><td>{measured}</td>\
             <td><strong>{verdict}</strong></td><td>{evidence}</td></tr>\n"
        )
    };
    let rows: String = articles.iter().flat_map(|article| &article.record.claims).map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        r#"<section>
<h2 id="claims">What the reports claim</h2>
<div class="wide" tabindex="0"><table>
<thead><tr><th scope="col">Claim</th><th scope="col">In the report</th><th scope="col">Its number</th>
<th scope="col">Measured, and what the claim demands</th><th scope="col">Verdict</th><th scope="col">Evidence</th></tr></thead>
<tbody>
{rows}</tbody></table></div>
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

#[cfg(test)]
mod tests;
