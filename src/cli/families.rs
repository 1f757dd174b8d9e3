//! Families of BSDFs: of this program by their names, or of another program, with the arguments that start it; and their list.

use super::console::Console;
use clap::Args;
use etalon_bench::protocol::program::bsdf::Program;
use etalon_bench::protocol::program::{self, External};
use etalon_bench::protocol::sampler::Space;
use etalon_bench::sweep::Families;
use etalon_bench::table::Table;
use etalon_bench::validation::families;
use etalon_core::error::{Error, Result};
use etalon_stats::bsdf::{Family, Parameter};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// The family of the program, or those of this program that are named, or all.
pub fn families(external: &ExternalBsdf, names: &[String]) -> Result<Families> {
    match external.start(names)? {
        Some(program) => Ok(vec![Box::new(program)]),
        None => chosen(names),
    }
}

/// The families of these names, or all.
fn chosen(names: &[String]) -> Result<Families> {
    let known: Vec<String> = families::all().iter().map(|family| Family::name(family).to_owned()).collect();
    for (i, name) in names.iter().enumerate() {
        if !known.contains(name) {
            return Err(Error::parameter("names", format!("there is no family \"{name}\""))
                .with_hint(format!("the families: {}", known.join(", "))));
        }
        if names[..i].contains(name) {
            return Err(Error::parameter("names", format!("{name} is given twice")).with_hint("give each family once"));
        }
    }
    let is_chosen =
        |family: &families::Family| names.is_empty() || names.iter().any(|name| name == Family::name(family));
    let chosen = families::all().into_iter().filter(is_chosen);
    Ok(chosen.map(|family| Box::new(family) as Box<dyn Family>).collect())
}

/// Prints the families with their parameters: default value and range of each.
pub fn list(families: &Families, console: &Console) {
    #[derive(Serialize)]
    struct Line {
        name: String,
        /// Name, default value and range.
        parameters: Vec<(String, f64, [f64; 2])>,
    }
    let parameter = |Parameter { name, value, range }: Parameter| (name, value, range);
    let line = |family: &dyn Family| Line {
        name: family.name().to_owned(),
        parameters: family.parameters().into_iter().map(parameter).collect(),
    };
    let lines: Vec<Line> = families.iter().map(|family| line(&**family)).collect();
    console.result(&BTreeMap::from([("families", &lines)]), || {
        let parameters = |line: &Line| {
            let short = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
            let of = |(name, value, [from, to]): &(String, f64, [f64; 2])| {
                format!("{name} = {value} ({} to {})", short(*from), short(*to))
            };
            line.parameters.iter().map(of).collect::<Vec<_>>().join(", ")
        };
        Table::of(&lines).words("", |line| &line.name).words("", parameters).text()
    });
}

/// Another program.
#[derive(Args)]
#[command(next_help_heading = "BSDFs of other programs")]
pub struct ExternalBsdf {
    /// Test the BSDFs of the program that COMMAND starts
    ///
    /// Requests and replies go over its standard input and output.
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// Time limit for each reply of the program [default: 30]
    #[arg(long, value_name = "SECONDS")]
    timeout: Option<f64>,
}

/// Seconds that a program has for each reply, unless the user gives others.
pub const REPLY_LIMIT: f64 = 30.0;

const OF_SAMPLERS: &str = "`etalon validate` tests samplers";

/// Where a program with samplers or BSDFs comes from.
#[derive(Debug, Clone, Copy)]
pub enum ProgramSource<'a> {
    /// A command that starts it.
    Command(&'a str),
    /// A file of Python functions.
    File(&'a str),
}

impl<'a> ProgramSource<'a> {
    /// The command, or the Python file that is the only one of `names`.
    pub fn of(command: Option<&'a str>, names: &'a [String]) -> Result<Option<Self>> {
        let file = names.iter().find(|name| program::is_python_file(name));
        match (command, file) {
            (Some(_), _) if !names.is_empty() => {
                Err(Error::parameter("names", "`exec` is given, too").with_hint("a program is tested alone"))
            }
            (None, Some(file)) if names.len() > 1 => {
                Err(Error::parameter("names", format!("{file} is not the only one"))
                    .with_hint("a file is tested alone"))
            }
            (command, file) => Ok(command.map(Self::Command).or(file.map(|file| Self::File(file)))),
        }
    }

    /// Starts the program, which has `timeout` seconds for each reply.
    pub fn start(self, space: Option<Space>, timeout: f64) -> Result<External> {
        let limit = reply_limit(timeout)?;
        match self {
            Self::Command(command) => program::start(command, space, limit),
            Self::File(file) => program::start_file(file, space, limit),
        }
    }

    /// Starts the program, which must have BSDFs.
    pub fn bsdf(self, timeout: f64) -> Result<Program> {
        match (self.start(None, timeout)?, self) {
            (External::Bsdf(program), _) => Ok(program),
            (External::Sampler(_), Self::Command(_)) => {
                Err(Error::parameter("exec", "the program has a sampler, and no BSDFs").with_hint(OF_SAMPLERS))
            }
            (External::Sampler(_), Self::File(file)) => {
                Err(Error::input(Path::new(file), "it has a sampler, and no BSDFs").with_hint(OF_SAMPLERS))
            }
        }
    }
}

impl ExternalBsdf {
    /// The command, if one is given.
    pub fn command(&self) -> Option<&str> {
        self.exec.as_deref()
    }

    /// Starts the program, if a command or a Python file among `names` is given.
    pub fn start(&self, names: &[String]) -> Result<Option<Program>> {
        match (ProgramSource::of(self.exec.as_deref(), names)?, self.timeout) {
            (Some(source), timeout) => source.bsdf(timeout.unwrap_or(REPLY_LIMIT)).map(Some),
            (None, Some(_)) => Err(Error::parameter("timeout", "there is no program that replies")
                .with_hint("it goes with `exec`, or with a Python file")),
            (None, None) => Ok(None),
        }
    }
}

/// The time that a program has for each reply.
pub fn reply_limit(seconds: f64) -> Result<Duration> {
    const LONGEST: f64 = 86_400.0;
    if !(seconds > 0.0 && seconds <= LONGEST) {
        return Err(Error::parameter("timeout", format!("{seconds} s is not from 0 to {LONGEST} s")));
    }
    Ok(Duration::from_secs_f64(seconds))
}
