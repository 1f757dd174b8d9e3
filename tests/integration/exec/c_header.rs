//! Clients in C and C++ upon `include/etalon.h`: they compile without warnings, are tested, and refuse requests that make no sense.

use super::{example, has, validate};
use crate::program::etalon;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::tempdir;

/// Options of a compiler for its language, strict.
const C99: [&str; 1] = ["-std=c99"];
const CPP11: [&str; 3] = ["-x", "c++", "-std=c++11"];

/// Compiles an example by a compiler, if there is one.
fn compiles_by(compiler: &str, language: &[&str], name: &str, binary: &str) -> bool {
    if !has(compiler, &["--version"]) {
        return false;
    }
    let include = format!("-I{}", Path::new(env!("CARGO_MANIFEST_DIR")).join("include").display());
    let source = example(name);
    let strict = ["-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", &include];
    let arguments = [language, &strict, &[source.as_str(), "-o", binary, "-lm"]].concat();
    let ran = Command::new(compiler).args(&arguments).output().unwrap();
    assert!(ran.status.success(), "{compiler} {name}: {}", String::from_utf8_lossy(&ran.stderr));
    true
}

/// Compiles an example in C, if there is a compiler.
pub fn compiles(name: &str, binary: &str) -> bool {
    compiles_by("cc", &C99, name, binary)
}

#[test]
fn examples_compile_as_c_and_as_cpp_and_are_tested() {
    let folder = tempdir().unwrap();
    let binary = folder.path().join("client").display().to_string();
    for (compiler, language) in [("gcc", &C99[..]), ("clang", &C99), ("g++", &CPP11), ("clang++", &CPP11)] {
        for (name, wrong) in [
            ("cosine.c", true),
            ("sampler.c", false),
            ("half_disk.c", false),
            ("bsdf.c", false),
            ("reservoir.c", false),
        ] {
            if !compiles_by(compiler, language, name, &binary) {
                continue;
            }
            if name != "bsdf.c" {
                let ran = validate(&binary, &[]);
                assert_eq!(ran.code, 0, "{compiler} {name}: {} {}", ran.stdout, ran.stderr);
            }
            if wrong {
                let ran = validate(&format!("{binary} wrong"), &[]);
                assert!(ran.code == 1 && ran.stdout.contains(" % too many within "), "{compiler}: {}", ran.stdout);
            }
        }
    }
}

#[test]
fn weights_and_parameters_are_served() {
    let folder = tempdir().unwrap();
    let binary = folder.path().join("reservoir").display().to_string();
    if compiles("reservoir.c", &binary) {
        let wrong = validate(&format!("{binary} wrong"), &[]);
        assert!(wrong.code == 1 && wrong.stdout.contains("fails over the whole of its ranges"), "{}", wrong.stdout);
    }
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let folder = tempdir().unwrap();
    let [sampler, bsdf] = ["cosine.c", "bsdf.c"].map(|name| {
        let binary = folder.path().join(name).with_extension("").display().to_string();
        compiles(name, &binary).then_some(binary)
    });
    let (Some(sampler), Some(bsdf)) = (sampler, bsdf) else { return };
    for (client, requests, code, said) in [
        (&sampler, "etalon 1\nquit\n", 0, ""),
        (&sampler, "etalon 1\n", 0, ""),
        (&sampler, "", 0, ""),
        (&sampler, "pdf 2\n0 0 1\n", 2, "the input ends early"),
        (&sampler, "pdf 1\n0 0\n", 2, "too few numbers: 0 0"),
        (&sampler, "pdf 1\n0 0 1 1\n", 2, "too many numbers"),
        (&sampler, "sample 1\n0.5 half\n", 2, "too few numbers"),
        (&sampler, "invert 1\n0 0 1\n", 2, "an unknown request: invert"),
        (&sampler, "eval 1\n", 2, "an unknown request: eval"),
        (&bsdf, "etalon 1\nset 1.5 2\n", 2, "too many numbers"),
        (&bsdf, "eval 1\n0 0 1\n", 2, "too few numbers"),
        (&bsdf, "invert 1\n", 2, "an unknown request"),
    ] {
        let mut started = Command::new(client);
        started.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut started = started.spawn().unwrap();
        started.stdin.take().unwrap().write_all(requests.as_bytes()).unwrap();
        let ran = started.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(code), "{requests:?}: {stderr}");
        assert!(stderr.contains(said), "{requests:?}: {stderr}");
    }
}

/// The project of `examples/cmake`, with the program under test in its path.
#[test]
fn a_cmake_project_tests_its_sampler() {
    if !has("cmake", &["--version"]) || !has("cc", &["--version"]) {
        return;
    }
    let folder = tempdir().unwrap();
    // Where the program is.
    assert_eq!(etalon(folder.path(), &["--version"]).code, 0);
    let program = assert_cmd::cargo::cargo_bin("etalon");
    let define = format!("-DETALON={}", program.display());
    let run = |command: &str, args: &[&str]| {
        let ran = Command::new(command).args(args).current_dir(folder.path()).output().unwrap();
        let text = String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr);
        assert!(ran.status.success(), "{command} {args:?}: {text}");
        text
    };
    run("cmake", &["-S", &example("cmake"), "-B", "build", &define]);
    run("cmake", &["--build", "build"]);
    let said = run("ctest", &["--test-dir", "build", "--output-on-failure"]);
    assert!(said.contains("100% tests passed, 0 tests failed out of 2"), "{said}");
}
