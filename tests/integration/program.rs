//! Runs the program in a folder, and refuses what no run may do: die of a signal, panic, or hang.

use std::path::Path;
use std::time::Duration;

/// What a run left behind.
pub struct Ran {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Runs `etalon` with `folder` as its working directory.
pub fn etalon(folder: &Path, args: &[&str]) -> Ran {
    let mut command = assert_cmd::Command::cargo_bin("etalon").unwrap();
    let output = command.current_dir(folder).args(args).timeout(Duration::from_secs(180)).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
    let code = output.status.code().unwrap_or_else(|| panic!("{args:?} was killed: {:?}", output.status));
    Ran { code, stdout, stderr }
}

/// Runs `etalon --json`, which must succeed and print one JSON object and nothing else.
pub fn json(folder: &Path, args: &[&str]) -> serde_json::Value {
    let ran = etalon(folder, &[args, &["--json"]].concat());
    assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap_or_else(|e| panic!("{args:?}: {e}"));
    assert!(value.is_object(), "{args:?}: {value}");
    value
}
