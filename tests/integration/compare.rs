//! `etalon compare`: metrics by hand, what explains a difference, and the test of two renderers with its exit codes.

use super::program::{etalon, json};
use etalon::raster::{Channel, Image, Layer, Metadata, Precision, Samples, write_exr, write_exr_channels};
use etalon::sampling::stream::{Independent, Stream};
use glam::Vec3;
use std::path::Path;

const SIZE: [usize; 2] = [24, 16];

/// An image with noise of a relative deviation of about 10 %, times `scale`.
fn noisy(seed: u64, scale: f32) -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let [u, v] = Independent::new(seed, (y * SIZE[0] + x) as u64, 0).pair(0).map(|u| u as f32);
        let level = 0.5 + 0.02 * x as f32;
        scale * level * Vec3::new(1.0 + 0.35 * (u - 0.5), 1.0 + 0.35 * (v - 0.5), 1.0 + 0.35 * (u * v - 0.25))
    })
}

/// Writes `count` replicates of each side, and returns the arguments of a comparison.
fn replicates(folder: &Path, count: u64, scale: f32) -> Vec<String> {
    let mut args = vec!["compare".to_owned()];
    for (side, scale) in [("a", scale), ("b", 1.0)] {
        if side == "b" {
            args.push("--against".into());
        }
        for k in 0..count {
            let name = format!("{side}{k}.exr");
            let image = noisy(1000 * u64::from(side == "b") + k, scale);
            let layer = Layer { name: "", image: &image };
            write_exr(&folder.join(&name), &[layer], Precision::Float, &Metadata::default()).unwrap();
            args.push(name);
        }
    }
    args
}

fn run(folder: &Path, args: &[String], more: &[&str]) -> super::program::Ran {
    let args: Vec<&str> = args.iter().map(String::as_str).chain(more.iter().copied()).collect();
    etalon(folder, &args)
}

#[test]
fn exit_codes_say_the_verdict() {
    let dir = tempfile::tempdir().unwrap();
    let same = replicates(dir.path(), 16, 1.0);
    let ran = run(dir.path(), &same, &["--junit", "t.xml"]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.starts_with("no difference found; a uniform bias of "), "{}", ran.stdout);
    let read_junit = || std::fs::read_to_string(dir.path().join("t.xml")).unwrap();
    let junit = read_junit();
    assert!(junit.contains("tests=\"3\" failures=\"0\" errors=\"0\""), "{junit}");
    let ran = run(dir.path(), &same, &["--detect", "0.01%", "--json"]);
    assert!(ran.code == 3 && ran.stdout.contains("\"answer\":\"cannot-tell\""), "{}", ran.stdout);
    // What is too little to tell is no success in a report either
    let ran = run(dir.path(), &same, &["--detect", "0.01%", "--markdown", "few.md"]);
    let few = std::fs::read_to_string(dir.path().join("few.md")).unwrap();
    assert!(
        ran.code == 3
            && few.starts_with("## etalon compare a0.exr (16 images) against b0.exr (16 images): inconclusive\n"),
        "{few}"
    );

    let biased = replicates(dir.path(), 16, 1.01);
    let ran = run(dir.path(), &biased, &["--junit", "t.xml", "--markdown", "t.md", "--json"]);
    assert!(ran.code == 1 && ran.stdout.contains("\"answer\":\"different\""), "{}", ran.stdout);
    assert!(std::fs::read_to_string(dir.path().join("t.xml")).unwrap().contains("<failure"));
    let markdown = std::fs::read_to_string(dir.path().join("t.md")).unwrap();
    assert!(markdown.contains("(16 images): rejected\n") && markdown.contains("; most at "), "{markdown}");
    assert!(markdown.contains("; mean of all channels +"), "{markdown}");
    let junit = read_junit();
    let mut failures = junit.split("<failure message=\"").skip(1);
    assert!(
        failures.all(|text| text.split_once("\">").is_some_and(|(message, more)| more.starts_with(message))),
        "{junit}"
    );
    // An exposure is named between the means, too
    let exposed = replicates(dir.path(), 16, 1.1);
    let ran = run(dir.path(), &exposed, &[]);
    assert!(ran.code == 1 && ran.stdout.contains("between the means: A is 1.1"), "{}", ran.stdout);
    // Tiles need 16 replicates.
    let few = replicates(dir.path(), 3, 1.0);
    let ran = run(dir.path(), &few, &[]);
    assert!(ran.stdout.contains("not tested: fewer than 16 replicates"), "{}", ran.stdout);
}

#[test]
fn bad_sides_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    replicates(dir.path(), 2, 1.0);
    for (line, expected) in [
        ("compare a0.exr a1.exr --against a0.exr b0.exr", "a0.exr and a0.exr are the same image"),
        ("compare a0.exr --against b0.exr", "says nothing of its noise"),
        ("compare a0.exr a1.exr --against b0.exr b1.exr --exact", "several images"),
        ("compare a0.exr a1.exr b0.exr", "3 images given"),
        ("compare a0.exr b0.exr --exact", "--against"),
        ("compare a0.exr a1.exr --against b0.exr b1.exr --detect 0", "not a share"),
        ("compare a0.exr a1.exr --against b0.exr b1.exr --level 2", "not a share"),
    ] {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{line}: {}", ran.stderr);
    }
    // A reference without noise.
    let ran = etalon(dir.path(), &["compare", "a0.exr", "a1.exr", "--against", "b0.exr", "--exact"]);
    assert_ne!(ran.code, 2, "{}", ran.stderr);
}

#[test]
fn errors_and_moments_are_read_by_their_layers() {
    let dir = tempfile::tempdir().unwrap();
    let spp = 64.0_f32;
    // Samples with a standard deviation of 10 % of the mean.
    let write = |name: &str, seed: u64, scale: f32, kind: &str| {
        let image = noisy(seed, scale);
        let error = image.map(|p| 0.1 * p);
        let square = image.map(|p| p * p + (0.1 * p) * (0.1 * p) * (spp - 1.0));
        let mut channels: Vec<Channel<'_>> = Layer { name: "", image: &image }.channels(Precision::Float).into();
        match kind {
            "error" => channels.extend(Layer { name: "error", image: &error }.channels(Precision::Float)),
            _ => {
                for (layer, values) in [("nested", &image), ("m2_nested", &square)] {
                    for (c, role) in kind.chars().enumerate() {
                        let samples = Samples::Float(Box::new(move |i| values.pixels()[i][c]));
                        channels.push(Channel { name: format!("{layer}.{role}"), samples });
                    }
                }
            }
        }
        write_exr_channels(&dir.path().join(name), (SIZE[0], SIZE[1]), channels, &Metadata::default()).unwrap();
    };
    write("e.exr", 1, 1.0, "error");
    write("bright.exr", 2, 1.1, "error");
    write("rgb.exr", 3, 1.0, "RGB");
    write("xyz.exr", 4, 1.0, "XYZ");
    write("xyz2.exr", 5, 1.1, "XYZ");
    let code = |line: &str| {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        (ran.code, ran.stdout + &ran.stderr)
    };
    let (same, text) = code("compare e.exr --against rgb.exr --spp 64 --detect 10%");
    assert_eq!(same, 0, "{text}");
    assert_eq!(code("compare e.exr --against bright.exr").0, 1);
    assert_eq!(code("compare xyz.exr --against xyz2.exr --spp 64").0, 1);
    let (missing, text) = code("compare e.exr --against rgb.exr");
    assert!(missing == 2 && text.contains("--spp"), "{text}");
    // RGB and XYZ of other images are compared in XYZ.
    let (_, text) = code("compare e.exr --against xyz.exr --spp 64");
    assert!(["X", "Y", "Z"].iter().any(|c| text.contains(&format!("image, channel {c}"))), "{text}");
}

#[test]
fn common_mistakes_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let write = |name: &str, image: &Image| etalon::raster::write(&path(name), image, &Metadata::default()).unwrap();
    let image = noisy(1, 1.0);
    write("a.pfm", &image);
    write("dark.pfm", &image.map(|p| p / 1.21));
    write("down.pfm", &image.clone().flipped_vertically());
    write("png.png", &image);
    let change = |b: &str| json(dir.path(), &["compare", "a.pfm", b])["explanation"]["change"].to_string();
    assert!(change("dark.pfm").contains("multiply A by 0.8264"), "{}", change("dark.pfm"));
    assert!(change("down.pfm").contains("upside down"));
    assert_eq!(change("a.pfm"), "null");
    let ran = etalon(dir.path(), &["compare", "a.pfm", "png.png", "--relative"]);
    assert!(ran.code == 0 && ran.stderr.contains("clipped at 1"), "{}", ran.stderr);
}

#[test]
fn each_of_many_images_is_compared_and_a_damaged_one_does_not_stop_the_others() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let write = |name: &str, image: &Image| etalon::raster::write(&path(name), image, &Metadata::default()).unwrap();
    let image = noisy(1, 1.0);
    write("ref.exr", &image);
    write("same.pfm", &image);
    write("double.exr", &image.map(|p| 2.0 * p));
    write("other.exr", &noisy(2, 1.0));
    write("small.exr", &Image::new(8, 8));
    std::fs::write(path("cut.exr"), b"v/1\x01").unwrap();
    let all = [
        "compare",
        "--reference",
        "ref.exr",
        "--at-most",
        "mse=.05,max_abs=0.5",
        "--sort",
        "mse",
        "--junit",
        "j.xml",
        "--markdown",
        "m.md",
        "--each",
    ];
    let good = [&all[..], &["double.exr", "other.exr", "same.pfm"]].concat();
    let ran = etalon(dir.path(), &good);
    assert!(ran.code == 1 && ran.stdout.contains("rejected: 1 of 3 images"), "{}{}", ran.stdout, ran.stderr);
    let value: serde_json::Value =
        serde_json::from_str(&etalon(dir.path(), &[&good[..], &["--json"]].concat()).stdout).unwrap();
    let images = value["images"].as_array().unwrap();
    let files: Vec<&str> = images.iter().map(|image| image["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["same.pfm", "other.exr", "double.exr"]);
    assert_eq!(
        images.iter().map(|image| image["rejected"].as_bool().unwrap()).collect::<Vec<_>>(),
        [false, false, true]
    );
    assert!(images[0]["identical"] == true && images[1]["explanation"].is_null());
    assert!(images[2]["explanation"]["change"].as_str().unwrap().starts_with("multiply A by 0.50"), "{}", images[2]);
    let junit = std::fs::read_to_string(path("j.xml")).unwrap();
    let markdown = std::fs::read_to_string(path("m.md")).unwrap();
    assert!(markdown.contains("allowed; A is 2.0"), "{markdown}");
    assert!(
        junit.contains("tests=\"6\" failures=\"2\" errors=\"0\"") && junit.contains("double.exr against ref.exr"),
        "{junit}"
    );
    // A PNG beside an image of floats is left out, unless it alone is given
    write("double.png", &image);
    let twice = ["compare", "--reference", "ref.exr", "--each", "double.png", "other.exr", "double.exr"];
    let count = |args: &[&str]| json(dir.path(), args)["images"].as_array().unwrap().len();
    assert_eq!([count(&twice), count(&twice[..5])], [2, 1]);
    assert!(etalon(dir.path(), &twice).stderr.contains("1 PNG left out, as double.png"));
    // What cannot be read is told of after the others; another size is rejected by limits
    let ran = etalon(dir.path(), &[&all[..], &["small.exr", "same.pfm"]].concat());
    assert!(ran.code == 1 && ran.stdout.contains("rejected: another size"), "{}{}", ran.stdout, ran.stderr);
    let ran = etalon(dir.path(), &["compare", "--reference", "ref.exr", "--each", "small.exr", "same.pfm"]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    let ran = etalon(dir.path(), &[&all[..], &["cut.exr", "small.exr", "same.pfm", "-o", "cut.csv"]].concat());
    assert!(
        ran.code == 2 && ran.stdout.contains("8x8") && ran.stdout.contains("the same values"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
    let rows = std::fs::read_to_string(path("cut.csv")).unwrap();
    assert!(rows.starts_with("file,mse,rel_mse,hdr_flip,ssim,psnr,") && rows.lines().count() == 4, "{rows}");
    assert!(rows.contains(",size,"), "{rows}");
    assert!(std::fs::read_to_string(path("j.xml")).unwrap().contains("failures=\"1\" errors=\"1\""));
    // Without any image nothing is written
    let ran = etalon(dir.path(), &["compare", "--reference", "ref.exr", "--each", ".", "-o", "none.csv"]);
    assert!(ran.code == 2 && !path("none.csv").exists(), "{}", ran.stderr);
    // Limits, twins and what is left of an explained difference, in CSV
    let ran = etalon(dir.path(), &[&good[..], &["ref.exr", "-o", "rows.csv"]].concat());
    let rows = std::fs::read_to_string(path("rows.csv")).unwrap();
    assert!(rows.contains(",mse;max_abs,") && rows.contains("same.pfm") && rows.contains("mse_left"), "{rows}");
    assert!(ran.stdout.contains("same pixels as "), "{}", ran.stdout);
}

#[test]
fn a_pixel_without_a_value_rejects_and_its_place_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let args = replicates(dir.path(), 16, 1.0);
    let mut holed = noisy(3, 1.0);
    holed.set(5, 7, Vec3::NAN);
    let layer = Layer { name: "", image: &holed };
    write_exr(&dir.path().join("a3.exr"), &[layer], Precision::Float, &Metadata::default()).unwrap();
    let ran = run(dir.path(), &args, &["--junit", "t.xml", "--markdown", "t.md"]);
    let place = "a3.exr is NaN or infinite in column 5, row 7";
    assert!(ran.code == 1 && ran.stdout.starts_with(&format!("not finite: {place}")), "{}", ran.stdout);
    for report in ["t.xml", "t.md"] {
        let report = std::fs::read_to_string(dir.path().join(report)).unwrap();
        assert!(report.contains(place) && report.contains("finite"), "{report}");
    }
    let answer: serde_json::Value = serde_json::from_str(&run(dir.path(), &args, &["--json"]).stdout).unwrap();
    assert!(answer["answer"] == "not-finite" && answer["first_non_finite"]["row"] == 7, "{answer}");
}

#[test]
fn turns_of_images_that_are_not_square_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, image: &Image| {
        etalon::raster::write(&dir.path().join(name), image, &Metadata::default()).unwrap();
    };
    let image = noisy(1, 1.0);
    write("ref.exr", &image);
    write("turned.exr", &Image::from_fn(SIZE[1], SIZE[0], |x, y| image.get(y, SIZE[1] - 1 - x)));
    let ran = etalon(dir.path(), &["compare", "--reference", "ref.exr", "--at-most", "mse=1", "--each", "turned.exr"]);
    assert!(ran.code == 1 && ran.stdout.contains("turned by 90° clockwise"), "{}{}", ran.stdout, ran.stderr);
    let ran = etalon(dir.path(), &["compare", "turned.exr", "ref.exr"]);
    assert!(ran.code == 2 && ran.stderr.contains("turned by 90° clockwise"), "{}", ran.stderr);
}

#[test]
fn two_images_may_be_limited() {
    let dir = tempfile::tempdir().unwrap();
    replicates(dir.path(), 2, 1.0);
    let run = |line: &str| etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
    let ran = run("compare a0.exr b0.exr --at-most rel_mse=1e-6 --junit j.xml");
    assert!(ran.code == 1 && ran.stdout.contains("at most 0.000001 allowed"), "{}", ran.stdout);
    assert!(
        std::fs::read_to_string(dir.path().join("j.xml")).unwrap().contains("a0.exr against b0.exr\" name=\"rel_mse\"")
    );
    assert_eq!(run("compare a0.exr b0.exr --at-most flip=.9").code, 0);
    // A pixel that is not finite fails a limit that all others keep
    let holed = noisy(1, 1.0).map(|p| if p.x > 0.9 { Vec3::NAN } else { p });
    etalon::raster::write(&dir.path().join("holed.pfm"), &holed, &Metadata::default()).unwrap();
    for line in ["compare holed.pfm b0.exr", "compare --each a0.exr holed.pfm --reference b0.exr"] {
        let ran = run(&format!("{line} --at-most flip=.9 --junit n.xml --markdown n.md"));
        assert!(ran.code == 1 && ran.stdout.contains("rejected: "), "{}{}", ran.stdout, ran.stderr);
        assert!(std::fs::read_to_string(dir.path().join("n.xml")).unwrap().contains("failures=\"1\" errors=\"0\""));
    }
    let same = run("compare a0.exr a0.exr --at-most mse=0");
    assert!(same.code == 0 && same.stdout.contains("A and B are the same values"), "{}", same.stdout);
    // The report of an earlier run does not stay where the input is bad, before or after the arguments are read
    for line in ["compare a0.exr gone.exr --at-most mse=0", "compare a0.exr b0.exr --at-most mse=x"] {
        std::fs::write(dir.path().join("old.xml"), "<testsuites/>").unwrap();
        let ran = run(&format!("{line} --junit old.xml --markdown=old.md"));
        let [junit, markdown] =
            ["old.xml", "old.md"].map(|file| std::fs::read_to_string(dir.path().join(file)).unwrap());
        assert!(ran.code == 2 && junit.contains("name=\"etalon compare\" tests=\"1\" failures=\"0\" errors=\"1\""));
        assert!(markdown.contains("## etalon compare: inconclusive\n"), "{markdown}");
        let said = ran.stderr.lines().next().unwrap().trim_start_matches("error: ").replace(['<', '>'], "");
        assert!(junit.replace("&lt;", "").replace("&gt;", "").contains(&said), "{said}: {junit}");
        // An input stays as it is, whatever the command
        let before = std::fs::read(dir.path().join("b0.exr")).unwrap();
        std::fs::copy(dir.path().join("b0.exr"), dir.path().join("b0.data")).unwrap();
        assert_eq!(run(&format!("{line} --against b0.data --junit b0.data")).code, 2);
        assert_eq!(std::fs::read(dir.path().join("b0.data")).unwrap(), before);
    }
    for (line, says) in [
        ("compare a0.exr b0.exr --at-most ssim=.9", "larger for images that are more alike"),
        ("compare a0.exr b0.exr --junit j.xml", "--at-most"),
        ("compare --each a0.exr", "--reference"),
        ("compare a0.exr --each a1.exr --reference b0.exr", "cannot be used with"),
    ] {
        let ran = run(line);
        assert!(ran.code == 2 && ran.stderr.contains(says), "{line}: {}", ran.stderr);
    }
}
