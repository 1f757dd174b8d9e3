//! Killed or interrupted at any moment, the program leaves whole files or none, and goes on from them to the same bits.
//!
//! Each command is stopped a few times, or as often as `ETALON_KILLS` says: `ETALON_KILLS=100 cargo test --test integration kill`.

use crate::program::{etalon, interruptible, json};
use etalon::raster::{ExrFile, ReadOptions, read};
use nix::sys::signal::{Signal, kill as send};
use nix::unistd::Pid;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

/// How a command is stopped: by one signal, or by the same one twice.
const WAYS: [&[Signal]; 5] =
    [&[Signal::SIGKILL], &[Signal::SIGTERM], &[Signal::SIGINT], &[Signal::SIGHUP], &[Signal::SIGINT, Signal::SIGINT]];

/// Time between two signals: the second must not be lost in the first.
const PAUSE: Duration = Duration::from_millis(5);

/// Runs a command to its end, then again and again in folders of their own, each time stopped at a random moment;
/// `check` gets each folder.
fn kill(folder: &Path, args: &[&str], check: impl Fn(&Path)) {
    let run = |folder: &Path| {
        std::fs::create_dir(folder).unwrap();
        let mut command = interruptible();
        command.args(args).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let start = Instant::now();
    // A measurement may find its budget too small on a busy machine: exit code 3.
    let alone = run(&folder.join("alone")).wait().unwrap().code();
    assert!(matches!(alone, Some(0 | 3)), "{args:?}: {alone:?}");
    let time = start.elapsed();
    check(&folder.join("alone"));
    let trials = std::env::var("ETALON_KILLS").map_or(WAYS.len() as u32, |n| n.parse().unwrap());
    let chance = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().subsec_nanos();
    for trial in 0..trials {
        let here = folder.join(trial.to_string());
        let signals = WAYS[trial as usize % WAYS.len()];
        // Moments spread uniformly over the command's time, in an order and from a start that are different each time.
        let moment = time.mul_f64((f64::from(chance) * 1e-9 + f64::from(trial) * 0.618_034).fract());
        let mut child = run(&here);
        std::thread::sleep(moment);
        for signal in signals {
            // It may have ended by itself.
            if child.try_wait().unwrap().is_none() {
                send(Pid::from_raw(child.id() as i32), *signal).unwrap();
                std::thread::sleep(PAUSE);
            }
        }
        let output = child.wait_with_output().unwrap();
        let (status, said) = (output.status, String::from_utf8_lossy(&output.stderr));
        let what = format!("{args:?}, {signals:?} after {moment:?}: {status}: {said}");
        assert!(!said.contains("panicked"), "{what}");
        let untouched = std::fs::read_dir(&here).unwrap().next().is_none();
        let right = match (status.code(), status.signal()) {
            (Some(code), _) if code == 0 || Some(code) == alone => true,
            (Some(3), _) => signals[0] != Signal::SIGKILL,
            (Some(130), _) => signals.len() == 2,
            // Before the program has taken notice of signals, they end it.
            (_, Some(signal)) => signal == signals[0] as i32 && (signals[0] == Signal::SIGKILL || untouched),
            _ => false,
        };
        assert!(right, "{what}");
        assert!(signals[0] == Signal::SIGKILL || !has_parts(&here), "a temporary file is left: {what}");
        check(&here);
    }
}

fn has_parts(folder: &Path) -> bool {
    std::fs::read_dir(folder).unwrap().any(|entry| is_part(entry.unwrap().file_name().to_str().unwrap()))
}

fn is_part(name: &str) -> bool {
    name.starts_with(".etalon-") && name.ends_with(".part")
}

/// Every file in a folder is whole, except for hidden temporary ones; beside them are the notes on whose results they are.
fn assert_whole(folder: &Path) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if is_part(name) || name == ".etalon" {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        let whole = match path.extension().and_then(|e| e.to_str()) {
            Some("exr" | "pfm") => read(&path, ReadOptions::default()).is_ok(),
            Some("png" | "ppm") => read(&path, ReadOptions { allow_ldr: true, ..ReadOptions::default() }).is_ok(),
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
    let parts = ["1", "2"].map(|i| at(&format!("furnace.shard-{i}-of-2.exr")));
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
#[ignore = "takes seconds: cargo test -- --ignored"]
fn killed_figures_are_whole_or_missing() {
    let dir = tempfile::tempdir().unwrap();
    let args = ["reproduce", "--quick", "--only", "fresnel-enter,fresnel-exit,metals-table", "-o", "."];
    kill(dir.path(), &args, |folder| {
        assert_whole(folder);
        // What was left is a sound beginning for the next run.
        assert_eq!(etalon(folder, &args).code, 0, "{}", folder.display());
        assert_whole(folder);
    });
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn killed_measurements_are_whole_or_missing() {
    let dir = tempfile::tempdir().unwrap();
    let args =
        ["converge", "cornell-lambert", "-r", "12", "9", "--budget", "1.5", "--strategies", "mis,light", "-o", "."];
    kill(dir.path(), &args, assert_whole);
}

/// Work that never looks whether it was asked to stop ends all the same.
#[test]
fn the_first_signal_ends_work_that_does_not_look() {
    let dir = tempfile::tempdir().unwrap();
    let mut command = interruptible();
    command.args(["envmap", "cut", "sun", "-n", "524288", "-o", "cut.csv"]).current_dir(dir.path());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    let start = Instant::now();
    send(Pid::from_raw(child.id() as i32), Signal::SIGTERM).unwrap();
    let status = child.wait().unwrap();
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    assert!(status.code() == Some(3) || status.success(), "{status}");
}
