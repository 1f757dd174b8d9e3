//! The page that shows all figures: one HTML file that needs no network and nothing beside it.

mod figure;
mod html;
mod picture;
mod record;

pub use record::{Record, Records, Setup, read_records, without_place};

use super::registry::Entry;
use crate::error::{Error, Result};
use crate::files;
use figure::{Figure, join};
use html::{Escaped, Seconds, counted};
use picture::Picture;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// The page's file name.
pub const FILE: &str = "index.html";

/// Writes the records and the page of those figures in `folder` that have one.
///
/// # Errors
/// When a picture is missing or damaged, or a file cannot be written.
pub fn write(folder: &Path, entries: &[Entry], records: &Records) -> Result<()> {
    let figures = figures(folder, entries, records)?;
    let path = folder.join(FILE);
    let text = document(&figures, folder).map_err(|e| Error::io(&path, std::io::Error::other(e)))?;
    record::write_records(folder, records)?;
    files::write_bytes(&path, text.as_bytes())
}

fn figures<'a>(folder: &Path, entries: &'a [Entry], records: &'a Records) -> Result<Vec<Figure<'a>>> {
    entries
        .par_iter()
        .enumerate()
        .filter_map(|(i, entry)| Some((i + 1, entry, records.get(entry.id)?)))
        .map(|(number, entry, record)| {
            let beside = entry.beside.filter(|id| records.contains_key(*id));
            Ok(Figure { entry, number, record, picture: Picture::read(folder, entry.id)?, beside })
        })
        .collect()
}

/// The figures by the report that they belong to, reports in the order of their first figures.
fn by_report<'a, 'b>(figures: &'b [Figure<'a>]) -> Vec<(&'static str, Vec<&'b Figure<'a>>)> {
    let mut groups: Vec<(&str, Vec<&Figure<'_>>)> = Vec::new();
    for figure in figures {
        let report = figure.entry.answers.split_once(':').map_or("beyond the reports", |(report, _)| report);
        match groups.iter_mut().find(|(name, _)| *name == report) {
            Some((_, group)) => group.push(figure),
            None => groups.push((report, vec![figure])),
        }
    }
    groups
}

fn document(figures: &[Figure<'_>], folder: &Path) -> std::result::Result<String, std::fmt::Error> {
    let mut out = String::from(concat!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n",
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n",
        "<meta name=\"color-scheme\" content=\"light dark\" />\n",
        "<title>etalon: figures and checks</title>\n<link rel=\"icon\" href=\"data:,\" />\n",
        "<style>\n",
        include_str!("page.css"),
        "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the figures</a>\n",
    ));
    let groups = by_report(figures);
    summary(&mut out, figures)?;
    contents(&mut out, figures, &groups)?;
    out.push_str("<main id=\"main\" tabindex=\"-1\">\n");
    errata(&mut out, figures)?;
    for (i, (report, group)) in groups.iter().enumerate() {
        writeln!(out, "<section>\n<h2 id=\"part-{}\">{}</h2>", i + 1, Escaped(&capitalized(report)))?;
        for figure in group {
            figure.html(&mut out, folder)?;
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

fn summary(out: &mut String, figures: &[Figure<'_>]) -> std::fmt::Result {
    let checks: usize = figures.iter().map(|f| f.record.checks.len()).sum();
    let failed: usize = figures.iter().map(Figure::failed).sum();
    let seconds: f64 = figures.iter().map(|f| f.record.seconds).sum();
    let verdict = if failed == 0 { "none" } else { "some" };
    writeln!(
        out,
        "<header>\n<h1>etalon: figures and checks</h1>\n<p>How light is sampled, figure by figure: each with the part of a \
         published report that it answers, the numbers that it must meet, and the command that makes it again.</p>\n\
         <dl class=\"totals\"><div><dt>Figures</dt><dd>{}</dd></div><div><dt>Checks passed</dt><dd class=\"pass\">{}</dd></div>\
         <div><dt>Checks failed</dt><dd class=\"{verdict}\">{failed}</dd></div>\
         <div><dt>Time in all</dt><dd>{}</dd></div></dl>",
        figures.len(),
        checks - failed,
        Seconds(seconds)
    )?;
    if failed > 0 {
        out.push_str("<p class=\"fail\">Checks failed in:");
        for figure in figures.iter().filter(|f| f.failed() > 0) {
            write!(out, " <a href=\"#figure-{0}\">{0}</a>", Escaped(figure.entry.id))?;
        }
        out.push_str("</p>\n");
    }
    let mut setups: BTreeMap<&Setup, usize> = BTreeMap::new();
    for figure in figures {
        *setups.entry(&figure.record.setup).or_default() += 1;
    }
    for (setup, count) in setups {
        writeln!(
            out,
            "<p class=\"fine\">{}: <code>{}</code>, etalon {}, seed {}, map {}; {}, {}, {}, {}</p>",
            counted(count, "figure"),
            Escaped(&join("etalon reproduce", &setup.options)),
            Escaped(&setup.version),
            setup.seed,
            Escaped(&setup.map),
            Escaped(&setup.cpu),
            counted(setup.cores, "core"),
            counted(setup.threads, "thread"),
            Escaped(&setup.system)
        )?;
    }
    out.push_str(
        "<p class=\"fine\">Figures that share a render have its time with the first of them. Large pictures are compressed \
         here; the files beside this page are exact. <a href=\"checks.csv\">checks.csv</a> and <a \
         href=\"reproduce.json\">reproduce.json</a> have all numbers in full.</p>\n</header>\n",
    );
    Ok(())
}

fn contents(out: &mut String, figures: &[Figure<'_>], groups: &[(&'static str, Vec<&Figure<'_>>)]) -> std::fmt::Result {
    out.push_str(concat!(
        "<nav aria-label=\"Figures\">\n<div class=\"tools\" hidden=\"hidden\">",
        "<label>Find <input type=\"search\" id=\"find\" placeholder=\"mirror, fresnel, slope\" /></label>",
        "<label><input type=\"checkbox\" id=\"failed\" /> only failed</label>",
        "<button type=\"button\" id=\"theme\">Dark or light</button>",
        "<p class=\"fine\" id=\"found\" role=\"status\"></p></div>\n",
        "<details open=\"open\"><summary>Contents</summary>\n",
    ));
    if figures.iter().any(|f| !f.record.errata.is_empty()) {
        out.push_str("<p><a href=\"#errata\">Where the reports are wrong</a></p>\n");
    }
    for (i, (report, group)) in groups.iter().enumerate() {
        writeln!(out, "<p><a href=\"#part-{}\">{}</a></p>\n<ul>", i + 1, Escaped(&capitalized(report)))?;
        for figure in group {
            let mark = if figure.failed() > 0 { " <span class=\"fail\">✗ failed</span>" } else { "" };
            writeln!(
                out,
                "<li data-id=\"{0}\"><a href=\"#figure-{0}\">{1}. {0}</a>{mark}</li>",
                Escaped(figure.entry.id),
                figure.number
            )?;
        }
        out.push_str("</ul>\n");
    }
    out.push_str("</details>\n</nav>\n");
    Ok(())
}

fn errata(out: &mut String, figures: &[Figure<'_>]) -> std::fmt::Result {
    if figures.iter().all(|f| f.record.errata.is_empty()) {
        return Ok(());
    }
    out.push_str(concat!(
        "<section>\n<h2 id=\"errata\">Where the reports are wrong</h2>\n<div class=\"wide\" tabindex=\"0\"><table>\n<thead><tr>",
        "<th scope=\"col\">Printed</th><th scope=\"col\">Right</th><th scope=\"col\">Told apart by</th>",
        "<th scope=\"col\">p-value</th><th scope=\"col\">Error in the picture</th><th scope=\"col\">Figure</th>",
        "</tr></thead>\n<tbody>\n",
    ));
    for figure in figures {
        for erratum in &figure.record.errata {
            writeln!(
                out,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td><td>{}</td>\
                 <td><a href=\"#figure-{id}\">{id}</a></td></tr>",
                Escaped(&erratum.printed),
                Escaped(&erratum.right),
                Escaped(&erratum.test),
                p_value(erratum.p_value),
                Escaped(&erratum.picture_error),
                id = Escaped(figure.entry.id)
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
