//! One figure on the page: its image, its counterpart, its checks and the commands that reproduce it.

use super::embedded::EmbeddedImage;
use super::record::Record;
use crate::figure::escape;
use crate::gallery::check::Check;
use crate::gallery::figure::Figure;
use crate::view::text::{counted, seconds};
use std::fmt::Write;
use std::path::Path;

/// Formats of a figure's files, in the order of the links.
const FILES: [&str; 7] = ["svg", "png", "pdf", "csv", "exr", "pfm", "ppm"];

pub struct Article<'a> {
    pub figure: &'a Figure,
    /// Its place in the registry, from 1.
    pub number: usize,
    pub record: &'a Record,
    pub image: EmbeddedImage,
    /// Its counterpart for comparison, if that is on the page, too.
    pub beside: Option<&'static str>,
}

impl Article<'_> {
    pub fn failed(&self) -> usize {
        self.record.checks.iter().filter(|c| !c.pass).count()
    }

    pub fn html(&self, out: &mut String, folder: &Path) -> std::fmt::Result {
        let Self { figure, record, image, .. } = self;
        let id = escape(figure.id);
        writeln!(
            out,
            "<article id=\"figure-{id}\" data-id=\"{id}\" data-failed=\"{}\" data-beside=\"{}\">",
            self.failed(),
            escape(self.beside.unwrap_or_default())
        )?;
        writeln!(out, "<h3>{} <code>{id}</code></h3>", escape(&self.heading()))?;
        writeln!(out, "<p>{}</p>", escape(figure.shows))?;
        writeln!(out, "<p class=\"fine\">Counterpart: {}</p>", escape(&figure.counterpart()))?;
        writeln!(
            out,
            "<figure><a class=\"zoom\" href=\"{id}.svg\" data-title=\"{}\"><img src=\"{}\" width=\"{}\" height=\"{}\" \
             data-vector=\"{}\" alt=\"{}\" /></a>",
            escape(&self.heading()),
            image.source,
            image.width,
            image.height,
            image.vector,
            escape(&self.alternative())
        )?;
        out.push_str("<figcaption class=\"fine\">Files beside this page:");
        for extension in FILES.into_iter().filter(|e| folder.join(format!("{}.{e}", figure.id)).exists()) {
            write!(out, " <a href=\"{id}.{extension}\">{}</a>", extension.to_uppercase())?;
        }
        out.push_str("</figcaption></figure>\n");
        if let Some(beside) = self.beside {
            let beside = escape(beside);
            writeln!(out, "<p class=\"beside\">Compare with <a href=\"#figure-{beside}\">{beside}</a></p>")?;
        }
        checks(out, &record.checks)?;
        out.push_str("<div class=\"again\"><p>Reproduce with</p>");
        command(out, &join(&format!("etalon reproduce --only {}", figure.id), &record.setup.options))?;
        if let Some(direct) = &figure.command {
            out.push_str("<p>or, with all options,</p>");
            command(out, &direct.replace("{map}", &record.setup.map))?;
        }
        writeln!(out, "<p class=\"fine\">{} here</p></div>\n</article>", seconds(record.seconds))
    }

    /// Number and title.
    pub fn heading(&self) -> String {
        format!("{}. {}", self.number, self.figure.title)
    }

    fn alternative(&self) -> String {
        let Figure { id, title, shows, .. } = self.figure;
        format!("{title} ({id}). {shows}")
    }
}

/// A command and the flags of the run.
pub fn join(command: &str, options: &str) -> String {
    format!("{command} {options}").trim_end().to_owned()
}

fn command(out: &mut String, text: &str) -> std::fmt::Result {
    writeln!(out, "<pre tabindex=\"0\"><code>{}</code></pre>", escape(text))
}

fn checks(out: &mut String, checks: &[Check]) -> std::fmt::Result {
    if checks.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "<table><caption>{}</caption>\n<thead><tr><th scope=\"col\">Verdict</th><th scope=\"col\">Check</th>\
         <th scope=\"col\">Measured</th><th scope=\"col\">Must be</th></tr></thead>\n<tbody>",
        counted(checks.len(), "check")
    )?;
    for check in checks {
        let (class, verdict) = if check.pass { ("pass", "✓ pass") } else { ("fail", "✗ FAIL") };
        writeln!(
            out,
            "<tr><td class=\"{class}\">{verdict}</td><td>{}</td><td class=\"number\" title=\"{}\">{}</td>\
             <td class=\"number\">{}</td></tr>",
            escape(&check.name),
            check.got,
            escape(&check.measured()),
            escape(&check.demand())
        )?;
    }
    out.push_str("</tbody></table>\n");
    Ok(())
}
