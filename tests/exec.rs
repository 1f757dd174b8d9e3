//! Samplers elsewhere: the example clients, programs that misbehave, and files of samples.

mod program;

use etalon::envmap::LatLong;
use etalon::raster::{Image, Metadata, Rgb, write};
use etalon::sampling::stream::CounterRng;
use program::{Ran, etalon, json};
use rand::RngExt;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use tempfile::tempdir;

/// The path of an example.
fn example(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).display().to_string()
}

/// Whether a command succeeds; says that a test is skipped if not.
fn has(program: &str, args: &[&str]) -> bool {
    let found = Command::new(program).args(args).output().is_ok_and(|output| output.status.success());
    if !found {
        eprintln!("skipped: {program} {args:?} does not run here");
    }
    found
}

/// Validates the sampler of `command` with few samples.
fn validate(command: &str, more: &[&str]) -> Ran {
    let folder = tempdir().unwrap();
    etalon(folder.path(), &[&["validate", "--samples", "40000", "--exec", command], more].concat())
}

/// Validates the sampler of a shell script.
fn script(text: &str, more: &[&str]) -> Ran {
    let folder = tempdir().unwrap();
    let file = folder.path().join("client.sh");
    std::fs::write(&file, text).unwrap();
    validate(&format!("sh {}", file.display()), more)
}

#[test]
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
    if !has("cc", &["-O2", &example("sampler.c"), "-o", &binary, "-lm"]) {
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

const HELLO: &str = "read l; echo 'etalon 1 domain=line dimension=0'; echo end; read l; ";

#[cfg(unix)]
#[test]
fn programs_that_misbehave_are_named() {
    let cases = [
        ("exit 3", "exit status: 3"),
        ("echo 'no such file' >&2; exit 1", "its last words: \"no such file\""),
        ("kill -9 $$", "signal: 9"),
        ("echo hello; echo end; cat > /dev/null", "\"hello\" does not begin with"),
        ("echo etalon 1 dimension=1000; echo end; cat > /dev/null", "dimension"),
        ("echo etalon 1 mass=nan; echo end; cat > /dev/null", "mass"),
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
        ("exit 0", "asked \"sample 4 0\", it ended (exit status: 0) after 0 lines"),
        ("echo 0.1; echo 0.2; echo end; cat > /dev/null", "answered only 2 lines"),
        ("for i in 1 2 3 4 5; do echo 0.$i; done; echo end; cat > /dev/null", "\"0.5\" where \"end\" belongs"),
        ("echo 0.1; echo nan; echo 0.2; echo 0.3; echo end; cat > /dev/null", "line 2 of the answer is \"nan\""),
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

#[cfg(unix)]
#[test]
fn nothing_hangs() {
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
        (&["validate", "--domain", "line"], "no sampler elsewhere"),
        (&["validate", "--samples", "some.csv", "--exec", "true"], "not a number"),
    ] {
        let ran = etalon(folder.path(), args);
        assert_eq!(ran.code, 2, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{args:?}: {}", ran.stderr);
    }
}

/// Writes samples of a density on the sphere, constant on 7 × 5 texels, and that density as an image and as numbers.
fn sphere_files(folder: &Path) {
    let map = LatLong::new(7, 5);
    let weight = |x: usize, y: usize| (1 + (3 * x + 5 * y) % 8) as f64;
    let texels: Vec<(usize, usize)> = (0..5).flat_map(|y| (0..7).map(move |x| (x, y))).collect();
    let flux: Vec<f64> = texels.iter().map(|&(x, y)| weight(x, y) * map.solid_angle(y)).collect();
    let total: f64 = flux.iter().sum();
    let image = Image::from_fn(7, 5, |x, y| Rgb::splat((weight(x, y) / total) as f32));
    write(&folder.join("density.exr"), &image, &Metadata::default()).unwrap();

    let mut rng = CounterRng::new(1, 0);
    let (mut points, mut angles) = (String::from("pdf, x, y, z\n"), String::from("theta,phi\n"));
    for _ in 0..60_000 {
        let [mut left, fx, fy] = [0; 3].map(|_| rng.random::<f64>());
        left *= total;
        let chosen = flux.iter().position(|f| {
            left -= f;
            left < 0.0
        });
        let (x, y) = texels[chosen.unwrap_or(0)];
        let w = map.direction_in_texel(x, y, fx, fy);
        let pdf = weight(x, y) / total;
        points.push_str(&format!("{pdf:.7},{:.9},{:.9},{:.9}\n", w.x, w.y, w.z));
        angles.push_str(&format!("{:.9},{:.9}\n", w.y.acos(), w.z.atan2(w.x)));
    }
    std::fs::write(folder.join("points.csv"), points).unwrap();
    std::fs::write(folder.join("angles.csv"), angles).unwrap();
}

#[test]
fn files_of_directions_are_tested_against_images() {
    let folder = tempdir().unwrap();
    sphere_files(folder.path());
    for samples in ["points.csv", "angles.csv"] {
        let value = json(folder.path(), &["validate", "--samples", samples, "--pdf", "density.exr"]);
        let test = &value["tests"][0];
        // A quarter of the samples went to the pilot; none is taken twice.
        assert_eq!((&test["verdict"], &test["samples"]), (&"accept".into(), &45_000.into()), "{value}");
    }
    // Directions of the local frame are not those of the map.
    let text = std::fs::read_to_string(folder.path().join("points.csv")).unwrap();
    std::fs::write(folder.path().join("turned.csv"), text.replace("pdf, x, y, z", "p, x, z, y")).unwrap();
    let ran = etalon(folder.path(), &["validate", "--samples", "turned.csv", "--pdf", "density.exr"]);
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    // A density that belongs to another sample.
    let swapped: String = text.lines().map(|line| line.replacen("0.0", "0.1", 1) + "\n").collect();
    std::fs::write(folder.path().join("swapped.csv"), swapped).unwrap();
    let ran = etalon(folder.path(), &["validate", "--samples", "swapped.csv", "--pdf", "density.exr"]);
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("carries the density"), "{}", ran.stdout);
}

#[test]
fn files_of_numbers_are_tested_against_tables() {
    let folder = tempdir().unwrap();
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let run = |samples: &str, pdf: &str, domain: &str| {
        etalon(folder.path(), &["validate", "--samples", samples, "--pdf", pdf, "--domain", domain])
    };
    let mut rng = CounterRng::new(2, 0);
    let (mut die, mut square) = (String::from("i\n"), String::from("x,y\n"));
    for _ in 0..30_000 {
        let [u, v] = [0; 2].map(|_| rng.random::<f64>());
        die.push_str(&format!("{}\n", (6.0 * u) as usize));
        // Three quarters of them at x < 1/2.
        square.push_str(&format!("{},{v}\n", if u < 0.75 { u / 1.5 } else { 2.0 * u - 1.0 }));
    }
    file("die.csv", &die);
    file("square.csv", &square);
    file("fair.csv", &["0.16666666666666666"; 6].join("\n"));
    file("loaded.csv", "0.15,0.15,0.15,0.15,0.2,0.2");
    file("columns.csv", "1.5,0.5");
    file("rows.csv", "1.5\n0.5");
    file("heavy.csv", "1.5,0.6");
    for (samples, pdf, domain, code) in [
        ("die.csv", "fair.csv", "discrete:6", 0),
        ("die.csv", "loaded.csv", "discrete:6", 1),
        ("square.csv", "columns.csv", "square", 0),
        ("square.csv", "rows.csv", "square", 1),
        ("square.csv", "heavy.csv", "square", 1),
        ("square.csv", "columns.csv", "line", 0),
    ] {
        let ran = run(samples, pdf, domain);
        assert_eq!(ran.code, code, "{samples} {pdf} {domain}: {} {}", ran.stdout, ran.stderr);
    }
    // Right, but too few to say so.
    file("few.csv", &die[..2 * 40]);
    assert_eq!(run("few.csv", "fair.csv", "discrete:6").code, 3);
    file("none.csv", "i\n");
    assert_eq!(run("none.csv", "fair.csv", "discrete:6").code, 3);
}

#[test]
fn damaged_files_are_located() {
    let folder = tempdir().unwrap();
    let run = |samples: &[u8], pdf: &[u8], domain: &str| {
        std::fs::write(folder.path().join("samples.csv"), samples).unwrap();
        std::fs::write(folder.path().join("pdf.csv"), pdf).unwrap();
        etalon(folder.path(), &["validate", "--samples", "samples.csv", "--pdf", "pdf.csv", "--domain", domain])
    };
    let long = vec![b'1'; 3 << 20];
    for (samples, pdf, domain, expected) in [
        (&b""[..], &b"1"[..], "line", "the header"),
        (b"u,v\n0.1,0.2\n", b"1", "square", "no columns x,y"),
        (b"x\n0.1\nhello\n0.2\n0.3", b"1", "line", "samples.csv:3"),
        (b"x\n0.1\n\nnan\n0.3\n0.3", b"1", "line", "samples.csv:4"),
        (b"x,y\n0.1\n0.1,0.2\n0.1,0.2\n0.1,0.2", b"1", "square", "samples.csv:2"),
        (b"i\n1\n1.5\n1\n1", b"0.5,0.5", "discrete:2", "samples.csv:3"),
        (b"x\n\xff\n0\n0\n0", b"1", "line", "UTF-8"),
        (&long, b"1", "line", "longer than"),
        (b"x\n0.1\n", b"1,2\n3", "square", "pdf.csv:2"),
        (b"x\n0.1\n", b"1,two", "line", "\"two\" is not a number"),
        (b"x\n0.1\n", b"", "line", "no numbers"),
        (b"x\n0.1\n", b"1,2\n3,4", "line", "a row or a column"),
        (b"i\n0\n", b"0.5,0.5", "discrete:3", "2 values for 3 outcomes"),
    ] {
        let ran = run(samples, pdf, domain);
        assert_eq!(ran.code, 2, "{expected}: {} {}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(expected), "{expected}: {}", ran.stderr);
    }
    let ran = etalon(folder.path(), &["validate", "--samples", "absent.csv", "--pdf", "pdf.csv", "--domain", "line"]);
    assert!(ran.code == 2 && ran.stderr.contains("absent.csv"), "{}", ran.stderr);
    // Numbers that are no place of the domain are a finding about the sampler.
    assert_eq!(run(b"x\n5\n", b"1", "line").code, 1);
    assert_eq!(run(b"i\n5\n5\n", b"0.5,0.5", "discrete:2").code, 1);
}
