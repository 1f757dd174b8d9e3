//! Programs that do not keep to the protocol: each is named and ended.

use super::group::assert_ended;
use super::{has_ps, validate};
use crate::program::{Ran, etalon};
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

const HELLO: &str = "read l; echo 'etalon 1 domain=line dimension=1'; echo end; read l; ";

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
        let ran = script(&format!("{HELLO}{text}"), &["--timeout", "5"]);
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
