//! The examples of the book run as they stand there.

use std::path::Path;
use std::time::Duration;

/// Every line of a `sh` block that starts with `etalon`, with the exit code that it should have.
fn examples(page: &str) -> Vec<(String, i32)> {
    let mut runs = false;
    let mut lines = Vec::new();
    for line in page.lines() {
        if let Some(info) = line.strip_prefix("```") {
            runs = info == "sh";
        } else if runs && line.starts_with("etalon ") {
            let (command, comment) = line.split_once(" #").unwrap_or((line, ""));
            let code = comment.trim().strip_prefix("exit ").map_or(0, |code| code.trim().parse().unwrap());
            lines.push((command.trim().to_owned(), code));
        }
    }
    lines
}

#[test]
fn examples_run() {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src");
    let summary = std::fs::read_to_string(book.join("SUMMARY.md")).unwrap();
    let mut count = 0;
    for page in std::fs::read_dir(&book).unwrap().map(|entry| entry.unwrap().path()) {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&page).unwrap();
        assert!(name == "SUMMARY.md" || summary.contains(&format!("({name})")), "{name} is not in the summary");
        let folder = tempfile::tempdir().unwrap();
        for (command, code) in examples(&text) {
            let words = shlex::split(&command).unwrap();
            let mut etalon = assert_cmd::Command::cargo_bin("etalon").unwrap();
            etalon.args(&words[1..]).current_dir(&folder).timeout(Duration::from_secs(60)).assert().code(code);
            count += 1;
        }
    }
    assert!(count > 10, "{count} examples");
}

/// Of all that `reproduce` writes, the repository keeps the checks and what the pages show.
#[test]
fn pictures_shown_are_kept_and_no_others() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = std::fs::read_dir(root.join("docs/src")).unwrap().map(|entry| entry.unwrap().path());
    let mut shown: Vec<String> = pages
        .chain([root.join("README.md")])
        .flat_map(|page| {
            let text = std::fs::read_to_string(page).unwrap();
            let names = text.split("](").skip(1).filter_map(|link| link.split_once(')')?.0.rsplit_once("figures/"));
            names.map(|(_, name)| name.to_owned()).filter(|name| !name.is_empty()).collect::<Vec<_>>()
        })
        .chain(["checks.csv".into()])
        .collect();
    shown.sort();
    shown.dedup();
    let ignored = std::fs::read_to_string(root.join(".gitignore")).unwrap();
    let kept: Vec<&str> = ignored.lines().filter_map(|line| line.strip_prefix("!/figures/")).collect();
    assert_eq!(kept, shown);
    // A package has no figures.
    let folder = root.join("figures");
    assert!(!folder.is_dir() || shown.iter().all(|name| folder.join(name).is_file()), "{shown:?}");
}
