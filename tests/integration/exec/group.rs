//! A program and what it started end when the test ends, however that happens.

use super::{etalon, has_ps};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::tempdir;

/// Waits until `found` finds something, at most for so long that a busy machine gets there.
fn wait_for<T>(mut found: impl FnMut() -> Option<T>) -> Option<T> {
    let deadline = Instant::now() + Duration::from_secs(30);
    loop {
        let value = found();
        if value.is_some() || Instant::now() > deadline {
            return value;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The process group whose number a script wrote into a file.
fn group_in(file: &Path) -> Option<u32> {
    std::fs::read_to_string(file).ok()?.trim().parse().ok()
}

/// The processes of a group, without those that have ended and are only not waited for.
fn members(group: u32) -> Vec<String> {
    let output = Command::new("ps").args(["-A", "-o", "pgid=,stat=,args="]).output().unwrap();
    let lives = |line: &&str| {
        let mut words = line.split_ascii_whitespace();
        words.next() == Some(&group.to_string()) && !words.next().unwrap_or_default().starts_with('Z')
    };
    String::from_utf8_lossy(&output.stdout).lines().filter(lives).map(str::to_owned).collect()
}

/// Soon nothing lives of the group whose number is in a file.
pub fn assert_ended(file: &Path) {
    let group = group_in(file).unwrap();
    let ended = wait_for(|| members(group).is_empty().then_some(()));
    assert!(ended.is_some(), "still there: {:?}", members(group));
}

/// Starts a test of a shell script.
fn start(folder: &Path, script: &str) -> Child {
    std::fs::write(folder.join("client.sh"), script).unwrap();
    crate::program::interruptible()
        .args(["validate", "--exec", "sh client.sh", "--samples", "1000", "--timeout", "5"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

const HELLO: &str = "read l; echo 'etalon 1 domain=line dimension=1'; echo end; read l";
const NOTE: &str = "ps -o pgid= -p $$ > group.part; mv group.part group";

#[test]
fn signals_end_the_program_and_what_it_started() {
    if !has_ps() {
        return;
    }
    let hanging = [
        "sleep 1000",
        "while :; do :; done",
        "sleep 1000 & (sleep 1000 & wait) & wait",
        "trap '' HUP INT TERM; sleep 1000 & while :; do sleep 1000; done",
        // Signals to its own group end neither the guard of the group nor what ignores them.
        "trap '' HUP INT TERM; kill -TERM 0; kill -INT 0; kill -HUP 0; sleep 1000",
    ];
    for script in hanging {
        for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP, Signal::SIGKILL] {
            let folder = tempdir().unwrap();
            let mut bench = start(folder.path(), &format!("{HELLO}; {NOTE}; {script}"));
            let group = folder.path().join("group");
            let noted = wait_for(|| group_in(&group));
            kill(Pid::from_raw(bench.id() as i32), signal).unwrap();
            let ended = wait_for(|| bench.try_wait().unwrap());
            assert!(noted.is_some() && ended.is_some(), "{script} {signal}: {noted:?} {ended:?}");
            assert_ended(&group);
        }
    }
}

/// A request to stop is noticed while an answer is waited for, long before its time limit.
#[test]
fn an_answer_is_not_waited_for_after_a_signal() {
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let folder = tempdir().unwrap();
        let script = format!("{HELLO}; echo > asked; sleep 1000");
        std::fs::write(folder.path().join("client.sh"), script).unwrap();
        let mut bench = crate::program::interruptible()
            .args(["validate", "--exec", "sh client.sh", "--samples", "1000", "--timeout", "600"])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let asked = wait_for(|| folder.path().join("asked").exists().then_some(()));
        kill(Pid::from_raw(bench.id() as i32), signal).unwrap();
        let ended = wait_for(|| bench.try_wait().unwrap());
        assert!(asked.is_some() && ended.and_then(|status| status.code()) == Some(3), "{signal}: {ended:?}");
    }
}

/// A program that ends by itself, after a right or a wrong answer, is not the last of its group.
#[test]
fn what_a_program_left_behind_is_ended() {
    if !has_ps() {
        return;
    }
    for (answers, code) in [
        ("read l; echo x; echo end; read l", 2),
        ("read l; exit 1", 2),
        // One outcome: all samples are 0, all densities 1.
        (
            "while read -r verb n rest; do case $verb in sample) yes 0 | head -n $n;; pdf) for i in $(seq $n); do \
             read -r l; echo 1; done;; quit) exit;; esac; echo end; done",
            0,
        ),
    ] {
        let folder = tempdir().unwrap();
        let script = format!(
            "{NOTE}; sleep 1000 > /dev/null 2>&1 & read l; echo 'etalon 1 domain=discrete:1 dimension=0'; echo end; {answers}"
        );
        std::fs::write(folder.path().join("client.sh"), script).unwrap();
        let ran = etalon(folder.path(), &["validate", "--exec", "sh client.sh", "--samples", "1000"]);
        assert_eq!(ran.code, code, "{answers}: {} {}", ran.stdout, ran.stderr);
        assert_ended(&folder.path().join("group"));
    }
}
