//! The page that shows all figures: one HTML file that works alone and offline.

mod article;
mod embedded;
mod record;

pub use record::{Record, Records, Setup, read_records, without_folder};

use super::figure::{Figure, Report};
use crate::error::{Error, Result};
use crate::figure::escape;
use crate::files;
use crate::view::text::{counted, seconds};
use article::{Article, join};
use embedded::EmbeddedImage;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

pub const FILE: &str = "index.html";

/// Writes the records and the page of those figures in `folder` that have one.
///
/// # Errors
/// When an image is missing or damaged, or a file cannot be written.
pub fn write(folder: &Path, figures: &[Figure], records: &Records) -> Result<()> {
    let articles = articles(folder, figures, records)?;
    let path = folder.join(FILE);
    let text = document(&articles, folder).map_err(|e| Error::io(&path, std::io::Error::other(e)))?;
    record::write_records(folder, records)?;
    files::write_bytes(&path, text.as_bytes())
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

/// The articles of one report.
type Group<'a, 'b> = (Report, Vec<&'b Article<'a>>);

/// The articles by report, reports in the order of their first articles.
fn by_report<'a, 'b>(articles: &'b [Article<'a>]) -> Vec<Group<'a, 'b>> {
    let mut groups: Vec<Group<'a, 'b>> = Vec::new();
    for article in articles {
        let report = article.figure.report;
        match groups.iter_mut().find(|(known, _)| *known == report) {
            Some((_, group)) => group.push(article),
            None => groups.push((report, vec![article])),
        }
    }
    groups
}

fn document(articles: &[Article<'_>], folder: &Path) -> std::result::Result<String, std::fmt::Error> {
    let mut out = String::from(concat!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n",
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n",
        "<meta name=\"color-scheme\" content=\"light dark\" />\n",
        "<title>etalon: figures and checks</title>\n<link rel=\"icon\" href=\"data:,\" />\n",
        "<style>\n",
        include_str!("page.css"),
        "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the figures</a>\n",
    ));
    let groups = by_report(articles);
    summary(&mut out, articles)?;
    contents(&mut out, articles, &groups)?;
    out.push_str("<main id=\"main\" tabindex=\"-1\">\n");
    errata(&mut out, articles)?;
    for (i, (report, group)) in groups.iter().enumerate() {
        writeln!(out, "<section>\n<h2 id=\"part-{}\">{}</h2>", i + 1, escape(&capitalized(report.name())))?;
        if let Some(citation) = report.citation() {
            writeln!(out, "<p class=\"fine\">{}</p>", escape(citation))?;
        }
        for article in group {
            article.html(&mut out, folder)?;
        }
        out.push_str("</section>\n");
    }
    out.push_str(concat!(
        "</main>\n<dialog aria-label=\"Enlarged figure\"></dialog>\n<script>\n//<![CDATA[\n",
        include_str!("page.js"),
        "//]]>\n</script>\n</body>\n</html>\n",
    ));
    Ok(out)
}

fn summary(out: &mut String, articles: &[Article<'_>]) -> std::fmt::Result {
    let checks: usize = articles.iter().map(|a| a.record.checks.len()).sum();
    let failed: usize = articles.iter().map(Article::failed).sum();
    let total: f64 = articles.iter().map(|a| a.record.seconds).sum();
    let verdict = if failed == 0 { "none" } else { "some" };
    writeln!(
        out,
        "<header>\n<h1>etalon: figures and checks</h1>\n<p>Figures about the sampling of light, each with its counterpart in \
         a published report, the checks that its numbers must pass, and the command that reproduces it.</p>\n\
         <dl class=\"totals\"><div><dt>Figures</dt><dd>{}</dd></div><div><dt>Checks passed</dt><dd class=\"pass\">{}</dd></div>\
         <div><dt>Checks failed</dt><dd class=\"{verdict}\">{failed}</dd></div>\
         <div><dt>Total time</dt><dd>{}</dd></div></dl>",
        articles.len(),
        checks - failed,
        seconds(total)
    )?;
    if failed > 0 {
        out.push_str("<p class=\"fail\">Checks failed in:");
        for article in articles.iter().filter(|a| a.failed() > 0) {
            write!(out, " <a href=\"#figure-{0}\">{0}</a>", escape(article.figure.id))?;
        }
        out.push_str("</p>\n");
    }
    let mut setups: BTreeMap<&Setup, usize> = BTreeMap::new();
    for article in articles {
        *setups.entry(&article.record.setup).or_default() += 1;
    }
    for (setup, count) in setups {
        writeln!(
            out,
            "<p class=\"fine\">{}: <code>{}</code>, etalon {}, seed {}, map {}; {}, {}, {}, {}</p>",
            counted(count, "figure"),
            escape(&join("etalon reproduce", &setup.options)),
            escape(&setup.version),
            setup.seed,
            escape(&setup.map),
            escape(&setup.cpu),
            counted(setup.cores, "core"),
            counted(setup.threads, "thread"),
            escape(&setup.system)
        )?;
    }
    out.push_str(
        "<p class=\"fine\">The time of a render that figures share is given for the first of them. Large images are compressed \
         here; the files beside this page are exact. <a href=\"checks.csv\">checks.csv</a> and <a \
         href=\"reproduce.json\">reproduce.json</a> have all numbers with all digits.</p>\n</header>\n",
    );
    Ok(())
}

fn contents(out: &mut String, articles: &[Article<'_>], groups: &[Group<'_, '_>]) -> std::fmt::Result {
    out.push_str(concat!(
        "<nav aria-label=\"Figures\">\n<div class=\"tools\" hidden=\"hidden\">",
        "<label>Find <input type=\"search\" id=\"find\" placeholder=\"mirror, fresnel, slope\" /></label>",
        "<label><input type=\"checkbox\" id=\"failed\" /> only failed</label>",
        "<button type=\"button\" id=\"theme\">Dark or light</button>",
        "<p class=\"fine\" id=\"found\" role=\"status\"></p></div>\n",
        "<details open=\"open\"><summary>Contents</summary>\n",
    ));
    if articles.iter().any(|a| !a.record.errata.is_empty()) {
        out.push_str("<p><a href=\"#errata\">Where the reports are wrong</a></p>\n");
    }
    for (i, (report, group)) in groups.iter().enumerate() {
        writeln!(out, "<p><a href=\"#part-{}\">{}</a></p>\n<ul>", i + 1, escape(&capitalized(report.name())))?;
        for article in group {
            let mark = if article.failed() > 0 { " <span class=\"fail\">✗ failed</span>" } else { "" };
            writeln!(
                out,
                "<li data-id=\"{0}\"><a href=\"#figure-{0}\">{1}. {0}</a>{mark}</li>",
                escape(article.figure.id),
                article.number
            )?;
        }
        out.push_str("</ul>\n");
    }
    out.push_str("</details>\n</nav>\n");
    Ok(())
}

fn errata(out: &mut String, articles: &[Article<'_>]) -> std::fmt::Result {
    if articles.iter().all(|a| a.record.errata.is_empty()) {
        return Ok(());
    }
    out.push_str(concat!(
        "<section>\n<h2 id=\"errata\">Where the reports are wrong</h2>\n<div class=\"wide\" tabindex=\"0\"><table>\n<thead><tr>",
        "<th scope=\"col\">As printed</th><th scope=\"col\">Corrected</th><th scope=\"col\">Detected by</th>",
        "<th scope=\"col\">p-value</th><th scope=\"col\">Error in an image</th><th scope=\"col\">Figure</th>",
        "</tr></thead>\n<tbody>\n",
    ));
    for article in articles {
        for erratum in &article.record.errata {
            writeln!(
                out,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td><td>{}</td>\
                 <td><a href=\"#figure-{id}\">{id}</a></td></tr>",
                escape(&erratum.printed),
                escape(&erratum.right),
                escape(&erratum.test),
                p_value(erratum.p_value),
                escape(&erratum.picture_error),
                id = escape(article.figure.id)
            )?;
        }
    }
    out.push_str("</tbody></table></div>\n</section>\n");
    Ok(())
}

/// A p-value as text; below the smallest number that f64 holds in full it is only known to be small.
fn p_value(p: Option<f64>) -> String {
    match p {
        None => "exact".to_owned(),
        Some(p) if p < f64::MIN_POSITIVE => "&lt; 1e-307".to_owned(),
        Some(p) => format!("{p:.1e}"),
    }
}

fn capitalized(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests;
