//! What `ARCHITECTURE.md` states about the sources and no compiler says: layers within crates, words, where things may stand.

use std::fs;
use std::path::{Path, PathBuf};

/// Layers of the crates that have them, lowest first. A module imports only from layers before its own.
const LAYERS: [(&str, &[&str]); 2] = [
    (
        "crates/etalon-core/src",
        &[
            "error interrupt memory build files",
            "math",
            "optics",
            "sampling",
            "errata",
            "raster",
            "bsdf envmap",
            "scene",
            "import export",
        ],
    ),
    ("crates/etalon-figures/src", &["figure", "output", "view", "gallery"]),
];

/// A source file without its unit tests.
struct Source {
    file: PathBuf,
    text: String,
}

impl Source {
    /// Lines of code, without strings and comments.
    fn code(&self) -> impl Iterator<Item = String> {
        let is_code = |line: &&str| !line.trim_start().starts_with("//");
        self.text.lines().filter(is_code).map(|line| {
            let line = line.split(" // ").next().unwrap_or_default();
            line.split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
        })
    }

    fn comments(&self) -> impl Iterator<Item = &str> {
        self.text.lines().map(str::trim).filter(|line| line.starts_with("//"))
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The files below `folder` without unit tests, which stand at the end of a file or in files named `tests`.
fn sources(folder: &str) -> Vec<Source> {
    let read = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
        Source { file: file.strip_prefix(root()).unwrap().to_path_buf(), text }
    };
    let is_test = |file: &PathBuf| file.iter().any(|part| part == "tests.rs" || part == "tests");
    let found: Vec<Source> = files(&root().join(folder)).into_iter().filter(|file| !is_test(file)).map(read).collect();
    assert!(!found.is_empty(), "{folder} has no sources");
    found
}

/// The crates of the workspace that are the product, and the program.
fn crates() -> Vec<String> {
    let folders = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().file_name());
    let names = folders.map(|name| name.into_string().unwrap()).filter(|name| name.starts_with("etalon-"));
    names.map(|name| format!("crates/{name}/src")).chain(["src".to_owned()]).collect()
}

fn assert_none(found: &[String]) {
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn modules_import_only_from_lower_layers() {
    let mut wrong = Vec::new();
    for (folder, layers) in LAYERS {
        let level = |module: &str| layers.iter().position(|layer| layer.split(' ').any(|name| name == module));
        for source in sources(folder) {
            let inside = source.file.strip_prefix(folder).unwrap();
            let own = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
            if own == "lib" {
                continue;
            }
            let own_level = level(own).unwrap_or_else(|| panic!("{own} is in no layer"));
            for line in source.code() {
                let is_name = |c: char| c.is_alphanumeric() || c == '_';
                let named = line.split("crate::").skip(1).filter_map(|rest| rest.split(|c| !is_name(c)).next());
                let above = named.filter(|other| *other != own && level(other).is_some_and(|other| other > own_level));
                wrong.extend(above.map(|other| format!("{} imports {other}", source.file.display())));
            }
        }
    }
    assert_none(&wrong);
}

#[test]
fn every_file_says_its_job_in_its_first_line() {
    let folders = ["src", "crates", "python", "tests", "benches", "examples"];
    let all = folders.iter().flat_map(|folder| files(&root().join(folder)));
    let silent = all.filter(|file| !fs::read_to_string(file).unwrap().starts_with("//! "));
    assert_none(&silent.map(|file| file.display().to_string()).collect::<Vec<_>>());
}

/// Whether a string literal of `line` contains a long flag, as in `"use --level 0.01"`.
fn has_flag(line: &str) -> bool {
    line.split('"').skip(1).step_by(2).any(|literal| {
        literal.match_indices("--").any(|(at, _)| {
            let before = literal[..at].chars().next_back();
            let after = literal[at + 2..].chars().next();
            before.is_none_or(|c| c == ' ' || c == '`') && after.is_some_and(|c| c.is_ascii_lowercase())
        })
    })
}

#[test]
fn only_the_command_line_names_flags() {
    // Figures carry the command that makes them; some hints name commands of other programs.
    let others = ["oiiotool", "exrmetrics"];
    let mut found = Vec::new();
    for source in crates().iter().filter(|folder| *folder != "src").flat_map(|folder| sources(folder)) {
        let lines = source.text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let named = lines.filter(|line| has_flag(line) && !others.iter().any(|other| line.contains(other)));
        if !source.file.starts_with("crates/etalon-figures/src/gallery") {
            found.extend(named.map(|line| format!("{}: {}", source.file.display(), line.trim())));
        }
    }
    assert_none(&found);
}

#[test]
fn only_errata_speak_of_the_reports() {
    let allowed = ["firstreport", "secondreport", "reported"];
    let mut found = Vec::new();
    for source in ["core", "render"].iter().flat_map(|name| sources(&format!("crates/etalon-{name}/src"))) {
        for line in source.code().filter(|_| !source.file.starts_with("crates/etalon-core/src/errata")) {
            let line = line.to_lowercase().replace('_', "");
            let mut names = line.split(|c: char| !c.is_alphanumeric());
            if names.any(|name| name.contains("report") && !allowed.contains(&name)) {
                found.push(format!("{}: {}", source.file.display(), line.trim()));
            }
        }
    }
    assert_none(&found);
}

/// Words that only this project used, and the terms of the field for them.
const WORDS: &[(&str, &str)] = &[
    ("lamp", "area light"),
    ("casters", "caustic cones"),
    ("shine", "product warp"),
    ("glow", "emission"),
    ("evenness", "uniformity"),
    ("promise", "bound"),
    ("by turns", "alternating"),
    ("told apart", "distinguished"),
    ("in any company", "whatever the others"),
];

#[test]
fn words_of_this_project_alone_do_not_come_back() {
    let mut found = Vec::new();
    for source in crates().iter().flat_map(|folder| sources(folder)) {
        for line in source.comments() {
            let spaced = format!(" {} ", line.to_lowercase().replace(|c: char| !c.is_alphanumeric(), " "));
            for (word, term) in WORDS {
                if [format!(" {word} "), format!(" {word}s ")].iter().any(|whole| spaced.contains(whole)) {
                    found.push(format!("{}: \"{word}\" is \"{term}\" in the field: {line}", source.file.display()));
                }
            }
        }
    }
    assert_none(&found);
}
