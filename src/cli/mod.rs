//! The command line: one file per subcommand, each parsing, calling and printing.

mod arguments;
mod compare;
mod console;
mod converge;
mod envmap;
mod flags;
mod fresnel;
mod map_file;
mod merge;
mod render;
mod reproduce;
mod scene_file;
mod scenes;
mod signals;
mod stability;
mod validate;

use crate::envmap::samplers::{self, Entry, MapSampling};
use crate::error::{Error, Result};
use crate::memory;
use crate::output::Target;
use arguments::Arguments;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use console::Console;
use flags::Flags;
use std::path::PathBuf;
use std::process::ExitCode;

/// A bench for light-transport samplers.
#[derive(Parser)]
#[command(version, about, max_term_width = 100, after_help = AFTER_HELP)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "\
Exit codes: 0 good, 1 a check was rejected, 2 usage or bad input, 3 inconclusive (too few samples) or interrupted.

Examples:
  etalon reproduce                      all figures, from built-in data, into figures/
  etalon fresnel --eta-i 1.45 --eta-t 1 leaving glass
  etalon envmap sample nave -n 256      importance samples of the built-in map
  etalon render sphere-env -s 64        the lit sphere
  etalon render cornell-spheres         a mirror and a glass ball in a room
  etalon converge cornell-spheres       error against run time
  etalon stability fresnel              errors against 256-bit arithmetic
  etalon validate                       every sampler against its density
  etalon scenes                         what else can be rendered";

/// The seed when none is given.
const DEFAULT_SEED: u64 = 1;

/// Flags that every subcommand takes.
#[derive(Args)]
struct Global {
    /// Print one JSON object on standard output and nothing else there
    #[arg(long, global = true)]
    json: bool,
    /// Seed of all random numbers
    #[arg(long, global = true, value_name = "N", default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Worker threads (default: one per core)
    #[arg(short, long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Most memory to take, in bytes or with K, M or G (default: what the machine has left)
    #[arg(long, global = true, value_name = "SIZE", value_parser = size)]
    memory: Option<u64>,
    /// No progress bars and no warnings
    #[arg(long, global = true)]
    quiet: bool,
    /// Where results go: a folder, or a file whose name (with .csv, .png, .exr ...) all of them take [default: out, under
    /// names that carry the options that differ from their defaults]
    #[arg(short, long, global = true, value_name = "PATH")]
    out: Option<PathBuf>,
    /// All arguments of the run.
    #[arg(skip)]
    arguments: Arguments,
}

impl Global {
    /// Where results go. Default names tell the arguments that differ from the defaults, but for those (`in_name`) that
    /// they tell already.
    fn target(&self, in_name: &[&str]) -> Target {
        self.arguments.target(self.out.as_deref(), in_name)
    }
}

#[derive(Subcommand)]
enum Command {
    /// Plot the reflectance of a dielectric or a metal over the angle of incidence
    Fresnel(fresnel::Fresnel),
    /// Inspect, sample and cut environment maps
    #[command(subcommand)]
    Envmap(envmap::Envmap),
    /// Render a scene
    Render(render::Render),
    /// List the built-in scenes
    Scenes(scenes::Scenes),
    /// Compare two images
    Compare(compare::Compare),
    /// Measure the error of sampling strategies against their run time
    Converge(converge::Converge),
    /// Merge parts of a render
    Merge(merge::Merge),
    /// Compare the code that renders with exact answers over stiff and extreme inputs
    Stability(stability::Stability),
    /// Test samplers against their densities
    Validate(validate::Validate),
    /// Make every figure and check it against the reports' numbers
    Reproduce(reproduce::Reproduce),
}

/// Which formulas a command uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Model {
    /// The correct ones
    Exact,
    /// The reports', mistakes included
    Report,
}

/// Reads the name of an environment-map sampler.
fn map_sampling(text: &str) -> std::result::Result<MapSampling, String> {
    text.parse().map_err(|_| format!("the samplers are {}", MapSampling::names().join(", ")))
}

/// The environment-map samplers among some, each with what it does.
fn map_samplers(among: impl Fn(MapSampling) -> bool) -> String {
    let line = |entry: &Entry| {
        let number = if entry.has_regions { "-K" } else { "" };
        let density = if entry.density == entry.name { String::new() } else { format!(" ({})", entry.density) };
        format!("{}{number}{density}: {}", entry.name, entry.doc)
    };
    let some = samplers::ALL.iter().filter(|entry| among(MapSampling::new(entry)));
    some.map(|entry| line(entry)).collect::<Vec<_>>().join("; ")
}

/// Reads a number of bytes, for example `512M`.
fn size(text: &str) -> std::result::Result<u64, String> {
    let shift = match text.chars().last().map(|unit| unit.to_ascii_uppercase()) {
        Some('K') => 10,
        Some('M') => 20,
        Some('G') => 30,
        _ => 0,
    };
    let digits = if shift > 0 { &text[..text.len() - 1] } else { text };
    let bytes = digits.parse::<u64>().ok().and_then(|number| number.checked_mul(1 << shift));
    bytes.ok_or("not a number of bytes such as 512M or 2G".into())
}

/// What a command that ran to its end has to say to the shell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Good,
    Rejected,
    /// Too few samples, or somebody interrupted.
    Inconclusive,
}

/// Runs the program on the process's arguments.
#[must_use]
pub fn main() -> ExitCode {
    let mut command = Cli::command();
    command.build();
    let matches = command.get_matches_mut();
    let mut cli = Cli::from_arg_matches(&matches).unwrap_or_else(|e| e.format(&mut command).exit());
    cli.global.arguments = Arguments::of(&command, &matches);
    let console = Console::new(cli.global.json, cli.global.quiet);
    if let Err(e) = signals::install() {
        console.warn(&format!("Ctrl-C will end the program without saving ({e})"));
    }
    if let Some(bytes) = cli.global.memory {
        memory::set_limit(bytes);
    }
    let verdict = run(&cli, &console);
    match verdict.and_then(|verdict| console.check().map(|()| verdict)) {
        Ok(Verdict::Good) => ExitCode::SUCCESS,
        Ok(Verdict::Rejected) => ExitCode::from(1),
        Ok(Verdict::Inconclusive) => ExitCode::from(3),
        Err(error) => {
            let code = if matches!(error, Error::Interrupted) { 3 } else { 2 };
            Console::error(&Flags::of(&command, &matches).named(error));
            ExitCode::from(code)
        }
    }
}

/// The program's name and arguments, for the metadata of pictures.
fn command_line() -> String {
    std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

fn run(cli: &Cli, console: &Console) -> Result<Verdict> {
    cli.global.arguments.check()?;
    let threads = cli.global.threads.map_or(0, |n| n as usize);
    // Fails only if a pool exists already, which then does the work.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    match &cli.command {
        Command::Fresnel(args) => args.run(&cli.global, console),
        Command::Envmap(command) => command.run(&cli.global, console),
        Command::Render(args) => args.run(&cli.global, console),
        Command::Scenes(args) => args.run(&cli.global, console),
        Command::Compare(args) => args.run(&cli.global, console),
        Command::Converge(args) => args.run(&cli.global, console),
        Command::Merge(args) => args.run(&cli.global, console),
        Command::Stability(args) => args.run(&cli.global, console),
        Command::Validate(args) => args.run(&cli.global, console),
        Command::Reproduce(args) => args.run(&cli.global, console),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn sizes_are_bytes_or_have_a_unit() {
        let read = |text| super::size(text).ok();
        assert_eq!(
            [read("77"), read("2K"), read("100M"), read("3g")],
            [Some(77), Some(2048), Some(100 << 20), Some(3 << 30)]
        );
        assert!(["", "M", "-1", "1.5G", "2T", "99999999999G", "é"].into_iter().all(|text| read(text).is_none()));
    }

    #[test]
    fn the_arguments_are_consistent() {
        use clap::CommandFactory;
        super::Cli::command().debug_assert();
    }
}
