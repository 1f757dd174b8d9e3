//! The arguments of a run as a whole: the files that they name.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use std::any::TypeId;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// Arguments that name what is written.
const OUTPUTS: [&str; 5] = ["out", "file", "resume", "junit", "markdown"];

/// The arguments that were given, by their role.
#[derive(Default)]
pub struct Arguments {
    /// Files and built-in names that are read.
    inputs: Vec<PathBuf>,
    /// Paths that are written, by the ids of the arguments that name them.
    outputs: Vec<(String, PathBuf)>,
}

impl Arguments {
    /// The arguments of the subcommand that was called; `command` must be built.
    pub fn of(command: &Command, matches: &ArgMatches) -> Self {
        let (command, matches) = called(command, matches);
        let mut found = Self::default();
        let given = |arg: &&Arg| matches.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine);
        for arg in command.get_arguments().filter(given) {
            let id = arg.get_id().as_str();
            let values: Vec<&OsStr> = matches.get_raw(id).into_iter().flatten().collect();
            let paths = values.iter().map(PathBuf::from);
            if OUTPUTS.contains(&id) {
                found.outputs.extend(paths.map(|path| (id.to_owned(), path)));
                continue;
            }
            if is_path(arg) {
                found.inputs.extend(paths);
            }
        }
        found
    }

    /// Refuses a path for results that is one of the files to read, also for those that the run names later.
    pub fn check(&self) -> Result<()> {
        self.inputs.iter().filter(|input| input.is_file()).for_each(|input| files::note_input(input));
        match self.outputs.iter().find(|(_, path)| files::check_no_input(path).is_err()) {
            None => Ok(()),
            Some((id, path)) => Err(Error::parameter(id, format!("{} is an input of this command", path.display()))
                .with_hint("name another file: results would replace the input")),
        }
    }
}

/// The subcommand that was called, and its arguments.
pub fn called<'a>(command: &'a Command, matches: &'a ArgMatches) -> (&'a Command, &'a ArgMatches) {
    let below = matches.subcommand().and_then(|(name, matches)| Some((command.find_subcommand(name)?, matches)));
    below.map_or((command, matches), |(command, matches)| called(command, matches))
}

/// The program's name and arguments, for the metadata of images.
pub fn command_line() -> String {
    std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Whether the values of an argument are paths (or names of what is built in, where paths may stand).
fn is_path(arg: &Arg) -> bool {
    let kind = arg.get_value_parser().type_id();
    kind == TypeId::of::<PathBuf>() || kind == TypeId::of::<OsString>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::{ArgAction, CommandFactory};

    #[test]
    fn every_id_that_is_named_here_exists() {
        fn ids(command: &Command, all: &mut Vec<String>) {
            all.extend(command.get_arguments().map(|arg| arg.get_id().to_string()));
            command.get_subcommands().for_each(|command| ids(command, all));
        }
        let mut all = Vec::new();
        ids(&Cli::command(), &mut all);
        for id in OUTPUTS {
            assert!(all.iter().any(|known| known == id), "{id}");
        }
    }

    #[test]
    fn an_option_given_twice_is_refused() {
        fn check(command: &Command) {
            // A renderer is one value; there may be several of them.
            for arg in command.get_arguments().filter(|arg| !arg.is_positional() && arg.get_id() != "renderer") {
                assert!(!matches!(arg.get_action(), ArgAction::Append), "{} {}", command.get_name(), arg.get_id());
            }
            command.get_subcommands().for_each(check);
        }
        check(&Cli::command());
        for line in ["render furnace -r 4 3 -r 4 3", "envmap sample nave -n 4 -n 8", "reproduce --only a --only b"] {
            let words = std::iter::once("etalon").chain(line.split_whitespace());
            let error = Cli::command().try_get_matches_from(words).unwrap_err();
            assert_eq!(error.kind(), clap::error::ErrorKind::ArgumentConflict, "{line}: {error}");
        }
    }
}
