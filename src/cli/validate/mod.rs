//! `etalon validate`: samplers tested against their pdfs.

mod external;
mod planted;

use super::console::Console;
use super::global::{Global, OUTPUT, Reports, Verdict, out, seed, threads};
use super::map_file::{self, MapOptions};
use crate::cli::style::StyleArgs;
use crate::cli::values::share;
use clap::Args;
use etalon_bench::validation::{Tested, Validation, museum, run, select, suite};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_figures::figure::Wanted;
use etalon_figures::output::{self, Saving};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::{validation as view, validation_cells as cells};
use etalon_stats::bsdf::Kind;
use etalon_stats::{Protocol, SampleCount};
use external::{SampleSource, Subject};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Test samplers against their pdfs
#[derive(Args)]
#[command(
    after_long_help = "Writes validation.{csv,svg,png,pdf}, for rejected tests (with --figures: for all) also validation-TEST.{csv,svg,png,pdf}; for a single test, validation-TEST with its figure, and validation-TEST-counts.csv. Exit code 1 if any test is rejected, 3 if none is but some are \
                        inconclusive, or if interrupted.\n\nExamples:\n  etalon validate\n  etalon validate bsdf/ggx 'normals/*/all'\n  \
                        etalon validate map --envmap my.exr --detect 0.01\n  etalon validate warp --figures --junit warp.xml\n  \
                        etalon validate my_sampler.py\n  etalon validate my_bsdf.py formula weights/60\n  etalon validate --exec 'python3 examples/sampler.py' --domain hemisphere\n  \
                        etalon validate --exec 'python3 examples/bsdf.py' --set exponent=100\n  \
                        etalon validate --samples samples.csv --pdf density.exr"
)]
#[command(next_help_heading = "Tests", args = [out(), seed(), threads()])]
pub struct Validate {
    /// Tests, families, patterns with * and ?, or a Python file [default: every test]
    ///
    /// A file FILE.py has a sampler, the functions sample(u) and pdf(w), or a BSDF, sample(wo, u), pdf(wo, wi) and value(wo, wi). Variables
    /// of the file declare more: domain = "square", scatters = "both", eta = 1.5, precision = "single". Names after it, or with --exec, choose
    /// tests of the BSDF: formula, albedo/60.
    #[arg(value_name = "NAME", help_heading = None::<&str>)]
    names: Vec<String>,
    /// List the tests and stop
    #[arg(long, conflicts_with_all = ["junit", "markdown"])]
    list: bool,
    /// Test samplers with a planted fault each, which must be rejected
    ///
    /// NAME and --list then mean planted faults.
    #[arg(long, conflicts_with_all = ["envmap", "figures", "exec"])]
    planted: bool,
    /// Test models of faults of published software, and their fixed twins
    ///
    /// NAME and --list then mean these faults; those that are named are drawn.
    #[arg(long, conflicts_with_all = ["planted", "envmap", "figures", "exec"])]
    museum: bool,
    /// Samples of each test [default: as --detect needs], or a CSV file of them
    ///
    /// A test that rejects may stop before: its result says after how many.
    #[arg(long, value_name = "N|FILE", conflicts_with = "detect", allow_negative_numbers = true)]
    samples: Option<OsString>,
    /// Relative error of a pdf to detect with 90 % probability [default: 2%]
    ///
    /// By default 5% for a phase function and 9% for a light, whose integrals take long. A test that rejects may stop before it has the
    /// samples for that.
    #[arg(long, value_name = "W", value_parser = share, allow_negative_numbers = true)]
    detect: Option<f64>,
    /// Probability that a run of correct samplers rejects any of them
    #[arg(long, value_name = "A", value_parser = share, default_value_t = 0.01, allow_negative_numbers = true)]
    level: f64,
    /// Plot the counts of each test [default: of rejected ones]
    ///
    /// Observed counts, expected counts, and residuals.
    #[arg(long, help_heading = OUTPUT)]
    figures: bool,
    /// Print accepted tests, too, a line for each
    #[arg(short, long, help_heading = OUTPUT)]
    verbose: bool,
    /// Add a map of your own to the tests, as map/NAME
    #[arg(long, value_name = "MAP")]
    envmap: Option<OsString>,
    #[command(flatten)]
    options: MapOptions,
    #[command(flatten)]
    external: external::Arguments,
    #[command(flatten)]
    reports: Reports,
    #[command(flatten)]
    style: StyleArgs,
}

impl Validate {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let draws_nothing = self.planted || self.museum && self.names.is_empty();
        if let (true, Some((flag, _))) = (draws_nothing && !self.list, self.style.flags().first()) {
            return Err(Error::parameter(flag.trim_start_matches('-'), "this run draws no figure")
                .with_hint("`museum` NAME draws that fault"));
        }
        if self.planted {
            let faults = select(planted::all(), &self.names)?;
            if self.list {
                list(&faults.iter().map(|fault| fault.name.to_owned()).collect::<Vec<_>>(), console);
                return Ok(Verdict::Good);
            }
            return planted::run(faults, &self.names, &self.protocol(global, None), &self.reports, global, console);
        }
        if self.museum {
            let exhibits = select(museum::all(), &self.names)?;
            if self.list {
                list(&exhibits.iter().map(|exhibit| exhibit.fault.name.to_owned()).collect::<Vec<_>>(), console);
                return Ok(Verdict::Good);
            }
            let style = self.style.style()?;
            let protocol = self.protocol(global, None);
            return planted::run_museum(exhibits, &self.names, &protocol, &style, &self.reports, global, console);
        }
        let subject = self.subject(console)?;
        if self.list {
            list(&subject.names(), console);
            return Ok(Verdict::Good);
        }
        let kind = if let Subject::Bsdf(bsdf) = &subject { Some(bsdf.kind()) } else { None };
        let protocol = self.protocol(global, kind);
        self.reports.check()?;
        let (target, style) = (global.target(), self.style.style()?);
        let named = subject.name().map(|name| vec![name.to_owned()]);
        let name = output::name_of_run("validation", named.as_ref().unwrap_or(&self.names));
        let stem = target.stem(&name, "", &output::STUDY)?;
        let bar = console.progress(subject.names().len() as u64, "validate", "tests");
        let validation = match &subject {
            Subject::Cases(cases) => run(cases, &protocol, &|_| bar.inc(1)),
            Subject::Bsdf(bsdf) => bsdf.run(&protocol, &|| bar.inc(1)),
        }?;
        bar.finish_and_clear();
        let mut saving = Saving::default();
        let mut wanted = Wanted::of(&style);
        let (drawing, table) = (view::drawing(&validation), view::csv(&validation)?);
        saving.add(output::write(&stem, &drawing, &wanted.style(&drawing), &table));
        // A single test is drawn already; of several what is rejected is drawn without being asked for.
        for tested in &validation.tests {
            let is_rejected = tested.outcome.verdict == etalon_stats::Verdict::Reject;
            match validation.tests.as_slice() {
                [_] => saving.add(write_counts(tested, &name, &target)),
                _ if self.figures || is_rejected => saving.add(draw_counts(tested, &mut wanted, &target)),
                _ => {}
            }
        }
        saving.add(wanted.check().map(|()| Vec::new()));
        saving.add(self.reports.write(&checks(&validation)));
        let (files, saved) = saving.end();
        console.saved(&validation, &target.written(files), || view::text(&validation, self.verbose));
        saved?;
        Ok(match validation {
            Validation { interrupted: true, .. } => Verdict::Inconclusive,
            Validation { rejected: 1.., .. } => Verdict::Rejected,
            Validation { inconclusive: 1.., .. } => Verdict::Inconclusive,
            _ => Verdict::Good,
        })
    }

    fn protocol(&self, global: &Global, kind: Option<&Kind>) -> Protocol {
        let usual = kind.unwrap_or(&Kind::Surface).detectable_error();
        let samples = match self.samples() {
            Some(SampleSource::Count(count)) => SampleCount::Fixed(count),
            _ => SampleCount::Detect(self.detect.unwrap_or(usual)),
        };
        Protocol { seed: global.seed, samples, level: self.level, ..Protocol::default() }
    }

    fn samples(&self) -> Option<SampleSource> {
        self.samples.as_deref().map(SampleSource::from)
    }

    fn subject(&self, console: &Console) -> Result<Subject> {
        if let Some(subject) = self.external.subject(&self.names, self.samples().as_ref(), console)? {
            return Ok(subject);
        }
        let mut all = suite::cases();
        if self.envmap.is_none() {
            self.options.check_unused()?;
        }
        if let Some(name) = &self.envmap {
            let source = map_file::load(name, self.options, console)?;
            all.extend(suite::maps::of_map(&map_file::short_name(name), source.map));
        }
        // A file without the end of its name?
        let file = self.names.iter().map(|name| format!("{name}.py")).find(|file| Path::new(file).is_file());
        let meant = |error: Error| match &file {
            Some(file) => error.with_hint(format!("to test the file, give {file}")),
            None => error,
        };
        select(all, &self.names).map(Subject::Cases).map_err(meant)
    }
}

/// The counts of one test, or the numbers that differ, if it has any.
fn numbers(Tested { outcome, .. }: &Tested) -> Result<Option<Vec<u8>>> {
    match (&outcome.counts, &outcome.compared) {
        (Some(counts), _) => output::csv(&cells::rows(counts)).map(Some),
        (None, Some(compared)) => cells::compared_csv(compared).map(Some),
        (None, None) => Ok(None),
    }
}

/// Writes the numbers of one test, if it has any, and their drawing.
fn draw_counts(tested: &Tested, wanted: &mut Wanted, target: &output::Target) -> Result<Vec<PathBuf>> {
    let Some(table) = numbers(tested)? else { return Ok(Vec::new()) };
    let stem = target.stem("validation", &format!("-{}", output::file_name(&tested.name)), &output::STUDY)?;
    let drawing = cells::drawing(tested);
    output::write(&stem, &drawing, &wanted.style(&drawing), &table)
}

/// Writes the counts of the only test, if it has any.
fn write_counts(tested: &Tested, name: &str, target: &output::Target) -> Result<Vec<PathBuf>> {
    let Some(counts) = &tested.outcome.counts else { return Ok(Vec::new()) };
    let csv = target.file(name, "-counts", "csv")?;
    files::write_bytes(&csv, &output::csv(&cells::rows(counts))?)?;
    Ok(vec![csv])
}

fn checks(validation: &Validation) -> Checks {
    let check = |Tested { name, outcome }: &Tested| {
        let (group, own) = name.rsplit_once('/').unwrap_or(("etalon", name));
        Check {
            group: group.into(),
            name: own.into(),
            verdict: Some(outcome.verdict),
            message: view::found(outcome),
            details: if outcome.is_accepted() { outcome.remarks.join("\n") } else { format!("{name}: {outcome}") },
            seconds: Some(outcome.seconds),
        }
    };
    let checks = validation.tests.iter().map(check).collect();
    Checks { title: "etalon validate".into(), list: checks, seconds: validation.seconds }
}

fn list(tests: &[String], console: &Console) {
    console.result(&BTreeMap::from([("tests", tests)]), || tests.join("\n"));
}
