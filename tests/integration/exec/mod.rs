//! External samplers: the example clients, programs that misbehave, how programs end, and files of samples.

mod bsdfs;
mod c_header;
mod files;
#[cfg(unix)]
mod misbehaviour;
mod python_files;

use crate::program::{Ran, etalon, json};
use std::path::Path;
use std::process::Command;
use tempfile::tempdir;

/// The path of an example.
pub fn example(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).display().to_string()
}

/// Whether a command succeeds; says that a test is skipped if not.
pub fn has(program: &str, args: &[&str]) -> bool {
    let found = Command::new(program).args(args).output().is_ok_and(|output| output.status.success());
    if !found {
        eprintln!("skipped: {program} {args:?} does not run here");
    }
    found
}

/// Whether processes can be listed; says that a test is skipped if not.
#[cfg(unix)]
fn has_ps() -> bool {
    has("ps", &["-A", "-o", "pgid=,stat=,args="])
}

/// Validates the sampler of `command` with few samples.
fn validate(command: &str, more: &[&str]) -> Ran {
    let folder = tempdir().unwrap();
    etalon(folder.path(), &[&["validate", "--samples", "40000", "--exec", command], more].concat())
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn python_clients_are_tested() {
    if has("python3", &["--version"]) {
        let command = format!("python3 '{}'", example("sampler.py"));
        let ran = validate(&command, &[]);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
        assert_eq!(validate(&format!("{command} wrong"), &[]).code, 1);
        let ran = validate(&command, &["--domain", "sphere"]);
        assert_eq!(ran.code, 2);
        assert!(ran.stderr.contains("its domain is hemisphere"), "{}", ran.stderr);
    }
    if has("python3", &["-c", "import numpy"]) {
        let ran = validate(&format!("python3 '{}' 0.05", example("sampler_numpy.py")), &[]);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
    }
}

#[test]
fn a_client_with_its_own_numbers_gives_the_same_again() {
    let folder = tempdir().unwrap();
    let binary = folder.path().join("sampler").display().to_string();
    if !c_header::compiles("sampler.c", &binary) {
        return;
    }
    let statistic = |args: &[&str]| {
        let args = [&["validate", "--samples", "200000", "--exec", &binary], args].concat();
        let value = json(folder.path(), &args);
        assert_eq!(value["accepted"], 1);
        value["tests"][0]["statistic"].as_f64().unwrap()
    };
    let one = statistic(&["--threads", "1"]);
    assert_eq!(one, statistic(&["--threads", "3"]));
    assert_ne!(one, statistic(&["--seed", "2"]));
}

#[test]
fn crlf_and_a_byte_order_mark_are_read() {
    if has("python3", &["--version"]) {
        let windows = r#"import sys; sys.stdout.reconfigure(newline="\r\n"); sys.stdout.write("\ufeff"); exec(open(sys.argv[1]).read())"#;
        let ran = validate(&format!("python3 -c '{windows}' '{}'", example("sampler.py")), &[]);
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
    }
}

/// Seeds of legacy generators, numpy's `RandomState` among them, have 32 bits.
#[test]
fn seeds_have_32_bits_and_never_come_twice() {
    const CLIENT: &str = "
import random, sys
seen = set()
for request in sys.stdin:
    verb, *words = request.split()
    if verb == 'etalon':
        print('etalon 1 domain=line dimension=0')
    elif verb == 'sample':
        seed = int(words[1])
        assert 0 <= seed < 2**32, f'the seed {seed} is out of range'
        assert seed not in seen, f'the seed {seed} comes again'
        seen.add(seed)
        generator = random.Random(seed)
        for _ in range(int(words[0])):
            print(generator.random())
    elif verb == 'pdf':
        for _ in range(int(words[0])):
            sys.stdin.readline()
            print(1)
    else:
        break
    print('end', flush=True)
";
    if has("python3", &["--version"]) {
        let folder = tempdir().unwrap();
        std::fs::write(folder.path().join("client.py"), CLIENT).unwrap();
        let args = ["validate", "--exec", "python3 client.py", "--samples", "300000"];
        assert_eq!(json(folder.path(), &args)["accepted"], 1);
    }
}

#[test]
fn usage_is_checked() {
    for (command, more, expected) in [
        ("", &[][..], "is no command"),
        ("'unfinished", &[], "is no command"),
        ("/no/such/program", &[], "/no/such/program"),
        ("true", &["--timeout", "0"], "--timeout"),
        ("true", &["--timeout", "nan"], "--timeout"),
        ("true", &["--timeout", "1e300"], "--timeout"),
        ("true", &["--domain", "disc"], "unknown domain"),
        ("true", &["--domain", "discrete:0"], "from 1 to"),
    ] {
        let ran = validate(command, more);
        assert_eq!(ran.code, 2, "{command} {more:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{command} {more:?}: {}", ran.stderr);
    }
    let folder = tempdir().unwrap();
    for (args, expected) in [
        (&["validate", "--samples", "some.csv"][..], "--pdf"),
        (&["validate", "--samples", "10", "--pdf", "a.csv"], "without samples"),
        (&["validate", "--domain", "line"], "no external sampler"),
        (&["validate", "--samples", "some.csv", "--exec", "true"], "not a number"),
    ] {
        let ran = etalon(folder.path(), args);
        assert_eq!(ran.code, 2, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{args:?}: {}", ran.stderr);
    }
}

/// A client on a line of which `$GREETING`, `$SAMPLE` and `$PDF` are to be filled in.
const LINE: &str = "
import math, sys
numbers = lambda count: [float(sys.stdin.readline()) for _ in range(count)]
for request in sys.stdin:
    verb, *words = request.split()
    if verb == 'etalon':
        print('etalon 1 domain=line dimension=1 GREETING')
    elif verb == 'sample':
        for u in numbers(int(words[0])):
            print(SAMPLE)
    elif verb == 'pdf':
        for x in numbers(int(words[0])):
            print(PDF)
    else:
        break
    print('end', flush=True)
";

#[test]
fn nan_singularities_tables_and_unknown_masses() {
    if !has("python3", &["--version"]) {
        return;
    }
    let folder = tempdir().unwrap();
    let client = folder.path().join("client.py");
    let run = |greeting: &str, sample: &str, pdf: &str| {
        let text = LINE.replace("GREETING", greeting).replace("SAMPLE", sample).replace("PDF", pdf);
        std::fs::write(&client, text).unwrap();
        validate(&format!("python3 '{}'", client.display()), &[])
    };
    // Steps of 1/2 and 3/2: of each pair, a quarter of the random numbers belongs to the first.
    let bins = "1.5 if int(64 * x) % 2 else 0.5";
    let of_bins = "(int(32 * u) + (2 * (32 * u % 1) if 32 * u % 1 < 0.25 else 0.5 + (32 * u % 1 - 0.25) / 1.5)) / 32";
    for (greeting, sample, pdf, code, word) in [
        ("", "u if u < 0.999 else 'nan'", "1", 1, "the sample NaN is outside of the domain (sampled from u = (0.999"),
        ("", "u", "1 if x < 0.999 else 'nan'", 1, "is NaN"),
        ("", "u if u < 0.999 else 'inf'", "1", 1, "the sample inf is outside"),
        (
            "",
            "math.sin(math.pi * u / 2) ** 2",
            "1 / (math.pi * math.sqrt(x * (1 - x))) if 0 < x < 1 else 'inf'",
            0,
            "infinite at the point",
        ),
        ("table=64x1", of_bins, bins, 0, "accept"),
        ("table=64x1", "u", bins, 1, "reject"),
        ("mass=unknown", "math.sqrt(u)", "1000 * x", 0, "only the shape of the pdf was tested"),
        ("mass=unknown", "math.sqrt(u)", "1000 * x * x", 1, "reject"),
        ("table=0x1", "u", "1", 2, "table=0x1"),
        ("table=64", "u", "1", 2, "table=64"),
    ] {
        let ran = run(greeting, sample, pdf);
        assert_eq!(ran.code, code, "{greeting} {sample} {pdf}: {} {}", ran.stdout, ran.stderr);
        assert!(
            (ran.stdout.clone() + &ran.stderr).contains(word),
            "{greeting} {sample} {pdf}: {} {}",
            ran.stdout,
            ran.stderr
        );
    }
}
