//! `etalon reproduce`: all figures, with their checks.

mod progress;

use super::console::Console;
use super::global::{DEFAULT_SEED, Global, Reports, Verdict, out, seed, threads, verbose};
use super::map_file::{self, MapOptions};
use crate::cli::style::StyleArgs;
use clap::{ArgAction, Args};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_figures::gallery::{self, Effort, Inputs, Originals, Reproduced, Step};
use etalon_figures::output::{self, Written};
use etalon_figures::view::checks::{Check, Checks};
use progress::{Lines, Progress};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Make every figure and check it against the reports' numbers
#[derive(Args)]
#[command(
    after_long_help = "Writes ID.{csv,svg,png,pdf} (and .exr, .pfm, .ppm of renders) into figures/, or into the folder \
                        given with -o, with checks.csv and index.html, a page that shows all figures there, those of \
                        earlier runs (reproduce.json) too. Exit code 1 if a check fails, 3 if interrupted.\n\nExamples:\n  etalon reproduce\n  \
                        etalon reproduce --only sphere-8,sphere-error --envmap grace_latlong.exr\n  \
                        etalon reproduce --only depth-differences,iron --scenes dae/sky"
)]
#[command(next_help_heading = "Figures", args = [out(), seed(), threads(), verbose()])]
pub struct Reproduce {
    /// Smaller images and fewer samples: a quick check of everything
    #[arg(long)]
    quick: bool,
    /// Only these figures
    #[arg(long, value_name = "ID,...", value_delimiter = ',', action = ArgAction::Set)]
    only: Vec<String>,
    /// The environment map to use instead of the built-in nave
    #[arg(long, value_name = "MAP", default_value = DEFAULT_MAP)]
    envmap: OsString,
    #[command(flatten)]
    options: MapOptions,
    /// A folder with the second report's scenes [default: the built-in ones]
    ///
    /// CBspheres.dae, CBdragon_microfacet_au.dae and CBbunny_microfacet_cu.dae.
    #[arg(long, value_name = "FOLDER")]
    scenes: Option<PathBuf>,
    /// Factor of the pixels of PNG files along each side
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    scale: u32,
    /// List the figures and stop
    #[arg(long, conflicts_with_all = ["junit", "markdown", "verbose"])]
    list: bool,
    #[command(flatten)]
    reports: Reports,
    #[command(flatten)]
    style: StyleArgs,
}

#[derive(Serialize)]
struct Output<'a> {
    figures: &'a [Reproduced],
    passed: usize,
    failed: usize,
    skipped: usize,
    interrupted: bool,
    seconds: f64,
}

#[derive(Serialize)]
struct Listed {
    id: &'static str,
    title: &'static str,
    /// The counterpart in a report.
    answers: String,
}

impl Reproduce {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if self.list {
            let figures = gallery::registry();
            let list: Vec<Listed> =
                figures.iter().map(|f| Listed { id: &f.id, title: &f.title, answers: f.counterpart() }).collect();
            console.result(&BTreeMap::from([("figures", &list)]), || {
                list.iter().map(|l| format!("{:<24} {} ({})\n", l.id, l.title, l.answers)).collect()
            });
            return Ok(Verdict::Good);
        }
        let start = Instant::now();
        self.reports.check()?;
        let inputs = self.inputs(global, console)?;
        let folder = global.out.as_deref().unwrap_or(Path::new("figures"));
        Self::check_inputs(folder)?;
        // Times of a former run of the same kind, if there was one in this folder
        let options = self.options(global);
        let records = gallery::page::read_records(folder, gallery::registry())?;
        let seconds = |id: &str| records.get(id).filter(|r| r.setup.options == options).map(|record| record.seconds);
        let ids: Vec<&'static str> = gallery::selected(&self.only)?.iter().map(|figure| figure.id.as_str()).collect();
        let lines = Lines { id: ids.iter().map(|id| id.len()).max().unwrap_or(0), verbose: global.verbose };
        let progress = Progress::new(console, ids, &seconds);
        let made = gallery::reproduce(&inputs, &self.only, folder, &options, &mut |step| match step {
            Step::Begin(figure) => progress.begin(&figure.id),
            Step::Done(figure) => progress.suspend(|| console.part(|| lines.of(figure))),
        })?;
        progress.clear();
        let (figures, interrupted) = (made.figures, made.interrupted);
        if interrupted && figures.is_empty() {
            return Err(Error::Interrupted);
        }
        let count = |pass| figures.iter().flat_map(|f| &f.checks).filter(|c| c.pass == pass).count();
        let [passed, failed, skipped] = [Some(true), Some(false), None].map(count);
        let seconds = start.elapsed().as_secs_f64();
        let reports =
            Written { files: self.reports.write(&checks(&figures, interrupted, seconds))?, ..Written::default() };
        let output = Output { figures: &figures, passed, failed, skipped, interrupted, seconds };
        console.result(&output, || {
            reports.text() + &progress::summary(&figures, interrupted, &folder.join(gallery::page::FILE), seconds)
        });
        Ok(Verdict::of(failed == 0, interrupted))
    }

    /// Refuses inputs that one of the figures in `folder` would replace.
    fn check_inputs(folder: &Path) -> Result<()> {
        gallery::registry().iter().try_for_each(|figure| {
            let stem = folder.join(&figure.id);
            gallery::FORMATS.iter().try_for_each(|format| files::check_no_input(&output::with_extension(&stem, format)))
        })
    }

    /// The flags that reproduce these figures.
    fn options(&self, global: &Global) -> String {
        let scenes = self.scenes.as_deref().unwrap_or(Path::new("")).to_string_lossy();
        let options = [
            (self.quick, "--quick".into()),
            (global.seed != DEFAULT_SEED, format!("--seed {}", global.seed)),
            (self.envmap != DEFAULT_MAP, format!("--envmap {}", quoted(&self.envmap.to_string_lossy()))),
            (self.options.flip, "--flip".into()),
            (self.options.no_flip, "--no-flip".into()),
            (self.options.ldr, "--ldr".into()),
            (self.scenes.is_some(), format!("--scenes {}", quoted(&scenes))),
            (self.scale != 1, format!("--scale {}", self.scale)),
        ];
        let given = options.into_iter().filter(|(given, _)| *given).map(|(_, flag)| flag);
        let style = self.style.flags().into_iter().map(|(flag, value)| format!("{flag} {}", quoted(&value)));
        given.chain(style).collect::<Vec<_>>().join(" ")
    }

    /// Loads the map and the scenes.
    fn inputs(&self, global: &Global, console: &Console) -> Result<Inputs> {
        let map = map_file::load(&self.envmap, self.options, console)?;
        let originals = match &self.scenes {
            Some(folder) => {
                let (originals, warnings) = Originals::read(folder)?;
                warnings.iter().for_each(|warning| console.warn(warning));
                Some(originals)
            }
            None => None,
        };
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        Ok(Inputs { map, originals, seed: global.seed, effort, style: self.style.style()?, scale: self.scale })
    }
}

/// The map that is used when none is named.
const DEFAULT_MAP: &str = "nave";

/// A path quoted for a shell; absolute paths without their folders.
fn quoted(path: &str) -> String {
    let path = gallery::page::without_folder(path);
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@".contains(c);
    if path.chars().all(plain) { path } else { format!("'{}'", path.replace('\'', r"'\''")) }
}

/// The checks of all figures.
fn checks(figures: &[Reproduced], interrupted: bool, seconds: f64) -> Checks {
    let of = |figure: &Reproduced| {
        let check = |check: &gallery::Check| Check {
            group: figure.id.into(),
            name: check.name.clone(),
            verdict: check
                .pass
                .map(|pass| if pass { etalon_stats::Verdict::Accept } else { etalon_stats::Verdict::Reject }),
            message: progress::found(check),
            details: String::new(),
            seconds: None,
        };
        figure.checks.iter().map(check).collect::<Vec<_>>()
    };
    let list = figures.iter().flat_map(of).collect();
    let mut checks = Checks { title: "etalon reproduce".into(), list, seconds };
    if interrupted {
        checks.interrupted("the other figures were not made");
    }
    checks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::CommandFactory;

    #[test]
    fn commands_of_figures_are_commands_of_the_program() {
        for figure in gallery::registry() {
            let Some(command) = &figure.command else { continue };
            let command = command.replace("{map}", "nave");
            let parsed = Cli::command().try_get_matches_from(command.split_whitespace());
            assert!(parsed.is_ok(), "{}: {command}: {}", figure.id, parsed.unwrap_err());
        }
    }
}
