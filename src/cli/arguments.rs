//! The arguments of a run as a whole: the files that it reads, and the arguments that the names of its results contain.

use crate::error::{Error, Result};
use crate::files;
use crate::output::{Target, checksum, file_name};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use std::any::TypeId;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Arguments that name what is written.
const OUTPUTS: [&str; 5] = ["out", "file", "resume", "junit", "markdown"];

/// Arguments that do not change the results, only their place, the time that they take and what is printed.
const OPERATIONAL: [&str; 10] =
    ["json", "quiet", "verbose", "threads", "memory", "list", "general", "timeout", "figures", "ldr"];

/// The arguments that were given, by their role.
#[derive(Default)]
pub struct Arguments {
    /// Files and built-in names that are read.
    inputs: Vec<PathBuf>,
    /// Paths that are written, by the ids of the arguments that name them.
    outputs: Vec<(String, PathBuf)>,
    /// Arguments that change the results and differ from their defaults: id, and how a file name shows it.
    differing: Vec<(String, String)>,
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
            if !OPERATIONAL.contains(&id) {
                found.differing.extend(shown(arg, &values).map(|text| (id.to_owned(), text)));
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

    /// Where results go. Default names contain the arguments that differ from their defaults, except those (`in_name`, by
    /// their ids) that the name contains already.
    pub fn target(&self, out: Option<&Path>, in_name: &[&str]) -> Target {
        let texts = self.differing.iter().filter(|(id, _)| !in_name.contains(&id.as_str()));
        let variant: String = texts.map(|(_, text)| format!("-{text}")).collect();
        Target::new(out).with_variant(&variant)
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

/// How a file name shows an argument: `s256`, `r480x360`, `alpha-0.5`, `flip`; none if it has its default value.
fn shown(arg: &Arg, values: &[&OsStr]) -> Option<String> {
    let name = match (arg.get_short(), arg.get_long()) {
        (Some(letter), _) => letter.to_string(),
        (None, long) => long.unwrap_or_default().to_owned(),
    };
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return Some(name);
    }
    let texts = |values: &[&OsStr]| values.iter().map(|value| value_text(value, is_path(arg))).collect::<Vec<_>>();
    let given = texts(values);
    let defaults = arg.get_default_values().iter().filter_map(|value| value.to_str());
    let defaults: Vec<&OsStr> = match arg.get_value_delimiter() {
        Some(delimiter) => defaults.flat_map(|list| list.split(delimiter)).map(OsStr::new).collect(),
        None => defaults.map(OsStr::new).collect(),
    };
    // Compare with the defaults as texts, value by value
    if given == texts(&defaults) {
        return None;
    }
    // Join name and values: `r480x360`, `n64+256`, `eta-i-1.45`
    let is_tuple = arg.get_num_args().is_some_and(|range| range.min_values() > 1);
    let value = given.join(if is_tuple { "x" } else { "+" });
    let is_number = value.starts_with(|c: char| c.is_ascii_digit());
    let joint = if name.is_empty() || (arg.get_short().is_some() && is_number) { "" } else { "-" };
    Some(format!("{name}{joint}{value}"))
}

/// A value as a part of a file name: numbers in their shortest form, paths without folders and extension. A checksum
/// distinguishes values that differ only in characters that file names should not have.
fn value_text(value: &OsStr, is_path: bool) -> String {
    if let Some(text) = value.to_str() {
        if let Ok(number) = text.parse::<u64>() {
            return number.to_string();
        }
        if let Some(number) = text.parse::<f64>().ok().filter(|number| number.is_finite()) {
            let [plain, scientific] = [number.to_string(), format!("{number:e}")];
            return if plain.len() <= scientific.len() + 4 { plain } else { scientific };
        }
    }
    let stem = Path::new(value).file_stem().filter(|_| is_path).unwrap_or(value);
    let text = stem.to_string_lossy();
    let name = file_name(&text);
    let is_plain = text.chars().zip(name.chars()).all(|(from, to)| from == to || "/ ".contains(from));
    if is_plain { name } else { format!("{name}-{}", checksum(stem)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, tests::parsed};
    use clap::CommandFactory;

    fn arguments(line: &str) -> Arguments {
        let (command, matches) = parsed(line);
        Arguments::of(&command, &matches)
    }

    /// The path of a result called `name`, whose name carries the arguments `in_name`.
    fn stem(line: &str, name: &str, in_name: &[&str]) -> String {
        arguments(line).target(None, in_name).stem(name, "", &[]).unwrap().display().to_string()
    }

    #[test]
    fn default_names_contain_what_differs_from_the_defaults() {
        for (line, expected) in [
            ("fresnel", "out/x"),
            ("fresnel --eta-i 1.0 --eta-t 1.450 --model exact --points 901", "out/x"),
            ("fresnel --eta-i 1.45 --eta-t 1", "out/x-eta-i-1.45-eta-t-1"),
            ("fresnel --eta-t 1 --eta-i 1.45", "out/x-eta-i-1.45-eta-t-1"),
            ("fresnel --eta-t 1e-9", "out/x-eta-t-1e-9"),
            ("--json validate --quiet --seed 1 -t 2", "out/x"),
            ("validate --seed 7", "out/x-seed-7"),
            ("render furnace -s 0256 -l 4 -m 7 -r 480 360", "out/x-r480x360-s256-l4-m7"),
            (
                "render furnace -H --general --paths --model lambda-pi,approximate-fresnel --resume a.exr",
                "out/x-H-model-lambda-pi+approximate-fresnel-paths-4",
            ),
            ("render a.pbrt --envmap maps/sky.v2.exr --flip --ldr -c b/view.txt", "out/x-envmap-sky.v2-flip-c-view"),
            ("envmap sample nave -n 64,256,1024 --sampler cosine", "out/x-sampler-cosine"),
            ("envmap sample nave -n 64 --exposure -2.5", "out/x-n64-exposure--2.5"),
            ("validate warp bsdf/ggx --samples 1000 --junit a.xml --markdown a.md", "out/x-warp+bsdf-ggx-samples-1000"),
            ("merge a/p1.exr b/p2.exr", "out/x-p1+p2"),
        ] {
            assert_eq!(stem(line, "x", &["scene", "map"]), expected, "{line}");
        }
        assert_eq!(stem("render furnace -s 64", "furnace", &["scene"]), "out/furnace-s64");
        let patterns = ["validate a/*", "validate a/?", "validate a/-"].map(|line| stem(line, "x", &[]));
        assert!(patterns[0] != patterns[1] && patterns[1] != patterns[2] && patterns[0] != patterns[2], "{patterns:?}");
    }

    #[cfg(unix)]
    #[test]
    fn names_with_invalid_unicode_remain_distinct() {
        use std::os::unix::ffi::OsStrExt;
        let text = |bytes| value_text(OsStr::from_bytes(bytes), true);
        assert!(text(b"a/\xff.exr") != text(b"a/\xfe.exr"));
        assert_eq!(text(b"a/\xff.exr"), text(b"b/\xff.hdr"));
    }

    #[test]
    fn every_id_that_is_named_here_exists() {
        fn ids(command: &Command, all: &mut Vec<String>) {
            all.extend(command.get_arguments().map(|arg| arg.get_id().to_string()));
            command.get_subcommands().for_each(|command| ids(command, all));
        }
        let mut all = Vec::new();
        ids(&Cli::command(), &mut all);
        for id in OUTPUTS.iter().chain(&OPERATIONAL) {
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
