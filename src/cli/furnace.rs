//! `etalon furnace`: directional albedos over the angle and parameters.

use super::console::Console;
use super::families::{ExternalBsdf, families, list};
use super::global::{Global, Reports, Verdict, out, seed, threads};
use super::style::StyleArgs;
use super::values::setting;
use clap::{ArgAction, Args};
use etalon_bench::albedo::{Request, SAMPLES_OF_PROGRAMS, Table, albedo_table};
use etalon_bench::validation::families;
use etalon_core::error::{Error, Result};
use etalon_figures::output;
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::furnace as view;
use etalon_stats::bsdf::Family;
use std::collections::BTreeMap;
use std::time::Instant;

/// Tabulate the directional albedo of BSDFs over angle and parameters: the furnace test with numbers
#[derive(Args)]
#[command(
    after_long_help = "The directional albedo is the radiance of a surface over that of uniform light from everywhere; above 1 the BSDF \
                  creates energy. Writes furnace-NAME.{csv,svg,png,pdf}. Exit code 1 if a BSDF contradicts what it declares or the weak furnace test fails, 3 if errors \
                  are larger than asked for.\n\nExamples:\n  etalon furnace ggx\n  etalon furnace ggx \
                  --over k --set alpha_x=0.5,alpha_y=0.5\n  etalon furnace my_bsdf.py\n  etalon furnace --exec 'python3 examples/bsdf.py'"
)]
#[command(next_help_heading = "BSDFs", args = [out(), seed(), threads()])]
pub struct Furnace {
    /// BSDFs (see --list), or a Python file with sample, pdf and value
    #[arg(value_name = "NAME", help_heading = None::<&str>, required_unless_present_any = ["list", "exec"])]
    names: Vec<String>,
    /// List the BSDFs with their parameters and stop
    #[arg(long, conflicts_with_all = ["junit", "markdown"])]
    list: bool,
    /// The parameter that varies, or several together [default: the first]
    ///
    /// The first varies with NAME_y if it is NAME_x.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', action = ArgAction::Set)]
    over: Vec<String>,
    /// Values of parameters that do not vary [default: see --list]
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',', action = ArgAction::Set, value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Angles, and values of the parameter [default: 32x32; of a program 16x16]
    #[arg(long, value_name = "ANGLESxVALUES")]
    size: Option<String>,
    /// Largest error of an albedo [default: 0.0001; of a program 0.01]
    ///
    /// By default a program is asked for 2 million samples in all (half a minute in plain Python); albedos whose errors are still larger make
    /// the result inconclusive. With --error, each albedo takes as many samples as it needs, up to 4 million.
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    error: Option<f64>,
    #[command(flatten)]
    external: ExternalBsdf,
    #[command(flatten)]
    style: StyleArgs,
    #[command(flatten)]
    reports: Reports,
}

impl Furnace {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if self.list {
            list(&families(&self.external, &self.names)?, console);
            return Ok(Verdict::Good);
        }
        let start = Instant::now();
        self.reports.check()?;
        let all = families::all();
        let program = self.external.start(&self.names)?;
        let cells = cells(self.size.as_deref().unwrap_or(if program.is_some() { "16x16" } else { "32x32" }))?;
        let error = self.error.unwrap_or(if program.is_some() { 0.01 } else { 1e-4 });
        let samples = Some(SAMPLES_OF_PROGRAMS).filter(|_| program.is_some() && self.error.is_none());
        let request =
            Request { over: self.over.clone(), set: self.set.clone(), cells, error, samples, seed: global.seed };
        // A program's BSDFs, or ours with what is known of their microfacets.
        let subjects: Vec<(&dyn Family, Option<&families::Family>)> = match &program {
            Some(program) => vec![(program, None)],
            None => {
                let own = self.names.iter().map(|name| find(&all, name).map(|own| (own as &dyn Family, Some(own))));
                own.collect::<Result<_>>()?
            }
        };
        let (target, style) = (global.target(), self.style.style()?);
        let (mut tables, mut files, mut left_out) = (Vec::new(), Vec::new(), 0);
        for (family, own) in &subjects {
            let stem = target.stem("furnace", &format!("-{}", output::file_name(family.name())), &output::STUDY)?;
            let bar = console.progress(1, &format!("furnace {}", family.name()), "albedos");
            let facets = |values: &[f64]| own.and_then(|own| own.facets(values));
            let done = |of: u64| {
                bar.set_length(of);
                bar.inc(1);
            };
            match albedo_table(*family, &facets, &request, &done) {
                // The tables before an interruption are told
                Err(Error::Interrupted) if !tables.is_empty() => {
                    left_out = subjects.len() - tables.len();
                    break;
                }
                table => tables.push(table?),
            }
            let table = &tables[tables.len() - 1];
            files.extend(output::write(&stem, &view::drawing(table), &style, &output::csv(&table.rows)?)?);
        }
        let mut checks = Checks {
            title: "etalon furnace".into(),
            list: tables.iter().map(check).collect(),
            seconds: start.elapsed().as_secs_f64(),
        };
        if left_out > 0 {
            let left_out = format!("{} of {} BSDFs left out", left_out, subjects.len());
            console.warn(&format!("interrupted: {left_out}"));
            checks.interrupted(&left_out);
        }
        files.extend(self.reports.write(&checks)?);
        let written = target.written(files);
        console.saved(&BTreeMap::from([("tables", &tables)]), &written, || tables.iter().map(view::text).collect());
        Ok(match Verdict::from(&checks) {
            Verdict::Inconclusive if samples.is_some() => {
                console.note(&format!("for more samples: --error {error}"));
                Verdict::Inconclusive
            }
            verdict => verdict,
        })
    }
}

fn cells(size: &str) -> Result<[usize; 2]> {
    let parsed = size.split_once(['x', 'X']).and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    parsed.ok_or_else(|| Error::parameter("size", format!("\"{size}\" is no size")).with_hint("use 32x32"))
}

/// Whether the albedos of a BSDF are what it declares, within errors that are small enough.
fn check(table: &Table) -> Check {
    Check {
        group: "furnace".into(),
        name: table.family.clone(),
        verdict: Some(table.verdict()),
        message: view::found(table),
        details: String::new(),
        seconds: Some(table.seconds),
    }
}

fn find<'a>(all: &'a [families::Family], name: &str) -> Result<&'a families::Family> {
    all.iter()
        .find(|family| Family::name(*family) == name)
        .ok_or_else(|| Error::parameter("names", format!("there is no BSDF \"{name}\"")).with_hint("`list` shows all"))
}
