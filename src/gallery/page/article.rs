//! One figure on the page: its image, its counterpart, its checks and the commands that reproduce it.

use super::embedded::EmbeddedImage;
use super::record::Record;
use crate::figure::escape;
use crate::gallery::check::Check;
use crate::gallery::figure::Figure;
use crate::view::text::{counted, seconds};
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
    /// The number of failed checks.
    pub fn failed(&self) -> usize {
        self.record.checks.iter().filter(|c| !c.pass).count()
    }

    /// The figure as HTML that is well-formed XML.
    pub fn html(&self, folder: &Path) -> String {
        let EmbeddedImage { source, width, height, vector } = &self.image;
        let Figure { title, shows, command: direct, .. } = self.figure;
        let Record { checks, setup, seconds: time, .. } = self.record;
        let (id, failed, beside) = (escape(self.figure.id), self.failed(), self.beside.unwrap_or_default());
        let [heading, shows, counterpart, alternative] = [
            &format!("{}. {title}", self.number),
            *shows,
            &self.figure.counterpart(),
            &format!("{title} ({id}). {shows}"),
        ]
        .map(escape);
        let there = FILES.into_iter().filter(|e| folder.join(format!("{id}.{e}")).exists());
        let files: String = there.map(|e| format!(r#" <a href="{id}.{e}">{}</a>"#, e.to_uppercase())).collect();
        let compare = self.beside.map_or_else(String::new, |beside| {
            format!("<p class=\"beside\">Compare with <a href=\"#figure-{beside}\">{beside}</a></p>\n")
        });
        let again = command(&join(&format!("etalon reproduce --only {id}"), &setup.options));
        let direct = direct.as_ref().map_or_else(String::new, |direct| {
            format!("<p>or, with all options,</p>{}", command(&direct.replace("{map}", &setup.map)))
        });
        let (table, time) = (table(checks), seconds(*time));
        format!(
            r##"<article id="figure-{id}" data-id="{id}" data-failed="{failed}" data-beside="{beside}">
<h3>{heading} <code>{id}</code></h3>
<p>{shows}</p>
<p class="fine">Counterpart: {counterpart}</p>
<figure><a class="zoom" href="{id}.svg" data-title="{heading}"><img src="{source}" width="{width}"
height="{height}" data-vector="{vector}" alt="{alternative}" /></a>
<figcaption class="fine">Files beside this page:{files}</figcaption></figure>
{compare}{table}<div class="again"><p>Reproduce with</p>{again}{direct}<p class="fine">{time} here</p></div>
</article>
"##
        )
    }
}

/// A command and the flags of the run.
pub fn join(command: &str, options: &str) -> String {
    format!("{command} {options}").trim_end().to_owned()
}

fn command(text: &str) -> String {
    format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escape(text))
}

fn table(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
    let row = |check: &Check| {
        let (class, verdict) = if check.pass { ("pass", "✓ pass") } else { ("fail", "✗ FAIL") };
        let [name, measured, demand] = [&check.name, &check.measured(), &check.demand()].map(|text| escape(text));
        let number =
            format!(r#"<td class="number" title="{}">{measured}</td><td class="number">{demand}</td>"#, check.got);
        format!("<tr><td class=\"{class}\">{verdict}</td><td>{name}</td>{number}</tr>\n")
    };
    let (count, rows) = (counted(checks.len(), "check"), checks.iter().map(row).collect::<String>());
    format!(
        r#"<table><caption>{count}</caption>
<thead><tr><th scope="col">Verdict</th><th scope="col">Check</th><th scope="col">Measured</th>
<th scope="col">Must be</th></tr></thead>
<tbody>
{rows}</tbody></table>
"#
    )
}
