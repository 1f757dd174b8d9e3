//! `etalon furnace` as a script relies on it: keys, columns, files, exit codes.

use crate::program::{etalon, json};
use etalon::study::validation::families;
use etalon_stats::Protocol;
use etalon_stats::bsdf::{Basis, BatchBsdf, Family as _, directional_albedo};
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

/// The albedo of `ggx` with these parameters, with a bound from theory, and the light that `name` reflects more: of multiple scattering,
/// which does not depend on the azimuth.
fn expected(name: &str, parameters: &[f64; 3], wo: [f64; 3]) -> f64 {
    let all = families::all();
    let family = |name: &str| all.iter().find(|family| family.name() == name).unwrap();
    let &[alpha, eta, k] = parameters;
    let single = family("ggx").with(&[alpha, alpha, eta, k]).unwrap();
    let albedo = directional_albedo(&*single, wo, 1e-5, &Protocol::default()).unwrap();
    assert!(matches!(albedo.basis, Basis::Certified(_)));
    if name == "ggx-ndf" {
        return albedo.value[0];
    }
    let whole = family(name).with(parameters).unwrap();
    let n = 20_000;
    let pair = |i: i32| {
        let cos = (f64::from(i) + 0.5) / f64::from(n);
        // Across the plane of `wo`, where single scattering is weak.
        [wo, [0.0, (1.0 - cos * cos).sqrt(), cos]]
    };
    let pairs: Vec<_> = (0..n).map(pair).collect();
    let of = |bsdf: &dyn BatchBsdf| bsdf.eval(&pairs, &[]).unwrap();
    let more = of(&*whole).into_iter().zip(of(&*single)).zip(&pairs).map(|((a, b), [_, wi])| (a[0] - b[0]) * wi[2]);
    albedo.value[0] + std::f64::consts::TAU * more.sum::<f64>() / f64::from(n)
}

#[test]
#[ignore = "takes minutes: cargo test -- --ignored"]
fn intervals_without_a_bound_cover_as_often_as_they_say() {
    let (all, seeds) = (families::all(), 300);
    for (name, parameters) in
        [("ggx-ndf", [0.3, 0.5, 10.0]), ("compensated-ggx", [0.3, 0.5, 10.0]), ("compensated-ggx", [1.0, 0.5, 2.0])]
    {
        let [alpha, eta, k] = parameters;
        let values = if name == "ggx-ndf" { vec![alpha, alpha, eta, k] } else { parameters.to_vec() };
        let family = all.iter().find(|family| family.name() == name).unwrap();
        let bsdf = family.with(&values).unwrap();
        for degrees in [0.0f64, 60.0, 85.0, 89.99] {
            let wo = [degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()];
            let expected = expected(name, &parameters, wo);
            let (mut covered, mut sum, mut bounds) = (0, 0.0, 0.0);
            for seed in 0..seeds {
                let found = directional_albedo(&*bsdf, wo, 1e-3, &Protocol { seed, ..Protocol::default() }).unwrap();
                assert!(matches!(found.basis, Basis::Normal(_)));
                covered += u32::from((found.value[0] - expected).abs() <= found.error[0]);
                (sum, bounds) = (sum + found.value[0] - expected, bounds + found.error[0]);
            }
            let n = f64::from(seeds as u32);
            println!(
                "{name} {parameters:?} {degrees} deg: {covered} of {seeds}, mean {:.2e}, bound {:.2e}",
                sum / n,
                bounds / n
            );
            // Of 300 with a risk of 1 %, 10 or more outside have a probability of 0.1 %.
            assert!(covered > 290, "{name} {parameters:?} at {degrees} deg: {covered} of {seeds}");
        }
    }
}
