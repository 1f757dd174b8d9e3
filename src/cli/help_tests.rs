//! Tests of the help of all subcommands, and of options that a subcommand does not take.

use super::Cli;
use super::global::DEFAULT_SEED;
use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory};

/// Calls `check` with the words of every subcommand that has no subcommands itself, and its built command.
fn walk(command: &mut Command, words: &[String], check: &mut impl FnMut(&[String], &mut Command)) {
    let is_help = |command: &Command| command.get_name() == "help";
    if command.get_subcommands().all(is_help) {
        check(words, command);
    }
    for below in command.get_subcommands_mut().filter(|command| !is_help(command)) {
        let words = [words, &[below.get_name().to_owned()]].concat();
        walk(below, &words, check);
    }
}

fn of_all(mut check: impl FnMut(&[String], &mut Command)) {
    let mut root = Cli::command();
    root.build();
    let mut count = 0;
    walk(&mut root, &[], &mut |words, command| {
        count += 1;
        check(words, command);
    });
    assert!(count > 10, "{count} subcommands");
}

#[test]
fn every_option_has_a_heading_and_a_line_of_help() {
    of_all(|words, command| {
        for arg in command.get_arguments().filter(|arg| !arg.is_hide_set()) {
            let name = format!("{words:?} {}", arg.get_id());
            assert!(arg.is_positional() || arg.get_help_heading().is_some(), "{name} has no heading");
            let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
            assert!((5..=80).contains(&help.chars().count()), "{name}: {help:?}");
            assert!(!help.contains("(default"), "{name}: the defaults stand in brackets: {help}");
            let is_lone = arg.get_short().is_some() && arg.get_long().is_none();
            assert!(!is_lone || arg.get_id() == "n", "{name} has a letter and no long name");
        }
    });
}

#[test]
fn local_options_stand_before_common_ones() {
    of_all(|words, command| {
        let help = command.render_help().to_string();
        let sections: Vec<&str> = help.lines().filter(|line| line.ends_with(':') && !line.starts_with(' ')).collect();
        assert_eq!(sections.last(), Some(&"Common:"), "{words:?}: {sections:?}");
        let common = help.split("Common:").nth(1).unwrap();
        for local in command.get_arguments().filter(|arg| arg.get_help_heading() != Some("Common")) {
            let Some(long) = local.get_long() else { continue };
            assert!(!common.contains(&format!("--{long} ")), "{words:?}: --{long} stands among the common options");
        }
    });
}

#[test]
fn help_is_at_most_100_columns_wide() {
    of_all(|words, command| {
        for (kind, help) in [("-h", command.render_help()), ("--help", command.render_long_help())] {
            for line in help.to_string().lines() {
                assert!(line.chars().count() <= 100, "{words:?} {kind}: {line}");
            }
        }
    });
}

/// Whether `words` and further arguments are refused because one of them is unknown.
fn is_unknown(words: &[String], more: &[&str]) -> bool {
    let line = std::iter::once("etalon").chain(words.iter().map(String::as_str)).chain(more.iter().copied());
    Cli::command().try_get_matches_from(line).is_err_and(|error| error.kind() == ErrorKind::UnknownArgument)
}

#[test]
fn common_options_are_taken_where_they_have_an_effect() {
    let mut taken: [Vec<String>; 3] = Default::default();
    of_all(|words, command| {
        let options: [&[&str]; 3] = [&["--seed", "2"], &["--threads", "2"], &["-o", "x"]];
        for ((id, option), taken) in ["seed", "threads", "out"].iter().zip(options).zip(&mut taken) {
            let arg: Option<&Arg> = command.get_arguments().find(|arg| arg.get_id() == id);
            assert_eq!(arg.is_none(), is_unknown(words, option), "{words:?} {option:?}");
            if arg.is_none() {
                taken.push(words.join(" "));
            }
        }
    });
    let without = ["envmap info", "scenes"];
    assert!(without.iter().all(|name| taken.iter().all(|names| names.iter().any(|n| n == name))), "{taken:?}");
    assert!(["merge", "compare", "fresnel"].iter().all(|name| taken[0].iter().any(|n| n == name)), "{taken:?}");
}

#[test]
fn the_seed_by_default_is_the_one_that_help_shows() {
    let seed = super::global::seed();
    assert_eq!(seed.get_default_values(), [DEFAULT_SEED.to_string().as_str()]);
}
