//! The suite must be able to fail: `etalon validate --planted`.

use crate::program::{etalon, json};
use tempfile::tempdir;

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn every_planted_fault_is_rejected_and_told() {
    let folder = tempdir().unwrap();
    let found = json(folder.path(), &["validate", "--planted", "--junit", "planted.xml", "--markdown", "planted.md"]);
    let tests = found["tests"].as_array().unwrap();
    assert!(tests.len() >= 25);
    assert_eq!((found["rejected"].as_u64().unwrap() as usize, &found["false_alarms"]), (tests.len(), &0.into()));
    for test in tests {
        assert_eq!((&test["verdict"], &test["sound"]), (&"reject".into(), &"accept".into()), "{test}");
        assert!(test["by"].is_string() && test["samples"].as_u64().unwrap() > 0, "{test}");
        assert!(test["mistake"].as_str().unwrap().len() > 20, "{test}");
    }
    let report = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(report("planted.xml").contains(&format!("tests=\"{}\" failures=\"0\" errors=\"0\"", tests.len())));
    assert!(report("planted.md").starts_with("## etalon validate --planted: accepted\n"));
    let table = std::fs::read_to_string(folder.path().join("out/planted.csv")).unwrap();
    assert_eq!(table.lines().count(), tests.len() + 1);
    // Integrals that are known: 1 + 0.05², ∫ cos θ sin θ dω/π, and two densities without the probability of either.
    for (name, mass) in [
        ("warp/hemisphere/cosine-floor", 1.0025),
        ("warp/hemisphere/sine-left-in", 2.0 / 3.0),
        ("light/choice-forgotten", 2.0),
    ] {
        let test = tests.iter().find(|test| test["name"] == name).unwrap();
        assert!((test["mass"].as_f64().unwrap() - mass).abs() < 1e-5, "{test}");
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn too_few_samples_do_not_count_as_finding() {
    let folder = tempdir().unwrap();
    let ran = etalon(folder.path(), &["validate", "--planted", "--samples", "20", "--markdown", "few.md"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let few = std::fs::read_to_string(folder.path().join("few.md")).unwrap();
    assert!(few.starts_with("## etalon validate --planted: rejected\n"), "{few}");
    assert!(ran.stdout.contains("inconclusive"), "{}", ran.stdout);
}

#[test]
fn one_fault_is_explained() {
    let folder = tempdir().unwrap();
    let ran = etalon(folder.path(), &["validate", "--planted", "warp/hemisphere/disc-without-root"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for said in ["mistake: ", "found: ", " % too many within ", "1 of 1 planted fault rejected"] {
        assert!(ran.stdout.contains(said), "{said}: {}", ran.stdout);
    }
    let list = json(folder.path(), &["validate", "--planted", "--list", "warp/hemisphere"]);
    let names = list["tests"].as_array().unwrap();
    assert!(names.len() > 3 && names.iter().all(|name| name.as_str().unwrap().starts_with("warp/hemisphere/")));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = tempdir().unwrap();
    for bad in [
        &["validate", "--planted", "warps"][..],
        &["validate", "--planted", "--samples", "0"],
        &["validate", "--planted", "--figures"],
    ] {
        assert_eq!(etalon(folder.path(), bad).code, 2, "{bad:?}");
    }
}
