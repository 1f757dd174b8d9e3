//! `etalon furnace` as a script relies on it: keys, columns, files, exit codes.

use crate::program::{etalon, json};
use tempfile::tempdir;

#[test]
fn a_table_has_its_columns_and_files() {
    let folder = tempdir().unwrap();
    let found = json(folder.path(), &["furnace", "diffuse", "ggx", "--size", "3x2", "--error", "1e-3", "-o", "out"]);
    let tables = found["tables"].as_array().unwrap();
    assert_eq!(tables.iter().map(|table| table["family"].as_str().unwrap()).collect::<Vec<_>>(), ["diffuse", "ggx"]);
    for table in tables {
        let rows = table["rows"].as_array().unwrap();
        assert_eq!(rows.len(), 6);
        for row in rows {
            assert!(row["error"].as_f64().unwrap() <= 1e-3 && row["basis"] == "certified", "{row}");
            assert!((0.0..=1.001).contains(&row["albedo"].as_f64().unwrap()), "{row}");
            assert_eq!(row["weak_furnace"].is_number(), table["family"] == "ggx", "{row}");
        }
    }
    let files = folder.path().join("out").read_dir().unwrap();
    let mut names: Vec<String> = files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let expected = ["diffuse", "ggx"].map(|name| ["csv", "pdf", "png", "svg"].map(|end| format!("-{name}.{end}")));
    for (name, end) in names.iter().zip(expected.as_flattened()) {
        assert!(name.starts_with("furnace") && name.ends_with(end), "{name}, {end}");
    }
    assert_eq!(names.len(), 8);
    let listed = json(folder.path(), &["furnace", "--list"]);
    assert!(listed["families"].as_array().unwrap().len() >= 14);
    assert_eq!(listed, json(folder.path(), &["sweep", "--list"]));
}

#[test]
fn what_is_too_coarse_or_makes_no_sense_has_its_exit_code() {
    let folder = tempdir().unwrap();
    let code = |args: &[&str]| etalon(folder.path(), &[&["furnace"][..], args].concat());
    // 2²² points leave an error of 1.5·10⁻⁶.
    assert_eq!(code(&["diffuse", "--size", "1x1", "--error", "1e-7"]).code, 3);
    for (bad, message) in [
        (&["difuse"][..], "there is no BSDF \"difuse\""),
        (&["diffuse", "--size", "0x3"], "0 x 3"),
        (&["diffuse", "--size", "3"], "is no size"),
        (&["diffuse", "--size", "99999999x99999999"], "cells"),
        (&["diffuse", "--error", "nan"], "--error"),
        (&["diffuse", "--error", "0"], "--error"),
        (&["ggx", "--over", "beta"], "has no parameter \"beta\""),
        (&["ggx", "--set", "eta=1e9"], "--set"),
        (&["ggx", "--set", "eta"], "NAME=VALUE"),
        (&["ggx", "--set", "eta=inf"], "NAME=VALUE"),
        (&[], "NAME"),
    ] {
        let ran = code(bad);
        assert!(ran.code == 2 && ran.stderr.contains(message), "{bad:?}: {} {}", ran.code, ran.stderr);
    }
    let left = folder.path().join("out");
    assert!(
        !left.exists() || left.read_dir().unwrap().all(|e| e.unwrap().path().to_string_lossy().contains("diffuse"))
    );
}
