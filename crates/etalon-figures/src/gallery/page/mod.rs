//! The page that shows all figures: one HTML file that works alone and offline.

mod article;
mod embedded;
mod front;
mod record;
mod tables;

pub use record::{Record, Records, Setup, read_records, without_folder};

use super::figure::Figure;
use crate::figure::escape;
use article::{Article, Shown};
use embedded::EmbeddedImage;
use etalon_core::error::Result;
use etalon_core::files;
use rayon::prelude::*;
use std::path::Path;

pub const FILE: &str = "index.html";

/// Writes the records and the page of those figures in `folder` that have one.
///
/// # Errors
/// When an image is missing or damaged, or a file cannot be written.
pub fn write(folder: &Path, figures: &[Figure], records: &Records) -> Result<()> {
    let shown: Vec<_> = figures.iter().filter_map(|figure| Some((figure, records.get(&figure.id)?))).collect();
    let with_image = |(figure, record): (_, _)| {
        let (figure, record): (&Figure, &Record) = (figure, record);
        // Claims are a table of text
        let has_image = record.claims.is_empty();
        let image = has_image.then(|| EmbeddedImage::read(folder, &figure.id)).transpose()?;
        let further = further_pages(folder, &figure.id).map(|name| EmbeddedImage::read(folder, &name));
        let further = if has_image { further.collect::<Result<Vec<_>>>()? } else { Vec::new() };
        Ok(Shown { figure, record, image, further })
    };
    let shown = shown.into_par_iter().map(with_image).collect::<Result<Vec<_>>>()?;
    record::write_records(folder, records)?;
    files::write_bytes(&folder.join(FILE), document(&shown, folder).as_bytes())
}

/// The names of a figure's pages after the first that a folder has.
pub fn further_pages<'a>(folder: &'a Path, id: &'a str) -> impl Iterator<Item = String> + 'a {
    let is_other = |name: &str| super::registry().iter().any(|figure| figure.id == name);
    let pages = (2..).map(move |page| format!("{id}-{page}"));
    pages.take_while(move |name| folder.join(format!("{name}.svg")).is_file() && !is_other(name))
}

/// The page: what it is, its contents, and the articles by section.
fn document(shown: &[Shown<'_>], folder: &Path) -> String {
    let articles = Article::all(shown);
    let sections: Vec<&[Article<'_>]> = articles.chunk_by(|a, b| a.section() == b.section()).collect();
    let section = |group: &&[Article<'_>]| {
        let articles: String = group.iter().map(|article| article.html(shown, folder)).collect();
        format!("<section>\n<h2>{}</h2>\n{articles}</section>\n", escape(group[0].section()))
    };
    let parts: String = sections.iter().map(section).collect();
    let (style, script, viewer) = (include_str!("page.css"), include_str!("page.js"), include_str!("viewer.html"));
    let (summary, contents, footer) = (front::summary(shown), front::contents(&sections), front::footer(shown));
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
{parts}</main>
{footer}{viewer}<script>
//<![CDATA[
{script}//]]>
</script>
</body>
</html>
"##
    )
}

#[cfg(test)]
mod tests;
