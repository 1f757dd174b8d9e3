//! The list of all figures, and the run that makes them.

use super::check::Check;
use super::context::Context;
use super::erratum::Erratum;
use super::page::{self, Record, Records, Setup};
use super::{audit_entry, converge_entries, entries, output, second_report, self_test, stability_entries};
use crate::error::{Error, Result};
use crate::figure::Drawing;
use crate::files;
use crate::interrupt;
use crate::raster::{self, Image, Metadata, ToneMap, WriteOptions};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Makes a figure's content.
pub(super) type Make = Box<dyn Fn(&Context) -> Result<Made> + Send + Sync>;

/// Finds the mistakes of a report.
type Audit = Box<dyn Fn(&Context) -> Result<Vec<Erratum>> + Send + Sync>;

/// A figure: what it shows, what it answers, and how it is made.
pub struct Entry {
    pub id: &'static str,
    pub title: &'static str,
    /// Its counterpart: "report: part of it", with the number of the figure where the report gives one.
    pub answers: &'static str,
    /// What is to be seen, in a sentence or two.
    pub shows: &'static str,
    /// The figure that it is best compared with.
    pub beside: Option<&'static str>,
    /// The subcommand that makes the same alone; `{map}` stands for the environment map.
    pub command: Option<&'static str>,
    pub(super) make: Make,
    audit: Option<Audit>,
}

impl Entry {
    pub(super) fn new(id: &'static str, title: &'static str, answers: &'static str, make: Make) -> Self {
        Self { id, title, answers, shows: "", beside: None, command: None, make, audit: None }
    }

    #[must_use]
    pub fn shows(self, shows: &'static str) -> Self {
        Self { shows, ..self }
    }

    #[must_use]
    pub fn beside(self, id: &'static str) -> Self {
        Self { beside: Some(id), ..self }
    }

    #[must_use]
    pub fn command(self, command: &'static str) -> Self {
        Self { command: Some(command), ..self }
    }

    /// Contributes to the list of where the reports are wrong.
    #[must_use]
    pub fn errata(self, audit: impl Fn(&Context) -> Result<Vec<Erratum>> + Send + Sync + 'static) -> Self {
        Self { audit: Some(Box::new(audit)), ..self }
    }
}

/// A figure's content.
pub struct Made {
    pub drawing: Drawing,
    /// CSV text.
    pub table: Vec<u8>,
    /// A rendered image, written as EXR, PFM and PPM beside the drawing.
    pub picture: Option<Picture>,
    pub checks: Vec<Check>,
}

/// A rendered image, and how its PPM shows it.
pub struct Picture {
    pub image: Image,
    pub tone: ToneMap,
}

/// A figure that was made: its JSON form.
#[derive(Debug, Clone, Serialize)]
pub struct Reproduced {
    pub id: &'static str,
    pub files: Vec<PathBuf>,
    pub seconds: f64,
    pub checks: Vec<Check>,
    pub errata: Vec<Erratum>,
}

/// What a run made.
pub struct Reproduction {
    pub figures: Vec<Reproduced>,
    /// Whether the process was asked to stop before all figures were made.
    pub interrupted: bool,
}

/// All figures, in the order in which they are made.
#[must_use]
pub fn registry() -> Vec<Entry> {
    let mut all = entries::all();
    all.extend(second_report::all());
    all.extend(self_test::all());
    all.extend(audit_entry::all());
    all.extend(converge_entries::all());
    all.extend(stability_entries::all());
    all
}

/// Makes the figures of `ids` (all when empty) in `folder`; `before` is called with each figure before it is made.
///
/// Also writes `checks.csv`, `reproduce.json` and the page `index.html` there. They cover what earlier runs left in the
/// folder, too, as far as this run does not make it again. `options` are the flags that make the same again. If the
/// process is asked to stop, they cover the figures that were finished.
///
/// # Errors
/// An unknown id, a damaged `reproduce.json`, those of the figures and of writing them.
pub fn reproduce(
    context: &Context,
    ids: &[String],
    folder: &Path,
    options: &str,
    before: &mut dyn FnMut(&Entry),
) -> Result<Reproduction> {
    let all = registry();
    if let Some(unknown) = ids.iter().find(|id| all.iter().all(|e| e.id != id.as_str())) {
        let known: Vec<_> = all.iter().map(|e| e.id).collect();
        return Err(Error::parameter("ids", format!("there is no figure \"{unknown}\""))
            .with_hint(format!("figures: {}", known.join(", "))));
    }
    let mut records = page::read_records(folder, &all)?;
    let setup = Setup::of(context, options);
    let (mut done, mut interrupted) = (Vec::new(), false);
    for entry in all.iter().filter(|e| ids.is_empty() || ids.iter().any(|id| id == e.id)) {
        before(entry);
        let figure = match figure(entry, context, folder) {
            Err(Error::Interrupted) => {
                interrupted = true;
                break;
            }
            figure => figure?,
        };
        let Reproduced { seconds, ref checks, ref errata, .. } = figure;
        let record = Record { seconds, checks: checks.clone(), errata: errata.clone(), setup: setup.clone() };
        records.insert(entry.id.to_owned(), record);
        done.push(figure);
    }
    if !done.is_empty() {
        files::write_bytes(&folder.join("checks.csv"), &checks_table(&all, &records)?)?;
        page::write(folder, &all, &records)?;
    }
    Ok(Reproduction { figures: done, interrupted })
}

/// Makes one figure and writes its files.
fn figure(entry: &Entry, context: &Context, folder: &Path) -> Result<Reproduced> {
    interrupt::check()?;
    let start = Instant::now();
    let made = (entry.make)(context)?;
    let errata = entry.audit.as_ref().map_or_else(|| Ok(Vec::new()), |audit| audit(context))?;
    // Studies that were cut short return what they have: that is no figure.
    interrupt::check()?;
    let stem = folder.join(entry.id);
    let mut files = output::write(&stem, &made.drawing, &made.table)?;
    if let Some(picture) = &made.picture {
        files.extend(write_picture(&stem, picture, &Metadata::default().with("figure", entry.id))?);
    }
    Ok(Reproduced { id: entry.id, files, seconds: start.elapsed().as_secs_f64(), checks: made.checks, errata })
}

/// Writes a picture as EXR and PFM (as it is) and as the PPM of its report.
fn write_picture(stem: &Path, picture: &Picture, metadata: &Metadata) -> Result<Vec<PathBuf>> {
    let options = WriteOptions { tone: picture.tone, ..WriteOptions::default() };
    ["exr", "pfm", "ppm"]
        .into_iter()
        .map(|extension| {
            let path = output::with_extension(stem, extension);
            raster::write_with(&path, &picture.image, metadata, options)?;
            Ok(path)
        })
        .collect()
}

fn checks_table(entries: &[Entry], records: &Records) -> Result<Vec<u8>> {
    #[derive(Default, Serialize)]
    struct Row<'a> {
        figure: &'a str,
        name: &'a str,
        expected: f64,
        got: f64,
        tolerance: f64,
        pass: bool,
    }
    let rows: Vec<Row<'_>> = entries
        .iter()
        .filter_map(|entry| Some((entry.id, records.get(entry.id)?)))
        .flat_map(|(id, record)| {
            record.checks.iter().map(move |c| Row {
                figure: id,
                name: &c.name,
                expected: c.expected,
                got: c.got,
                tolerance: c.tolerance,
                pass: c.pass,
            })
        })
        .collect();
    output::table(&rows)
}
