//! `etalon sweep`: whole BSDFs over their parameters and directions.

use super::console::Console;
use super::families::{ExternalBsdf, families, list};
use super::global::{Global, OUTPUT, Reports, Verdict, out, seed, threads, verbose};
use super::values::{choice, share};
use clap::Args;
use etalon_bench::protocol::program;
use etalon_bench::sweep::{Computed, Description, Plan, conclude, replay, run};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_figures::output;
use etalon_figures::view::checks::Checks;
use etalon_figures::view::sweep as view;
use etalon_figures::view::text::p_is;
use etalon_stats::bsdf::ALL;
use etalon_stats::sweep::{Finding, State, Strategy};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// The title of reports.
const TITLE: &str = "etalon sweep";
/// The default error that a sweep looks for.
const DETECT: f64 = 0.05;

/// Test whole BSDFs over their parameters and directions
#[derive(Args)]
#[command(after_long_help = "\
Writes sweep-NAME.csv with a row for each configuration, and sweep-NAME-survivors.csv with the tests that were run again.

Ctrl-C keeps what is finished: the same command with --resume FILE continues.

Exit codes: 0 good, 1 a BSDF was rejected, 2 usage or bad input, 3 inconclusive or interrupted.

Examples:
  etalon sweep ggx
  etalon sweep ggx-dielectric --strategy edges --configurations 2000
  etalon sweep --exec 'python3 examples/bsdf.py'
  etalon sweep --replay 'ggx alpha_x=0.001 eta=1.5 wo=75,0 seed=7 check=sampling'")]
#[command(next_help_heading = "BSDFs and tests", args = [out(), seed(), threads(), verbose()])]
pub struct Sweep {
    /// Families of BSDFs [default: all]
    #[arg(value_name = "NAME", help_heading = None::<&str>)]
    names: Vec<String>,
    /// List the families with their parameters and stop
    #[arg(long, conflicts_with_all = ["junit", "markdown"])]
    list: bool,
    /// How configurations are chosen
    #[arg(long, default_value = "random", value_parser = choice([
        ("grid", "equally spaced values of every parameter, ends included", Strategy::Grid),
        ("random", "a low-discrepancy sequence, shifted at random", Strategy::Random),
        ("edges", "ends of ranges, default values, 1 and beside it, equal parameters, grazing angles", Strategy::Edges),
    ]))]
    strategy: Strategy,
    /// Configurations of each family, at most
    #[arg(long, value_name = "N", default_value_t = 100)]
    configurations: u64,
    /// Relative error of a pdf or of weights to detect with 90 % probability
    #[arg(long, value_name = "W", value_parser = share, default_value_t = DETECT, allow_negative_numbers = true)]
    detect: f64,
    /// Probability that a sweep of correct BSDFs rejects any of them
    #[arg(long, value_name = "A", value_parser = share, default_value_t = 0.01, allow_negative_numbers = true)]
    level: f64,
    /// Continue from FILE if it exists, and save the state in it
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Run one configuration again
    ///
    /// TEXT: a family, then parameters, wo=THETA,PHI in degrees, seed, check.
    #[arg(long, value_name = "TEXT", conflicts_with_all = ["names", "list", "strategy", "configurations", "resume", "junit", "markdown"])]
    replay: Option<String>,
    #[command(flatten)]
    external: ExternalBsdf,
    #[command(flatten)]
    reports: Reports,
}

/// The command that runs a configuration again, except for its last argument.
fn replay_by(external: &ExternalBsdf, detect: f64) -> String {
    let exec = external.command().map_or(String::new(), |command| format!(" --exec \"{command}\""));
    let detect = if detect == DETECT { String::new() } else { format!(" --detect {detect}") };
    format!("etalon sweep{exec}{detect} --replay")
}

/// What checks say of one configuration.
#[derive(Serialize)]
struct Replayed {
    configuration: String,
    checks: Vec<CheckLine>,
    rejected: bool,
}

#[derive(Serialize)]
struct CheckLine {
    check: &'static str,
    verdict: &'static str,
    p: Option<f64>,
    detectable: Option<f64>,
    message: Option<String>,
}

impl Sweep {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if let Some(text) = &self.replay {
            return self.replay(text, console);
        }
        let start = Instant::now();
        self.reports.check()?;
        if let Some(file) = self.names.iter().find(|name| program::is_python_file(name)) {
            return Err(Error::parameter("names", format!("{file}: a sweep takes no Python file"))
                .with_hint("`exec` starts a program with BSDFs"));
        }
        let families = families(&self.external, &self.names)?;
        if self.list {
            list(&families, console);
            return Ok(Verdict::Good);
        }
        // Results are called after the program's BSDF, or the families that were named.
        let subjects = match self.external.command() {
            Some(_) => vec![families[0].name().to_owned()],
            None => self.names.clone(),
        };
        let numbers = [self.detect, self.level];
        let description = Description::new(&families, self.strategy, self.configurations, global.seed, numbers)?;
        let plan = Plan::new(description, families)?;
        // Where the file goes, checked before anything is computed.
        let target = global.target();
        let name = output::name_of_run("sweep", &subjects);
        let path = target.file(&name, "", "csv")?;
        files::check_writable(&path)?;
        let mut computed = Computed::new(&plan);
        if let Some(state) = self.resume.as_deref().filter(|state| state.exists()) {
            computed = continued(Computed::read(state)?, &plan, state)?;
            files::release_input(state);
        }
        let save = |computed: &Computed| {
            computed.write(self.resume.as_deref().unwrap_or(&path))?;
            if self.resume.is_some() { computed.write(&path) } else { Ok(()) }
        };
        let missing = (0..plan.len()).filter(|&number| !computed.has(number)).count();
        let bar = console.progress(missing as u64, "sweep", "configurations");
        run(&plan, &mut computed, &|count| bar.inc(count), &save)?;
        bar.finish_and_clear();
        if (0..plan.len()).any(|number| !computed.has(number)) {
            let found = serde_json::json!({ "configurations": computed.len(), "interrupted": true });
            console
                .saved(&found, &target.written(vec![path.clone()]), || format!("{} configurations\n", computed.len()));
            let mut checks = Checks { title: TITLE.into(), list: Vec::new(), seconds: start.elapsed().as_secs_f64() };
            checks.interrupted("nothing is decided yet");
            self.reports.write(&checks)?;
            console.warn(&format!("interrupted; to continue: the same command with --resume {}", path.display()));
            return Ok(Verdict::Inconclusive);
        }
        let bar = console.progress(1, "run survivors again", "configurations");
        let found = conclude(&plan, &computed, &|count, of| {
            bar.set_length(of);
            bar.inc(count);
        })?;
        bar.finish_and_clear();
        let survivors = target.file(&name, "-survivors", "csv")?;
        files::write_bytes(&survivors, &output::csv(&found.rows)?)?;
        let checks = Checks { title: TITLE.into(), list: view::checks(&found), seconds: start.elapsed().as_secs_f64() };
        let written = target.written([vec![path, survivors], self.reports.write(&checks)?].concat());
        let replay_by = replay_by(&self.external, self.detect);
        console.saved(&found, &written, || view::text(&found, &plan.description, &replay_by, global.verbose));
        Ok(Verdict::from(&checks))
    }

    fn replay(&self, text: &str, console: &Console) -> Result<Verdict> {
        let families = families(&self.external, &[])?;
        let (family, configuration, findings) = replay(text, &families, self.detect)?;
        let replayed = replayed(configuration.text(family), findings, self.level);
        console.result(&replayed, || {
            let mut text = format!("{}\n", replayed.configuration);
            for CheckLine { check, verdict, p, message, .. } in &replayed.checks {
                let p = p.map_or(String::new(), |p| format!("  {}", p_is(p)));
                text += &format!("{check:<12} {verdict}{p}\n");
                text += &message.as_ref().map_or(String::new(), |message| format!("  {message}\n"));
            }
            text
        });
        let undecided = replayed.checks.iter().any(|line| line.verdict == "inconclusive");
        Ok(match replayed.rejected {
            true => Verdict::Rejected,
            false if undecided => Verdict::Inconclusive,
            false => Verdict::Good,
        })
    }
}

/// The verdict on each finding, at `level` for all together.
fn replayed(text: String, findings: Vec<Finding>, level: f64) -> Replayed {
    let p: Vec<f64> = findings.iter().map(|finding| finding.p.unwrap_or(f64::NAN)).collect();
    let rejected = etalon_stats::multiple::holm(&p, level);
    let line = |(finding, rejected): (Finding, bool)| CheckLine {
        check: ALL[finding.check].name,
        verdict: match finding.state {
            State::Violated => "reject",
            _ if rejected => "reject",
            State::Inconclusive => "inconclusive",
            _ => "accept",
        },
        p: finding.p,
        detectable: finding.detectable,
        message: finding.message,
    };
    let checks: Vec<CheckLine> = findings.into_iter().zip(rejected).map(line).collect();
    Replayed { configuration: text, rejected: checks.iter().any(|line| line.verdict == "reject"), checks }
}

/// `held` if it is of the same sweep.
fn continued(held: Computed, plan: &Plan, path: &std::path::Path) -> Result<Computed> {
    if let Some(number) = held.last().filter(|number| *number >= plan.len()) {
        return Err(Error::input(path, format!("the sweep has no configuration {number}")));
    }
    match held.description().difference(&plan.description) {
        None => Ok(held),
        Some(difference) => Err(Error::input(path, format!("the file is of another sweep ({difference})"))
            .with_hint("use the arguments and version that began it, or give `resume` another file")),
    }
}
