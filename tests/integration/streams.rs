//! Disks that are full, pipes, closed streams, names that are taken, two runs at once: clear errors, whole files.

use crate::program::{Ran, etalon, json};
use etalon::raster::{ReadOptions, read};
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs a line of the shell, in which `$E` is the program.
fn shell(folder: &Path, line: &str) -> Ran {
    let program = assert_cmd::cargo::cargo_bin("etalon");
    let output = Command::new("sh").args(["-c", line]).env("E", program).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert!(!stderr.contains("panicked"), "{line}: {stderr}");
    Ran { code: output.status.code().unwrap_or(-1), stdout, stderr }
}

fn names(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// A limit on the size of files stands for a disk that is full: the signal ignored, writing fails in the same way.
#[test]
fn a_full_disk_is_an_error_and_keeps_what_was_there() {
    let dir = tempfile::tempdir().unwrap();
    let args = "furnace -r 120 90 -s 2";
    json(dir.path(), &["render", "furnace", "-r", "12", "9", "-s", "1", "-o", "a.exr"]);
    let (before, listing) = (std::fs::read(dir.path().join("a.exr")).unwrap(), names(dir.path()));
    for line in [
        format!("\"$E\" render {args} -o a.exr"),
        format!("\"$E\" render {args} -o b.exr --resume a-state.exr"),
        format!("\"$E\" render {args} --shard 1/2 -o c.exr"),
        "\"$E\" envmap make nave -o d.exr".into(),
        "\"$E\" fresnel -o e".into(),
        "\"$E\" reproduce --quick --only fresnel-enter -o e".into(),
    ] {
        // Blocks of 512 bytes or of 1024, as the shell likes.
        let ran = shell(dir.path(), &format!("trap '' XFSZ; ulimit -f 8; {line}"));
        assert_eq!(ran.code, 2, "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains("File too large"), "{line}: {}", ran.stderr);
        let left: Vec<String> = names(dir.path()).into_iter().filter(|name| name != "e").collect();
        assert_eq!(left, listing, "{line}");
    }
    assert!(std::fs::read(dir.path().join("a.exr")).unwrap() == before);
    assert!(names(&dir.path().join("e")).iter().all(|name| !name.starts_with('.')), "{:?}", names(dir.path()));
    if Path::new("/dev/full").exists() {
        let ran = shell(dir.path(), "\"$E\" envmap info black > /dev/full");
        assert!(ran.code == 2 && ran.stderr.contains("standard output"), "{}", ran.stderr);
    }
}

#[test]
fn pipes_and_devices_are_not_files() {
    let dir = tempfile::tempdir().unwrap();
    json(dir.path(), &["envmap", "make", "onehot", "-o", "map.exr"]);
    assert!(Command::new("mkfifo").arg("pipe.exr").current_dir(dir.path()).status().unwrap().success());
    for args in [
        &["envmap", "info", "pipe.exr"][..],
        &["envmap", "info", "/dev/zero"],
        &["merge", "pipe.exr"],
        &["render", "furnace", "--mesh", "/dev/null"],
        &["render", "furnace", "-s", "4000000", "-o", "pipe.exr"],
        &["envmap", "make", "onehot", "-o", "pipe.exr"],
    ] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains("hint: "), "{args:?}: {}", ran.stderr);
    }
    assert_eq!(names(dir.path()), ["map.exr", "pipe.exr"]);
    // A pipe of the shell is as good as a file.
    let piped = shell(dir.path(), "cat map.exr | \"$E\" envmap info /dev/stdin --json");
    let piped: serde_json::Value = serde_json::from_str(&piped.stdout).unwrap_or_else(|_| panic!("{}", piped.stderr));
    assert_eq!(piped["max"], json(dir.path(), &["envmap", "info", "map.exr"])["max"]);
}

#[test]
fn streams_may_be_closed() {
    let dir = tempfile::tempdir().unwrap();
    for line in [
        "\"$E\" envmap info onehot >&-",
        "\"$E\" envmap info onehot 2>&-",
        "\"$E\" envmap info onehot <&- >&- 2>&-",
        "\"$E\" render furnace -r 8 6 -s 1 -o a.exr >&- 2>&-",
    ] {
        assert_eq!(shell(dir.path(), line).code, 0, "{line}");
    }
    assert!(read(&dir.path().join("a.exr"), ReadOptions::default()).is_ok());
    assert_eq!(shell(dir.path(), "\"$E\" envmap info gone.exr >&- 2>&-").code, 2);
    let head = shell(dir.path(), "\"$E\" reproduce --list | head -n 1; \"$E\" --help | head -n 1");
    assert!(head.code == 0 && head.stdout.lines().count() == 2 && head.stderr.is_empty(), "{}", head.stderr);
}

#[test]
fn names_that_are_taken_are_refused_before_the_work() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a.exr", "a.png"] {
        std::fs::create_dir(dir.path().join(name)).unwrap();
        let ran = etalon(dir.path(), &["render", "furnace", "-s", "4000000", "-o", "a.exr"]);
        assert!(ran.code == 2 && ran.stderr.contains(name), "{}", ran.stderr);
        std::fs::remove_dir(dir.path().join(name)).unwrap();
    }
}

/// What a command says that lacks an argument can be pasted.
#[test]
fn examples_of_missing_arguments_run() {
    for command in ["compare", "merge", "envmap info", "envmap make", "completions"] {
        let dir = tempfile::tempdir().unwrap();
        let ran = etalon(dir.path(), &command.split(' ').collect::<Vec<_>>());
        assert_eq!(ran.code, 2, "{command}");
        let (_, example) = ran.stderr.split_once("Example:\n").unwrap_or_else(|| panic!("{command}: {}", ran.stderr));
        let line = example
            .replace("etalon ", "\"$E\" ")
            .replace("~/", "./")
            .replace("> ./.local/share/bash-completion/completions/", "> ");
        let ran = shell(dir.path(), &line);
        assert_eq!(ran.code, 0, "{command}: {example}{}", ran.stderr);
    }
}

#[test]
fn of_two_runs_at_once_each_file_is_of_one() {
    let dir = tempfile::tempdir().unwrap();
    let run = |seed: &str, out: &str| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("etalon"));
        command.args(["render", "cornell-lambert", "-r", "60", "45", "-s", "1", "--seed", seed, "-o", out]);
        command.current_dir(dir.path()).stdout(Stdio::null()).spawn().unwrap()
    };
    let image = |path: &str| read(&dir.path().join(path), ReadOptions::default()).unwrap();
    for (seed, out) in [("1", "one.pfm"), ("2", "two.pfm")] {
        assert!(run(seed, out).wait().unwrap().success());
    }
    for _ in 0..5 {
        let mut both = ["1", "2"].map(|seed| run(seed, "out/both.exr"));
        both.iter_mut().for_each(|child| assert!(child.wait().unwrap().success()));
        assert!([image("one.pfm"), image("two.pfm")].contains(&image("out/both.exr")));
        assert_eq!(names(&dir.path().join("out")), ["both.exr", "both.png"]);
    }
}
