//! Names of library parameters as the user of the command line types them, and the arguments of a run as a whole: the files that
//! they name.
//!
//! An argument's id is the name of the field or argument of the library that it sets. [`ALIASES`] lists the few names
//! that differ. Texts of the library put the names of other parameters between backquotes.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use std::any::TypeId;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// Names of the library, and the ids of the arguments that set them where these differ.
const ALIASES: [(&str, &str); 11] = [
    ("allow_ldr", "ldr"),
    ("case", "replay"),
    ("command", "exec"),
    ("density", "light_density"),
    ("draws", "n"),
    ("environment", "envmap"),
    ("height", "resolution"),
    ("ids", "only"),
    ("map", "envmap"),
    ("path", "out"),
    ("width", "resolution"),
];

/// The flags of the program by the ids of their arguments.
pub struct Flags {
    /// Flags of the subcommand that was called.
    called: Vec<(String, String)>,
    /// Flags of all subcommands.
    all: Vec<(String, String)>,
}

impl Flags {
    /// The arguments of the program; `command` must be built.
    pub fn of(command: &Command, matches: &ArgMatches) -> Self {
        let (called, _) = called(command, matches);
        Self { called: flags(called).collect(), all: flags_of_all(command) }
    }

    /// The error with flags in place of the names of parameters.
    pub fn named(&self, error: Error) -> Error {
        error.with_names(|name| self.find(name))
    }

    /// The flag of a parameter, of the subcommand that was called if it has one.
    fn find<'a>(&'a self, name: &str) -> Option<&'a str> {
        let aliases = ALIASES.iter().filter(|(alias, _)| *alias == name).map(|(_, id)| *id);
        let ids: Vec<&str> = std::iter::once(name).chain(aliases).collect();
        let among =
            |flags: &'a [(String, String)]| ids.iter().find_map(|id| flags.iter().find(|(known, _)| known == id));
        among(&self.called).or_else(|| among(&self.all)).map(|(_, flag)| flag.as_str())
    }
}

fn flags(command: &Command) -> impl Iterator<Item = (String, String)> {
    command.get_arguments().map(|arg| (arg.get_id().to_string(), flag(arg)))
}

fn flags_of_all(command: &Command) -> Vec<(String, String)> {
    flags(command).chain(command.get_subcommands().flat_map(flags_of_all)).collect()
}

/// An argument as the user types it: `-s`, `--level`, or the name of its value if it has no flag.
fn flag(arg: &Arg) -> String {
    let value = || arg.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
    match (arg.get_short(), arg.get_long()) {
        (Some(letter), _) => format!("-{letter}"),
        (None, Some(long)) => format!("--{long}"),
        (None, None) => value().unwrap_or_else(|| arg.get_id().to_string().to_uppercase()),
    }
}

/// Arguments that name what is written.
const OUTPUTS: [&str; 5] = ["out", "file", "resume", "junit", "markdown"];

/// The arguments that were given, by their role.
#[derive(Default)]
pub struct Arguments {
    /// Files and built-in names that are read.
    inputs: Vec<PathBuf>,
    /// Paths that are written, by the ids of the arguments that name them.
    outputs: Vec<(String, PathBuf)>,
    /// The subcommand with what it is about, which tells its results from those of other commands.
    pub subject: String,
}

/// Arguments that name other programs.
const PROGRAMS: [&str; 2] = ["exec", "renderer"];

impl Arguments {
    /// The arguments of the subcommand that was called; `command` must be built.
    pub fn of(command: &Command, matches: &ArgMatches) -> Self {
        let (command, matches) = called(command, matches);
        let mut found = Self { subject: command.get_name().into(), ..Self::default() };
        let given = |arg: &&Arg| matches.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine);
        for arg in command.get_arguments().filter(given) {
            let id = arg.get_id().as_str();
            let values: Vec<&OsStr> = matches.get_raw(id).into_iter().flatten().collect();
            let paths = values.iter().map(PathBuf::from);
            if OUTPUTS.contains(&id) {
                found.outputs.extend(paths.map(|path| (id.to_owned(), path)));
                continue;
            }
            if arg.is_positional() || is_path(arg) || PROGRAMS.contains(&id) {
                let words = values.iter().map(|value| format!(" {}", value.to_string_lossy()));
                found.subject.extend(words);
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
    use super::super::Cli;
    use super::super::tests::parsed;
    use super::*;
    use clap::{ArgAction, CommandFactory};
    use std::path::Path;

    /// Names that no argument sets: the errors tell a caller of the library of a mistake in its own code.
    const OF_CALLERS: [&str; 20] = [
        "SIGMA",
        "cells",
        "chart",
        "dimension",
        "figure",
        "figure size",
        "films",
        "format",
        "heat map",
        "images",
        "layers",
        "mass",
        "metadata",
        "narrow",
        "output file",
        "size",
        "table",
        "target",
        "test",
        "wall",
    ];

    fn flags(line: &str) -> Flags {
        let (command, matches) = parsed(line);
        Flags::of(&command, &matches)
    }

    #[test]
    fn names_become_flags_of_the_subcommand() {
        for (line, name, flag) in [
            ("render furnace", "spp", "-s"),
            ("render furnace", "width", "-r"),
            ("render furnace", "density", "--light-density"),
            ("render furnace", "map", "--envmap"),
            ("render furnace", "path", "-o"),
            ("render furnace", "scene", "SCENE"),
            ("merge a b", "resume", "--resume"),
            ("envmap info nave", "map", "MAP"),
            ("envmap cut nave", "n", "-n"),
            ("envmap proposal nave", "draws", "-n"),
            ("converge furnace", "max_spp", "--max-spp"),
            ("stability", "families", "FAMILY"),
            ("validate", "names", "NAME"),
            ("validate", "level", "--level"),
            ("validate", "detect", "--detect"),
        ] {
            assert_eq!(flags(line).find(name), Some(flag), "{line}: {name}");
        }
        assert_eq!(flags("scenes").find("films"), None);
    }

    #[test]
    fn every_alias_names_an_argument() {
        let flags = flags("scenes");
        for (name, id) in ALIASES {
            assert!(flags.all.iter().any(|(known, _)| known == id), "{name} stands for {id}, which is no argument");
        }
    }

    /// All names that the sources give to `Error::parameter` and `check_index`.
    fn names_in(path: &Path, found: &mut Vec<String>) {
        if path.is_dir() {
            std::fs::read_dir(path).unwrap().for_each(|entry| names_in(&entry.unwrap().path(), found));
        } else if path.extension().is_some_and(|e| e == "rs")
            && path != Path::new(env!("CARGO_MANIFEST_DIR")).join(file!())
        {
            let text = std::fs::read_to_string(path).unwrap();
            for call in ["Error::parameter(", "check_index("] {
                let arguments = text.split(call).skip(1).filter_map(|rest| rest.trim_start().strip_prefix('"'));
                found.extend(arguments.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())));
            }
        }
    }

    #[test]
    fn every_parameter_of_the_library_is_an_argument() {
        let mut names = Vec::new();
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        ["src", "crates"].iter().for_each(|folder| names_in(&root.join(folder), &mut names));
        assert!(names.len() > 50, "{names:?}");
        let flags = flags("scenes");
        for name in names {
            assert!(!name.contains("--"), "{name} is a flag: give the name of the parameter");
            assert!(flags.find(&name).is_some() || OF_CALLERS.contains(&&*name), "no argument sets \"{name}\"");
        }
    }

    #[test]
    fn every_id_that_is_named_here_exists() {
        fn ids(command: &Command, all: &mut Vec<String>) {
            all.extend(command.get_arguments().map(|arg| arg.get_id().to_string()));
            command.get_subcommands().for_each(|command| ids(command, all));
        }
        let mut all = Vec::new();
        ids(&Cli::command(), &mut all);
        for id in OUTPUTS.into_iter().chain(PROGRAMS) {
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
