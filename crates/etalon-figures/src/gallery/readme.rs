//! `figures/README.md`: the figures of the two reports beside ours, for the pages of a code host. The test writes it from the
//! registry if it is not what the registry says.

use super::figure::{Figure, Report};
use super::figures::registry;
use super::inputs::{Effort, Inputs};
use crate::figure::Style;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::envmap::{EnvMap, NamedMap};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// All figures and tables of the reports, by their labels.
const FIRST: [&str; 15] = [
    "Figure 1",
    "Figure 2",
    "Figure 3",
    "Figure 4",
    "Figure 5",
    "Figure 6",
    "Figure 7",
    "Figure 8",
    "Figure 9",
    "Figure 10",
    "Figure 11",
    "Figure 12",
    "Figure 13",
    "Figure 14",
    "Figure 15",
];
const SECOND: [&str; 15] = [
    "Figure 1a",
    "Figure 1b",
    "Figure 1c",
    "Figure 1d",
    "Figure 1e",
    "Figure 1f",
    "Figure 1g",
    "Figure 2a",
    "Figure 2b",
    "Figure 2c",
    "Figure 2d",
    "Figure 3a",
    "Figure 3b",
    "Figure 4",
    "Table 1",
];
/// Most bytes of all pictures in the folder.
const MOST: u64 = 6_500_000;

/// The figures of a report in its order, each with the label of its counterpart.
fn of_report<'a>(all: &'a [Figure], report: Report, labels: &[&'static str]) -> Vec<(&'static str, &'a Figure)> {
    let figure = |label: &&'static str| {
        let is_it = |figure: &&Figure| figure.report == report && figure.reproduces.split(',').next() == Some(label);
        (*label, all.iter().find(is_it).unwrap_or_else(|| panic!("no figure answers {label}")))
    };
    labels.iter().map(figure).collect()
}

fn text() -> String {
    let map = NamedMap { map: Arc::new(EnvMap::new(Synthetic::Onehot.make())), name: "nave".into() };
    let inputs = Inputs { map, originals: None, seed: 1, effort: Effort::Full, style: Style::default(), scale: 1 };
    let all = registry();
    let mut text = "# The figures of the two reports\n\nEach figure and table of the reports beside the one that `etalon reproduce` makes here. \
                    These show the built-in map `nave` and built-in scenes, with a statue of ours in place of bunny and dragon; \
                    `--envmap` and `--scenes` take [the reports' own](../docs/src/originals.md). Figures of a series have their \
                    caption once.\n"
        .to_owned();
    for (report, labels) in [(Report::First, &FIRST), (Report::Second, &SECOND)] {
        let citation = report.citations()[0];
        writeln!(text, "\n## The {}\n\n{citation}\n\n| in the report | here | |\n|---|---|---|", report.name())
            .unwrap();
        let mut before = "";
        for (label, figure) in of_report(all, report, labels) {
            let Figure { id, title, shows, reproduces, input, .. } = figure;
            let counterpart = reproduces.strip_prefix(label).unwrap_or_default().trim_start_matches(", ");
            let sentence = shows.split_inclusive(". ").next().unwrap_or_default().trim_end();
            let name = inputs.name_of(*input).unwrap();
            let name = if name.is_empty() { name } else { format!(" ({name})") };
            // Figures of a series have one caption
            let caption = if sentence == before { String::new() } else { format!(": {sentence}") };
            before = sentence;
            writeln!(text, "| **{label}**<br>{counterpart} | ![{title}{name}]({id}.png) | `{id}`{caption} |").unwrap();
        }
    }
    text
}

#[test]
fn the_page_of_the_folder_shows_every_figure_of_the_reports() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../figures/README.md");
    // A package has no figures
    let Ok(kept) = std::fs::read_to_string(&path) else { return };
    if kept != text() {
        std::fs::write(&path, text()).unwrap();
        panic!(
            "{} was not what the registry says and has been written again: look at it and commit it",
            path.display()
        );
    }
}

#[test]
fn the_pictures_of_the_folder_are_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../figures");
    let ignored = std::fs::read_to_string(folder.join("../.gitignore")).unwrap_or_default();
    let kept = ignored.lines().filter_map(|line| line.strip_prefix("!/figures/"));
    let sizes = kept.filter_map(|name| Some(std::fs::metadata(folder.join(name)).ok()?.len()));
    let total: u64 = sizes.sum();
    assert!(total <= MOST, "{total} bytes of pictures, at most {MOST}");
}
