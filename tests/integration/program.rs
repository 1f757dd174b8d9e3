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
    let output = command.current_dir(folder).args(args).timeout(Duration::from_secs(400)).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
    let code = output.status.code().unwrap_or_else(|| panic!("{args:?} was killed: {:?}", output.status));
    Ran { code, stdout, stderr }
}

/// The program, for tests that send it signals. It takes them also where the tests themselves were started with signals
/// ignored, as by `nohup` or in the background of a script, and would hand that down.
#[cfg(unix)]
pub fn interruptible() -> std::process::Command {
    use signal_hook::consts::{SIGHUP, SIGINT};
    use std::sync::{Arc, Once, atomic::AtomicBool};

    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        for signal in [SIGHUP, SIGINT] {
            // A handler in place of "ignore", which ends the tests; their children begin with the default action.
            let ends = Arc::new(AtomicBool::new(true));
            signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, ends).unwrap();
        }
    });
    std::process::Command::new(assert_cmd::cargo::cargo_bin("etalon"))
}

/// Runs `etalon --json`, which must succeed and print one JSON object and nothing else.
pub fn json(folder: &Path, args: &[&str]) -> serde_json::Value {
    let ran = etalon(folder, &[args, &["--json"]].concat());
    assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap_or_else(|e| panic!("{args:?}: {e}"));
    assert!(value.is_object(), "{args:?}: {value}");
    value
}
