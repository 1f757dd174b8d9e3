//! Samples and densities from files.

use crate::program::{etalon, json};
use etalon::envmap::LatLong;
use etalon::math::Rgb;
use etalon::raster::{Image, Metadata, write};
use etalon::sampling::stream::CounterRng;
use rand::RngExt;
use std::path::Path;
use tempfile::tempdir;

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
    let turned: Vec<&str> = text.lines().skip(1).filter_map(|line| Some(line.split_once(',')?.1)).collect();
    std::fs::write(folder.path().join("turned.csv"), format!("x,z,y\n{}\n", turned.join("\n"))).unwrap();
    let ran = etalon(folder.path(), &["validate", "--samples", "turned.csv", "--pdf", "density.exr"]);
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    // A density that belongs to another sample.
    let swapped = |line: &str| {
        let (pdf, point) = line.split_once(',').unwrap();
        format!("{},{point}\n", pdf.replacen("0.0", "0.1", 1))
    };
    let swapped: String = text.lines().map(swapped).collect();
    std::fs::write(folder.path().join("swapped.csv"), swapped).unwrap();
    let ran = etalon(folder.path(), &["validate", "--samples", "swapped.csv", "--pdf", "density.exr"]);
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("carries the pdf"), "{}", ran.stdout);
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

/// As spreadsheets, Windows and NumPy write them.
#[test]
fn byte_order_marks_crlf_and_comments_are_read() {
    let folder = tempdir().unwrap();
    let mut rng = CounterRng::new(3, 0);
    let rows: String = (0..20_000).map(|_| format!("{}\r\n", rng.random::<f64>())).collect();
    std::fs::write(folder.path().join("samples.csv"), format!("\u{feff}x\r\n{rows}")).unwrap();
    std::fs::write(folder.path().join("pdf.csv"), "\u{feff}1\r\n1\r\n").unwrap();
    let args = ["validate", "--samples", "samples.csv", "--pdf", "pdf.csv", "--domain", "line"];
    assert_eq!(json(folder.path(), &args)["accepted"], 1);
    std::fs::write(folder.path().join("samples.csv"), format!("# x\n# of a run\n{rows}# its end\n")).unwrap();
    std::fs::write(folder.path().join("pdf.csv"), "# pdf\n1\n1\n").unwrap();
    assert_eq!(json(folder.path(), &args)["accepted"], 1);
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
        (&b""[..], &b"1"[..], "line", "samples.csv: the file is empty"),
        (b"\xef\xbb\xbf\n\n", b"1", "line", "samples.csv: the file is empty"),
        (b"x,y\n0.5,0.5\n0.5,0.5,0.5\n0.5,0.5\n0.5,0.5", b"1", "square", "samples.csv:3:1: 3 numbers in a row"),
        (b"x,y,z\n0,0,1\n", b"1", "square", "samples.csv:1:1: the column \"z\" has no meaning beside x,y and pdf"),
        (b"x,y\n0.5,0.5\n", b"1", "line", "the column \"y\" has no meaning beside x and pdf"),
        (b"x,pdf,PDF\n0.5,1,1\n", b"1", "line", "the column \"pdf\" has no meaning"),
        (b"u,v\n0.1,0.2\n", b"1", "square", "no columns x,y"),
        (b"x\n0.1\nhello\n0.2\n0.3", b"1", "line", "samples.csv:3"),
        (b"x\n0.1\n\nnan\n0.3\n0.3", b"1", "line", "samples.csv:4"),
        (b"x,y\n0.1\n0.1,0.2\n0.1,0.2\n0.1,0.2", b"1", "square", "samples.csv:2"),
        (b"i\n1\n1.5\n1\n1", b"0.5,0.5", "discrete:2", "samples.csv:3"),
        (b"x\n\xff\n0\n0\n0", b"1", "line", "UTF-8"),
        (&long, b"1", "line", "longer than"),
        (b"x\n0.1\n", b"1,2\n3", "square", "pdf.csv:2"),
        (b"x\n0.1\n", b"1,two", "line", "\"two\" is not a number"),
        (b"x\n0.1\n", b"", "line", "pdf.csv: the file is empty"),
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
