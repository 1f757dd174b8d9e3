//! Programs that do not keep to the protocol: each is named and ended. A program and what it started end when the test ends,
//! however that happens.

use super::{has_ps, validate};
use crate::program::{Ran, etalon};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::tempdir;

/// Validates the sampler of a shell script, of which nothing may be left afterwards.
fn script(text: &str, more: &[&str]) -> Ran {
    let folder = tempdir().unwrap();
    let [file, group] = ["client.sh", "group"].map(|name| folder.path().join(name));
    std::fs::write(&file, format!("ps -o pgid= -p $$ > '{}'\n{text}", group.display())).unwrap();
    let ran = validate(&format!("sh {}", file.display()), more);
    assert_ended(&group);
    ran
}

const GREETING: &str = "read l; echo 'etalon 1 domain=line dimension=1'; echo end; read l";

#[test]
fn a_name_gives_files_theirs_and_no_commands_to_the_terminal() {
    if !has_ps() {
        return;
    }
    // A sampler of the line that always draws the same number, and is rejected; a name with a terminal's command.
    let client = "read l; printf 'etalon 1 domain=line name=a\\033[31mb\\n'; echo end; while read what n; do i=0; \
                  while [ $i -lt $n ]; do read x; i=$((i+1)); echo 1; done; echo end; done";
    let folder = tempdir().unwrap();
    std::fs::write(folder.path().join("client.sh"), client).unwrap();
    for json in [&[][..], &["--json"]] {
        let line = [&["validate", "--detect", "0.2", "--exec", "sh client.sh"][..], json].concat();
        let ran = etalon(folder.path(), &line);
        assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
        assert!(!(ran.stdout + &ran.stderr).contains('\u{1b}'), "{line:?}");
    }
    assert!(folder.path().join("out/validation-a--31mb.csv").exists());
}

#[test]
fn programs_that_misbehave_are_named() {
    if !has_ps() {
        return;
    }
    let cases = [
        ("exit 3", "exit status: 3"),
        ("echo 'no such file' >&2; exit 1", "its standard error ends with \"no such file\""),
        ("kill -9 $$", "signal: 9"),
        ("echo hello; echo end; cat > /dev/null", "\"hello\" does not begin with"),
        ("echo etalon 1 dimension=1000; echo end; cat > /dev/null", "dimension"),
        ("echo etalon 1 mass=nan; echo end; cat > /dev/null", "mass"),
        ("echo etalon 1 domain=line domain=line; echo end; cat > /dev/null", "the key \"domain\" twice"),
        ("echo etalon 1 domain=line numbers=bits; echo end; cat > /dev/null", "hint: write hexadecimal floats"),
        ("echo Loading the scene; echo etalon 1; echo end; cat > /dev/null", "\"Loading the scene\" does not begin"),
        ("printf '\\000\\377\\200\\n'; echo end; cat > /dev/null", "not UTF-8"),
        ("head -c 5000 /dev/zero | tr '\\000' x; cat > /dev/null", "longer than 1024 bytes"),
        ("head -c 500 /dev/urandom | tr -d '\\n'; exit 1", "after 0 lines, at last"),
        ("exec >&-; cat > /dev/null", "it closed its standard output"),
        ("yes complaint >&2 & sleep 0.3; exit 1", "its standard error ends with \""),
        ("echo etalon 1 colour=red; echo end; cat > /dev/null", "colour=red"),
        ("echo etalon 1; echo end; cat > /dev/null", "does not say what its domain is"),
        ("echo etalon 1 domain=line; echo 0.5 2; echo end; cat > /dev/null", "atom \"0.5 2\""),
    ];
    for (text, expected) in cases {
        let ran = script(text, &["--timeout", "20"]);
        assert_eq!(ran.code, 2, "{text}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{text}: {}", ran.stderr);
    }
    // The first request asks for 4 samples.
    let cases = [
        ("exit 0", "asked \"sample 4\", it ended (exit status: 0) after 0 lines"),
        ("echo 0.1; echo 0.2; echo end; cat > /dev/null", "answered only 2 lines"),
        ("for i in 1 2 3 4 5; do echo 0.$i; done; echo end; cat > /dev/null", "\"0.5\" where \"end\" belongs"),
        ("echo 0.1; echo x; echo 0.2; echo 0.3; echo end; cat > /dev/null", "line 2 of the answer is \"x\""),
        ("for i in 1 2 3 4; do echo 0.1 0.2 0.3; done; echo end; cat > /dev/null", "\"0.1 0.2 0.3\""),
        ("echo segmentation fault; echo end; cat > /dev/null", "line 1 of the answer is \"segmentation fault\""),
        ("printf '\\377\\376\\n\\n\\n\\nend\\n'; cat > /dev/null", "not UTF-8"),
        ("cat /dev/zero", "longer than 1024 bytes"),
        ("yes", "\"y\" where \"end\" belongs"),
        ("yes 0.5", "where \"end\" belongs"),
        ("yes end", "it went on after \"end\""),
    ];
    for (text, expected) in cases {
        let ran = script(&format!("{GREETING}; {text}"), &["--timeout", "5"]);
        assert_eq!(ran.code, 2, "{text}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected) && ran.stderr.contains("client.sh"), "{text}: {}", ran.stderr);
    }
}

#[test]
fn nothing_hangs() {
    if !has_ps() {
        return;
    }
    let start = Instant::now();
    let silent = [
        "sleep 1000",
        // Its child holds the pipes.
        "sleep 1000 & sleep 1000 & wait",
        // Deaf: more is written than the pipe holds.
        "read l; echo 'etalon 1 domain=square dimension=2'; echo end; sleep 1000",
        // Noisy on the other channel.
        "yes complaint | head -c 20000000 >&2; sleep 1000",
    ];
    for text in silent {
        let ran = script(text, &["--timeout", "0.5"]);
        assert_eq!(ran.code, 2, "{text}: {}", ran.stderr);
        assert!(ran.stderr.contains("0.5 s") && ran.stderr.len() < 1000, "{text}: {}", ran.stderr);
    }
    assert!(start.elapsed() < Duration::from_secs(30));
}

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
            let mut bench = start(folder.path(), &format!("{GREETING}; {NOTE}; {script}"));
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
        let script = format!("{GREETING}; echo > asked; sleep 1000");
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
