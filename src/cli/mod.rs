//! The command line: one file per subcommand, each parsing, calling and printing.

mod compare;
mod completions;
mod console;
mod converge;
mod envmap;
mod families;
mod flags;
mod fresnel;
mod furnace;
mod global;
#[cfg(test)]
mod help_tests;
mod map_file;
mod merge;
mod render;
mod reproduce;
mod scene_file;
mod scenes;
mod signals;
mod stability;
mod style;
mod sweep;
mod validate;
mod values;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use console::Console;
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_core::memory;
use flags::Flags;
use global::{Global, IS_REPORTED, Verdict, report_error};
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;

#[derive(Parser)]
#[command(version, about, max_term_width = 100, disable_help_flag = true, after_help = AFTER_HELP)]
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
  etalon render sphere-env -s 64        a white sphere under the built-in map
  etalon render cornell-spheres         a mirror and a glass sphere in a Cornell box
  etalon converge cornell-spheres       error against run time
  etalon furnace ggx                    the albedo of a BSDF over angle and width
  etalon stability fresnel              errors against 256-bit arithmetic
  etalon validate                       every sampler against its pdf
  etalon sweep ggx                      a BSDF over its parameters and directions
  etalon scenes                         what else can be rendered";

#[derive(Subcommand)]
enum Command {
    Fresnel(fresnel::Fresnel),
    /// Inspect, sample and cut environment maps
    #[command(subcommand, after_help = "Example:\n  etalon envmap sample nave -n 64,256")]
    Envmap(envmap::Envmap),
    Render(render::Render),
    Scenes(scenes::Scenes),
    Compare(compare::Compare),
    Converge(converge::Converge),
    Merge(merge::Merge),
    Furnace(furnace::Furnace),
    Stability(stability::Stability),
    Validate(validate::Validate),
    Sweep(sweep::Sweep),
    Reproduce(reproduce::Reproduce),
    Completions(completions::Completions),
}

/// Runs the program on `args`, the first of which is its name, and returns the exit code.
///
/// It sets what belongs to the whole process: handlers of signals, the number of threads, the limit of memory.
pub fn main(args: impl IntoIterator<Item = OsString>) -> u8 {
    crate::BUILD.declare();
    files::protect_inputs();
    IS_REPORTED.store(false, Ordering::Relaxed);
    // Parse the arguments
    let mut command = Cli::command();
    command.build();
    let args: Vec<OsString> = args.into_iter().collect();
    let parsed =
        command.try_get_matches_from_mut(&args).and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (mut cli, matches) = match parsed {
        Ok(parsed) => parsed,
        // The text of --help and --version is an error, too; there is no other place to report that it cannot be printed
        Err(e) => {
            let e = e.format(&mut command);
            if !e.use_stderr() {
                let _ = e.print();
                return 0;
            }
            // Arguments may hold characters that command a terminal
            let example = example(&command, &args, &e);
            let message = e.render().to_string();
            let message = message.split("\n\n").next().unwrap_or_default();
            report_error(&args, message.trim_start_matches("error: "));
            let _ = write!(std::io::stderr(), "{}{example}", console::shown(&e.render().to_string()));
            return 2;
        }
    };
    cli.global.complete(&command, &matches);
    let console = Console::new(cli.global.json, cli.global.quiet);
    // Set up the process and run
    if let Err(e) = signals::install() {
        console.warn(&format!("Ctrl-C will end the program without saving ({e})"));
    }
    memory::set_limit(cli.global.memory);
    let verdict = with_threads(cli.global.threads, || run(&cli, &console));
    match verdict.and_then(|verdict| console.check().map(|()| verdict)) {
        Ok(verdict) => verdict.code(),
        Err(error) => {
            let code = if matches!(error, Error::Interrupted) { 3 } else { 2 };
            let error = Flags::of(&command, &matches).named(error);
            Console::error(&error);
            report_error(&args, &error.to_string());
            code
        }
    }
}

/// The first example of the subcommand that lacks an argument.
fn example(command: &clap::Command, args: &[OsString], error: &clap::Error) -> String {
    if error.kind() != ErrorKind::MissingRequiredArgument {
        return String::new();
    }
    let words = args.iter().skip(1).filter_map(|word| word.to_str());
    let subcommand = words.fold(command, |command, word| command.find_subcommand(word).unwrap_or(command));
    let help = subcommand.get_after_long_help().map(ToString::to_string).unwrap_or_default();
    let example = help.lines().find_map(|line| line.strip_prefix("  etalon "));
    example.map(|line| format!("\nExample:\n  etalon {line}\n")).unwrap_or_default()
}

/// Runs `work` on a pool of n threads of its own: another run in this process may have others.
fn with_threads(threads: Option<u32>, work: impl FnOnce() -> Result<Verdict> + Send) -> Result<Verdict> {
    /// As the main thread's: `work` itself runs on one of the threads.
    const STACK: usize = 8 << 20;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, |n| n as usize)).stack_size(STACK);
    let pool = pool.build().map_err(|e| Error::io(Path::new("worker threads"), std::io::Error::other(e)))?;
    pool.install(work)
}

fn run(cli: &Cli, console: &Console) -> Result<Verdict> {
    cli.global.arguments.check()?;
    match &cli.command {
        Command::Fresnel(args) => args.run(&cli.global, console),
        Command::Envmap(command) => command.run(&cli.global, console),
        Command::Render(args) => args.run(&cli.global, console),
        Command::Scenes(args) => args.run(&cli.global, console),
        Command::Compare(args) => args.run(&cli.global, console),
        Command::Converge(args) => args.run(&cli.global, console),
        Command::Merge(args) => args.run(&cli.global, console),
        Command::Furnace(args) => args.run(&cli.global, console),
        Command::Stability(args) => args.run(&cli.global, console),
        Command::Validate(args) => args.run(&cli.global, console),
        Command::Sweep(args) => args.run(&cli.global, console),
        Command::Reproduce(args) => args.run(&cli.global, console),
        Command::Completions(args) => args.run(Cli::command(), console),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The program, and its arguments on a line.
    pub fn parsed(line: &str) -> (clap::Command, clap::ArgMatches) {
        let mut command = Cli::command();
        command.build();
        let words = std::iter::once("etalon").chain(line.split_whitespace());
        let matches = command.try_get_matches_from_mut(words).unwrap_or_else(|e| panic!("{line}: {e}"));
        (command, matches)
    }

    #[test]
    fn each_run_has_the_threads_that_it_asks_for() {
        for count in [1, 3, 2] {
            let run = || {
                assert_eq!(rayon::current_num_threads(), count as usize);
                Ok(Verdict::Good)
            };
            assert_eq!(with_threads(Some(count), run).unwrap(), Verdict::Good);
        }
    }

    #[test]
    fn a_missing_argument_is_shown_by_an_example() {
        let needs = ["render", "compare", "converge", "furnace", "merge", "completions"].into_iter();
        for line in needs.chain(["envmap info", "envmap sample", "envmap cut", "envmap proposal", "envmap make"]) {
            let mut command = Cli::command();
            command.build();
            let args: Vec<OsString> = ["etalon"].into_iter().chain(line.split(' ')).map(OsString::from).collect();
            let error = command.try_get_matches_from_mut(&args).unwrap_err();
            let example = example(&command, &args, &error);
            let shown = example.strip_prefix("\nExample:\n  ").unwrap_or_else(|| panic!("{line}: {example}"));
            assert!(shown.split(" && ").any(|part| part.starts_with(&format!("etalon {line} "))), "{line}: {example}");
        }
    }

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }
}
