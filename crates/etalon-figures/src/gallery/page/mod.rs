//! The page that shows all figures: one HTML file that works alone and offline.

mod article;
mod embedded;
mod front;
mod record;

pub use record::{Record, Records, Setup, read_records, without_folder};

use super::figure::Figure;
use crate::figure::escape;
use article::Article;
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
    let articles = articles(folder, figures, records)?;
    record::write_records(folder, records)?;
    files::write_bytes(&folder.join(FILE), document(&articles, folder).as_bytes())
}

fn articles<'a>(folder: &Path, figures: &'a [Figure], records: &'a Records) -> Result<Vec<Article<'a>>> {
    let shown: Vec<_> = figures.iter().filter_map(|figure| Some((figure, records.get(&figure.id)?))).collect();
    shown
        .into_par_iter()
        .enumerate()
        .map(|(i, (figure, record))| {
            Ok(Article { figure, number: i + 1, record, image: EmbeddedImage::read(folder, &figure.id)? })
        })
        .collect()
}

/// The page: summary, contents, thumbnails, errors and claims of the reports, and the articles by section.
fn document(articles: &[Article<'_>], folder: &Path) -> String {
    let sections: Vec<&[Article<'_>]> = articles.chunk_by(|a, b| a.figure.section == b.figure.section).collect();
    let section = |(i, group): (usize, &&[Article<'_>])| {
        let (number, name) = (i + 1, escape(&group[0].figure.section));
        let articles: String = group.iter().map(|article| article.html(folder)).collect();
        format!("<section>\n<h2 id=\"part-{number}\">{name}</h2>\n{articles}</section>\n")
    };
    let parts: String = sections.iter().enumerate().map(section).collect();
    let (style, script) = (include_str!("page.css"), include_str!("page.js"));
    let (summary, contents) = (front::summary(articles), front::contents(articles, &sections));
    let (thumbnails, footer) = (front::thumbnails(&sections), front::footer(articles));
    let (errata, claims) = (front::errata(articles), front::claims(articles));
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
{thumbnails}{errata}{claims}{parts}</main>
{footer}<dialog aria-label="Enlarged figure"></dialog>
<script>
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
