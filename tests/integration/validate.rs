//! `etalon validate` as a script relies on it: names, JSON keys, files, exit codes; and the suite must be able to fail:
//! `etalon validate --planted`.

use crate::program::{etalon, json};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use tempfile::tempdir;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn names(value: &Value) -> Vec<&str> {
    value["tests"].as_array().unwrap().iter().map(|test| test["name"].as_str().unwrap()).collect()
}

fn files(folder: &Path) -> BTreeSet<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name != ".etalon").collect()
}

#[test]
fn the_list_names_every_test_once() {
    let dir = folder();
    let value = json(dir.path(), &["validate", "--list"]);
    let list: Vec<&str> = value["tests"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(list.len() >= 200 && list.iter().collect::<BTreeSet<_>>().len() == list.len());
    let family = json(dir.path(), &["validate", "--list", "normals/ggx", "b*/60"]);
    for name in family["tests"].as_array().unwrap() {
        let name = name.as_str().unwrap();
        assert!(name.starts_with("normals/ggx/") || (name.starts_with('b') && name.ends_with("/60")), "{name}");
    }
    assert!(files(dir.path()).is_empty(), "--list writes nothing");
}

#[test]
fn right_samplers_are_accepted_and_reported() {
    const NAME: &str = "validation-warp+table-cdf-gaps+bsdf-glass-inside-20";
    let dir = folder();
    let args = ["validate", "warp", "table/cdf/gaps", "bsdf/glass/inside/20", "--junit", "ci/report.xml", "-o", "out"];
    let value = json(dir.path(), &args);
    for key in ["level", "seed", "tests", "accepted", "rejected", "inconclusive", "files"] {
        assert!(value.get(key).is_some(), "no \"{key}\"");
    }
    let tests = value["tests"].as_array().unwrap();
    for test in tests {
        for key in ["name", "verdict", "statistic", "dof", "p", "samples", "detectable", "seconds"] {
            assert!(test.get(key).is_some(), "no \"{key}\" in {test}");
        }
        assert!(test["verdict"] == "accept" && test["detectable"].as_f64().unwrap() <= 0.0201, "{test}");
    }
    assert_eq!((value["accepted"].as_u64().unwrap() as usize, &value["rejected"]), (tests.len(), &Value::from(0)));
    let expected = ["csv", "pdf", "png", "svg"].map(|extension| format!("{NAME}.{extension}"));
    assert_eq!(files(&dir.path().join("out")), expected.into());
    let table = std::fs::read_to_string(dir.path().join(format!("out/{NAME}.csv"))).unwrap();
    assert!(table.starts_with("name,verdict,statistic,dof,p,samples,detectable,"), "{table}");
    assert_eq!(table.lines().count(), tests.len() + 1);

    let text = std::fs::read_to_string(dir.path().join("ci/report.xml")).unwrap();
    let xml = roxmltree::Document::parse(&text).unwrap();
    let suite = xml.descendants().find(|node| node.has_tag_name("testsuite")).unwrap();
    assert_eq!((suite.attribute("failures"), suite.attribute("errors")), (Some("0"), Some("0")));
    let cases: Vec<_> = suite.children().filter(|node| node.has_tag_name("testcase")).collect();
    assert_eq!(cases.len(), tests.len());
    for (case, name) in cases.iter().zip(names(&value)) {
        let full =
            format!("{}/{}", case.attribute("classname").unwrap().replace('.', "/"), case.attribute("name").unwrap());
        assert_eq!(full.replace('.', "/"), name.replace('.', "/"));
    }
}

#[test]
fn a_seed_gives_the_same_numbers_whatever_else_is_in_the_run() {
    let dir = folder();
    let statistic = |args: &[&str]| {
        let value = json(dir.path(), &[&["validate", "--samples", "300000"][..], args].concat());
        let tests = value["tests"].as_array().unwrap();
        let test = tests.iter().find(|test| test["name"] == "warp/cosine-hemisphere").unwrap();
        test["statistic"].as_f64().unwrap()
    };
    let alone = statistic(&["warp/cosine-hemisphere"]);
    assert_eq!(alone, statistic(&["warp", "table/grid", "--threads", "1"]));
    assert_ne!(alone, statistic(&["warp/cosine-hemisphere", "--seed", "2"]));
}

#[test]
fn exit_codes_tell_rejected_from_inconclusive() {
    let dir = folder();
    // So few samples that even large errors would go unnoticed.
    let ran = etalon(dir.path(), &["validate", "warp", "--samples", "2000", "--junit", "few.xml", "--json"]);
    assert_eq!(ran.code, 3, "{}", ran.stderr);
    let value: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(value["inconclusive"].as_u64().unwrap() as usize, names(&value).len());
    let xml = std::fs::read_to_string(dir.path().join("few.xml")).unwrap();
    assert!(xml.contains("<error message=\"too few samples") && !xml.contains("<failure"), "{xml}");
    // A level at which chance alone is called a fault.
    let ran = etalon(dir.path(), &["validate", "table/cdf", "--level", "0.9999999", "--junit", "all.xml"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stdout.contains("reject"), "{}", ran.stdout);
    assert!(std::fs::read_to_string(dir.path().join("all.xml")).unwrap().contains("<failure message="));
}

#[test]
fn markdown_is_appended_and_says_where_a_sampler_fails() {
    let dir = folder();
    let read = || std::fs::read_to_string(dir.path().join("summary.md")).unwrap();
    std::fs::write(dir.path().join("summary.md"), "# Of an earlier command").unwrap();
    let markdown = ["--markdown", "summary.md"];
    // Samples of the lower half of an interval whose pdf is uniform
    let samples: String = (0..20_000).map(|i| format!("{}\n", f64::from(i) / 40_000.0)).collect();
    std::fs::write(dir.path().join("half|<b>*.csv"), format!("x\n{samples}")).unwrap();
    std::fs::write(dir.path().join("uniform.csv"), "1\n").unwrap();
    let own = ["validate", "--samples", "half|<b>*.csv", "--pdf", "uniform.csv", "--domain", "line"];
    let ran = etalon(dir.path(), &[&own[..], &markdown].concat());
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("wrote summary.md\n"), "{}", ran.stdout);
    let text = read();
    assert!(text.starts_with("# Of an earlier command\n\n## etalon validate: rejected\n"), "{text}");
    let row = text.lines().find(|line| line.starts_with("| etalon/half&#124;&#60;b&#62;&#42; | ")).unwrap();
    assert!(row.contains(" | 100 % too few for x 0.00000..0.") && row.matches('|').count() == 3, "{row}");

    let ran = etalon(dir.path(), &[&["validate", "warp/cosine-hemisphere"], &markdown[..]].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(read().starts_with(&text) && read().contains("</details>\n\n## etalon validate: accepted\n"), "{}", read());
    for bad in [["--junit", "summary.md"], ["--list", "--quiet"]] {
        let ran = etalon(dir.path(), &[&["validate", "warp"], &markdown[..], &bad].concat());
        assert!(ran.code == 2 && ran.stderr.contains("--markdown"), "{bad:?}: {}", ran.stderr);
    }
}

#[test]
fn counts_are_drawn_where_asked_for() {
    let dir = folder();
    let args = ["validate", "warp/cosine-hemisphere", "table/cdf/even/37", "bsdf/mirror/outside", "--figures"];
    let value = json(dir.path(), &[&args[..], &["-o", "f"]].concat());
    let made = files(&dir.path().join("f"));
    assert_eq!(made.len(), 16, "{made:?}");
    assert_eq!(value["files"].as_array().unwrap().len(), 16);
    let name = made.iter().find(|name| name.ends_with("-warp-cosine-hemisphere.csv")).unwrap();
    let table = std::fs::read_to_string(dir.path().join("f").join(name)).unwrap();
    assert!(table.starts_with("kind,x_from,x_to,y_from,y_to,observed,expected,residual\ncell,0"), "{table}");
    let observed: u64 = table.lines().skip(1).map(|line| line.split(',').nth(5).unwrap().parse::<u64>().unwrap()).sum();
    let samples =
        value["tests"].as_array().unwrap().iter().find(|test| test["name"] == "warp/cosine-hemisphere").unwrap();
    assert_eq!(observed, samples["samples"].as_u64().unwrap());
}

#[test]
fn a_rejected_sampler_is_drawn_and_told_where_it_fails() {
    let dir = folder();
    // Squares of stratified numbers, said to be uniform: far too many near 0.
    let samples: String =
        (0..40_000).map(|i| format!("{}\n", ((f64::from(i * 7919 % 40_000) + 0.5) / 4e4).powi(2))).collect();
    std::fs::write(dir.path().join("samples.csv"), format!("x\n{samples}")).unwrap();
    std::fs::write(dir.path().join("pdf.csv"), "1\n1\n").unwrap();
    let args = ["validate", "--samples", "samples.csv", "--pdf", "pdf.csv", "--domain", "line", "-o", "r"];
    let ran = etalon(dir.path(), &args);
    assert_eq!(ran.code, 1, "{} {}", ran.stdout, ran.stderr);
    assert!(
        ran.stdout.contains("as many as expected for x 0.00000..") && ran.stdout.contains("too few for x"),
        "{}",
        ran.stdout
    );
    assert!(ran.stdout.contains("< 1e-300"), "{}", ran.stdout);
    // The table and the figure of the test, and its counts.
    assert_eq!(files(&dir.path().join("r")).len(), 5);
}

#[test]
fn a_map_of_ones_own_is_tested() {
    let dir = folder();
    json(dir.path(), &["envmap", "make", "onehot", "-o", "mine.pfm"]);
    let value = json(dir.path(), &["validate", "map/mine", "--envmap", "mine.pfm", "--detect", "0.05"]);
    assert!(names(&value).iter().all(|name| name.starts_with("map/mine/")) && names(&value).len() >= 4);
    assert_eq!(etalon(dir.path(), &["validate", "map/mine"]).code, 2);
}

#[test]
fn bad_requests_are_refused() {
    let dir = folder();
    for (line, word) in [
        ("validate nothing-like-it", "nothing-like-it"),
        ("validate warp/cosine-hemisphre", "warp/cosine-hemisphere"),
        ("validate warp --level 0", "--level"),
        ("validate warp --level nan", "--level"),
        ("validate warp --level 1", "--level"),
        ("validate warp --samples 0", "--samples"),
        ("validate warp --samples 99999999999999", "--samples"),
        ("validate warp --samples -1", "--samples"),
        ("validate warp --detect 0", "--detect"),
        ("validate warp --detect 1e-9", "--detect"),
        ("validate warp --detect inf", "--detect"),
        ("validate warp --samples 10 --detect 0.1", "--detect"),
        ("validate warp --envmap gone.exr", "gone.exr"),
        ("validate warp --junit .", "."),
    ] {
        let args: Vec<&str> = line.split_whitespace().collect();
        let ran = etalon(dir.path(), &args);
        assert_eq!(ran.code, 2, "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains(word), "{line}: {}", ran.stderr);
    }
}

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
fn a_fault_of_the_museum_is_told_and_drawn() {
    let folder = tempdir().unwrap();
    let ran = etalon(folder.path(), &["validate", "--museum", "pdf/reservoir-merge", "map/upside-down"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for said in ["mmp/pbrt-v4#250: after a merge", "says: the sample ", "A is upside down", "2 of 2 faults found"] {
        assert!(ran.stdout.contains(said), "{said}: {}", ran.stdout);
    }
    let table =
        std::fs::read_to_string(folder.path().join("out/museum-pdf-reservoir-merge+map-upside-down.csv")).unwrap();
    assert!(table.starts_with("name,source,seen,story,verdict,check,named,") && table.lines().count() == 3, "{table}");
    assert!(folder.path().join("out/exhibit-pdf-reservoir-merge.png").is_file());
    let list = json(folder.path(), &["validate", "--museum", "--list", "light"]);
    assert!(list["tests"].as_array().unwrap().len() >= 4);
}

/// The page has the table that the command prints: which faults nothing finds, first; by which check, with a name or not, and
/// what the plain test says.
#[test]
#[ignore = "takes a minute or two: cargo test -- --ignored"]
fn the_museum_is_as_its_page_says() {
    let folder = tempdir().unwrap();
    let found = json(folder.path(), &["validate", "--museum"]);
    let row = |test: &serde_json::Value| {
        let is_found = test["verdict"] == "reject";
        let accepts = |key: &str| test[key].as_f64().map(|p| p >= 1e-3);
        let plain = match (accepts("plain"), accepts("plain_sound")) {
            (Some(_), Some(false)) => "rejects both",
            (Some(true), _) => "misses",
            (Some(false), _) => "finds",
            (None, _) => "–",
        };
        assert_eq!(test["sound"], "accept", "{test}");
        let check = if is_found { test["check"].as_str().unwrap() } else { "**nothing**" };
        let named = if test["named"].is_null() { "–" } else { "yes" };
        [test["name"].as_str().unwrap(), test["source"].as_str().unwrap(), check, named, plain].map(str::to_owned)
    };
    let ran: Vec<[String; 5]> = found["tests"].as_array().unwrap().iter().map(row).collect();
    let page = include_str!("../../docs/src/museum.md");
    let table = page.split("| fault |").nth(1).unwrap().split("\n\n").next().unwrap();
    let told = table.lines().skip(2).map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let source = cells[1].trim_start_matches('[').split(']').next().unwrap();
        [cells[0], source, cells[2], cells[3], cells[5]].map(str::to_owned)
    });
    assert_eq!(told.collect::<Vec<_>>(), ran);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = tempdir().unwrap();
    for bad in [
        &["validate", "--planted", "warps"][..],
        &["validate", "--planted", "--samples", "0"],
        &["validate", "--planted", "--figures"],
        &["validate", "--museum", "warps"],
        &["validate", "--museum", "--planted"],
        &["validate", "--museum", "--figures"],
    ] {
        assert_eq!(etalon(folder.path(), bad).code, 2, "{bad:?}");
    }
}
