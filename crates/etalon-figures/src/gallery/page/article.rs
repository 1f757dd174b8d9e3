//! One figure on the page: its image, what it says, its counterpart, its checks and the commands that reproduce it.

use super::embedded::EmbeddedImage;
use super::record::Record;
use crate::figure::escape;
use crate::gallery::check::Check;
use crate::gallery::figure::{Erratum, FORMATS, Figure, Printed};
use crate::view::text::{counted, duration};
use etalon_bench::table::Table;
use std::path::Path;

pub struct Article<'a> {
    pub figure: &'a Figure,
    /// Its place on the page, from 1.
    pub number: usize,
    pub record: &'a Record,
    pub image: EmbeddedImage,
}

impl EmbeddedImage {
    /// Its class in the style sheet.
    fn kind(&self) -> &'static str {
        if self.chart { "chart" } else { "picture" }
    }

    /// The class of its thumbnail: a chart that has images must not be inverted on a dark page.
    pub fn thumbnail_kind(&self) -> &'static str {
        match self.source.matches("data:image/").count() {
            1 if self.chart => "plain",
            _ if self.chart => "mixed",
            _ => "picture",
        }
    }
}

impl Article<'_> {
    /// The number of failed checks.
    pub fn failed(&self) -> usize {
        self.record.checks.iter().filter(|c| c.failed()).count()
    }

    /// The figure as HTML that is well-formed XML.
    pub fn html(&self, folder: &Path) -> String {
        let EmbeddedImage { source, width, height, .. } = &self.image;
        let Figure { title, shows, matters, .. } = self.figure;
        let (id, number, failed, kind) = (escape(&self.figure.id), self.number, self.failed(), self.image.kind());
        let input = &self.record.input;
        let shows = &if input.is_empty() { shows.clone() } else { format!("{shows} Made with {input}.") };
        let [title, shows, matters, alternative] =
            [title, shows, matters, &format!("{title} ({id}). {shows}")].map(|text| escape(text));
        let (beside, render) =
            (self.figure.beside.as_deref().unwrap_or_default(), folder.join(format!("{id}.exr")).exists());
        let there = FORMATS.into_iter().filter(|e| folder.join(format!("{id}.{e}")).exists());
        let files: String = there.map(|e| format!(r#" <a href="{id}.{e}">{}</a>"#, e.to_uppercase())).collect();
        let panels: String = self.record.errata.iter().filter_map(|erratum| panel(&id, erratum)).collect();
        let (printed, citation, checks) = (printed(&self.record.printed), self.citation(), checks(&self.record.checks));
        let commands = self.commands();
        format!(
            r##"<article id="figure-{id}" data-id="{id}" data-failed="{failed}" data-beside="{beside}" data-render="{render}">
<h3><span class="fine">{number}</span> {title} <a class="permalink" href="#figure-{id}" aria-label="Link to figure {number}">#</a></h3>
<p>{shows}</p>
<p class="matters">{matters}</p>
<figure class="{kind}"><div class="scroll"><a class="zoom" href="{id}.svg" data-title="{number}. {title}" style="--width:{width}px">
<img src="{source}" width="{width}" height="{height}" alt="{alternative}" decoding="async" />{panels}</a></div>
<figcaption class="fine"><span class="hint">Scroll sideways, or tap to enlarge. </span>Download, from beside this page:{files}</figcaption></figure>
{printed}{citation}{checks}{commands}</article>
"##
        )
    }

    /// The counterpart in a report, and the papers.
    fn citation(&self) -> String {
        let Figure { report, reproduces, papers, .. } = self.figure;
        let counterpart = match report.citations() {
            [] => String::new(),
            [one] => format!("<p>{}: {}.</p>\n", escape(one.trim_end_matches('.')), escape(reproduces)),
            all => format!("<p>{} In them: {}.</p>\n", escape(&all.join(" ")), escape(reproduces)),
        };
        let papers: String = papers.iter().map(|paper| format!("<p>{}.</p>\n", escape(paper))).collect();
        if counterpart.is_empty() && papers.is_empty() {
            return String::new();
        }
        format!("<div class=\"sources fine\">\n{counterpart}{papers}</div>\n")
    }

    fn commands(&self) -> String {
        let setup = &self.record.setup;
        let again = command(&join(&format!("etalon reproduce --only {}", escape(&self.figure.id)), &setup.options));
        let direct = self.figure.command.as_ref().map_or_else(String::new, |direct| {
            format!("<p>or, with all options,</p>{}", command(&direct.replace("{map}", &setup.map)))
        });
        let time = duration(self.record.seconds);
        format!(
            "<details class=\"again\"><summary>Reproduce it</summary>{again}{direct}<p class=\"fine\">took {time} when this page was made</p>\
             </details>\n"
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

/// Where links to a panel of the figure lead.
fn panel(id: &str, erratum: &Erratum) -> Option<String> {
    let place = erratum.place.as_ref()?;
    let [left, top, width, height] = place.share.map(|share| 100.0 * share);
    Some(format!(
        "<span class=\"target\" id=\"{id}-{}\" style=\"left:{left:.2}%;top:{top:.2}%;width:{width:.2}%;height:{height:.2}%\">\
         </span>",
        place.panel
    ))
}

/// The report's numbers beside ours.
fn printed(printed: &[Printed]) -> String {
    if printed.is_empty() {
        return String::new();
    }
    Table::of(printed)
        .words("Quantity", |number| escape(&number.quantity))
        .numbers("The report prints", |number| escape(&number.report))
        .numbers("Computed here", |number| escape(&number.ours))
        .html("cards printed")
}

/// All checks, closed unless one has failed.
fn checks(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
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
        .numbers("Must be", |check| escape(&check.demand()))
        .html("cards");
    let failed = checks.iter().filter(|check| check.failed()).count();
    let skipped = checks.iter().filter(|check| check.pass.is_none()).count();
    let left_out = if skipped > 0 { format!(", {skipped} skipped") } else { String::new() };
    let (open, class, outcome) = match failed {
        0 if skipped == checks.len() => ("", "fine", "none was made".to_owned()),
        0 => ("", "pass", format!("✓ passed{left_out}")),
        failed => (" open=\"open\"", "fail", format!("✗ {failed} FAILED{left_out}")),
    };
    format!(
        "<details class=\"checks\"{open}><summary>{}, <span class=\"{class}\">{outcome}</span></summary>\n{table}</details>\n",
        counted(checks.len(), "check")
    )
}
