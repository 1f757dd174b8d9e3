//! `etalon stability` as a script relies on it.

use crate::program::{etalon, json};

#[test]
fn a_run_writes_its_files_and_its_worst_case_replays() {
    let dir = tempfile::tempdir().unwrap();
    let value = json(dir.path(), &["stability", "fresnel", "half-cosine", "-o", "out"]);
    for file in value["files"].as_array().unwrap() {
        assert!(dir.path().join(file.as_str().unwrap()).metadata().unwrap().len() > 100, "{file}");
    }
    assert_eq!(value["files"].as_array().unwrap().len(), 4 + 4);
    let bounds = value["bounds"].as_array().unwrap();
    assert!(bounds.len() == 4 && bounds.iter().all(|bound| bound["holds"] == true), "{bounds:?}");
    let csv = std::fs::read_to_string(dir.path().join("out/stability-fresnel+half-cosine.csv")).unwrap();
    let header = "family,variant,precision,cases,max_relative,max_ulp,condition_at_worst,max_ulp_per_condition,non_finite,\
                  negative,out_of_range,worst";
    assert_eq!(csv.lines().next(), Some(header));
    let row = &value["rows"][0];
    assert_eq!((&row["variant"], &row["precision"]), (&"stable".into(), &"f32".into()));
    let replay = json(dir.path(), &["stability", "--replay", row["worst"].as_str().unwrap()]);
    let line = replay["lines"].as_array().unwrap().iter().find(|l| l["variant"] == "stable" && l["precision"] == "f32");
    assert_eq!(line.unwrap()["relative"], row["max_relative"]);
}

#[test]
fn bad_input_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |args: &[&str], hint: &str| {
        let ran = etalon(dir.path(), args);
        assert_eq!(ran.code, 2, "{args:?}: {}", ran.stdout);
        assert!(ran.stderr.contains(hint), "{args:?}: {}", ran.stderr);
    };
    refused(&["stability", "glass"], "fresnel, schlick, conductor");
    refused(&["stability", "--replay", "glass:eta=1"], "formulas: fresnel");
    refused(&["stability", "--replay", "special-directions:eta=1"], "many formulas");
    refused(&["stability", "--replay", "fresnel:eta=1.5"], "\"cos\" is missing");
    refused(&["stability", "--replay", "fresnel:eta=1.5,cos=NaN"], "not a number");
    refused(&["stability", "--replay", "fresnel:eta=1.5,cos=0x1p99999999999"], "not a number");
    let list = etalon(dir.path(), &["stability", "--list"]);
    assert!(list.code == 0 && list.stdout.contains("beckmann-normal") && list.stdout.contains("special-directions"));
}

#[test]
fn extreme_replays_do_not_panic() {
    let dir = tempfile::tempdir().unwrap();
    for (case, code) in [
        ("fresnel:eta=1e-18,cos=1e-38", 0),
        ("fresnel:eta=1e18,cos=0", 0),
        ("conductor:eta=0,k=0,cos=0", 0),
        ("beckmann-d:alpha=1e38,x=0,y=0,z=0", 0),
        ("beckmann-g:alpha=1e-37,x=3e38,y=0,z=-0.0", 0),
        ("beckmann-normal:alpha=1e-37,wo_x=0,wo_y=0,wo_z=0,u0=0,u1=0.9999", 0),
        ("ggx-normal:alpha=1e38,wo_x=1,wo_y=0,wo_z=0,u0=1e-38,u1=0", 0),
        ("half-vector:wo_x=0,wo_y=0,wo_z=1,wi_x=0,wi_y=0,wi_z=-1", 0),
        ("sphere:radius=1e-37,x=0,y=0,z=0,dx=0,dy=0,dz=0", 0),
        ("triangle:ax=0,ay=0,az=0,bx=0,by=0,bz=0,cx=0,cy=0,cz=0,dx=0,dy=0,dz=0", 0),
        // Outside of the formulas' domains.
        ("beckmann-normal:alpha=1,wo_x=1,wo_y=0,wo_z=-1,u0=-1,u1=2", 2),
        ("ggx-normal:alpha=1,wo_x=0,wo_y=0,wo_z=-1,u0=3e38,u1=3e38", 2),
        ("fresnel:eta=0,cos=0", 2),
        ("fresnel:eta=-1,cos=0.5", 2),
        ("fresnel:eta=1e20,cos=0.5", 2),
        ("fresnel:eta=1.5,cos=2", 2),
        ("beckmann-d:alpha=0,x=0,y=0,z=0", 2),
        ("beckmann-g:alpha=-1,x=3e38,y=0,z=-0.0", 2),
        ("sphere:radius=0,x=0,y=0,z=0,dx=0,dy=0,dz=0", 2),
    ] {
        let ran = etalon(dir.path(), &["stability", "--replay", case]);
        assert_eq!(ran.code, code, "{case}: {}", ran.stderr);
        assert_eq!(ran.stderr.contains(" is not from "), code == 2, "{case}: {}", ran.stderr);
    }
}

#[test]
fn bounds_are_reported() {
    let dir = tempfile::tempdir().unwrap();
    let ran = etalon(dir.path(), &["stability", "fresnel", "--junit", "s.xml", "--markdown", "s.md", "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let bounds = value["bounds"].as_array().unwrap();
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    assert!(read("s.xml").contains(&format!("tests=\"{}\" failures=\"0\" errors=\"0\"", bounds.len())));
    let markdown = read("s.md");
    assert!(markdown.starts_with("## etalon stability: accepted\n"), "{markdown}");
    assert_eq!(markdown.lines().filter(|line| line.starts_with("| stability/")).count(), bounds.len(), "{markdown}");
    for report in [&["--list", "--markdown", "l.md"][..], &["--replay", "fresnel:eta=1.5,cos=0.5", "--junit", "l.xml"]]
    {
        assert_eq!(etalon(dir.path(), &[&["stability"], report].concat()).code, 2, "{report:?}");
    }
}
