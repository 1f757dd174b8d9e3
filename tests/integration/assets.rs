//! The program on real maps and on damaged files, where the folder with them stands beside the repository. Which way up a map
//! stands: every command turns the one file that is known to be upside-down, and no other.

use crate::program::{etalon, json};
use etalon::raster::{ReadOptions, read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A folder of the shared assets; `None`, and a word about it, where there is none.
pub fn assets(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: there is no {}", path.display());
    None
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files_below(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

#[test]
fn the_grace_probe_has_its_known_numbers() {
    let Some(maps) = assets("envmaps") else { return };
    let dir = tempfile::tempdir().unwrap();
    let grace = maps.join("grace_latlong.exr");
    let grace = grace.to_str().unwrap();
    let close = |got: &serde_json::Value, expected: [f64; 3], tolerance: f64| {
        for (c, e) in expected.into_iter().enumerate() {
            let g = got[c].as_f64().unwrap();
            assert!((g - e).abs() <= tolerance, "{g} is not {e}");
        }
    };
    for (flip, row) in [(&["--no-flip"][..], 382), (&[], 129)] {
        let info = json(dir.path(), &[&["envmap", "info", grace][..], flip].concat());
        close(&info["flux_rgb"], [0.28132, 0.15577, 0.19289], 6e-6);
        close(&info["solid_angle_mean_rgb"], [0.02239, 0.01240, 0.01535], 6e-6);
        assert_eq!((info["width"].as_u64(), info["height"].as_u64()), (Some(1024), Some(512)));
        assert_eq!((info["peak"][0].as_u64(), info["peak"][1].as_u64()), (Some(502), Some(row)));
        assert_eq!((info["nonfinite"].as_u64(), info["negative"].as_u64()), (Some(0), Some(0)));
        assert_eq!(info["max"], 18.375);
        assert!((info["min"].as_f64().unwrap() - 7.4e-6).abs() < 5e-8, "{info}");
    }
}

/// The first report's cuts of the probe: the most energetic region over the mean.
#[test]
fn the_grace_probe_is_cut_into_regions_of_nearly_equal_energy() {
    let Some(maps) = assets("envmaps") else { return };
    let dir = tempfile::tempdir().unwrap();
    let grace = maps.join("grace_latlong.exr");
    let value = json(dir.path(), &["envmap", "cut", grace.to_str().unwrap(), "-n", "2,4,16,64"]);
    for (result, expected) in value["results"].as_array().unwrap().iter().zip([1.0007, 1.0036, 1.0271, 1.0757]) {
        let got = result["imbalance"].as_f64().unwrap();
        assert!((got - expected).abs() < 1e-4, "{} regions: {got}, not {expected}", result["n"]);
    }
}

#[test]
fn real_maps_are_read() {
    let Some(maps) = assets("envmaps") else { return };
    let dir = tempfile::tempdir().unwrap();
    for file in files_below(&maps) {
        let image = read(&file, ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let info = json(dir.path(), &["envmap", "info", file.to_str().unwrap()]);
        let width = if file.ends_with("park-512-negatives.exr") { 512 } else { 1024 };
        assert_eq!([image.width(), image.height()], [width, width / 2], "{}", file.display());
        assert_eq!([&info["width"], &info["nonfinite"]], [width, 0], "{}", file.display());
        assert!((0..3).all(|c| info["flux_rgb"][c].as_f64().is_some_and(|f| f > 0.0)), "{}: {info}", file.display());
        let dwa = ["interior.exr", "park-512-negatives.exr", "sunset.exr"].iter().any(|name| file.ends_with(name));
        assert_eq!(info["negative"].as_u64().unwrap() > 0, dwa, "{}: lossy compression rings", file.display());
    }
}

/// PFM files of other programs: four channels, and blanks at the end of the header.
#[test]
fn odd_pfm_files_are_refused_or_read_right() {
    let Some(odd) = assets("odd") else { return };
    let dir = tempfile::tempdir().unwrap();
    let four = etalon(dir.path(), &["envmap", "info", odd.join("pf4.pfm").to_str().unwrap()]);
    assert!(four.code == 2 && four.stderr.contains("PF4"), "{}", four.stderr);
    let info = json(dir.path(), &["envmap", "info", odd.join("sp.pfm").to_str().unwrap()]);
    assert_eq!([&info["width"], &info["height"], &info["negative"]], [8, 5, 0]);
    assert!(info["max"].as_f64().unwrap() < 4.0, "{info}");
}

/// Damaged files: a result or an error, soon, within 1 GiB of address space.
#[test]
fn damaged_files_are_refused_or_read() {
    let Some(hostile) = assets("hostile") else { return };
    let files = files_below(&hostile);
    assert!(!files.is_empty());
    let mut sound = 0;
    for file in &files {
        let start = Instant::now();
        // Where the shell cannot limit memory, the file is tried all the same.
        let output = std::process::Command::new("sh")
            .args(["-c", "ulimit -v 1048576 2>/dev/null; RAYON_NUM_THREADS=1 exec \"$0\" envmap info \"$1\""])
            .arg(assert_cmd::cargo::cargo_bin("etalon"))
            .arg(file)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        let name = file.display();
        assert!(!stderr.contains("panicked"), "{name}: {stderr}");
        assert!(start.elapsed() < Duration::from_secs(10), "{name} took {:?}", start.elapsed());
        match output.status.code() {
            Some(0) => sound += 1,
            Some(2) => {
                assert!(stderr.contains("error: ") && stderr.contains(file.to_str().unwrap()), "{name}: {stderr}");
                assert!(stderr.contains("hint: "), "{name}: {stderr}");
            }
            other => panic!("{name}: exit code {other:?}: {stderr}"),
        }
    }
    println!("{sound} of {} files were read, the others refused", files.len());
    // Files that are merely unusual must be read.
    for (name, size) in [
        ("exr/BrightRingsNanInf.exr", [800, 800]),
        ("exr/GrayRampsDiagonal.exr", [800, 800]),
        ("exr/WideFloatRange.exr", [500, 500]),
        ("other/hopper.pfm", [128, 128]),
        ("other/hopper_be.pfm", [128, 128]),
        ("other/old-rle.hdr", [551, 276]),
    ] {
        let image = read(&hostile.join(name), ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!([image.width(), image.height()], size, "{name}");
    }
}

/// The first report's scene, unchanged, under the Grace probe, against what PBRT-v2 makes of it.
#[test]
fn the_report_scene_has_the_known_radiance() {
    const S: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const KNOWN: [([f64; 2], [f64; 3]); 5] = [
        ([0.0, S], [0.33820, 0.19120, 0.26335]),
        ([0.0, -S], [0.16658, 0.04898, 0.01052]),
        ([S, 0.0], [0.36022, 0.16219, 0.17004]),
        ([-S, 0.0], [0.12029, 0.04990, 0.04182]),
        ([0.0, 0.0], [0.28311, 0.10953, 0.08941]),
    ];
    let (Some(maps), Some(scenes)) = (assets("envmaps"), assets("scenes")) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (scene, map) = (scenes.join("simple_sphere.pbrt"), maps.join("grace_latlong.exr"));
    let args = ["render", scene.to_str().unwrap(), "--envmap", map.to_str().unwrap(), "-s", "8", "-o", "grace.pfm"];
    let value = json(dir.path(), &args);
    assert_eq!((value["width"].as_u64(), value["height"].as_u64()), (Some(511), Some(511)));
    let image = read(&dir.path().join("grace.pfm"), ReadOptions::default()).unwrap();
    for (n, expected) in KNOWN {
        // The window -1..1 is 511 pixels; x to the right, y up. 15x15 pixels: the radiance is nearly linear across them.
        let (x, y) = (255.5 + 255.5 * n[0], 255.5 - 255.5 * n[1]);
        let mut sum = glam::DVec3::ZERO;
        for dy in -7..=7 {
            for dx in -7..=7 {
                sum += image.get((x as i32 + dx) as usize, (y as i32 + dy) as usize).as_dvec3();
            }
        }
        let got = (sum / 225.0).to_array();
        for (g, e) in got.into_iter().zip(expected) {
            // 1 % and the noise that is left.
            assert!((g - e).abs() < 0.01 * e + 2e-4, "n = {n:?}: {got:?} is not {expected:?}");
        }
    }
    // All rays that miss run along -z, to the point where four texels meet: PBRT interpolates them, here one is looked up.
    let texels = read(&map, ReadOptions::default()).unwrap();
    let four = [(767, 255), (768, 255), (767, 256), (768, 256)].map(|(x, y)| texels.get(x, y) * 8.0);
    let blend = four.into_iter().sum::<glam::Vec3>() / 4.0;
    assert!((blend - glam::Vec3::new(0.03271, 0.00987, 0.00831)).abs().max_element() < 1e-5, "{blend}");
    assert!(four.contains(&image.get(2, 2)), "the background is {}, not one of {four:?}", image.get(2, 2));
}

/// A scene of the course whose camera matrix lacks a number.
#[test]
fn the_gems_are_seen() {
    let Some(odd) = assets("odd") else { return };
    let dir = tempfile::tempdir().unwrap();
    let gems = odd.join("CBgems.dae");
    let args = ["render", gems.to_str().unwrap(), "-s", "4", "-m", "4", "-r", "80", "60"];
    let ran = etalon(dir.path(), &args);
    assert!(ran.code == 0 && ran.stderr.contains("712:9: <matrix> has 15 numbers"), "{}", ran.stderr);
    let mean = json(dir.path(), &args)["mean_rgb"][0].as_f64().unwrap();
    assert!(mean > 0.05, "{mean}");
}

#[test]
fn the_second_reports_scenes_take_the_place_of_the_built_in_ones() {
    let Some(scenes) = assets("scenes") else { return };
    let dir = tempfile::tempdir().unwrap();
    let only = "depth-0,depth-1,depth-2,depth-3,depth-4";
    let args = ["reproduce", "--quick", "--only", only, "--scenes", scenes.to_str().unwrap()];
    let value = json(dir.path(), &args);
    assert_eq!(value["failed"], 0, "{value}");
    assert!(value["passed"].as_u64().unwrap() > 20);
}

/// Means of real scenes by region against the pictures of another renderer. Two differences are not the scenes': in its
/// picture of veach-mis, plates have Beckmann microfacets and 0.3 of the reflectance, and there is direct light alone.
#[test]
fn real_scenes_agree_with_the_pictures_of_another_renderer() {
    let Some(scenes) = assets("pbrt-real") else { return };
    let dir = tempfile::tempdir().unwrap();
    // The image of the changed scene, and the reference; means over part of the width and the height.
    let render = |name: &str, changes: &[(&str, &str)], options: &[&str]| {
        let folder = scenes.join(name).join("pbrt");
        let mut text = std::fs::read_to_string(folder.join("scene-v4.pbrt")).unwrap();
        for (from, to) in changes {
            assert!(text.contains(from), "{name} has no {from}");
            text = text.replace(from, to);
        }
        std::fs::write(dir.path().join("scene.pbrt"), text).unwrap();
        let ran = etalon(dir.path(), &[&["render", "scene.pbrt", "-s", "64", "-o", "o.exr"], options].concat());
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        [dir.path().join("o.exr"), folder.join("TungstenRender.exr")]
            .map(|path| read(&path, ReadOptions::default()).unwrap())
    };
    // The ratio of the means over columns x0..x1 and rows y0..y1 of our image, whose pixels are blocks of theirs.
    let ratio = |[ours, theirs]: &[etalon::raster::Image; 2], [x0, x1, y0, y1]: [usize; 4]| {
        let [a, b] = [ours, theirs].map(|image| {
            let times = image.width() / ours.width();
            let row = |y: usize| (x0 * times..x1 * times).map(move |x| image.get(x, y).as_dvec3().element_sum());
            (y0 * times..y1 * times).flat_map(row).sum::<f64>() / (times * times) as f64
        });
        a / b
    };
    let gaussian = "PixelFilter \"gaussian\" \"float xradius\" [ 1.5 ] \"float yradius\" [ 1.5 ]";
    let images = render("cornell-box", &[(gaussian, "PixelFilter \"box\"")], &["-m", "65", "-r", "128", "128"]);
    for (x, y) in (0..16).map(|i| (32 * (i % 4), 32 * (i / 4))) {
        let ratio = ratio(&images, [x, x + 32, y, y + 32]);
        assert!((ratio - 1.0).abs() < 0.02, "cornell-box at {x} {y}: {ratio}");
    }
    let triangle = "PixelFilter \"triangle\"\n    \"float xradius\" [ 1 ]\n    \"float yradius\" [ 1 ]";
    let (smooth, beckmann) = ("[ \"conductor\" ]", "[ \"conductor\" ] \"string distribution\" \"beckmann\"");
    let changes = [(triangle, "PixelFilter \"box\""), (smooth, beckmann)];
    let images = render("veach-mis", &changes, &["-m", "1", "-r", "320", "180"]);
    for (what, region, expected) in [
        ("wall", [40, 280, 5, 20], 1.0),
        ("floor", [40, 280, 172, 180], 1.0),
        ("plate 1", [90, 230, 66, 92], 1.0 / 0.3),
        ("plate 2", [82, 240, 95, 115], 1.0 / 0.3),
        ("plate 3", [66, 256, 121, 139], 1.0 / 0.3),
        ("plate 4", [46, 276, 146, 163], 1.0 / 0.3),
    ] {
        let ratio = ratio(&images, region);
        assert!((ratio / expected - 1.0).abs() < 0.02, "veach-mis, {what}: {ratio}");
    }
}

/// Nothing is skipped, and both reports' claims are judged.
#[test]
#[ignore = "takes a minute: cargo test -- --ignored"]
fn the_reports_own_files_allow_every_check() {
    let (Some(maps), Some(scenes)) = (assets("envmaps"), assets("scenes")) else { return };
    let dir = tempfile::tempdir().unwrap();
    let only = "envmap-samples-64,median-cut-64,sphere-error,claims-first,sampling-error,depth-3";
    let (map, scenes) = (maps.join("grace_latlong.exr"), scenes.to_str().unwrap().to_owned());
    let args = ["reproduce", "--quick", "--only", only, "--envmap", map.to_str().unwrap(), "--scenes", &scenes];
    let found = json(dir.path(), &args);
    assert_eq!((&found["failed"], &found["skipped"]), (&0.into(), &0.into()), "{found}");
    let figures = found["figures"].as_array().unwrap();
    let claims = figures.iter().flat_map(|figure| figure["claims"].as_array().unwrap());
    assert!(
        claims.clone().count() > 10 && claims.clone().all(|c| !c["verdict"].as_str().unwrap().contains("measured"))
    );
    // Columns: 28 % of Grace's samples are in the middle half
    let columns = claims.clone().find(|c| c["claim"].as_str().unwrap().ends_with("edge: columns.")).unwrap();
    assert_eq!(columns["verdict"], "does not hold");
    let page = std::fs::read_to_string(dir.path().join("figures/index.html")).unwrap();
    assert!(page.contains("grace_latlong.exr (Grace Cathedral), CBspheres.dae"), "the page names the originals");
}

/// The row of the brightest texel in the middle of 512 rows, and what was said.
fn peak(folder: &Path, args: &[&str]) -> (u64, String) {
    let row = json(folder, &[&["envmap", "info"], args].concat())["peak"][1].as_u64().unwrap();
    (row, etalon(folder, &[&["envmap", "info"], args].concat()).stderr)
}

#[test]
fn a_map_that_seems_upside_down_is_named_and_not_turned() {
    let dir = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| assert_eq!(etalon(dir.path(), args).code, 0, "{args:?}");
    run(&["envmap", "make", "sun", "-o", "sun.pfm"]);
    let pfm = std::fs::read(dir.path().join("sun.pfm")).unwrap();
    // Rows in reverse order, behind the header
    let (header, rows) = pfm.split_at(pfm.len() - 1024 * 512 * 12);
    let turned: Vec<u8> = rows.chunks(1024 * 12).rev().flatten().copied().collect();
    std::fs::write(dir.path().join("nus.pfm"), [header, &turned].concat()).unwrap();
    let (right, said) = peak(dir.path(), &["sun.pfm"]);
    assert!(right < 256 && said.is_empty(), "{said}");
    let (stored, said) = peak(dir.path(), &["nus.pfm"]);
    assert_eq!(stored, 511 - right);
    assert!(said.contains("warning: nus.pfm is probably stored upside-down") && said.contains("--flip"), "{said}");
    assert_eq!(peak(dir.path(), &["nus.pfm", "--no-flip"]), (stored, String::new()));
    assert_eq!(peak(dir.path(), &["nus.pfm", "--flip"]), (right, String::new()));
    let both = etalon(dir.path(), &["envmap", "info", "nus.pfm", "--flip", "--no-flip"]);
    assert!(both.code == 2 && both.stderr.contains("--no-flip"), "{}", both.stderr);
    // Commands that draw nothing of the map warn, too
    for command in ["envmap proposal nus.pfm -n 1000", "validate map/nus/cdf --envmap nus.pfm --samples 1000"] {
        let said = etalon(dir.path(), &command.split(' ').collect::<Vec<_>>()).stderr;
        assert!(said.contains("upside-down"), "{command}: {said}");
    }
}

/// The light of the sphere's upper and lower half.
fn halves(folder: &Path, args: &[&str]) -> [f32; 2] {
    let args = [&["render"], args, &["-r", "33", "33", "-s", "8", "-o", "sphere.pfm"]].concat();
    let ran = etalon(folder, &args);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let pfm = std::fs::read(folder.join("sphere.pfm")).unwrap();
    let values: Vec<f32> =
        pfm[pfm.len() - 33 * 33 * 12..].as_chunks().0.iter().map(|v| f32::from_le_bytes(*v)).collect();
    // The bottom row comes first
    let (lower, upper) = (&values[..16 * 33 * 3], &values[17 * 33 * 3..]);
    [upper, lower].map(|half| half.iter().sum())
}

#[test]
fn the_grace_probe_is_turned_by_every_command() {
    let Some(maps) = assets("envmaps") else { return };
    let dir = tempfile::tempdir().unwrap();
    // Its content is known, not its name
    std::fs::copy(maps.join("grace_latlong.exr"), dir.path().join("probe.exr")).unwrap();
    let (row, said) = peak(dir.path(), &["probe.exr"]);
    assert_eq!(row, 129);
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with("note: probe.exr: the Grace Cathedral probe, stored upside-down, is turned"), "{said}");
    assert_eq!(peak(dir.path(), &["probe.exr", "--flip"]), (129, String::new()));
    assert_eq!(peak(dir.path(), &["probe.exr", "--no-flip"]), (382, String::new()));
    let [upper, lower] = halves(dir.path(), &["sphere-env", "--envmap", "probe.exr"]);
    assert!(upper > 1.3 * lower, "{upper} above, {lower} below");
    assert_eq!(halves(dir.path(), &["sphere-env", "--envmap", "probe.exr", "--flip"]), [upper, lower]);
    let [up, down] = halves(dir.path(), &["sphere-env", "--envmap", "probe.exr", "--no-flip"]);
    assert!(up < down, "{up} above, {down} below");
    // A scene file of PBRT turns the map itself
    let Some(scenes) = assets("scenes") else { return };
    let scene = scenes.join("simple_sphere.pbrt");
    let [up, down] = halves(dir.path(), &[scene.to_str().unwrap(), "--envmap", "probe.exr"]);
    assert!((up / upper - 1.0).abs() < 0.03 && (down / lower - 1.0).abs() < 0.03, "{up} above, {down} below");
    for command in ["envmap proposal probe.exr -n 1000", "validate map/probe/cdf --samples 1000 --envmap probe.exr"] {
        let said = etalon(dir.path(), &command.split(' ').collect::<Vec<_>>()).stderr;
        assert!(said.contains("is turned"), "{command}: {said}");
    }
}
