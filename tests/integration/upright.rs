//! Which way up a map stands: every command turns the one file that is known to be upside-down, and no other.

use crate::assets::assets;
use crate::program::{etalon, json};
use std::path::Path;

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
