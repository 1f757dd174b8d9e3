//! The command line as a script relies on it: JSON keys, files, exit codes, determinism; `etalon scenes --export`: files of other
//! renderers, and what cannot be exported.

use crate::program::{etalon, json};
use etalon::math::Rgb;
use etalon::raster::{Image, Metadata, ReadOptions, read, write};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::Path;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number \"{key}\" in {value}"))
}

fn assert_keys(value: &Value, keys: &str) {
    for key in keys.split(", ") {
        assert!(value.get(key).is_some(), "no \"{key}\" in {value}");
    }
}

/// Every file that the object names is there and is what its extension says; returns their names.
fn assert_files(folder: &Path, value: &Value) -> BTreeSet<String> {
    let files = value["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap().to_owned());
    let check = |name: String| {
        let bytes = std::fs::read(folder.join(&name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let magic: &[u8] = match name.rsplit('.').next().unwrap() {
            "png" => b"\x89PNG\r\n\x1a\n",
            "pdf" => b"%PDF-",
            "svg" => b"<svg",
            "exr" => b"\x76\x2f\x31\x01",
            "pfm" => b"PF\n",
            "ppm" => b"P6\n",
            "hdr" => b"#?RADIANCE",
            "csv" => b"",
            other => panic!("what is .{other}?"),
        };
        let start = if bytes.starts_with(b"<?xml") { bytes.iter().position(|b| *b == b'\n').unwrap() + 1 } else { 0 };
        assert!(bytes.len() > 16 && bytes[start..].starts_with(magic), "{name}");
        name
    };
    files.map(check).collect()
}

/// All files below `folder`, by their path from there.
fn tree(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned());
            }
        }
    }
    found
}

/// Header and rows of a CSV file.
fn table(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    let rows = lines.map(|l| l.split(',').map(|c| c.parse().unwrap_or(f64::NAN)).collect()).collect();
    (header, rows)
}

/// The table that comes first in the files of a result.
fn first_table(folder: &Path, value: &Value) -> (String, Vec<Vec<f64>>) {
    table(&folder.join(value["files"][0].as_str().unwrap()))
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels().iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn image(path: &Path) -> Image {
    read(path, ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn fresnel_of_a_dielectric_both_ways() {
    const KEYS: &str =
        "eta_i, eta_t, brewster_deg, critical_deg, r_normal, schlick_max_abs_error, schlick_max_abs_error_deg, files";
    const HEADER: &str =
        "theta_deg,r_parallel,r_perpendicular,r_unpolarized,transmittance,r_schlick,r_schlick_incident";
    let dir = folder();
    for (eta, is_denser) in [(["1", "1.45"], true), (["1.45", "1"], false)] {
        let args = ["fresnel", "--eta-i", eta[0], "--eta-t", eta[1], "--points", "91", "-o", "a"];
        let value = json(dir.path(), &args);
        assert_keys(&value, KEYS);
        assert_eq!(value["critical_deg"].is_null(), is_denser);
        assert_files(dir.path(), &value);
        let (header, rows) = first_table(dir.path(), &value);
        assert_eq!((header.as_str(), rows.len()), (HEADER, 91));
    }
    let told = etalon(dir.path(), &["fresnel", "1.3", "--eta-i", "1.3", "-o", "a"]);
    assert!(told.code == 0 && told.stderr.contains("both sides have the index 1.3"), "{}", told.stderr);
    let equal = json(dir.path(), &["fresnel", "--eta-i", "1.3", "--eta-t", "1.3", "--points", "91", "-o", "a"]);
    assert!(equal["brewster_deg"].is_null());

    let args = ["fresnel", "--eta-i", "1.45", "--eta-t", "1", "--model", "report", "--points", "9001", "-o", "b"];
    let value = json(dir.path(), &args);
    let last = first_table(dir.path(), &value).1.last().unwrap()[0];
    assert_eq!(last, number(&value, "critical_deg"), "the report's curve ends there");
}

#[test]
fn fresnel_of_both_sides_and_lines_at_angles() {
    let dir = folder();
    let args = ["fresnel", "glass", "--both", "--points", "91", "--style", "slide", "-o", "a"];
    let value = json(dir.path(), &args);
    assert_keys(&value, "eta_i, wavelength_nm, media, leaving, files");
    assert_files(dir.path(), &value);
    assert!(value["media"][0]["critical_deg"].is_null());
    assert!(value["leaving"]["media"][0]["critical_deg"].is_number());
    let svg = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    let both = svg("a/fresnel-glass-both.svg");
    assert!(both.contains("into glass") && both.contains("total reflection"), "both on one slide");
    json(dir.path(), &["fresnel", "glass", "--show", "parallel,brewster", "--points", "91", "-o", "b"]);
    let lines = svg("b/fresnel-glass.svg");
    assert!(lines.contains("Brewster") && !lines.contains("Schlick"));
    let several = etalon(dir.path(), &["fresnel", "water", "glass", "--both"]);
    assert!(several.code == 2 && several.stderr.contains("--both: "), "{}", several.stderr);
}

#[test]
fn fresnel_angles_over_the_index() {
    let dir = folder();
    let value = json(dir.path(), &["fresnel", "--angles", "diamond", "1.45", "--points", "91", "-o", "a"]);
    assert_keys(&value, "eta_i, wavelength_nm, media, files");
    assert_files(dir.path(), &value);
    assert_keys(&value["media"][0], "medium, eta_t, brewster_deg, brewster_reverse_deg, critical_deg");
    // Without a medium all dielectrics are marked, and no metal.
    let all = json(dir.path(), &["fresnel", "--angles", "--points", "91", "-o", "b"]);
    assert!(all["media"].as_array().unwrap().len() > 10);
}

#[test]
fn fresnel_of_a_conductor() {
    let dir = folder();
    for (args, channels) in [
        (&["fresnel", "--metal", "Au", "--points", "46"][..], 3),
        (&["fresnel", "--metal", "Fe", "--points", "46"], 3),
        (&["fresnel", "--eta-t", "0.2", "--k", "3.9", "--points", "46"], 1),
    ] {
        let value = json(dir.path(), args);
        let files = assert_files(dir.path(), &value);
        let list = value["channels"].as_array().unwrap();
        assert_eq!(list.len(), channels);
        for c in list {
            assert_keys(c, "eta, k, r_normal, pseudo_brewster_deg, approximate_max_abs_error, schlick_max_abs_error");
        }
        let csv = files.iter().find(|f| f.ends_with(".csv")).unwrap();
        assert!(csv.starts_with("out/"), "without -o results go to out/, not to {csv}");
        assert_eq!(table(&dir.path().join(csv)).1.len(), 46 * channels);
    }
}

#[test]
fn fresnel_of_several_media() {
    let dir = folder();
    let args = ["fresnel", "water", "1.5", "--metal", "Au,iron", "--show", "unpolarized,error", "--points", "46"];
    let value = json(dir.path(), &args);
    let csv = "out/fresnel-water-1.5-Au-Fe.csv";
    assert!(assert_files(dir.path(), &value).iter().any(|file| file == csv));
    let media = value["media"].as_array().unwrap();
    let names: Vec<&str> = media.iter().map(|medium| medium["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["water", "η = 1.5", "gold (Au)", "iron (Fe)"]);
    assert_eq!(table(&dir.path().join(csv)).1.len(), 46 * media.len());
    // A medium alone has the figure of its kind.
    let files = |args: &[&str]| assert_files(dir.path(), &json(dir.path(), args));
    assert!(files(&["fresnel", "gold"]).iter().any(|file| file == "out/fresnel-Au.csv"));
    assert!(files(&["fresnel", "Diamond"]).iter().any(|file| file == "out/fresnel-diamond.csv"));
    let list = json(dir.path(), &["fresnel", "--list"]);
    let listed = list["media"].as_array().unwrap();
    assert!(listed.len() > 15 && listed.iter().all(|medium| !medium["source"].as_str().unwrap().is_empty()));
}

#[test]
fn envmap_info() {
    const KEYS: &str = "width, height, min, max, mean_rgb, solid_angle_mean_rgb, flux_rgb, nonfinite, negative, \
                        peak_to_mean, effective_texels";
    let dir = folder();
    for (map, width, flux) in [("constant", 64, Some(4.0 * PI)), ("black", 64, Some(0.0)), ("nave", 1024, None)] {
        let value = json(dir.path(), &["envmap", "info", map]);
        assert_keys(&value, KEYS);
        assert_eq!((number(&value, "width"), number(&value, "negative")), (f64::from(width), 0.0));
        let got = value["flux_rgb"][1].as_f64().unwrap();
        assert!(flux.is_none_or(|f| (got - f).abs() < 1e-12), "{map}: flux {got}");
    }
    assert!(number(&json(dir.path(), &["envmap", "info", "nave"]), "peak_to_mean") >= 500.0);
    assert!(number(&json(dir.path(), &["envmap", "info", "sun"]), "peak_to_mean") >= 1e4);
    assert!(tree(dir.path()).is_empty(), "info writes nothing");
}

#[test]
fn envmap_sample() {
    let dir = folder();
    let csv = |out: &str, extra: &[&str]| {
        let value = json(dir.path(), &[&["envmap", "sample", "constant", "-n", "7,20", "-o", out][..], extra].concat());
        let results = value["results"].as_array().unwrap();
        assert_eq!(results.len(), 2);
        results.iter().for_each(|r| assert_eq!(assert_files(dir.path(), r).len(), 7));
        std::fs::read(dir.path().join(results[1]["files"][0].as_str().unwrap())).unwrap()
    };
    let first = csv("a", &[]);
    assert_eq!(first, csv("b", &["--threads", "2"]), "the same seed gives the same samples");
    for (out, other) in [("c", &["--seed", "2"][..]), ("d", &["--sampler", "cosine"]), ("e", &["--model", "report"])] {
        assert_ne!(first, csv(out, other), "{other:?}");
    }
    let (header, rows) = table(&dir.path().join("a/constant-samples-20.csv"));
    assert_eq!((header.as_str(), rows.len()), ("x,y,dir_x,dir_y,dir_z,pdf,solid_angle,r,g,b", 20));
    for r in rows {
        assert!((0.0..64.0).contains(&r[0]) && (0.0..32.0).contains(&r[1]), "{r:?}");
        assert!((r[2].hypot(r[3]).hypot(r[4]) - 1.0).abs() < 1e-6 && (r[5] * 4.0 * PI - 1.0).abs() < 1e-6, "{r:?}");
        assert!((r[6] * 20.0 / (4.0 * PI) - 1.0).abs() < 1e-6, "{r:?}");
    }
    let args = ["envmap", "sample", "onehot", "-n", "9", "--sampler", "cosine", "-o", "f/any.svg"];
    let files = assert_files(dir.path(), &json(dir.path(), &args)["results"][0]);
    assert!(files.contains("f/any-9.svg") && files.contains("f/any-only-9.png"), "{files:?}");
}

#[test]
fn envmap_cut() {
    const HEADER: &str =
        "x0,y0,x1,y1,centroid_x,centroid_y,dir_x,dir_y,dir_z,flux_r,flux_g,flux_b,energy,solid_angle,r,g,b";
    let dir = folder();
    let colour = |x: usize, y: usize| Rgb::new((x * 7 % 48) as f32, (y * y) as f32, if x == 40 { 3e4 } else { 0.5 });
    write(&dir.path().join("map.pfm"), &Image::from_fn(48, 24, colour), &Metadata::default()).unwrap();
    let info = json(dir.path(), &["envmap", "info", "map.pfm"]);
    for (i, extra) in [
        &[][..],
        &["--split", "variance"],
        &["--centroid", "median"],
        &["--sides", "sphere", "--window", "9", "--exposure", "-3", "--gamma", "2.2"],
    ]
    .into_iter()
    .enumerate()
    {
        let out = format!("cut{i}");
        let value = json(dir.path(), &[&["envmap", "cut", "map.pfm", "-n", "1,13", "-o", &out][..], extra].concat());
        for (n, result) in [(1, &value["results"][0]), (13, &value["results"][1])] {
            assert_files(dir.path(), result);
            let (header, rows) = first_table(dir.path(), result);
            assert_eq!((header.as_str(), rows.len()), (HEADER, n), "{extra:?}");
            let texels: f64 = rows.iter().map(|r| (r[2] - r[0]) * (r[3] - r[1])).sum();
            assert_eq!(texels, 48.0 * 24.0, "{extra:?}: the regions tile the map");
            assert_eq!(result["lights"].as_array().unwrap().len(), n);
            for (row, light) in rows.iter().zip(result["lights"].as_array().unwrap()) {
                assert!((number(light, "r") * number(light, "solid_angle") / row[9] - 1.0).abs() < 1e-9, "{light}");
            }
            for c in 0..3 {
                let flux = info["flux_rgb"][c].as_f64().unwrap();
                assert!((rows.iter().map(|r| r[9 + c]).sum::<f64>() / flux - 1.0).abs() < 1e-9, "{extra:?}");
            }
        }
    }
}

#[test]
fn envmap_proposal() {
    let dir = folder();
    let value = json(dir.path(), &["envmap", "proposal", "sun", "-n", "20000", "-o", "p"]);
    assert_files(dir.path(), &value);
    assert!(number(&value["uniform"], "p") > 1e-3 && number(&value["gaussian"], "p") < 1e-6, "{value}");
    let other = json(dir.path(), &["envmap", "proposal", "sun", "-n", "20000", "-o", "p", "--seed", "2"]);
    assert_ne!(value["uniform"]["p"], other["uniform"]["p"]);
}

#[test]
fn envmap_make_reproduces_the_stored_maps() {
    let dir = folder();
    for name in ["nave", "sun", "constant", "onehot", "black"] {
        let value = json(dir.path(), &["envmap", "make", name, "-o", "made"]);
        assert_eq!(assert_files(dir.path(), &value), [format!("made/{name}.exr")].into());
        let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("envmaps/{name}.exr"));
        assert!(
            stored.exists(),
            "{} is missing: write it with `etalon envmap make {name} -o envmaps`",
            stored.display()
        );
        let made = image(&dir.path().join(format!("made/{name}.exr")));
        assert!(bits(&made) == bits(&image(&stored)), "envmaps/{name}.exr is not what `make` writes");
    }
    for format in ["hdr", "pfm", "png", "ppm"] {
        let file = format!("m.{format}");
        let value = json(dir.path(), &["envmap", "make", "onehot", "-o", &file]);
        assert_eq!(assert_files(dir.path(), &value), [file].into());
    }
}

#[test]
fn render_writes_the_same_bits_however_it_is_run() {
    const KEYS: &str = "width, height, spp, seconds, mean_rgb, dropped, left_out, files";
    let dir = folder();
    let render = |out: &str, extra: &[&str]| {
        let args = ["render", "sphere-env", "--envmap", "sun", "-s", "4", "-l", "2", "-m", "3", "-r", "31", "17"];
        let value = json(dir.path(), &[&args, &["-o", out][..], extra].concat());
        assert_keys(&value, KEYS);
        assert_keys(&value["dropped"], "nonfinite, negative, faint");
        assert!(value["left_out"].is_array());
        assert_eq!([number(&value, "width"), number(&value, "height"), number(&value, "spp")], [31.0, 17.0, 4.0]);
        let files = assert_files(dir.path(), &value);
        assert_eq!(files.len(), if out.ends_with(".pfm") { 2 } else { 4 }, "{files:?}");
        let mean = value["mean_rgb"][0].as_f64().unwrap();
        let pfm = files.iter().find(|name| name.ends_with(".pfm")).unwrap();
        let pixels = image(&dir.path().join(pfm));
        let expected = pixels.pixels().iter().map(|p| f64::from(p.x)).sum::<f64>() / (31.0 * 17.0);
        assert!((mean - expected).abs() < 1e-9 * expected, "{mean} {expected}");
        if !out.ends_with(".pfm") {
            assert!(bits(&image(&dir.path().join(pfm.replace("pfm", "exr")))) == bits(&pixels), "EXR is not PFM");
        }
        bits(&pixels)
    };
    let one = render("one", &["--threads", "1"]);
    assert!(one == render("two", &["--threads", "2"]), "threads change the image");
    assert!(one == render("general.pfm", &["--general"]), "--general changes the image");
    for (i, other) in [
        &["--seed", "2"][..],
        &["--stream", "independent"],
        &["--sampling", "light", "--light-density", "map"],
        &["--sampling", "bsdf"],
        &["--sampling", "hemisphere"],
        &["--light-density", "map"],
    ]
    .into_iter()
    .enumerate()
    {
        assert!(one != render(&format!("other{i}.pfm"), other), "{other:?} changes nothing");
    }
}

#[test]
fn render_reads_a_scene_file() {
    let dir = folder();
    json(dir.path(), &["envmap", "make", "sun", "-o", "sky map.exr"]);
    let scene = "LookAt 0 0 1 0 0 0 0 1 0 Camera \"orthographic\" Film \"image\" \"integer xresolution\" 9 \"integer \
                 yresolution\" 5 PixelFilter \"box\" WorldBegin LightSource \"infinite\" \"string mapname\" \"sky map.exr\" \
                 Material \"matte\" \"color Kd\" [1 1 1] Shape \"sphere\" \"float radius\" .5 WorldEnd";
    std::fs::write(dir.path().join("scène 1.pbrt"), scene).unwrap();
    let named = json(dir.path(), &["render", "scène 1.pbrt", "-s", "4", "-o", "a"]);
    let given = json(dir.path(), &["render", "scène 1.pbrt", "-s", "4", "-o", "b", "--envmap", "sky map.exr"]);
    assert_eq!([number(&named, "width"), number(&named, "height")], [9.0, 5.0]);
    assert_eq!(named["mean_rgb"], given["mean_rgb"]);
    assert_eq!(assert_files(dir.path(), &named).len(), 4);
}

#[test]
fn compare_measures_and_draws() {
    let dir = folder();
    let pfm = |values: [f32; 6]| [&b"PF\n2 1\n-1\n"[..], &values.map(f32::to_le_bytes).concat()].concat();
    std::fs::write(dir.path().join("a.pfm"), pfm([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])).unwrap();
    std::fs::write(dir.path().join("b.pfm"), pfm([1.0, 2.0, 3.0, 4.0, 5.0, 9.0])).unwrap();
    let value = json(dir.path(), &["compare", "a.pfm", "b.pfm", "-o", "d"]);
    assert_keys(&value, "mse, rmse, rel_mse, mape, smape, mse_trimmed, hdr_flip, mean_a, mean_b, max_abs, files");
    for (key, expected) in [
        ("mse", 1.5),
        ("rmse", 1.5_f64.sqrt()),
        ("rel_mse", 1.5 / 81.01),
        ("mean_a", 3.5),
        ("mean_b", 4.0),
        ("max_abs", 3.0),
    ] {
        assert!((number(&value, key) - expected).abs() < 1e-12, "{key}: {}", value[key]);
    }
    assert!(assert_files(dir.path(), &value).contains("d/a-vs-b.png"));
    assert_eq!(number(&json(dir.path(), &["compare", "a.pfm", "a.pfm"]), "max_abs"), 0.0);
}

#[test]
fn reproduce_lists_and_makes() {
    let dir = folder();
    let list = json(dir.path(), &["reproduce", "--list"]);
    let ids: Vec<&str> = list["figures"].as_array().unwrap().iter().map(|f| f["id"].as_str().unwrap()).collect();
    for id in "fresnel-enter fresnel-exit envmap-samples-64 envmap-samples-256 envmap-samples-1024 \
               envmap-samples-only-256 proposal median-cut-2 median-cut-4 median-cut-16 median-cut-64 \
               median-cut-radiance-64 sphere-8 sphere-16 sphere-32 sphere-64 sphere-error depth-0 depth-1 depth-2 \
               depth-3 depth-4 depth-5 depth-100 depth-differences roughness-0.005 roughness-0.05 roughness-0.25 \
               roughness-0.5 sampling-importance sampling-hemisphere sampling-error iron metals-table error-time-sphere \
               error-time-cornell error-time-roughness error-depth median-cut-error fresnel-angles"
        .split_whitespace()
    {
        assert!(ids.contains(&id), "{id} is not in {ids:?}");
    }
    assert!(tree(dir.path()).is_empty(), "--list writes nothing");

    let only = "fresnel-enter,fresnel-exit,median-cut-4,metals-table";
    let value = json(dir.path(), &["reproduce", "--quick", "--only", only, "-o", "given/place"]);
    assert_keys(&value, "figures, passed, failed, seconds");
    let mut written =
        BTreeSet::from(["checks.csv", "index.html", "reproduce.json"].map(|f| format!("given/place/{f}")));
    let mut checks = 0;
    for (id, figure) in only.split(',').zip(value["figures"].as_array().unwrap()) {
        assert_eq!(figure["id"], id);
        let made = assert_files(dir.path(), figure);
        for extension in ["csv", "svg", "png", "pdf"] {
            assert!(made.contains(&format!("given/place/{id}.{extension}")), "{made:?}");
        }
        written.extend(made);
        for check in figure["checks"].as_array().unwrap() {
            assert_keys(check, "name, kind, expected, got, tolerance, pass, skipped");
            assert_eq!(check["pass"], true, "{check}");
            checks += 1;
        }
    }
    assert_eq!((number(&value, "passed"), number(&value, "failed")), (f64::from(checks), 0.0));
    assert_eq!(tree(dir.path()), written, "files outside the place that was given, or not reported");

    // Under the black map the proposal has no samples to test, and the sphere's error has nothing to be relative to.
    let failing =
        ["reproduce", "--quick", "--only", "proposal,sphere-8,fresnel-enter", "--envmap", "black", "-o", "black"];
    let ran = etalon(dir.path(), &[&failing[..], &["--markdown", "black.md", "--junit", "black.xml"]].concat());
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert!(
        lines[0].starts_with("fresnel-enter  ok, 3 checks    ")
            && lines[0].ends_with(" s  fresnel-enter.{csv,svg,png,pdf}")
    );
    assert!(
        lines[1].starts_with("proposal       skipped")
            && lines[2].starts_with("    1 check skipped: the map has light in too few rows")
            && lines[3].starts_with("sphere-8       FAILED 1 of 3   ")
            && lines[4].starts_with("    FAILED: ")
            && lines[5] == "    1 check skipped: the map is black, not the first report's",
        "{lines:?}"
    );
    assert!(
        lines[6] == "wrote black.{xml,md}"
            && lines[7].starts_with("3 figures in black/index.html: 7 checks, 1 failed, 2 skipped (1: the map")
    );
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    assert!(
        read("black.md").starts_with("## etalon reproduce: rejected\n") && read("black.md").contains("\n| sphere-8/")
    );
    assert!(
        read("black.xml").contains("tests=\"7\" failures=\"1\" errors=\"0\" skipped=\"2\""),
        "{}",
        read("black.xml")
    );
    let ran = etalon(dir.path(), &["reproduce", "--quick", "--only", "fresnel-enter", "-o", "black", "-v"]);
    assert!(ran.code == 0 && ran.stdout.matches("    ok: ").count() == 3, "{}", ran.stdout);
    assert_eq!(etalon(dir.path(), &["reproduce", "--list", "-v"]).code, 2);
    let missing = ["reproduce", "--quick", "--only", "metals-table", "--scenes", "nowhere"];
    assert_eq!(etalon(dir.path(), &missing).code, 2);
}

#[test]
fn a_reader_that_goes_away_is_no_crash() {
    let dir = folder();
    for args in [&["reproduce", "--list"][..], &["--help"], &["envmap", "info", "constant"], &["fresnel", "--json"]] {
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("etalon"))
            .args(args)
            .current_dir(dir.path())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 2)), "{args:?}: {:?}", output.status);
        assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"), "{args:?}");
    }
}

#[test]
fn every_shell_has_completions() {
    let dir = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let ran = etalon(dir.path(), &["completions", shell]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(["fresnel", "max-spp"].iter().all(|word| ran.stdout.contains(word)), "{shell}");
        // Shells that are here read the script without complaint.
        let file = dir.path().join(shell);
        std::fs::write(&file, &ran.stdout).unwrap();
        match std::process::Command::new(shell).arg("-n").arg(&file).output() {
            Ok(read) if ["bash", "zsh", "fish"].contains(&shell) => {
                assert!(read.status.success(), "{shell}: {}", String::from_utf8_lossy(&read.stderr));
            }
            _ => eprintln!("skipped: {shell} did not read its script"),
        }
    }
    assert_eq!(etalon(dir.path(), &["completions", "tcsh"]).code, 2);
}

#[test]
fn both_formats_stand_beside_each_other_and_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["sphere-env.pbrt", "sphere-env.xml", "cornell-lambert.pbrt"] {
        let ran = etalon(folder.path(), &["scenes", "--export", name]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stdout.contains(&format!("wrote {name}")), "{}", ran.stdout);
    }
    for name in ["sphere-env.pbrt", "cornell-lambert.pbrt"] {
        let ran = etalon(folder.path(), &["render", name, "-r", "16", "12", "-s", "1", "-o", "image.exr"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
}

#[test]
fn what_cannot_be_exported_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (name, says) in [
        ("room.xml", "--export: \"room\" is no built-in scene"),
        ("cornell-spheres.obj", "--export: no scene format has the extension"),
        ("furnace.pbrt", "Beckmann"),
        ("brushed-metal.pbrt", "one side"),
    ] {
        let ran = etalon(folder.path(), &["scenes", "--export", name]);
        assert!(ran.code == 2 && ran.stderr.contains(says), "{name}: {} {}", ran.code, ran.stderr);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn sweeps_go_on_where_they_were_and_bad_ones_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let sweep = ["sweep", "mirror", "--configurations", "9"];
    let whole = json(dir.path(), &[&sweep[..], &["-t", "1", "-o", "whole.csv"]].concat());
    assert_eq!((&whole["configurations"], &whole["rejected"]), (&9.into(), &0.into()));
    let text = std::fs::read_to_string(dir.path().join("whole.csv")).unwrap();
    let some: Vec<&str> = text.lines().take(6).collect();
    std::fs::write(dir.path().join("state.csv"), some.join("\n")).unwrap();
    std::fs::write(dir.path().join("beyond.csv"), text.replacen("\n8,", "\n99,", 1)).unwrap();
    let resumed = json(dir.path(), &[&sweep[..], &["-t", "2", "--resume", "state.csv", "-o", "again.csv"]].concat());
    assert_eq!(resumed["groups"], whole["groups"]);
    assert_eq!(std::fs::read_to_string(dir.path().join("again.csv")).unwrap(), text);
    for (args, expected) in [
        (&["sweep", "mirror", "--resume", "whole.csv"][..], "another sweep (configurations: 100 here, 9 there)"),
        (&["sweep", "mirror", "--configurations", "9", "--resume", "beyond.csv"], "has no configuration 99"),
        (&["sweep", "miror"], "there is no family \"miror\""),
        (&["sweep", "mirror", "--configurations", "0"], "--configurations"),
        (&["sweep", "mirror", "--detect", "2"], "--detect"),
        (&["sweep", "--replay", "mirror wo=90"], "--replay"),
        (&["sweep", "--replay", "mirror check=x"], "there is no check \"x\""),
    ] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{args:?}: {}", ran.stderr);
    }
}

#[test]
fn replays_run_one_configuration() {
    let dir = tempfile::tempdir().unwrap();
    let found = json(dir.path(), &["sweep", "--replay", "ggx alpha_x=0.001 wo=75,30 seed=7 check=formula"]);
    assert_eq!(found["configuration"], "ggx alpha_x=0.001 alpha_y=0.3 eta=0.5 k=2.5 wo=75,30 seed=7");
    assert_eq!((&found["checks"][0]["verdict"], &found["checks"][1]), (&"accept".into(), &serde_json::Value::Null));
    let list = json(dir.path(), &["sweep", "diffuse", "--list"]);
    assert_eq!(list["families"][0]["parameters"][0][0], "albedo");
}
