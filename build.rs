//! Tells the program which commit it is built on: `ETALON_COMMIT`, empty where there is no repository.
//!
//! It reads the repository's files and needs no git. It never fails: what it cannot read, it leaves out.

use std::fs::read_to_string;
use std::path::{Path, PathBuf};

/// Digits of a commit that are shown.
const DIGITS: usize = 10;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let commit = commit(Path::new(".git")).unwrap_or_default();
    println!("cargo::rustc-env=ETALON_COMMIT={}", commit.get(..DIGITS).unwrap_or_default());
}

/// The commit of HEAD. `git` is the repository's folder, or in a linked worktree a file that names the folder.
fn commit(git: &Path) -> Option<String> {
    let folder = match read_to_string(git) {
        Ok(text) => PathBuf::from(text.strip_prefix("gitdir:")?.trim()),
        Err(_) => git.to_path_buf(),
    };
    let head = watched(&folder.join("HEAD"))?;
    let Some(name) = head.strip_prefix("ref:").map(str::trim) else { return hash(&head) };
    // Branches are in the main repository, each in a file of its own or packed with others
    let common =
        read_to_string(folder.join("commondir")).map_or_else(|_| folder.clone(), |path| folder.join(path.trim()));
    let packed = || {
        let text = watched(&common.join("packed-refs"))?;
        text.lines().find_map(|line| line.strip_suffix(name)?.strip_suffix(' ').and_then(hash))
    };
    watched(&common.join(name)).and_then(|text| hash(&text)).or_else(packed)
}

/// A file's text; cargo builds again when it changes.
fn watched(path: &Path) -> Option<String> {
    let text = read_to_string(path).ok()?;
    println!("cargo::rerun-if-changed={}", path.display());
    Some(text)
}

fn hash(text: &str) -> Option<String> {
    let text = text.trim();
    (text.len() >= 40 && text.bytes().all(|b| b.is_ascii_hexdigit())).then(|| text.to_owned())
}
