//! `etalon converge` as a script relies on it: keys, files, exit codes, the budget.

use crate::program::{etalon, json};
use std::time::Instant;

#[test]
fn curves_of_a_room_against_a_rendered_reference() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["converge", "cornell-lambert", "-r", "24", "18", "--max-spp", "32", "--replicates", "4"];
    let strategies = ["--strategies", "light+independent,mis,hemisphere", "--budget", "30", "-o", "out/room.csv"];
    let value = json(folder.path(), &[&args[..], &strategies].concat());
    for key in ["scene", "width", "height", "reference", "curves", "cut", "seconds", "common_cpu_seconds", "files"] {
        assert!(value.get(key).is_some(), "{key}");
    }
    assert_eq!((value["reference"]["exact"].as_bool(), value["cut"].as_array().unwrap().len()), (Some(false), 0));
    let curves = value["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 3);
    for curve in curves {
        let spp: Vec<u64> = curve["levels"].as_array().unwrap().iter().map(|l| l["spp"].as_u64().unwrap()).collect();
        assert_eq!(spp, [1, 2, 4, 8, 16, 32]);
        assert!(curve["slope"]["value"].as_f64().unwrap() < -0.3 && curve["verdict"] != "biased", "{curve}");
    }
    let files: Vec<&str> = value["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    assert_eq!(files.len(), 7, "{files:?}");
    assert!(files.iter().all(|file| folder.path().join(file).is_file()), "{files:?}");
    let table = std::fs::read_to_string(folder.path().join("out/room.csv")).unwrap();
    assert!(table.starts_with("strategy,spp,replicates,cpu_seconds,wall_seconds,") && table.lines().count() == 19);
}

#[test]
fn fixed_lights_are_biased_and_regions_as_strata_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["converge", "sphere-env", "--envmap", "sun", "-r", "24", "24", "--max-spp", "64", "--replicates", "5"];
    let strategies = ["--strategies", "median-cut-16,variance-cut-16,strata-16+independent,light+independent"];
    let value = json(folder.path(), &[&args[..], &strategies].concat());
    assert_eq!(value["reference"]["exact"], true);
    let verdicts: Vec<&str> =
        value["curves"].as_array().unwrap().iter().map(|curve| curve["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts[..2], ["biased", "biased"]);
    assert!(verdicts[2..].iter().all(|verdict| *verdict != "biased"), "{verdicts:?}");
}

#[test]
fn it_ends_when_the_budget_does() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    let ran =
        etalon(folder.path(), &["converge", "cornell-spheres", "--budget", "2", "--quiet", "-o", "out", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let seconds = value["seconds"].as_f64().unwrap();
    // Other tests may keep the machine busy.
    assert!(seconds < 4.0, "{seconds} of 2 s");
    assert!(!value["cut"].as_array().unwrap().is_empty(), "4096 samples per pixel do not fit into 2 s");
    assert!(start.elapsed().as_secs_f64() < 30.0);
}

#[test]
fn a_budget_too_small_for_any_verdict_is_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let ran = etalon(folder.path(), &["converge", "cornell-spheres", "--budget", "1e-4", "-o", "out"]);
    assert_eq!(ran.code, 3, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stderr.contains("stopped by"), "{}", ran.stderr);
}

#[test]
fn bad_input_is_refused_with_what_and_why() {
    let folder = tempfile::tempdir().unwrap();
    for (args, says) in [
        (&["cornell-box"][..], "built-in scenes: "),
        (&["cornell-spheres", "--strategies", "ligth"], "strategies: light, "),
        (&["cornell-spheres", "--strategies", "light+sobol"], "+independent"),
        (&["cornell-spheres", "--strategies", "median-cut-16"], "needs an environment map"),
        (&["sphere-env", "--strategies", "strata-0", "-r", "8", "8"], "0 regions"),
        (&["sphere-env", "--strategies", "median-cut-4294967295", "-r", "8", "8"], "regions out of"),
        (&["cornell-spheres", "--budget", "nan"], "--budget: NaN"),
        (&["cornell-spheres", "--budget", "0"], "--budget: 0"),
        (&["cornell-spheres", "--budget", "-1"], "--budget: -1"),
        (&["cornell-spheres", "--budget", "inf"], "--budget: inf"),
        (&["cornell-spheres", "--max-spp", "0"], "--max-spp"),
        (&["cornell-spheres", "--replicates", "0"], "--replicates"),
        (&["cornell-spheres", "-l", "0"], "-l: must be at least 1"),
        (&["cornell-spheres", "-r", "0", "10"], "cannot render 0x10"),
        (&["cornell-spheres", "-r", "100000", "100000"], "the films of"),
    ] {
        let ran = etalon(folder.path(), &[&["converge"], args].concat());
        assert_eq!(ran.code, 2, "{args:?}: {}{}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(says), "{args:?}: {}", ran.stderr);
    }
}
