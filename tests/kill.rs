//! Killed at any moment, the program leaves whole files or none, and goes on from them to the same bits.

mod program;

use etalon::raster::{ExrFile, ReadOptions, read};
use program::{etalon, json};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Moments at which a command is killed, spread over the time that it takes alone.
const MOMENTS: u32 = 4;

/// Runs a command to its end, then again and again in folders of their own, killed at one moment after the other;
/// `check` gets each folder.
fn kill(folder: &Path, args: &[&str], check: impl Fn(&Path)) {
    let run = |folder: &Path| {
        std::fs::create_dir(folder).unwrap();
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("etalon"));
        command.args(args).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let start = Instant::now();
    assert!(run(&folder.join("alone")).wait().unwrap().success());
    let time = start.elapsed();
    check(&folder.join("alone"));
    for moment in 0..=MOMENTS {
        let here = folder.join(moment.to_string());
        let mut child = run(&here);
        std::thread::sleep(time * moment / MOMENTS);
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"));
        check(&here);
    }
}

/// Every file in a folder is whole, but for hidden temporary ones.
fn assert_whole(folder: &Path) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.starts_with(".etalon-") && name.ends_with(".part") {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        let whole = match path.extension().and_then(|e| e.to_str()) {
            Some("exr" | "pfm") => read(&path, ReadOptions::default()).is_ok(),
            Some("png" | "ppm") => read(&path, ReadOptions { allow_ldr: true }).is_ok(),
            Some("csv") => bytes.ends_with(b"\n"),
            Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
            Some("html") => bytes.trim_ascii_end().ends_with(b"</html>"),
            Some("svg") => bytes.trim_ascii_end().ends_with(b"</svg>"),
            Some("pdf") => bytes.trim_ascii_end().ends_with(b"%%EOF"),
            _ => false,
        };
        assert!(whole, "{name} ({} bytes)", bytes.len());
    }
}

#[test]
fn a_killed_render_goes_on_to_the_same_bits() {
    let dir = tempfile::tempdir().unwrap();
    let layers = |path: &Path| ExrFile::open(path).unwrap().layers().unwrap();
    let args = ["render", "cornell-spheres", "-r", "32", "24", "-s", "150", "-l", "1", "--paths", "1"];
    json(dir.path(), &[&args[..], &["-o", "whole.exr"]].concat());
    let whole = layers(&dir.path().join("whole.exr"));
    let resumed = [&args[..], &["-o", "a.exr", "--resume", "state.exr"]].concat();
    kill(dir.path(), &resumed, |folder| {
        assert_whole(folder);
        json(folder, &resumed);
        for name in ["a.exr", "state.exr"] {
            assert!(layers(&folder.join(name)) == whole, "{}: {name}", folder.display());
        }
    });
}

#[test]
fn a_killed_merge_leaves_what_was_there() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    for shard in ["1/2", "2/2"] {
        let args = ["render", "furnace", "-r", "200", "150", "-s", "2", "--shard", shard, "-o", "."];
        assert_eq!(etalon(dir.path(), &args).code, 0);
    }
    let parts = ["1", "2"].map(|i| at(&format!("furnace-r200x150-s2.shard-{i}-of-2.exr")));
    let before = std::fs::read(&parts[0]).unwrap();
    kill(dir.path(), &["merge", &parts[0], &parts[1], "-o", "all.exr"], assert_whole);
    // Onto one of the parts: it holds one sample, or both.
    let onto = dir.path().join("onto");
    std::fs::create_dir(&onto).unwrap();
    kill(&onto, &["merge", &parts[0], &parts[1], "-o", &at("onto.exr")], |_| {
        if dir.path().join("onto.exr").exists() {
            assert!(read(&dir.path().join("onto.exr"), ReadOptions::default()).is_ok());
        }
    });
    assert!(std::fs::read(&parts[0]).unwrap() == before, "parts are only read");
}

#[test]
fn killed_figures_are_whole_or_missing() {
    let dir = tempfile::tempdir().unwrap();
    let args = ["reproduce", "--quick", "--only", "fresnel-enter,fresnel-exit,metals-table", "-o", "."];
    kill(dir.path(), &args, assert_whole);
}
