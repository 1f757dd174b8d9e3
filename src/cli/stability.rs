//! `etalon stability`: numerical errors of the renderer's functions over stiff and extreme inputs.

use super::console::Console;
use super::global::{Global, Reports, Verdict, out, threads, verbose};
use super::style::StyleArgs;
use clap::Args;
use etalon_bench::stability::{self, BoundCheck, ErrorRow, REGISTRY, Replay};
use etalon_bench::table::Table;
use etalon_core::error::{Error, Result};
use etalon_figures::figure::Wanted;
use etalon_figures::output::{self, Saving};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::stability as view;
use etalon_figures::view::text::{LINE, rounded, wrapped};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Compare the renderer's functions with exact values over stiff and extreme inputs
#[derive(Args)]
#[command(after_long_help = "Errors are those of the renderer's functions against 256-bit arithmetic at the rounded \
                  input. The condition number is the relative change of the value per relative change \
                  of the input. Exit code 1 if a bound does not hold, 3 if interrupted. Writes stability.{csv,svg,png,pdf}, or stability-FAMILY… \
                  with their errors over the inputs if families are named.\n\nExamples:\n  etalon stability\n  etalon stability \
                  fresnel sphere\n  etalon stability --replay fresnel:eta=1.0003,cos=0x1p-3")]
#[command(next_help_heading = "Families", args = [out(), threads(), verbose()])]
pub struct Stability {
    /// Families to run [default: all; see --list]
    #[arg(value_name = "FAMILY", help_heading = None::<&str>)]
    families: Vec<String>,
    /// Run one input in every variant and precision
    #[arg(long, value_name = "CASE", conflicts_with_all = ["families", "junit", "markdown"])]
    replay: Option<String>,
    /// List the families and stop
    #[arg(long, conflicts_with_all = ["replay", "junit", "markdown"])]
    list: bool,
    #[command(flatten)]
    reports: Reports,
    #[command(flatten)]
    style: StyleArgs,
}

#[derive(Serialize)]
struct Output<'a> {
    rows: &'a [ErrorRow],
    bounds: &'a [BoundCheck],
    effort: BTreeMap<&'static str, usize>,
    interrupted: bool,
}

#[derive(Serialize)]
struct Listed {
    family: &'static str,
    about: &'static str,
    inputs: &'static [&'static str],
}

impl Stability {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if self.list {
            list(console);
            return Ok(Verdict::Good);
        }
        if let Some(case) = &self.replay {
            let replay = stability::replay(case)?;
            console.result(&replay, || replayed(&replay));
            return Ok(Verdict::Good);
        }
        let start = Instant::now();
        self.reports.check()?;
        let (target, style) = (global.target(), self.style.style()?);
        let name = output::name_of_run("stability", &self.families);
        let stem = target.stem(&name, "", &output::STUDY)?;
        let errors_stem = target.stem(&name, "-errors", &output::STUDY)?;
        let count = if self.families.is_empty() { stability::names().count() } else { self.families.len() };
        let bar = console.progress(count as u64, "stability", "families");
        let result = stability::run(&self.families, stability::SIDE, &mut |name| {
            bar.set_message(name);
            bar.inc(1);
        })?;
        bar.finish_and_clear();
        if result.interrupted && result.rows.is_empty() {
            return Err(Error::Interrupted);
        }
        let mut saving = Saving::default();
        let mut wanted = Wanted::of(&style);
        let worst = view::worst_cases(&result.rows);
        saving.add(output::write(&stem, &worst, &wanted.style(&worst), &output::csv(&result.rows)?));
        if !self.families.is_empty() && !result.sweeps.is_empty() {
            let errors = view::errors(&result.sweeps);
            let table = output::csv(&view::curve_rows(&result.sweeps))?;
            saving.add(output::write(&errors_stem, &errors, &wanted.style(&errors), &table));
        }
        saving.add(wanted.check().map(|()| Vec::new()));
        saving.add(self.reports.write(&checks(&result, start.elapsed().as_secs_f64())));
        let (files, saved) = saving.end();
        let (rows, bounds, interrupted) = (&result.rows, &result.bounds, result.interrupted);
        let written = target.written(files);
        let output = Output { rows, bounds, effort: BTreeMap::from([("side", stability::SIDE)]), interrupted };
        let all = global.verbose || !self.families.is_empty();
        console.saved(&output, &written, || human(&output, all));
        saved?;
        let all_hold = result.bounds.iter().all(|bound| bound.holds);
        Ok(Verdict::of(all_hold, interrupted))
    }
}

/// A check for each bound.
fn checks(result: &stability::Stability, seconds: f64) -> Checks {
    let check = |bound: &BoundCheck| Check {
        group: "stability".into(),
        name: bound.name.clone(),
        verdict: Some(if bound.holds { etalon_stats::Verdict::Accept } else { etalon_stats::Verdict::Reject }),
        message: found(bound),
        details: String::new(),
        seconds: None,
    };
    let checks = result.bounds.iter().map(check).collect();
    let mut checks = Checks { title: "etalon stability".into(), list: checks, seconds };
    if result.interrupted {
        checks.interrupted(LEFT_OUT);
    }
    checks
}

/// What is told of an interrupted run.
const LEFT_OUT: &str = "the other families were not run";

/// The largest error beside the bound, and the input of one that is too large.
fn found(bound: &BoundCheck) -> String {
    let limit = match bound.limit {
        small if small > 0.0 && small < 0.01 => format!("{small:e}"),
        limit => limit.to_string(),
    };
    let place = if bound.holds || bound.worst.is_empty() { String::new() } else { format!("; at {}", bound.worst) };
    format!("{}, at most {limit}{place}", rounded(bound.got, 3))
}

fn list(console: &Console) {
    let special = Listed { family: stability::SPECIAL, about: stability::ABOUT_SPECIAL, inputs: &[] };
    let families = REGISTRY.iter().map(|f| Listed { family: f.name, about: f.about, inputs: f.inputs });
    let list: Vec<Listed> = families.chain([special]).collect();
    console.result(&BTreeMap::from([("families", &list)]), || {
        let about = |l: &Listed| match l.inputs {
            [] => l.about.to_owned(),
            inputs => format!("{} ({})", l.about, inputs.join(", ")),
        };
        Table::of(&list).words("", |l| l.family).words("", about).text()
    });
}

fn replayed(replay: &Replay) -> String {
    let inputs = replay.inputs.iter().map(|(name, x)| format!("{name} = {x:?}"));
    let numbers = |values: &[f64]| match values {
        [] => "nothing".to_owned(),
        values => values.iter().map(|x| format!("{x:.17e}")).collect::<Vec<_>>().join(" "),
    };
    let mut text = format!("{}: {}\n", replay.family, inputs.collect::<Vec<_>>().join(", "));
    for line in &replay.lines {
        text += &format!(
            "{:<9} {}  {}\n  reference    {}\n  {:.3e} ULP, relative {:.3e}, condition number {:.3e}{}{}\n",
            line.variant,
            line.precision.name(),
            numbers(&line.value),
            numbers(&line.reference),
            line.ulp,
            line.relative,
            line.condition,
            if line.flaw.is_empty() { "" } else { "; " },
            line.flaw
        );
    }
    text
}

/// The bounds; if `all`, the table of errors.
fn human(output: &Output<'_>, all: bool) -> String {
    let mut text = String::new();
    for bound in output.bounds {
        let verdict = if bound.holds { "ok    " } else { "FAILED" };
        text += &wrapped(&format!("{verdict} {}: {}", bound.name, found(bound)), "", LINE);
    }
    if output.interrupted {
        text += &format!("interrupted: {LEFT_OUT}\n");
    }
    if !all {
        return text;
    }
    text += &Table::of(output.rows)
        .words("family", |r| &r.family)
        .words("variant", |r| r.variant)
        .words("", |r| r.precision.name())
        .numbers("relative", |r| rounded(r.max_relative, 2))
        .numbers("ULP", |r| rounded(r.max_ulp, 2))
        .numbers("condition", |r| rounded(r.condition_at_worst, 2))
        .numbers("NaN, ∞", |r| r.non_finite)
        .numbers("< 0", |r| r.negative)
        .numbers("outside", |r| r.out_of_range)
        .text();
    text + &wrapped(
        "condition: of the problem, at the input of the largest relative error (in the CSV file, for --replay). Rounding that input \
         alone costs condition x 6e-8 in f32, x 1.1e-16 in f64. The bounds say what more `stable` may lose.",
        "",
        LINE,
    )
}
