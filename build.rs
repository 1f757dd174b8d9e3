//! Tells the program what it is built from: `ETALON_SOURCES`, a hash of the sources and of the versions of dependencies, and
//! `ETALON_COMMIT`, the commit, empty where there is no repository.
//!
//! It reads the repository's files and needs no git. It never fails: what it cannot read, it leaves out.

use std::fs::{read, read_dir, read_to_string};
use std::path::{Path, PathBuf};

/// Digits of a commit that are shown.
const DIGITS: usize = 10;
/// What a result may depend on, beside the sources of the crates. A packaged program has them as dependencies, whose versions are
/// in the lock file.
const SOURCES: [&str; 3] = ["src", "envmaps", "Cargo.lock"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let commit = commit(Path::new(".git")).unwrap_or_default();
    println!("cargo::rustc-env=ETALON_COMMIT={}", commit.get(..DIGITS).unwrap_or_default());
    let mut sources = Fnv(0xcbf2_9ce4_8422_2325);
    let crates = entries(Path::new("crates")).into_iter().map(|path| path.join("src"));
    for path in SOURCES.iter().map(PathBuf::from).chain(crates).filter(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", path.display());
        sources.add(&path);
    }
    println!("cargo::rustc-env=ETALON_SOURCES={:016x}", sources.0);
}

/// The entries of a folder, in the order of their names; none if it cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    entries
}

/// The hash FNV-1a of names and contents of files.
struct Fnv(u64);

impl Fnv {
    /// Adds a file, or the files of a folder in the order of their names.
    fn add(&mut self, path: &Path) {
        // The same name on every system
        let names: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
        self.bytes(names.join("/").as_bytes());
        if path.is_dir() {
            entries(path).iter().for_each(|entry| self.add(entry));
        } else {
            self.bytes(&read(path).unwrap_or_default());
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        // The length tells where a name or a file ends
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
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
