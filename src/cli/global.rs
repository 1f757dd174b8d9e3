//! What subcommands have in common: the options that all or most take, and the verdict; `--junit` and `--markdown`: reports of
//! checks for continuous integration.

use super::flags::{Arguments, called};
use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, value_parser};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_figures::output::{self, Target};
use etalon_figures::view::checks::{Check, Checks};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

pub const DEFAULT_SEED: u64 = 1;

/// Headings of the help, for options of one kind in several subcommands.
pub const SCENE: &str = "Scene";
pub const SAMPLING: &str = "Sampling";
pub const OUTPUT: &str = "Output";
const COMMON: &str = "Common";

/// Options that every subcommand takes, and the values of those that most take ([`out`], [`seed`], [`threads`]).
#[derive(Args)]
#[command(next_help_heading = COMMON)]
pub struct Global {
    /// Print one JSON object on standard output and nothing else there
    #[arg(long, global = true, display_order = LAST)]
    pub json: bool,
    /// No progress bars and no warnings
    #[arg(long, global = true, display_order = LAST)]
    pub quiet: bool,
    /// Upper limit of memory, such as 2G [default: the free memory]
    ///
    /// In bytes, or with K, M or G.
    #[arg(long, global = true, display_order = LAST, value_name = "SIZE", value_parser = size)]
    pub memory: Option<u64>,
    /// Print help: one line for each option with -h, all with --help
    #[arg(short, long, global = true, display_order = LAST, action = ArgAction::Help)]
    help: Option<bool>,
    #[arg(skip)]
    pub out: Option<PathBuf>,
    #[arg(skip = DEFAULT_SEED)]
    pub seed: u64,
    #[arg(skip)]
    pub threads: Option<u32>,
    #[arg(skip)]
    pub verbose: bool,
    /// All arguments of the run.
    #[arg(skip)]
    pub arguments: Arguments,
}

/// Behind the options of a subcommand, which clap numbers from 0.
const LAST: usize = 100;

/// The option `-o`, of subcommands that write files.
pub fn out() -> Arg {
    let file = PathBufValueParser::new().try_map(|path: PathBuf| match path.as_os_str() == "-" {
        true => Err("results are files, not standard output; a folder of that name is ./-"),
        false => Ok(path),
    });
    let arg = Arg::new("out").short('o').long("out").value_name("PATH").value_parser(file);
    arg.help_heading(COMMON).help("Folder of the results, or their file name [default: out/]").long_help(
        "Where results go: a folder, or a file whose name (with .csv, .png, .exr ...) all of them take [default: the folder \
         out]",
    )
}

/// The option `--verbose`, of subcommands with more to tell than the answer.
pub fn verbose() -> Arg {
    let arg = Arg::new("verbose").short('v').long("verbose").action(ArgAction::SetTrue).conflicts_with("json");
    arg.help_heading(OUTPUT).help("Print the details, too")
}

/// The option `--seed`, of subcommands that use random numbers.
pub fn seed() -> Arg {
    let arg = Arg::new("seed").long("seed").value_name("N").value_parser(value_parser!(u64));
    arg.help_heading(COMMON).help("Seed of all random numbers").default_value("1")
}

/// The option `--threads`, of subcommands that compute in parallel.
pub fn threads() -> Arg {
    let arg = Arg::new("threads").short('t').long("threads").value_name("N");
    let arg = arg.value_parser(value_parser!(u32).range(1..=1024));
    arg.help_heading(COMMON).help("Worker threads [default: one per core]")
}

impl Global {
    /// Takes the arguments of the subcommand that was called; `command` must be built.
    pub fn complete(&mut self, command: &Command, matches: &ArgMatches) {
        let (_, given) = called(command, matches);
        // Not an argument of every subcommand, nor given where it is one.
        self.out = given.try_get_one("out").ok().flatten().cloned();
        self.threads = given.try_get_one("threads").ok().flatten().copied();
        self.verbose = given.try_get_one("verbose").ok().flatten().copied().unwrap_or(false);
        self.seed = given.try_get_one("seed").ok().flatten().copied().unwrap_or(DEFAULT_SEED);
        self.arguments = Arguments::of(command, matches);
    }

    /// Where results go.
    pub fn target(&self) -> Target {
        Target::new(self.out.as_deref(), &self.arguments.subject)
    }
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

/// The result of a command that ran to its end, for the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Exit code 0.
    Good,
    /// A check or a test failed: exit code 1.
    Rejected,
    /// Too few samples, or interrupted: exit code 3.
    Inconclusive,
}

impl Verdict {
    /// The verdict on work whose checks all hold (`good`) or not, or that was interrupted.
    pub fn of(good: bool, interrupted: bool) -> Self {
        match good {
            _ if interrupted => Self::Inconclusive,
            true => Self::Good,
            false => Self::Rejected,
        }
    }

    /// The exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Good => 0,
            Self::Rejected => 1,
            Self::Inconclusive => 3,
        }
    }
}

impl From<&Checks> for Verdict {
    /// A rejected check decides, then an inconclusive one.
    fn from(checks: &Checks) -> Self {
        use etalon_stats::Verdict::{Inconclusive, Reject};
        let has = |verdict| checks.list.iter().any(|check| check.verdict == Some(verdict));
        match (has(Reject), has(Inconclusive)) {
            (true, _) => Self::Rejected,
            (false, true) => Self::Inconclusive,
            (false, false) => Self::Good,
        }
    }
}

/// Whether the run has written its reports: `compare --each` does before it ends with the error of a bad input.
pub static IS_REPORTED: AtomicBool = AtomicBool::new(false);

/// The options, of subcommands with checks.
#[derive(Args, Default)]
pub struct Reports {
    /// Write the checks as JUnit XML too
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Append the checks to FILE as Markdown
    ///
    /// For the summary of a job, "$GITHUB_STEP_SUMMARY". FILE is made if it is missing.
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

impl Reports {
    /// Refuses files that cannot be written: before the work, not after it.
    pub fn check(&self) -> Result<()> {
        let given = [("junit", &self.junit), ("markdown", &self.markdown)];
        for (name, path) in given.into_iter().filter_map(|(name, path)| Some((name, path.as_ref()?))) {
            if output::result_extension(path).is_some() {
                let message = format!("{} has the extension of a result", path.display());
                return Err(Error::parameter(name, message).with_hint("reports are .xml and .md"));
            }
            files::check_writable(path)?;
        }
        if let Some(path) = &self.markdown {
            if self.junit.as_ref().is_some_and(|junit| junit == path || files::is_same_file(junit, path)) {
                let message = format!("{} is the file of the other report", path.display());
                return Err(Error::parameter("markdown", message).with_hint("name another file than that of `junit`"));
            }
            before(path)?;
        }
        Ok(())
    }

    /// Writes the reports that were asked for; returns their paths.
    pub fn write(&self, checks: &Checks) -> Result<Vec<PathBuf>> {
        IS_REPORTED.store(true, Ordering::Relaxed);
        if let Some(path) = &self.junit {
            files::write_bytes(path, checks.junit().as_bytes())?;
        }
        if let Some(path) = &self.markdown {
            // Several commands of a step share its summary
            let mut text = before(path)?;
            if !text.is_empty() {
                text.extend(if text.ends_with(b"\n") { "\n" } else { "\n\n" }.bytes());
            }
            text.extend(checks.markdown().bytes());
            files::write_bytes(path, &text)?;
        }
        Ok([&self.junit, &self.markdown].into_iter().flatten().cloned().collect())
    }
}

/// Writes the reports that a command line asks for, valid or not, where the run ended with an error: a check that is inconclusive, in the
/// place of a report of an earlier run. All else that the command line names is input, which is not replaced.
pub fn report_error(args: &[OsString], error: &str) {
    if IS_REPORTED.load(Ordering::Relaxed) {
        return;
    }
    let (mut reports, mut others) = (Reports::default(), Vec::new());
    let mut words = args.iter().skip(1);
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        let (name, value) = text.split_once('=').map_or((&*text, None), |(name, value)| (name, Some(value.into())));
        let report = match name {
            "--junit" => &mut reports.junit,
            "--markdown" => &mut reports.markdown,
            _ => {
                others.push(text.into_owned());
                continue;
            }
        };
        *report = value.or_else(|| words.next().map(PathBuf::from));
    }
    files::note_command(&others);
    let command = others.iter().find(|word| !word.starts_with('-')).map_or("", String::as_str);
    let check = Check {
        group: "run".into(),
        name: "input".into(),
        verdict: Some(etalon_stats::Verdict::Inconclusive),
        message: error.into(),
        details: String::new(),
        seconds: None,
    };
    let checks = Checks { title: format!("etalon {command}"), list: vec![check], seconds: 0.0 };
    // What keeps a report from being written is the error itself, or comes after it
    let _ = reports.check().and_then(|()| reports.write(&checks));
}

/// Most bytes of a file that is appended to; summaries of GitHub have at most one MiB.
const LONGEST: u64 = 16 << 20;

/// What stands in the file already.
fn before(path: &Path) -> Result<Vec<u8>> {
    if path.exists() { files::read_own(path, LONGEST) } else { Ok(Vec::new()) }
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
}
