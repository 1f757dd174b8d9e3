//! NaN and infinities at every entry point of the README's table: an error, a rejection, or what the documentation says.

use crate::exec::{example, has};
use crate::program::{Ran, etalon};
use etalon_stats::{Protocol, Sample, Square, Verdict, density, sampler, validate};
use std::path::Path;

const VALUES: [(&str, f32); 3] = [("nan", f32::NAN), ("inf", f32::INFINITY), ("-inf", f32::NEG_INFINITY)];

/// In place of an exit code: rejected, or an error.
const REFUSED: i32 = -1;

/// In place of an exit code: what is said counts; the verdict depends on how much a budget of time allows.
const SAID: i32 = -2;

/// A client whose numbers are replaced now and then: VALUE COLUMN COMMAND…
const FILTER: &str = r#"
import subprocess, sys
value, column = sys.argv[1], int(sys.argv[2])
client = subprocess.Popen(sys.argv[3:], stdout=subprocess.PIPE, text=True, bufsize=1)
for n, line in enumerate(client.stdout):
    words = line.split()
    if n % 97 == 96 and words[0].lstrip("-")[0].isdigit():
        words[min(column, len(words) - 1)] = value
        line = " ".join(words) + "\n"
    sys.stdout.write(line)
    sys.stdout.flush()
"#;

/// A renderer of noise in [0, 1), with one pixel of another value: VALUE SEED OUT.
const RENDERER: &str = r#"
import random, struct, sys
random.seed(int(sys.argv[2]))
pixels = [random.random() for _ in range(192)]
pixels[5] = float(sys.argv[1])
open(sys.argv[3], "wb").write(b"PF\n8 8\n-1\n" + struct.pack("<192f", *pixels))
"#;

/// Writes an image of 8 by 8 noisy pixels, `bad` of which have the value.
fn image(path: &Path, seed: u32, value: f32, bad: usize) {
    let mut bytes = b"PF\n8 8\n-1\n".to_vec();
    for i in 0..192_u32 {
        let noise = f32::from((i + 192 * seed).wrapping_mul(0x9E37_79B9).rotate_left(7) as u16) / 65536.0;
        let number = if (i as usize) < 3 * bad { value } else { 0.5 + noise };
        bytes.extend(number.to_le_bytes());
    }
    std::fs::write(path, bytes).unwrap();
}

/// A folder with images `a0` to `a3`, `b0` to `b3`, `one` and `all` of the value, and the programs above.
fn folder(value: f32) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for i in 0..4 {
        image(&path(&format!("a{i}.pfm")), i, 0.0, 0);
        image(&path(&format!("b{i}.pfm")), 10 + i, 0.0, 0);
    }
    image(&path("one.pfm"), 20, value, 1);
    image(&path("all.pfm"), 20, value, 64);
    std::fs::write(path("filter.py"), FILTER).unwrap();
    std::fs::write(path("renderer.py"), RENDERER).unwrap();
    folder
}

/// What a run must have said, and the exit code.
fn check(ran: &Ran, code: i32, said: &str, what: &str) {
    let is_right = match code {
        SAID => true,
        REFUSED => [1, 2].contains(&ran.code),
        code => ran.code == code,
    };
    assert!(is_right, "{what}: {} {} {}", ran.code, ran.stdout, ran.stderr);
    assert!(format!("{}{}", ran.stdout, ran.stderr).contains(said), "{what}: {} {}", ran.stdout, ran.stderr);
}

/// The arguments of a command line, at whose bars several words are one.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (i, part) in line.split('|').enumerate() {
        match i % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

/// An entry point: how a row of the README's table begins, lines of arguments, and for each the exit code and a text of the output.
/// `VALUE` stands for the value, `FILTER COLUMN EXAMPLE` for an example whose answers have it in that column.
type Entry = (&'static str, &'static [(&'static str, i32, &'static str)]);

const ENTRIES: [Entry; 14] = [
    ("etalon validate examples/my_sampler.py", &[("validate --detect 0.2 --domain line mine.py", 1, "reject")]),
    (
        "etalon validate examples/exponential.py",
        &[
            ("validate --detect 0.2 --domain interval:0,1 mine.py", 1, "reject"),
            ("validate --domain interval:0,VALUE mine.py", 2, "VALUE"),
        ],
    ),
    (
        "etalon validate examples/phase.py",
        &[
            ("validate --samples 400 phase.py", 1, "phase/values/85"),
            ("validate --samples 400 light.py", REFUSED, "light.py"),
        ],
    ),
    (
        "--like ggx",
        &[
            ("validate --exec |FILTER 0 bsdf.py| like --like diffuse --set albedo=0.5", 1, "not the values of diffuse"),
            ("validate --exec |python3 bsdf.py| like --like diffuse --set albedo=VALUE", 2, "albedo"),
        ],
    ),
    (
        "etalon render sphere-env --exec 'python3 examples/bsdf.py'",
        &[("render sphere-env -r 8 8 -s 2 --exec |FILTER 3 bsdf.py|", 2, "not finite")],
    ),
    (
        "etalon validate --exec 'python3 examples/sampler.py'",
        &[
            ("validate --detect 0.2 --exec |FILTER 0 sampler.py|", 1, "reject"),
            // An infinity is a place outside of the line, NaN is no place at all.
            ("validate --samples samples.csv --pdf pdf.csv --domain line", REFUSED, "samples"),
            ("validate --samples good.csv --pdf bad.csv --domain line", REFUSED, "VALUE"),
            ("validate --detect=VALUE warp", 2, "--detect"),
        ],
    ),
    // The package has a table of its own: python/tests/test_not_a_number.py.
    ("etalon_bench.check_sampler", &[]),
    // Below: `samplers_in_rust`.
    ("assert_samples_follow_pdf", &[]),
    // Clients in C speak the protocol of the first row.
    ("include/etalon.h", &[]),
    (
        "etalon validate --exec 'python3 examples/bsdf.py'",
        &[
            ("validate --samples 400 --exec |FILTER 3 bsdf.py|", 1, "rejected"),
            ("sweep --detect=VALUE ggx", 2, "--detect"),
        ],
    ),
    (
        "etalon furnace --exec 'python3 examples/bsdf.py'",
        &[("furnace --size 2x2 --exec |FILTER 3 bsdf.py|", 1, "VIOLATIONS")],
    ),
    (
        "etalon compare mine-*.exr --against theirs-*.exr",
        &[
            (
                "compare one.pfm a1.pfm a2.pfm --against b0.pfm b1.pfm b2.pfm",
                1,
                "not finite: one.pfm is NaN or infinite in column",
            ),
            ("compare all.pfm a1.pfm a2.pfm --against b0.pfm b1.pfm b2.pfm", 2, "no pixel has finite values"),
        ],
    ),
    (
        "etalon compare a.exr b.exr",
        &[
            ("compare one.pfm b0.pfm", 0, "left out: 1 pixel with NaN or infinite"),
            ("compare b0.pfm one.pfm", 0, "left out: 1 pixel with NaN or infinite"),
            ("compare all.pfm b0.pfm", 2, "no pixel is finite"),
        ],
    ),
    (
        "etalon converge scene.pbrt --renderer",
        &[
            (
                "converge cornell-lambert -r 8 8 --strategies none --budget 6 --reference a0.pfm --renderer \
                 |bad=python3 renderer.py VALUE {seed} {out} {spp}| --renderer |fine=python3 renderer.py 0.5 {seed} {out} {spp}|",
                SAID,
                "bad, replicate 1 (seed 1, 1 spp): 1 pixel of its image is not finite",
            ),
            (
                "converge cornell-lambert -r 8 8 --strategies none --budget 6 --reference one.pfm --renderer \
                 |fine=python3 renderer.py 0.5 {seed} {out} {spp}|",
                SAID,
                "one.pfm: left out: 1 pixel with NaN or infinite",
            ),
        ],
    ),
];

/// Maps and scenes have the entries of the README's other half, too.
const MAPS: Entry = (
    "etalon converge sphere-env --envmap my.exr",
    &[
        ("converge sphere-env -r 8 8 --strategies light --budget 1 --envmap one.pfm", SAID, "such values count as 0"),
        ("envmap info one.pfm", 0, "such values count as 0"),
        ("envmap sample one.pfm -n 4", 0, "such values count as 0"),
        ("envmap sample all.pfm -n 4", 0, "no texel of this map can be sampled"),
        ("envmap cut one.pfm -n 2", 0, "such values count as 0"),
        ("render sphere-env --envmap one.pfm -r 8 8 -s 1", 0, "such values count as 0"),
        ("validate map --envmap one.pfm --detect 0.3", 0, "such values count as 0"),
        ("fresnel --eta-t=VALUE", 2, "--eta-t"),
        ("stability --replay fresnel:eta=VALUE,cos=0.5", 2, "--replay"),
    ],
);

#[test]
#[ignore = "takes a minute: cargo test -- --ignored"]
fn every_entry_point_says_what_it_does_with_numbers_that_are_none() {
    if !has("python3", &["--version"]) {
        return;
    }
    for (value, number) in VALUES {
        let folder = folder(number);
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("mine.py", &format!("def sample(u):\n    return float('{value}')\n\n\ndef pdf(x):\n    return 1.0\n"));
        let phase = "def phase(wo, wi):\n    return float('VALUE')\n\n\ndef pdf(wo, wi):\n    return 0.1\n\n\ndef sample(wo, u):\n    return wo\n";
        write("phase.py", &phase.replace("VALUE", value));
        write(
            "light.py",
            &format!(
                "delta, reference_points = True, [{value}, 0, 0]\n\n\ndef sample(point, u):\n    return (0, 0, 1), 1\n"
            )
            .replace("[", "[float('")
            .replace(", 0, 0", "'), 0, 0"),
        );
        write("samples.csv", &format!("x\n0.5\n{value}\n0.25\n"));
        write("good.csv", "x\n0.5\n0.75\n0.25\n");
        write("pdf.csv", "1\n1\n");
        write("bad.csv", &format!("1\n{value}\n"));
        for (entry, lines) in ENTRIES.into_iter().chain([MAPS]) {
            for (line, code, said) in lines {
                let mut line = line.replace("VALUE", value);
                for client in ["sampler.py", "bsdf.py"] {
                    let path = example(client);
                    line = line.replace(&format!(" {client}|"), &format!(" python3 -u '{path}'|"));
                }
                let line = line.replace("FILTER", &format!("python3 filter.py {value}"));
                let args = words(&line);
                let ran = etalon(folder.path(), &args.iter().map(String::as_str).collect::<Vec<_>>());
                check(&ran, *code, &said.replace("VALUE", value), &format!("{entry}: {line}"));
            }
        }
    }
}

#[test]
fn every_row_of_the_readme_has_an_entry() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let table = readme.split_once("| **Test your own** | |\n").unwrap().1.split_once("| **See how").unwrap().0;
    // Continuous integration runs what the other rows run.
    for row in table.lines().filter(|row| !row.contains("continuous integration")) {
        let known = ENTRIES.iter().chain([&MAPS]).any(|(entry, _)| row.contains(entry));
        assert!(known, "no entry point of this row is tested with NaN: {row}");
    }
}

#[test]
fn samplers_in_rust_are_rejected_for_them() {
    for (_, value) in VALUES {
        let value = f64::from(value);
        let now_and_then = move |x: f64, right: f64| if (0.4..0.41).contains(&x) { value } else { right };
        let right = |u: &[f64]| Some(Sample::new([u[0], u[1]]));
        let wrong = move |u: &[f64]| Some(Sample::new([now_and_then(u[0], u[0]), u[1]]));
        let protocol = Protocol::default();
        let of_samples = validate(&Square, &sampler(2, wrong), &density(|_: [f64; 2]| 1.0), &protocol).unwrap();
        let uneven = density(move |[x, _]: [f64; 2]| now_and_then(x, 1.0));
        let of_pdf = validate(&Square, &sampler(2, right), &uneven, &protocol).unwrap();
        assert_eq!([of_samples.verdict, of_pdf.verdict], [Verdict::Reject; 2], "{value}");
    }
}
