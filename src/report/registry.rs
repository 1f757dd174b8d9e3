//! The list of all figures, and the run that makes them.

use super::check::Check;
use super::context::Context;
use super::{entries, output, second_report, self_test};
use crate::error::{Error, Result};
use crate::figure::Drawing;
use crate::files;
use crate::raster::{self, Image, Metadata, ToneMap, WriteOptions};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Makes a figure's content.
pub(super) type Make = Box<dyn Fn(&Context) -> Result<Made> + Send + Sync>;

/// A figure: what it shows, what it answers, and how it is made.
pub struct Entry {
    pub id: &'static str,
    pub title: &'static str,
    /// The part of a report that it reproduces.
    pub answers: &'static str,
    pub(super) make: Make,
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
}

/// All figures, in the order in which they are made.
#[must_use]
pub fn registry() -> Vec<Entry> {
    let mut all = entries::all();
    all.extend(second_report::all());
    all.extend(self_test::all());
    all
}

/// Makes the figures of `ids` (all when empty) in `folder`; `before` is called with each figure before it is made.
///
/// Also writes `checks.csv` there.
pub fn reproduce(
    context: &Context,
    ids: &[String],
    folder: &Path,
    before: &mut dyn FnMut(&Entry),
) -> Result<Vec<Reproduced>> {
    let all = registry();
    if let Some(unknown) = ids.iter().find(|id| all.iter().all(|e| e.id != id.as_str())) {
        let known: Vec<_> = all.iter().map(|e| e.id).collect();
        return Err(Error::parameter("--only", format!("there is no figure \"{unknown}\""))
            .with_hint(format!("figures: {}", known.join(", "))));
    }
    let mut done = Vec::new();
    for entry in all.iter().filter(|e| ids.is_empty() || ids.iter().any(|id| id == e.id)) {
        before(entry);
        let start = Instant::now();
        let made = (entry.make)(context)?;
        let stem = folder.join(entry.id);
        let mut paths = output::write(&stem, &made.drawing, &made.table)?;
        if let Some(picture) = &made.picture {
            paths.extend(write_picture(&stem, picture, &Metadata::default().with("figure", entry.id))?);
        }
        done.push(Reproduced {
            id: entry.id,
            files: paths,
            seconds: start.elapsed().as_secs_f64(),
            checks: made.checks,
        });
    }
    files::write_bytes(&folder.join("checks.csv"), &checks_table(&done)?)?;
    Ok(done)
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

fn checks_table(figures: &[Reproduced]) -> Result<Vec<u8>> {
    #[derive(Default, Serialize)]
    struct Row<'a> {
        figure: &'a str,
        name: &'a str,
        expected: f64,
        got: f64,
        tolerance: f64,
        pass: bool,
    }
    let rows: Vec<Row<'_>> = figures
        .iter()
        .flat_map(|f| {
            f.checks.iter().map(|c| Row {
                figure: f.id,
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
