//! Where results go: names after the subject, inputs that are never replaced, links, names that are no Unicode.

use crate::program::{etalon, json};
use std::path::Path;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn strings(value: &serde_json::Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

#[test]
fn results_are_named_after_their_subject() {
    let dir = folder();
    let first_file = |args: &[&str]| strings(&json(dir.path(), args)["files"])[0].to_owned();
    assert_eq!(first_file(&["fresnel", "--points", "9"]), "out/fresnel.csv");
    assert_eq!(first_file(&["fresnel", "water", "Au", "--points", "9"]), "out/fresnel-water-Au.csv");
    let render = |args: &[&str]| first_file(&[&["render", "furnace", "-r", "4", "3"], args].concat());
    assert_eq!(render(&["-s", "2"]), "out/furnace.exr");
    assert_eq!(render(&["-s", "2", "-H", "--seed", "7", "-o", "there"]), "there/furnace.exr");
    assert_eq!(render(&["-s", "2", "--shard", "1/2"]), "out/furnace.shard-1-of-2.exr");
    assert_eq!(render(&["-s", "2", "-o", "mine.exr"]), "mine.exr");
}

#[test]
fn a_result_under_a_default_name_is_not_replaced_in_silence() {
    let dir = folder();
    let args = ["fresnel", "--points", "9"];
    let value = json(dir.path(), &args);
    assert!(value["files"].as_array().unwrap().len() == 4 && value["replaced"] == serde_json::json!([]), "{value}");
    let again = json(dir.path(), &args);
    assert_eq!(again["files"], again["replaced"]);
    assert!(etalon(dir.path(), &args).stdout.contains("replaced out/fresnel.{csv,svg,png,pdf}\n"));
    // A name that was asked for says itself what it replaces.
    for _ in 0..2 {
        let named = etalon(dir.path(), &["fresnel", "--points", "9", "-o", "a.csv"]);
        assert!(
            named.stdout.contains("wrote a.{csv,svg,png,pdf}\n") && !named.stdout.contains("replaced"),
            "{}",
            named.stdout
        );
    }
}

#[test]
fn results_of_another_command_are_not_replaced() {
    let dir = folder();
    let first_file = |args: &[&str]| {
        let value = json(dir.path(), args);
        let files = value.get("files").unwrap_or(&value["results"][0]["files"]);
        strings(files)[0].to_owned()
    };
    json(dir.path(), &["envmap", "make", "onehot", "-o", "onehot.exr"]);
    let [own, file] = ["onehot", "onehot.exr"].map(|map| ["envmap", "cut", map, "-n", "1", "--no-flip"]);
    assert_eq!(first_file(&own[..5]), "out/onehot-cut-1.csv");
    assert_eq!([first_file(&file), first_file(&file)], ["out/onehot-cut-1.2.csv"; 2]);
    assert_eq!(first_file(&[&own[..5], &["--theme", "dark"]].concat()), "out/onehot-cut-1.csv", "another option");
    std::fs::write(dir.path().join("out/fresnel-water.png"), b"a photograph").unwrap();
    assert_eq!(first_file(&["fresnel", "water", "--points", "9"]), "out/fresnel-water.2.csv");
    assert_eq!(std::fs::read(dir.path().join("out/fresnel-water.png")).unwrap(), b"a photograph");
}

/// The attribute of an SVG file's first tag.
fn attribute(svg: &str, name: &str) -> String {
    svg.split_once(&format!(" {name}=\"")).unwrap().1.split_once('"').unwrap().0.to_owned()
}

#[test]
fn figures_have_the_style_that_is_asked_for() {
    let dir = folder();
    let svg = |args: &[&str], name: &str| {
        let ran = etalon(dir.path(), &[&["fresnel", "glass", "--points", "31"], args].concat());
        assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
        std::fs::read_to_string(dir.path().join(name)).unwrap()
    };
    let column = svg(&["--style", "column", "-o", "a.svg"], "a.svg");
    assert!(attribute(&column, "width").strip_suffix("mm").unwrap().parse::<f64>().unwrap() - 84.0 < 0.1);
    let dark = svg(&["--style", "slide", "--theme", "dark", "--title", "Glass & air", "-o", "b.svg"], "b.svg");
    assert!(dark.contains("Glass &amp; air") && !dark.contains("fill=\"#fff\""));
    assert!(dir.path().join("b-2.pdf").exists(), "three panels are too many for a slide");
    let one = svg(&["--panels", "RELATIVE", "-o", "c.svg"], "c.svg");
    assert!(one.contains("Relative error") && !one.contains("share of the power"));
    let wide = svg(&["--width", "120mm", "-o", "d.svg"], "d.svg");
    assert!((attribute(&wide, "width").parse::<f64>().unwrap() - 120.0 * 96.0 / 25.4).abs() < 1.5);
    for (args, words) in [
        (&["--style", "poster"][..], "[possible values: screen, slide, column]"),
        (&["--width", "3"], "'--width <MM>'"),
        (&["--width", "30"], "mm are enough"),
        (&["--panels", "nothing"], "--panels: no panel is called \"nothing\""),
    ] {
        let ran = etalon(dir.path(), &[&["fresnel", "glass", "--points", "31"], args].concat());
        assert!(ran.code == 2 && ran.stderr.contains(words), "{args:?}: {}", ran.stderr);
    }
}

#[test]
fn panels_are_chosen_or_refused_by_every_command_that_has_the_option() {
    let dir = folder();
    for name in ["a.exr", "b.exr"] {
        json(dir.path(), &["envmap", "make", "onehot", "-o", name]);
    }
    // Each with a panel that it has
    let commands = [
        ("compare a.exr b.exr", "a"),
        ("converge cornell-lambert -r 8 6 --max-spp 4 --replicates 2 --strategies light,bsdf", "error"),
        ("envmap proposal sun -n 1000", "uniform"),
        ("fresnel glass --points 9", "relative"),
        ("furnace diffuse --size 3x2", "SPHERES"),
        ("reproduce --quick --only fresnel-enter", "relative"),
        ("render sphere-env -r 8 6 -s 2", ""),
        ("stability sphere", "single"),
        ("validate warp/circle-f32/angle --samples 2000", "counts"),
    ];
    let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let run = |command: &str, more: &[&str]| {
        let all = [words(command), more.iter().map(|word| (*word).to_owned()).collect()].concat();
        etalon(dir.path(), &all.iter().map(String::as_str).collect::<Vec<_>>())
    };
    // The commands of a help text
    let listed = |help: &str| {
        let rest = help.split("Commands:\n").nth(1).unwrap_or_default().split("\n\n").next().unwrap_or_default();
        let lines = rest.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
        lines.map(|line| line.split_whitespace().next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let mut with_option = Vec::new();
    for name in listed(&etalon(dir.path(), &["--help"]).stdout).into_iter().filter(|name| name != "help") {
        let help = etalon(dir.path(), &[&name, "--help"]).stdout;
        let below = listed(&help).into_iter().filter(|name| name != "help").map(|below| format!("{name} {below}"));
        let below: Vec<String> = below.collect();
        let all = if below.is_empty() { vec![name] } else { below };
        with_option.extend(all.into_iter().filter(|command| run(command, &["--help"]).stdout.contains("--panels")));
    }
    with_option.sort();
    let tested = commands.map(|(command, _)| command);
    let is_tested = |name: &String| tested.iter().any(|command| command.starts_with(&format!("{name} ")));
    assert!(with_option.iter().all(is_tested) && with_option.len() == tested.len(), "{with_option:?}");
    for (command, panel) in commands {
        let ran = run(command, &["--panels", "nonsense"]);
        assert!(ran.code == 2 && ran.stderr.contains("--panels"), "{command}: {} {}", ran.code, ran.stderr);
        if !panel.is_empty() {
            let ran = run(command, &["--quiet", "--panels", panel]);
            assert!(ran.code != 2 && ran.stderr.is_empty(), "{command}: {} {}", ran.code, ran.stderr);
        }
    }
    let ran = run("validate --planted warp/cosine-hemisphere/*", &["--panels", "counts"]);
    assert!(ran.code == 2 && ran.stderr.contains("--panels: this run draws no figure"), "{}", ran.stderr);
}

#[test]
fn inputs_are_never_replaced() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    for name in ["map.exr", "map.pfm", "sphere-8.pfm"] {
        json(dir.path(), &["envmap", "make", "onehot", "-o", name]);
    }
    for shard in ["1", "2"] {
        let share = format!("{shard}/2");
        json(
            dir.path(),
            &["render", "furnace", "-r", "4", "3", "-s", "2", "--shard", &share, "-o", &format!("{shard}.exr")],
        );
    }
    std::fs::write(
        at("scene.pbrt"),
        "Camera \"orthographic\" WorldBegin LightSource \"infinite\" \"string mapname\" \"map.exr\" Shape \"sphere\"",
    )
    .unwrap();
    std::fs::write(at("samples.csv"), "x,y\n0.5,0.5\n").unwrap();
    std::fs::write(at("grid.csv"), "1\n").unwrap();
    std::fs::hard_link(at("map.exr"), at("hard.exr")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("map.exr", at("soft.exr")).unwrap();
    #[cfg(not(unix))]
    std::fs::hard_link(at("map.exr"), at("soft.exr")).unwrap();
    std::fs::hard_link(at("sphere-8.pfm"), at("link.hdr")).unwrap();
    let names = || std::fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().path()).filter(|path| path.is_file());
    let content = || {
        names().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect::<std::collections::BTreeMap<_, _>>()
    };
    let before = content();
    for line in [
        "render sphere-env -s 4000000 --envmap map.exr -o map.exr",
        "render sphere-env -s 4000000 --envmap map.exr -f ./map.exr",
        "render sphere-env -s 4000000 --envmap map.exr -o soft.exr",
        "render sphere-env -s 4000000 --envmap map.exr -o hard.exr",
        "render sphere-env -s 4000000 --envmap soft.exr -o map.png",
        "render sphere-env -s 4000000 --envmap map.exr --resume map.exr",
        "render scene.pbrt -s 4000000 -o map.exr",
        "render scene.pbrt -s 4000000 -o scene.pbrt",
        "merge 1.exr 2.exr -o 1.exr",
        "compare map.exr map.pfm -o map.pfm",
        "envmap sample map.exr -n 4 -o map.exr",
        "envmap cut map.exr -n 4 -o map.exr",
        "envmap proposal map.exr -o map.exr",
        "validate --samples samples.csv --pdf grid.csv --domain square -o samples.csv",
        "validate --samples samples.csv --pdf grid.csv --domain square -o grid.png",
        "validate map/map --envmap map.exr --junit map.exr",
        "validate map/map --envmap map.exr --markdown map.exr",
        "converge sphere-env --envmap map.exr -o map.exr",
        "reproduce --only sphere-8 --envmap sphere-8.pfm -o .",
        "reproduce --only sphere-8 --envmap link.hdr -o .",
    ] {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        assert_eq!(ran.code, 2, "{line}: {}", ran.stderr);
        assert!(
            ran.stderr.contains("is an input of this command") && ran.stderr.contains("hint: "),
            "{line}: {}",
            ran.stderr
        );
        assert!(content() == before, "{line} changed a file");
    }
    // Beside an input, or with the state of a render as its result, there is nothing to refuse.
    json(dir.path(), &["compare", "map.exr", "map.pfm", "-o", "map.png"]);
    for _ in 0..2 {
        json(dir.path(), &["render", "furnace", "-r", "4", "3", "-s", "2", "--resume", "state.exr", "-o", "state.exr"]);
    }
}

#[test]
fn files_that_take_part_under_other_names_are_not_replaced() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    let map = "bsdf/spp-1_seed-1.exr";
    json(dir.path(), &["envmap", "make", "onehot", "-o", map]);
    std::fs::copy(at(map), at("sphere-env-pbrt-1.exr")).unwrap();
    std::fs::write(at("renderer.csv"), "exit 1").unwrap();
    let before = [map, "sphere-env-pbrt-1.exr", "renderer.csv"].map(|name| std::fs::read(at(name)).unwrap());
    let run = ["converge", "furnace", "-r", "8", "8", "--budget", "9", "--max-spp", "1", "--replicates", "1"];
    let command = "x=sh renderer.csv {out} {spp} {seed}";
    for args in [
        &["scenes", "--export", "sphere-env.pbrt", "--envmap", "sphere-env-pbrt-1.exr"][..],
        &["converge", "sphere-env", "--envmap", map, "-r", "8", "8", "--strategies", "bsdf", "--keep-runs", "."],
        &[&run[..], &["--strategies", "none", "--renderer", command, "-o", "renderer.csv"]].concat(),
    ] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains("is an input of this command"), "{args:?}: {}", ran.stderr);
        let after = [map, "sphere-env-pbrt-1.exr", "renderer.csv"].map(|name| std::fs::read(at(name)).unwrap());
        assert!(before == after, "{args:?}");
    }
    let ran = etalon(dir.path(), &["stability", "fresnel", "-o", "s.csv", "--junit", "s.csv"]);
    assert!(ran.code == 2 && ran.stderr.contains("extension of a result"), "{}", ran.stderr);
}

#[cfg(unix)]
#[test]
fn results_follow_symbolic_links() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    std::fs::create_dir(at("store")).unwrap();
    std::fs::write(at("store/old.exr"), "old").unwrap();
    for (link, real) in [("a.exr", "store/old.exr"), ("b.exr", "store/new.exr")] {
        std::os::unix::fs::symlink(real, at(link)).unwrap();
        json(dir.path(), &["render", "furnace", "-s", "1", "-r", "4", "3", "-o", link]);
        assert!(std::fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link} was replaced");
        assert!(std::fs::read(at(real)).unwrap().starts_with(b"\x76\x2f\x31\x01"), "{real}");
    }
}

/// Linux takes any bytes as file names; some other systems do not.
#[cfg(target_os = "linux")]
#[test]
fn file_names_need_not_be_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let dir = folder();
    let name = |text: &str| OsStr::from_bytes(&[b"\xff", text.as_bytes()].concat()).to_owned();
    json(dir.path(), &["envmap", "make", "constant", "-o", "map.exr"]);
    std::fs::rename(dir.path().join("map.exr"), dir.path().join(name("map.exr"))).unwrap();
    std::fs::write(dir.path().join(name("scene.pbrt")), "Camera \"orthographic\" WorldBegin Shape \"sphere\"").unwrap();
    std::fs::write(dir.path().join(name("mesh.obj")), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(dir.path().join(name("samples.csv")), "x,y\n0.5,0.5\n0.25,0.75\n").unwrap();
    std::fs::write(dir.path().join(name("grid.csv")), "1\n").unwrap();
    let run = |line: &str, code: i32| {
        // A word that begins with @ stands for a name that is no Unicode.
        let words = line.split(' ').map(|word| word.strip_prefix('@').map_or_else(|| word.into(), name));
        let mut command = assert_cmd::Command::cargo_bin("etalon").unwrap();
        let output = command.current_dir(dir.path()).args(words).arg("--json").output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
        (serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap_or_default(), stderr)
    };
    for (line, file) in [
        ("envmap sample @map.exr -n 4", None),
        ("envmap proposal @map.exr -n 1000 -o @a.csv", Some("a.png")),
        ("render sphere-env --envmap @map.exr -s 1 -r 4 3 -o @b.exr", Some("b.exr")),
        ("render @scene.pbrt -s 1 -r 4 3 -f @c.exr --resume @state.exr", Some("state.exr")),
        ("render cornell-statue-au --mesh @mesh.obj -s 1 -r 4 3 -o @d.exr", Some("d.png")),
        ("compare @map.exr @b.exr -o @e.png", None),
        ("validate map --envmap @map.exr --samples 1000 --list", None),
        ("validate warp/cosine-hemisphere --samples 100000 --junit @f.xml", Some("f.xml")),
        ("render furnace -s 2 -r 4 3 --shard 1/2 -o @g.exr", Some("g.exr")),
        ("merge @g.exr -o @h.exr", Some("h.exr")),
    ] {
        let sizes_differ = line.starts_with("compare");
        let (value, stderr) = run(line, if sizes_differ { 2 } else { 0 });
        assert!(sizes_differ || value.is_object(), "{line}: {stderr}");
        if let Some(file) = file {
            assert!(Path::new(&dir.path().join(name(file))).is_file(), "{line}: {file}");
        }
    }
    let (value, _) = run("validate --samples @samples.csv --pdf @grid.csv --domain square", 3);
    assert_eq!(value["tests"].as_array().unwrap().len(), 1, "{value}");
    let (_, stderr) = run("envmap info @gone.exr", 2);
    assert!(stderr.contains("\u{fffd}gone.exr: "), "{stderr}");
}
