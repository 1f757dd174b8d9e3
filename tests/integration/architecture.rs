//! What `ARCHITECTURE.md` states about the sources: layers, no cycles, words, and where things may stand.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The layers, lowest first. A module imports only from modules in front of it; those of one line do not know each other.
const LAYERS: &[&[&str]] = &[
    &["error"],
    &["interrupt", "memory"],
    &["files"],
    &["math"],
    &["optics"],
    &["sampling"],
    &["errata"],
    &["raster", "figure"],
    &["output"],
    &["envmap", "bsdf"],
    &["scene"],
    &["import", "export", "render"],
    &["study"],
    &["view"],
    &["gallery", "summary"],
    &["cli"],
];

/// A source file of the library: its module path, and its text without comments, strings and unit tests.
struct Module {
    file: PathBuf,
    path: Vec<String>,
    text: String,
    code: String,
}

impl Module {
    fn name(&self) -> String {
        self.path.join("::")
    }
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below `folder` that end in `extension`.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The library's modules without their unit tests.
fn modules() -> Vec<Module> {
    let src = root().join("src");
    let is_test = |file: &PathBuf| file.iter().any(|part| part == "tests.rs" || part == "tests");
    let mut modules: Vec<Module> =
        files(&src, "rs").into_iter().filter(|f| !is_test(f)).map(|f| read(&src, f)).collect();
    modules.retain(|m| m.name() != "main");
    modules
}

fn read(src: &Path, file: PathBuf) -> Module {
    let relative = file.strip_prefix(src).unwrap().with_extension("");
    let mut path: Vec<String> = relative.iter().map(|p| p.to_str().unwrap().to_owned()).collect();
    if path.last().is_some_and(|name| name == "mod" || name == "lib") {
        path.pop();
    }
    let text = fs::read_to_string(&file).unwrap();
    // Unit tests stand at the end of a file.
    let product = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code = without_comments_and_strings(product);
    Module { file: file.strip_prefix(root()).unwrap().to_path_buf(), path, text, code }
}

/// Blanks comments, strings and characters, so that what is left are names and punctuation.
fn without_comments_and_strings(text: &str) -> String {
    let bytes: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (String::with_capacity(text.len()), 0);
    while i < bytes.len() {
        let rest = &bytes[i..];
        if rest.starts_with(&['/', '/']) {
            while i < bytes.len() && bytes[i] != '\n' {
                i += 1;
            }
        } else if rest[0] == 'r' && matches!(rest.get(1), Some('"' | '#')) && !out.ends_with(char::is_alphanumeric) {
            let hashes = rest[1..].iter().take_while(|c| **c == '#').count();
            let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
            if rest.get(1 + hashes) != Some(&'"') {
                out.push('r');
                i += 1;
                continue;
            }
            i += 2 + hashes;
            while i < bytes.len() && !bytes[i..].starts_with(&end) {
                i += 1;
            }
            i += end.len();
        } else if rest[0] == '"' {
            i += 1;
            while i < bytes.len() && bytes[i] != '"' {
                i += if bytes[i] == '\\' { 2 } else { 1 };
            }
            i += 1;
        } else if rest[0] == '\'' && (rest.get(2) == Some(&'\'') || rest.get(1) == Some(&'\\')) {
            i += 2;
            while i < bytes.len() && bytes[i] != '\'' {
                i += 1;
            }
            i += 1;
        } else {
            out.push(rest[0]);
            i += 1;
        }
    }
    out
}

/// The paths that `code` names: those that start with `crate`, `super` or `self`, or with one of its own `children`.
fn paths(code: &str, children: &BTreeSet<String>) -> Vec<Vec<String>> {
    let tokens = tokens(code);
    let mut found = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        let starts = ["crate", "super", "self"].contains(&token.as_str()) || children.contains(token);
        let is_start = starts && tokens.get(i + 1).is_some_and(|t| t == "::") && (i == 0 || tokens[i - 1] != "::");
        if is_start {
            tree(&tokens, i, &[], &mut found);
        }
    }
    found
}

/// Names and punctuation; `::` is one token.
fn tokens(code: &str) -> Vec<String> {
    let (mut tokens, mut name) = (Vec::new(), String::new());
    let mut chars = code.chars().peekable();
    while let Some(c) = chars.next() {
        if c.is_alphanumeric() || c == '_' {
            name.push(c);
            continue;
        }
        if !name.is_empty() {
            tokens.push(std::mem::take(&mut name));
        }
        if c == ':' && chars.peek() == Some(&':') {
            chars.next();
            tokens.push("::".to_owned());
        } else if !c.is_whitespace() {
            tokens.push(c.to_string());
        }
    }
    tokens.extend(Some(name).filter(|name| !name.is_empty()));
    tokens
}

/// Reads a path or a tree of paths (`a::{b, c::d}`) that starts at token `i`; returns the token after it.
fn tree(tokens: &[String], mut i: usize, prefix: &[String], found: &mut Vec<Vec<String>>) -> usize {
    let mut path = prefix.to_vec();
    loop {
        match tokens.get(i).map(String::as_str) {
            Some("{") => {
                i += 1;
                while tokens.get(i).is_some_and(|t| t != "}") {
                    i = tree(tokens, i, &path, found);
                    if tokens.get(i).is_some_and(|t| t == ",") {
                        i += 1;
                    }
                }
                return i + 1;
            }
            Some(name) if name == "*" || name.starts_with(|c: char| c.is_alphabetic() || c == '_') => {
                path.push(name.to_owned());
                i += 1;
                if tokens.get(i).is_some_and(|t| t == "::") {
                    i += 1;
                    continue;
                }
                // `as name`
                if tokens.get(i).is_some_and(|t| t == "as") {
                    i += 2;
                }
            }
            // A generic's `::<`, or the end of a list.
            _ => {}
        }
        found.push(path);
        return i.max(1);
    }
}

/// The arrows between modules: whom each one's code names.
struct Graph {
    arrows: BTreeMap<String, BTreeSet<String>>,
}

impl Graph {
    fn of(modules: &[Module]) -> Self {
        let known: BTreeSet<Vec<String>> = modules.iter().map(|m| m.path.clone()).collect();
        let children: BTreeMap<&[String], BTreeSet<String>> = modules
            .iter()
            .map(|m| {
                let own = known.iter().filter(|k| k.len() == m.path.len() + 1 && k.starts_with(&m.path));
                (m.path.as_slice(), own.filter_map(|k| k.last().cloned()).collect())
            })
            .collect();
        let exports: BTreeMap<(Vec<String>, String), Vec<String>> = modules
            .iter()
            .flat_map(|m| {
                // What `pub use` hands on belongs to the file that defines it.
                let uses: Vec<&str> =
                    m.code.split("pub use ").skip(1).filter_map(|rest| rest.split(';').next()).collect();
                let own = &children[m.path.as_slice()];
                uses.into_iter()
                    .flat_map(|u| paths(u, own))
                    .filter_map(|p| {
                        let item = p.last()?.clone();
                        Some(((m.path.clone(), item), absolute(&m.path, &p)?))
                    })
                    .collect::<Vec<_>>()
            })
            .collect();
        let resolve = |from: &[String], path: &[String]| -> Option<Vec<String>> {
            let mut path = absolute(from, path)?;
            for _ in 0..4 {
                let depth = (0..=path.len()).rev().find(|&n| known.contains(&path[..n]))?;
                match path.get(depth).and_then(|item| exports.get(&(path[..depth].to_vec(), item.clone()))) {
                    Some(definition) if *definition != path => path = definition.clone(),
                    _ => return Some(path[..depth].to_vec()),
                }
            }
            None
        };
        let arrows = modules
            .iter()
            .map(|m| {
                let named = paths(&m.code, &children[m.path.as_slice()]);
                let to = named.iter().filter_map(|p| resolve(&m.path, p)).filter(|to| *to != m.path && !to.is_empty());
                (m.name(), to.map(|to| to.join("::")).collect())
            })
            .collect();
        Self { arrows }
    }

    /// Groups of more than one module that reach each other.
    fn cycles(&self) -> Vec<Vec<String>> {
        let reach: BTreeMap<&str, BTreeSet<&str>> =
            self.arrows.keys().map(|m| (m.as_str(), self.reachable(m))).collect();
        let mut groups = BTreeSet::new();
        for (module, reached) in &reach {
            let group: Vec<String> = reached
                .iter()
                .filter(|other| reach.get(*other).is_some_and(|r| r.contains(module)))
                .map(|m| (*m).to_owned())
                .collect();
            if group.len() > 1 {
                groups.insert(group);
            }
        }
        groups.into_iter().collect()
    }

    fn reachable(&self, from: &str) -> BTreeSet<&str> {
        let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            for next in self.arrows.get(module).into_iter().flatten() {
                if reached.insert(next.as_str()) {
                    open.push(next);
                }
            }
        }
        reached
    }
}

/// A path from the crate's root; `None` for names that are not modules of this crate.
fn absolute(from: &[String], path: &[String]) -> Option<Vec<String>> {
    let mut base = match path[0].as_str() {
        "crate" => Vec::new(),
        "super" => from[..from.len().checked_sub(1)?].to_vec(),
        "self" => from.to_vec(),
        child => [from, &[child.to_owned()]].concat(),
    };
    for segment in &path[1..] {
        match segment.as_str() {
            "super" => {
                base.pop()?;
            }
            "self" => {}
            name => base.push(name.to_owned()),
        }
    }
    Some(base)
}

#[test]
fn modules_import_only_from_lower_layers() {
    let level = |module: &str| LAYERS.iter().position(|layer| layer.contains(&module));
    let mut wrong = Vec::new();
    for (from, to) in &Graph::of(&modules()).arrows {
        let Some(top) = from.split("::").next().filter(|top| !top.is_empty()) else { continue };
        let own = level(top).unwrap_or_else(|| panic!("{top} is in no layer"));
        for to in to {
            let other = to.split("::").next().unwrap();
            let other_level = level(other).unwrap_or_else(|| panic!("{other} is in no layer"));
            if other != top && other_level >= own {
                wrong.push(format!("{from} imports {to}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_two_files_import_each_other() {
    let cycles = Graph::of(&modules()).cycles();
    let lines: Vec<String> = cycles.iter().map(|group| group.join(", ")).collect();
    assert!(cycles.is_empty(), "{}", lines.join("\n"));
}

#[test]
fn every_file_says_its_job_in_its_first_line() {
    let silent: Vec<String> = ["src", "crates", "python", "tests", "benches"]
        .iter()
        .flat_map(|folder| files(&root().join(folder), "rs"))
        .filter(|file| !fs::read_to_string(file).unwrap().starts_with("//! "))
        .map(|file| file.display().to_string())
        .collect();
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

/// Lines of product code, comments left out, that `holds` is true for: "file:line: text".
fn lines_where(holds: impl Fn(&Module, &str) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for module in modules() {
        let product = module.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        for (number, line) in product.lines().enumerate() {
            if !line.trim_start().starts_with("//") && holds(&module, line) {
                found.push(format!("{}:{}: {}", module.file.display(), number + 1, line.trim()));
            }
        }
    }
    found
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
    let found = lines_where(|module, line| {
        let top = module.path.first().map_or("", String::as_str);
        !["cli", "gallery"].contains(&top) && has_flag(line) && !others.iter().any(|o| line.contains(o))
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Names of code that tell of the reports, in lower case.
fn speaks_of_reports(name: &str) -> bool {
    let name = name.to_lowercase().replace('_', "");
    let allowed = ["firstreport", "secondreport", "reported"];
    (name.contains("report") || name.contains("printed")) && !allowed.contains(&name.as_str())
}

#[test]
fn only_errata_and_what_shows_them_name_the_reports() {
    // The audit, the claims and the stability study compare what the reports print; their views, the figures and the command line
    // show it.
    let studies =
        ["study::audit", "study::claims", "study::stability", "view::audit", "view::claims", "view::stability"];
    let allowed = [&["errata", "gallery", "cli"][..], &studies].concat();
    let found: BTreeSet<String> = modules()
        .iter()
        .filter(|module| !allowed.iter().any(|prefix| module.name().starts_with(prefix)))
        .flat_map(|module| {
            let names = tokens(&module.code).into_iter().filter(|name| speaks_of_reports(name));
            names.map(|name| format!("{}: {name}", module.file.display())).collect::<Vec<_>>()
        })
        .collect();
    assert!(found.is_empty(), "{}", Vec::from_iter(found).join("\n"));
}

/// Words that only this project used, and the terms of the field for them.
const WORDS: &[(&str, &str)] = &[
    ("lamp", "area light"),
    ("lamps", "area lights"),
    ("ball", "sphere"),
    ("balls", "spheres"),
    ("casters", "caustic cones"),
    ("shine", "product warp"),
    ("glow", "emission"),
    ("evenness", "uniformity"),
    ("promise", "bound"),
    ("promises", "bounds"),
    ("howmany", "sample count"),
    ("by turns", "alternating"),
    ("told apart", "distinguished"),
    ("nobody's business", "private"),
    ("in any company", "whatever the others"),
];

#[test]
fn words_of_this_project_alone_do_not_come_back() {
    let mut found = Vec::new();
    for module in modules() {
        let product = module.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let comments = product.lines().map(str::trim).filter(|line| line.starts_with("//"));
        let names = tokens(&module.code).into_iter().flat_map(|name| words_of(&name));
        let text: Vec<String> = comments.map(str::to_lowercase).chain(names).collect();
        for (word, term) in WORDS {
            let is_whole = |line: &String| {
                line.match_indices(word).any(|(at, _)| {
                    let around = [line[..at].chars().next_back(), line[at + word.len()..].chars().next()];
                    around.into_iter().all(|c| c.is_none_or(|c| !c.is_alphanumeric()))
                })
            };
            if let Some(line) = text.iter().find(|line| is_whole(line)) {
                found.push(format!("{}: \"{word}\" is \"{term}\" in the field: {line}", module.file.display()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The words of an identifier in lower case: `AreaLight` and `area_light` are "area" and "light".
fn words_of(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for c in name.chars() {
        if c == '_' || c.is_uppercase() {
            words.push(String::new());
        }
        if c != '_' {
            words.last_mut().expect("there is one").extend(c.to_lowercase());
        }
    }
    words
}
