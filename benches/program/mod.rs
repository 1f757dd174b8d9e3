//! What benches of whole processes share: runs of the program, its built-in scenes, the files of a folder.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The program of this package.
pub const ETALON: &str = env!("CARGO_BIN_EXE_etalon");

/// Runs a program that prints JSON; what it writes on standard error if it fails.
pub fn run(program: &str, args: &[String]) -> Result<serde_json::Value, String> {
    let output = Command::new(program).args(args).output().expect("the program runs");
    match output.status.success() {
        true => Ok(serde_json::from_slice(&output.stdout).expect("the program writes JSON")),
        false => Err(format!("{args:?}: {}", String::from_utf8_lossy(&output.stderr))),
    }
}

/// The names of the built-in scenes.
pub fn built_in() -> Vec<String> {
    let json = run(ETALON, &["scenes".into(), "--json".into()]).expect("a list of scenes");
    let scenes = json["scenes"].as_array().into_iter().flatten();
    scenes.filter_map(|scene| scene["name"].as_str()).map(str::to_owned).collect()
}

/// The files of a folder with one of these extensions, by name.
pub fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| extensions.iter().any(|extension| e == *extension)));
    paths.sort();
    paths
}
