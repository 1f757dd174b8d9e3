//! BSDFs of other programs: the example clients, wrong ones among them, and programs that misbehave.

use super::{c_header, example, has};
use crate::program::{Ran, etalon};
use tempfile::tempdir;

/// Validates the BSDF of `command` with as few samples as make a verdict.
fn validate(command: &str, more: &[&str]) -> Ran {
    let folder = tempdir().unwrap();
    etalon(folder.path(), &[&["validate", "--detect", "0.09", "--exec", command], more].concat())
}

/// Validates a BSDF with a mistake, for which fewer samples do.
fn validate_wrong(command: &str) -> Ran {
    let folder = tempdir().unwrap();
    etalon(folder.path(), &["validate", "--samples", "10000", "--exec", command])
}

/// Whether a run rejects, and names these checks for it.
fn rejects(ran: &Ran, checks: &[&str]) {
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    let is_rejected = |check: &&&str| {
        ran.stdout.lines().any(|line| line.contains(&format!("/{check}/")) && line.contains(" reject "))
    };
    assert!(checks.iter().all(|check| is_rejected(&check)), "{checks:?}: {}", ran.stdout);
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_python_client_is_tested() {
    if has("python3", &["--version"]) {
        // The furnace test below finds the mistake of this client, in less time.
        let command = format!("python3 '{}'", example("bsdf.py"));
        let ran = validate(&command, &["--set", "exponent=5"]);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_numpy_client_is_tested() {
    if has("python3", &["-c", "import numpy"]) {
        let command = format!("python3 '{}'", example("bsdf_numpy.py"));
        let ran = validate(&command, &["--set", "alpha_x=0.1"]);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
        rejects(&validate_wrong(&format!("{command} wrong")), &["formula"]);
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_client_in_c_is_tested() {
    let folder = tempdir().unwrap();
    let binary = folder.path().join("bsdf").display().to_string();
    if !c_header::compiles("bsdf.c", &binary) {
        return;
    }
    for more in [&[][..], &["--set", "eta=2.4"]] {
        let ran = validate(&binary, more);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
    }
    rejects(&validate_wrong(&format!("{binary} wrong")), &["reciprocity", "energy"]);
    for (more, expected) in [
        (["--set", "eta=9"], "eta = 9 is not from 1.01 to 3"),
        (["--set", "alpha=0.1"], "has no parameter \"alpha\""),
        (["--set", "eta"], "not NAME=VALUE"),
        (["--domain", "sphere"], "--domain"),
    ] {
        let ran = validate(&binary, &more);
        assert_eq!(ran.code, 2, "{more:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{more:?}: {}", ran.stderr);
    }
    let listed = validate(&binary, &["--list"]);
    assert!(listed.code == 0 && listed.stdout.contains("glass-c/reciprocity/60"), "{}", listed.stdout);
}

#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn programs_that_misbehave_are_named() {
    const GREETING: &str = "read l; echo 'etalon 1 kind=bsdf'; echo end; read l; ";
    let folder = tempdir().unwrap();
    let script = |text: &str| {
        let file = folder.path().join("client.sh");
        std::fs::write(&file, text).unwrap();
        validate(&format!("sh {}", file.display()), &["--timeout", "5"])
    };
    // The first request asks for samples.
    let cases = [
        ("exit 7", "it ended (exit status: 7) after 0 lines"),
        ("echo 0 0 1 1 1; echo end; cat > /dev/null", "answered only 1 lines"),
        ("yes none", "\"none\" where \"end\" belongs"),
        (
            "echo 0 0 1 x 1; yes none | head -n 1059; echo end; cat > /dev/null",
            "line 1 of the answer is \"0 0 1 x 1\" (for \"",
        ),
        ("echo 0 0; yes none | head -n 1059; echo end; cat > /dev/null", "\"0 0\""),
        ("echo delta 0 0 1 1; yes none | head -n 1059; echo end; cat > /dev/null", "\"delta 0 0 1 1\""),
        ("cat /dev/zero", "longer than 1024 bytes"),
        ("sleep 1000", "within 5 s"),
    ];
    for (text, expected) in cases {
        let ran = script(&format!("{GREETING}{text}"));
        assert_eq!(ran.code, 2, "{text}: {} {}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(expected) && ran.stderr.contains("client.sh"), "{text}: {}", ran.stderr);
    }
    let ran = script(
        "read l; echo etalon 1 kind=bsdf; echo alpha 1 0 1; echo end; read l; echo eta=no; echo end; cat > /dev/null",
    );
    assert!(ran.code == 2 && ran.stderr.contains("eta=no"), "{}", ran.stderr);
    let ran = validate("sh -c 'read l; echo etalon 1 domain=line; echo end'", &["--set", "alpha=1"]);
    assert!(ran.code == 2 && ran.stderr.contains("--set"), "{}", ran.stderr);
}

#[test]
fn a_furnace_tests_a_client() {
    if !has("python3", &["--version"]) {
        return;
    }
    let command = format!("python3 '{}'", example("bsdf.py"));
    let folder = tempdir().unwrap();
    let furnace = |command: &str| {
        let args = ["furnace", "--exec", command, "--over", "exponent", "--size", "2x1", "--error", "0.05"];
        etalon(folder.path(), &args)
    };
    let right = furnace(&command);
    assert!(
        right.code == 0 && right.stdout.contains("phong-python (diffuse = 0.5)"),
        "{} {}",
        right.stdout,
        right.stderr
    );
    // Weights without the cosine create energy.
    let wrong = furnace(&format!("{command} wrong"));
    assert!(wrong.code == 1 && wrong.stdout.contains("VIOLATIONS"), "{} {}", wrong.stdout, wrong.stderr);
    let sampler = furnace(&format!("python3 '{}'", example("sampler.py")));
    assert!(sampler.code == 2 && sampler.stderr.contains("no BSDFs"), "{}", sampler.stderr);
}
