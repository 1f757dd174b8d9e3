//! An article of the page: a figure, or a group of figures that share one place, where a slider goes through them.

use super::embedded::EmbeddedImage;
use super::record::Record;
use super::tables;
use crate::figure::escape;
use crate::gallery::figure::{Erratum, FORMATS, Figure};
use crate::view::text::{counted, duration};
use std::path::Path;

/// A figure with what a run has recorded of it.
pub struct Shown<'a> {
    pub figure: &'a Figure,
    pub record: &'a Record,
    pub image: Option<EmbeddedImage>,
    /// The images of its further pages, as of slides.
    pub further: Vec<EmbeddedImage>,
}

pub struct Article<'a> {
    /// Its place on the page, from 1.
    pub number: usize,
    /// One figure, or those of a group in the order of the slider.
    pub figures: &'a [Shown<'a>],
}

impl<'a> Article<'a> {
    /// Figures of one group are one article.
    pub fn all(shown: &'a [Shown<'a>]) -> Vec<Self> {
        let groups = shown.chunk_by(|a, b| a.figure.group.is_some() && a.figure.group == b.figure.group);
        groups.enumerate().map(|(i, figures)| Self { number: i + 1, figures }).collect()
    }

    /// The figure that is seen first, and as a thumbnail: the middle one of a group.
    pub fn first(&self) -> &Shown<'a> {
        &self.figures[self.middle()]
    }

    fn middle(&self) -> usize {
        (self.figures.len() - 1) / 2
    }

    pub fn section(&self) -> &'a str {
        &self.figures[0].figure.section
    }

    pub fn title(&self) -> &'a str {
        match (self.figures, &self.figures[0].figure.group) {
            ([_, _, ..], Some(group)) => &group.title,
            ([one, ..], _) => &one.figure.title,
            ([], _) => "",
        }
    }

    pub fn failed(&self) -> usize {
        self.figures.iter().map(Shown::failed).sum()
    }

    /// The article as HTML that is well-formed XML; `all` are the figures of the page, `folder` has their files.
    pub fn html(&self, all: &[Shown<'_>], folder: &Path) -> String {
        let (number, title, failed) = (self.number, escape(self.title()), self.failed());
        let (id, slider) = match (self.figures, &self.figures[0].figure.group) {
            ([_, _, ..], Some(group)) => (format!(" id=\"figure-{}\"", group.id), self.slider(&group.varies)),
            _ => Default::default(),
        };
        let mut before = String::new();
        let figures: String = self.figures.iter().map(|shown| shown.html(self, &mut before, all, folder)).collect();
        format!(
            "<article{id} data-failed=\"{failed}\">\n<h3><span class=\"fine\">{number}</span> {title}</h3>\n{slider}{figures}</article>\n"
        )
    }

    /// The slider, which the script shows.
    fn slider(&self, varies: &str) -> String {
        let label = |shown: &Shown<'_>| format!("<span>{}</span>", escape(&shown.figure.at));
        let labels: String = self.figures.iter().map(label).collect();
        let (count, varies) = (self.figures.len(), escape(varies));
        format!(
            "<div class=\"slider\" hidden=\"hidden\" style=\"--count:{count}\"><label>{varies}\n\
             <input type=\"range\" min=\"0\" max=\"{}\" value=\"{}\" /></label><p aria-hidden=\"true\">{labels}</p></div>\n",
            count - 1,
            self.middle()
        )
    }
}

impl Shown<'_> {
    pub fn failed(&self) -> usize {
        self.record.checks.iter().filter(|c| c.failed()).count()
    }

    /// `before` has the texts of the figure before, which a list need not repeat.
    fn html(&self, article: &Article<'_>, before: &mut String, all: &[Shown<'_>], folder: &Path) -> String {
        let Figure { id, title, shows, matters, beside, .. } = self.figure;
        let (id, title, beside) = (escape(id), escape(title), beside.as_deref().unwrap_or_default());
        let input = &self.record.input;
        let made = if input.is_empty() { String::new() } else { format!(" Made with {input}.") };
        let texts =
            format!("<p>{}{}</p>\n<p class=\"matters\">{}</p>\n", escape(shows), escape(&made), escape(matters));
        let repeated = if *before == texts { " repeated" } else { "" };
        let heading = if article.figures.len() > 1 { format!("<h4>{title}</h4>\n") } else { String::new() };
        let heading_of = |page: &str| format!("{}. {title}{page}", article.number);
        let (picture, about) = (self.picture(&id, self.image.as_ref(), &heading_of("")), self.about(folder));
        let further = self.further.iter().zip(2..).map(|(image, page)| {
            let own = format!("{id}-{page}");
            let picture = self.picture(&own, Some(image), &heading_of(&format!(", page {page}")));
            format!("<div class=\"figure\" id=\"figure-{own}\" data-id=\"{own}\" data-of=\"{id}\">\n{picture}</div>\n")
        });
        let further: String = further.collect();
        let Record { claims, errata, numbers, .. } = self.record;
        let tables = [tables::claims(claims, all), tables::errata(&id, errata), tables::numbers(numbers)].concat();
        before.clone_from(&texts);
        format!(
            "<div class=\"figure\" id=\"figure-{id}\" data-id=\"{id}\" data-beside=\"{beside}\">\n{heading}{picture}\
             <div class=\"text{repeated}\">\n{texts}</div>\n{tables}{about}</div>\n{further}"
        )
    }

    /// The image, which leads to the file called `id`.
    fn picture(&self, id: &str, image: Option<&EmbeddedImage>, heading: &str) -> String {
        let Some(EmbeddedImage { source, width, height, chart, map, .. }) = image else { return String::new() };
        let Figure { title, shows, .. } = self.figure;
        let kind = match (chart, map) {
            (true, true) => "chart map",
            (true, false) => "chart",
            (false, true) => "picture map",
            (false, false) => "picture",
        };
        let alternative = escape(&format!("{title} ({id}). {shows}"));
        // Places of errata are those of the first page
        let errata = self.record.errata.iter().filter(|_| id == escape(&self.figure.id));
        let panels: String = errata.filter_map(|erratum| panel(id, erratum)).collect();
        format!(
            "<figure class=\"{kind}\"><a class=\"zoom\" href=\"{id}.svg\" data-title=\"{heading}\">\n\
             <img src=\"{source}\" width=\"{width}\" height=\"{height}\" alt=\"{alternative}\" decoding=\"async\" />{panels}</a></figure>\n"
        )
    }

    /// Checks, numbers, sources, files and commands; open if a check has failed.
    fn about(&self, folder: &Path) -> String {
        let checks = &self.record.checks;
        let skipped = checks.iter().filter(|check| check.pass.is_none()).count();
        let left_out = if skipped > 0 { format!(", {skipped} skipped") } else { String::new() };
        let (open, class, outcome) = match self.failed() {
            0 if skipped == checks.len() => ("", "fine", "none was made".to_owned()),
            0 => ("", "pass", format!("✓ passed{left_out}")),
            failed => (" open=\"open\"", "fail", format!("✗ {failed} FAILED{left_out}")),
        };
        let id = escape(&self.figure.id);
        let formats = if self.image.is_some() { &FORMATS[..] } else { &FORMATS[..1] };
        let there = formats.iter().filter(|e| folder.join(format!("{id}.{e}")).exists());
        let files: String = there.map(|e| format!(" <a href=\"{id}.{e}\">{}</a>", e.to_uppercase())).collect();
        let (count, table) = (counted(checks.len(), "check"), tables::checks(checks));
        let (printed, citation, commands) = (tables::printed(&self.record.printed), self.citation(), self.commands());
        format!(
            "<details class=\"about\"{open}><summary>{count}, <span class=\"{class}\">{outcome}</span>; sources, files, commands</summary>\n\
             {citation}{printed}{table}{commands}<p class=\"fine\">Files beside this page:{files}. \
             <a href=\"#figure-{id}\">Link to this figure</a></p>\n</details>\n"
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
        format!("<div class=\"sources fine\">\n{counterpart}{papers}</div>\n")
    }

    fn commands(&self) -> String {
        let setup = &self.record.setup;
        let again = command(&join(&format!("etalon reproduce --only {}", self.figure.id), &setup.options));
        let direct = self.figure.command.as_ref().map_or_else(String::new, |direct| {
            format!("<p class=\"fine\">or, with all options,</p>{}", command(&direct.replace("{map}", &setup.map)))
        });
        let time = duration(self.record.seconds);
        format!("{again}{direct}<p class=\"fine\">Made in {time}.</p>\n")
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
