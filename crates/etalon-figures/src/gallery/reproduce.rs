//! A run of the gallery: makes figures and writes their files, the records and the page.

use super::check::Check;
use super::figure::{Claim, Content, Erratum, Figure, Numbers, Printed};
use super::figures::{self, registry};
use super::inputs::{Inputs, Studies};
use super::page::{self, Record, Records, Setup};
use crate::figure::{FORMATS, Page, write_pages};
use crate::output;
use etalon_core::error::{Error, Result};
use etalon_core::raster::{self, Metadata, WriteOptions};
use etalon_core::{files, interrupt};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A figure that was made. Field names are JSON keys.
#[derive(Debug, Clone, Serialize)]
pub struct Reproduced {
    pub id: &'static str,
    pub files: Vec<PathBuf>,
    /// Wall-clock time; studies that figures share count for the first of them.
    pub seconds: f64,
    pub checks: Vec<Check>,
    pub errata: Vec<Erratum>,
    pub claims: Vec<Claim>,
    pub printed: Vec<Printed>,
    pub numbers: Numbers,
}

pub struct Reproduction {
    pub figures: Vec<Reproduced>,
    /// Whether an interruption ended the run before all figures were made.
    pub interrupted: bool,
}

/// What a run tells while it goes on.
pub enum Step<'a> {
    Begin(&'a Figure),
    /// Its files are written.
    Done(&'a Reproduced),
}

/// The figures of `ids` (all when empty), in the order in which a run makes them.
///
/// # Errors
/// [`Error::Parameter`] for an unknown id.
pub fn selected(ids: &[String]) -> Result<Vec<&'static Figure>> {
    let all = registry();
    if let Some(unknown) = ids.iter().find(|id| all.iter().all(|figure| figure.id != **id)) {
        let known: Vec<_> = all.iter().map(|figure| figure.id.as_str()).collect();
        return Err(Error::parameter("ids", format!("there is no figure \"{unknown}\""))
            .with_hint(format!("figures: {}", known.join(", "))));
    }
    let is_wanted = |figure: &&Figure| ids.is_empty() || ids.contains(&figure.id);
    Ok(all.iter().filter(is_wanted).collect())
}

/// Makes the figures of `ids` (all when empty) in `folder`; `tell` is called before and after each.
///
/// Also writes `checks.csv`, `reproduce.json` and the page `index.html` there. They also cover figures that earlier runs
/// wrote to the folder. `options` are the flags of this run, for the commands on the page. After an interruption,
/// they cover the finished figures.
///
/// # Errors
/// An unknown id, a damaged `reproduce.json`, those of the figures and of writing them.
pub fn reproduce(
    inputs: &Inputs,
    ids: &[String],
    folder: &Path,
    options: &str,
    tell: &mut dyn FnMut(Step<'_>),
) -> Result<Reproduction> {
    let (all, wanted) = (registry(), selected(ids)?);
    // Make the figures one by one; after an interruption, keep those that are finished
    let mut records = page::read_records(folder, all)?;
    let setup = Setup::of(inputs, options);
    let mut studies = Studies::default();
    let (mut done, mut interrupted) = (Vec::new(), false);
    for figure in wanted {
        tell(Step::Begin(figure));
        let made = match make(figure, inputs, &mut studies, folder) {
            Err(Error::Interrupted) => {
                interrupted = true;
                break;
            }
            made => made?,
        };
        tell(Step::Done(&made));
        let Reproduced { seconds, checks, errata, claims, printed, numbers, .. } = made.clone();
        let input = inputs.name_of(figure.input)?;
        records.insert(
            figure.id.clone(),
            Record { seconds, input, checks, errata, claims, printed, numbers, setup: setup.clone() },
        );
        done.push(made);
    }
    // Checks and page of all recorded figures
    if !done.is_empty() {
        files::write_bytes(&folder.join("checks.csv"), &checks_table(all, &records)?)?;
        page::write(folder, all, &records)?;
    }
    Ok(Reproduction { figures: done, interrupted })
}

/// Makes one figure and writes its files.
fn make(figure: &'static Figure, inputs: &Inputs, studies: &mut Studies, folder: &Path) -> Result<Reproduced> {
    interrupt::check()?;
    let start = Instant::now();
    let Content { drawing, table, image, mut checks, errata, claims, printed, numbers } =
        figures::make(figure, inputs, studies)?;
    // Interrupted studies return partial results, which make no figure.
    interrupt::check()?;
    if checks.is_empty() {
        checks.push(Check::is_true("the figure has a check", false));
    }
    let stem = folder.join(&figure.id);
    let mut files = vec![output::write_table(&stem, &table)?];
    let enlarged = |page: Page| Page { scale: page.scale * f64::from(inputs.scale), few_colours: true, ..page };
    if let Some(drawing) = drawing {
        let pages: Vec<Page> = drawing.pages(&inputs.style)?.into_iter().map(enlarged).collect();
        files.extend(write_pages(&pages, &stem, &FORMATS)?);
        // Pages of an earlier run that had more of them
        for name in page::further_pages(folder, &figure.id).skip(pages.len() - 1).collect::<Vec<_>>() {
            for extension in FORMATS {
                let path = output::with_extension(&folder.join(&name), extension);
                match std::fs::remove_file(&path) {
                    Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(Error::io(&path, e)),
                    _ => {}
                }
            }
        }
    }
    // A render as EXR and PFM (linear) and as PPM (tone-mapped as in its report)
    if let Some((image, tone)) = &image {
        let metadata = Metadata::default().with("figure", &figure.id);
        for extension in ["exr", "pfm", "ppm"] {
            let path = output::with_extension(&stem, extension);
            raster::write_with(&path, image, &metadata, WriteOptions { tone: *tone, ..WriteOptions::default() })?;
            files.push(path);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    Ok(Reproduced { id: &figure.id, files, seconds, checks, errata, claims, printed, numbers })
}

/// All checks of all recorded figures, in the order of the registry.
fn checks_table(figures: &'static [Figure], records: &Records) -> Result<Vec<u8>> {
    #[derive(Default, Serialize)]
    struct Of {
        figure: &'static str,
    }
    let recorded = figures.iter().filter_map(|figure| Some((figure.id.as_str(), records.get(&figure.id)?)));
    let rows =
        recorded.flat_map(|(figure, record)| record.checks.iter().map(move |check| (Of { figure }, check.clone())));
    output::csv(&rows.collect::<Vec<_>>())
}
