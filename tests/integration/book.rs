//! The examples of the book run as they stand there.

use crate::exec::has;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

/// Every line of a `sh` block that starts with `etalon` or `cc`, with the exit code that it should have.
fn examples(page: &str) -> Vec<(String, i32)> {
    let mut runs = false;
    let mut lines = Vec::new();
    for line in page.lines() {
        if let Some(info) = line.strip_prefix("```") {
            runs = info == "sh";
        } else if runs && (line.starts_with("etalon ") || line.starts_with("cc ")) {
            let (command, comment) = line.split_once(" #").unwrap_or((line, ""));
            let code = comment.trim().strip_prefix("exit ").map_or(0, |code| code.trim().parse().unwrap());
            lines.push((command.trim().to_owned(), code));
        }
    }
    lines
}

/// Copies what the commands of the book name in the repository: the clients, and the header of those in C.
fn copy_clients(folder: &Path) {
    for name in ["examples", "include"] {
        std::fs::create_dir(folder.join(name)).unwrap();
        for file in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap() {
            let file = file.unwrap().path();
            if file.is_file() {
                std::fs::copy(&file, folder.join(name).join(file.file_name().unwrap())).unwrap();
            }
        }
    }
}

#[test]
#[ignore = "takes minutes: cargo test -- --ignored"]
fn examples_run() {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src");
    let summary = std::fs::read_to_string(book.join("SUMMARY.md")).unwrap();
    let program = assert_cmd::cargo::cargo_bin("etalon");
    let before = std::env::var_os("PATH").unwrap_or_default();
    let folders = program.parent().map(Path::to_owned).into_iter().chain(std::env::split_paths(&before));
    let path = std::env::join_paths(folders).unwrap();
    let mut count = 0;
    for page in std::fs::read_dir(&book).unwrap().map(|entry| entry.unwrap().path()) {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&page).unwrap();
        assert!(name == "SUMMARY.md" || summary.contains(&format!("({name})")), "{name} is not in the summary");
        let folder = tempfile::tempdir().unwrap();
        copy_clients(folder.path());
        for (command, code) in examples(&text) {
            let words = shlex::split(&command).unwrap();
            let needed =
                [("cc", words[0] == "cc"), ("python3", command.contains(".py"))].into_iter().filter(|(_, is)| *is);
            if !needed.into_iter().all(|(tool, _)| has(tool, &["--version"])) {
                continue;
            }
            let mut example = assert_cmd::Command::new(&words[0]);
            example.args(&words[1..]).current_dir(&folder).env("PATH", &path);
            example.timeout(Duration::from_secs(300)).assert().code(code);
            count += 1;
        }
    }
    assert!(count > 10, "{count} examples");
}

#[test]
fn the_first_sampler_is_the_file_of_the_examples() {
    let file = include_str!("../../examples/my_sampler.py");
    for page in [include_str!("../../README.md"), include_str!("../../docs/src/external-samplers.md")] {
        assert!(page.contains(&format!("```python\n{file}```")));
    }
}

/// The names that a cell of a table lists in backquotes; `.name` stands for the last part of the name before it.
fn names(cell: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in cell.split('`').skip(1).step_by(2) {
        let before = names.last().and_then(|before| before.rsplit_once('.')).map_or("", |(stem, _)| stem);
        names.push(if name.starts_with('.') { format!("{before}{name}") } else { name.to_owned() });
    }
    names
}

/// The keys of a value and of all objects in it, as `outer.inner` and `list[].inner`.
fn keys(value: &serde_json::Value, name: &str) -> BTreeSet<String> {
    let inner: BTreeSet<String> = match value {
        serde_json::Value::Object(map) if name.is_empty() => map.iter().flat_map(|(k, v)| keys(v, k)).collect(),
        serde_json::Value::Object(map) => map.iter().flat_map(|(k, v)| keys(v, &format!("{name}.{k}"))).collect(),
        serde_json::Value::Array(list) => {
            list.iter().filter(|v| v.is_object()).flat_map(|v| keys(v, &format!("{name}[]"))).collect()
        }
        _ => BTreeSet::new(),
    };
    if inner.is_empty() { [name.to_owned()].into() } else { inner }
}

/// The page of columns and keys lists what its commands write, and nothing else.
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn columns_and_keys_are_those_of_the_page() {
    let page = include_str!("../../docs/src/columns.md");
    let mut tables = 0;
    for section in page.split("\n## ").skip(1) {
        let folder = tempfile::tempdir().unwrap();
        let mut printed = String::new();
        for (command, code) in examples(section) {
            let mut etalon = assert_cmd::Command::cargo_bin("etalon").unwrap();
            let run = etalon.args(&shlex::split(&command).unwrap()[1..]).current_dir(&folder).assert().code(code);
            printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
        }
        let mut files: Vec<_> = ["", "out", "figs"].iter().map(|inner| folder.path().join(inner)).collect();
        files.retain(|path| path.is_dir());
        for table in section.split("\n\n").filter(|block| block.starts_with("| ")) {
            let rows = table.lines().skip(2).map(|row| row.trim_matches('|').split_once('|').unwrap());
            let (header, _) = table.trim_start_matches("| ").split_once(" | ").unwrap();
            if let Some(file) = names(header).first() {
                let path = files.iter().map(|inner| inner.join(file)).find(|path| path.is_file());
                let text = std::fs::read_to_string(path.unwrap_or_else(|| panic!("{file} is not written"))).unwrap();
                let listed: Vec<String> = rows.flat_map(|(cell, _)| names(cell)).collect();
                let first = text.lines().find(|line| !line.starts_with('#')).unwrap();
                assert_eq!(first.split(',').collect::<Vec<_>>(), listed, "{file}");
            } else {
                let mut found = keys(&serde_json::from_str(&printed).unwrap(), "");
                let in_all = ["files", "replaced", "interrupted"];
                found.retain(|key| !in_all.contains(&key.rsplit('.').next().unwrap()));
                let (mut listed, mut optional) = (BTreeSet::new(), BTreeSet::new());
                for (cell, meaning) in rows {
                    let is_optional = meaning.trim().starts_with("if ");
                    if is_optional { &mut optional } else { &mut listed }.extend(names(cell));
                }
                listed.retain(|key| !in_all.contains(&key.rsplit('.').next().unwrap()));
                found.retain(|key| !optional.contains(key));
                assert_eq!(found, listed, "keys of {}", section.lines().next().unwrap());
            }
            tables += 1;
        }
    }
    assert!(tables > 20, "{tables} tables");
}

/// The repository keeps what the pages show of all that `reproduce` writes.
#[test]
fn pictures_shown_are_kept_and_no_others() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = std::fs::read_dir(root.join("docs/src")).unwrap().map(|entry| entry.unwrap().path());
    let mut shown: Vec<String> = pages
        .chain([root.join("README.md"), root.join("figures/README.md")])
        .flat_map(|page| {
            // A package has no figures, and no page of them.
            let text = std::fs::read_to_string(&page).unwrap_or_default();
            let beside = page.parent().is_some_and(|folder| folder.ends_with("figures"));
            let name = |link: &str| {
                let link = link.split_once(')')?.0;
                let name = link.rsplit_once("figures/").map(|(_, name)| name);
                name.or_else(|| (beside && !link.contains('/')).then_some(link)).map(str::to_owned)
            };
            text.split("](").skip(1).filter_map(name).filter(|name| !name.is_empty()).collect::<Vec<_>>()
        })
        .chain(["README.md".into()])
        .collect();
    shown.sort();
    shown.dedup();
    let ignored = std::fs::read_to_string(root.join(".gitignore")).unwrap();
    let kept: Vec<&str> = ignored.lines().filter_map(|line| line.strip_prefix("!/figures/")).collect();
    let folder = root.join("figures");
    if folder.is_dir() {
        assert_eq!(kept, shown);
        let missing: Vec<&String> = shown.iter().filter(|name| !folder.join(name).is_file()).collect();
        assert!(missing.is_empty(), "not in figures/, `etalon reproduce` makes them: {missing:?}");
    }
}

/// Every Markdown file of the repository, and every file of tests, whose comments name commands.
fn texts() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["", "docs/src", "crates/etalon-stats", "tests/integration", "tests/fuzz"];
    let files =
        folders.iter().flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap()).map(|e| e.unwrap().path());
    let named = files.filter(|path| path.extension().is_some_and(|e| e == "md" || e == "rs"));
    named.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap())).collect()
}

/// Files and test binaries that a text names are there.
#[test]
fn files_and_tests_that_texts_name_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for (name, text) in texts() {
        // A path in backquotes that begins with a folder of the repository
        for path in text.split('`').skip(1).step_by(2).filter(|quoted| !quoted.contains([' ', '\n', '…', '*', '{'])) {
            let ours = ["src/", "crates/", "tests/", "docs/", "benches/", "examples/"];
            if ours.iter().any(|folder| path.starts_with(folder)) && name.ends_with(".md") {
                assert!(root.join(path).exists(), "{name} names {path}, which does not exist");
                count += 1;
            }
            if path.starts_with("etalon-") && path.contains("/src/") {
                assert!(root.join("crates").join(path).exists(), "{name} names {path}, which does not exist");
                count += 1;
            }
        }
        for test in text.split("cargo ").skip(1).filter_map(|rest| rest.split('`').next()?.split(" --test ").nth(1)) {
            let test = test.split_whitespace().next().unwrap();
            let folders = ["tests", "crates/etalon-stats/tests"].map(|folder| root.join(folder).join(test));
            assert!(
                folders.iter().any(|folder| folder.join("main.rs").is_file() || folder.with_extension("rs").is_file()),
                "{name} names the test {test}"
            );
            count += 1;
        }
    }
    assert!(count > 25, "{count} names");
}

/// Code that a page quotes, below the path of its file, stands in the file, so that it compiles; indentation aside.
#[test]
fn quoted_code_is_that_of_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let lines = |text: &str| text.trim().lines().map(|line| format!("{}\n", line.trim())).collect::<String>();
    let mut count = 0;
    for (name, text) in texts().iter().filter(|(name, _)| name.ends_with(".md")) {
        for (before, rest) in
            text.match_indices("```rust,ignore\n").map(|(i, mark)| (&text[..i], &text[i + mark.len()..]))
        {
            let (_, file) = before.trim_end().rsplit_once('\n').expect("a quotation has the path of its file above it");
            let source = std::fs::read_to_string(root.join(file.trim_matches('`'))).expect(file);
            let (code, _) = rest.split_once("\n```").expect("the end of a block");
            assert!(lines(&source).contains(&lines(code)), "{name}: not in {file}:\n{code}");
            count += 1;
        }
    }
    assert!(count >= 11, "{count} quotations");
}

#[test]
fn the_table_of_materials_has_every_bsdf() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src/materials.md");
    let page = std::fs::read_to_string(page).unwrap();
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with('|')).collect();
    for (name, _) in etalon::bsdf::ALL {
        assert!(rows.iter().any(|row| row.contains(&format!("`{name}`"))), "{name}");
    }
}
