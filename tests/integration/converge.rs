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
    assert_eq!(files.len(), 8, "{files:?}");
    assert!(files.iter().all(|file| folder.path().join(file).is_file()), "{files:?}");
    let table = std::fs::read_to_string(folder.path().join("out/room.csv")).unwrap();
    assert!(table.starts_with("strategy,spp,replicates,cpu_seconds,wall_seconds,") && table.lines().count() == 19);
}

#[test]
fn fixed_lights_are_biased_and_light_samples_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["converge", "sphere-env", "--envmap", "sun", "-r", "24", "24", "--max-spp", "64", "--replicates", "5"];
    let strategies = ["--strategies", "median-cut-16,variance-cut-16,light-cosine+independent,light+independent"];
    let value = json(folder.path(), &[&args[..], &strategies].concat());
    assert_eq!(value["reference"]["exact"], true);
    let verdicts: Vec<&str> =
        value["curves"].as_array().unwrap().iter().map(|curve| curve["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts[..2], ["biased", "biased"]);
    assert!(verdicts[2..].iter().all(|verdict| *verdict != "biased"), "{verdicts:?}");
}

/// The efficiencies of the table are those of the answer, after equal time.
#[test]
fn the_table_has_the_efficiencies_of_the_answer() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["converge", "cornell-lambert", "-r", "24", "18", "--max-spp", "64", "--replicates", "3"];
    let text = etalon(folder.path(), &[&args[..], &["--strategies", "light,bsdf", "-o", "out"]].concat()).stdout;
    // "best at 0.014 s: light, 78 times the efficiency of bsdf (95 %: 65 to 95)"
    let ratio: f64 = text.split_once("light, ").unwrap().1.split_once(" times").unwrap().0.parse().unwrap();
    let end = text.lines().find_map(|line| Some(line[..line.find('†')?].chars().count())).unwrap();
    let efficiency = |name: &str| -> f64 {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        line.chars().take(end + 1).collect::<String>().split_whitespace().last().unwrap().parse().unwrap()
    };
    assert!((efficiency("light ") / efficiency("bsdf ") / ratio - 1.0).abs() < 0.06, "{text}");
    assert!(text.contains("† after equal time"), "{text}");
}

#[test]
fn it_ends_when_the_budget_does() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    let ran = etalon(
        folder.path(),
        &["converge", "cornell-spheres", "--budget", "2", "--max-spp", "4096", "--quiet", "-o", "out", "--json"],
    );
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
        (&["cornell-spheres", "--strategies", "ligth"], "strategies: default, light, "),
        (&["cornell-spheres", "--strategies", "light+sobol"], "+independent"),
        (&["cornell-spheres", "--strategies", "default+adaptive"], "default has no suffix"),
        (&["cornell-spheres", "--strategies", "median-cut-16"], "needs an environment map"),
        (&["sphere-env", "--strategies", "median-cut-0", "-r", "8", "8"], "0 regions"),
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
        (&["cornell-spheres", "--renderer", "prog"], "--renderer: "),
        (&["cornell-spheres", "--renderer", "a=prog {spp}"], "has no {out}"),
        (&["cornell-spheres", "--renderer", "a=BIAS=0.1 prog {spp} {out}"], "hint: `env BIAS=0.1 ...`"),
        (&["cornell-spheres", "--renderer", "a=prog {spp} {out} {sed}"], "no placeholder {sed}"),
        (&["cornell-spheres", "--renderer", "a=prog {spp} {out} {scene}"], "hint: --renderer-scene"),
        (&["cornell-spheres", "--renderer", "mis=prog {spp} {out}"], "two of them are called mis"),
        (&["cornell-spheres", "--renderer", "a=prog {spp} {out}", "--timeout", "0"], "--timeout: "),
        (&["cornell-spheres", "--renderer", "a=prog {spp} {out} {scene}", "--renderer-scene", "no.xml"], "no.xml: "),
        (&["cornell-spheres", "--strategies", "none"], "--strategies: \"none\" leaves no method"),
        (&["cornell-spheres", "--runs", "."], "no folder in it has a file times.csv"),
        (&["cornell-spheres", "--reference", "missing.exr"], "is no file, renderer or strategy"),
    ] {
        let ran = etalon(folder.path(), &[&["converge"], args].concat());
        assert_eq!(ran.code, 2, "{args:?}: {}{}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(says), "{args:?}: {}", ran.stderr);
    }
}

/// A renderer in another program: our own, by its command line.
#[cfg(unix)]
fn ourselves(extra: &str) -> String {
    let program = assert_cmd::cargo::cargo_bin("etalon");
    format!(
        "etalon='{}' render cornell-lambert -r {{width}} {{height}} -s {{spp}} --seed {{seed}} -t {{threads}} -l 1 --quiet {extra} -o {{out}}",
        program.display()
    )
}

#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn our_own_program_as_a_renderer_is_as_efficient_as_its_strategy() {
    let folder = tempfile::tempdir().unwrap();
    let renderer = ourselves("--sampling mis --uniform");
    let args =
        ["converge", "cornell-lambert", "-r", "32", "24", "-t", "1", "--strategies", "mis", "--keep-runs", "kept"];
    let more =
        ["--renderer", &renderer, "--max-spp", "256", "--replicates", "6", "--budget", "60", "-o", "out/own.csv"];
    let value = json(folder.path(), &[&args[..], &more].concat());
    assert_eq!(value["faults"].as_array().unwrap().len(), 0, "{}", value["faults"]);
    let curves = value["curves"].as_array().unwrap();
    let external = &curves[1];
    assert_ne!(external["verdict"], "biased", "{external}");
    // The samples are the same, and so is the error.
    let last = |curve: &serde_json::Value| curve["levels"].as_array().unwrap().last().unwrap().clone();
    let mse = |curve| last(curve)["mse"]["value"].as_f64().unwrap();
    assert!((mse(external) / mse(&curves[0]) - 1.0).abs() < 1e-9, "{} {}", mse(external), mse(&curves[0]));
    // The time per sample is that of the library, up to the noise of a machine that other tests keep busy.
    let seconds = |curve| last(curve)["cpu_seconds"].as_f64().unwrap();
    let ratio = seconds(external) / seconds(&curves[0]);
    assert!((0.4..2.5).contains(&ratio), "{ratio}");
    assert!(external["times"]["startup_cpu_seconds"]["value"].as_f64().unwrap() < 1.0, "{external}");
    // What was kept is read, and gives the same errors.
    let args =
        ["converge", "cornell-lambert", "-r", "32", "24", "--strategies", "none", "--runs", "kept", "--budget", "10"];
    let again =
        json(folder.path(), &[&args[..], &["--reference", "mis+lt", "--max-spp", "256", "-o", "again"]].concat());
    let names: Vec<&str> =
        again["curves"].as_array().unwrap().iter().map(|c| c["strategy"].as_str().unwrap()).collect();
    assert_eq!(names, ["etalon", "mis"]);
    let kept = &again["curves"][0];
    assert_eq!((kept["replicates"].as_u64(), last(kept)["spp"].as_u64()), (Some(6), Some(256)));
    assert_ne!(kept["verdict"], "biased", "{kept}");
    let table = std::fs::read_to_string(folder.path().join("out/own-replicates.csv")).unwrap();
    assert!(table.starts_with("strategy,replicate,seed,spp,wall_seconds,cpu_seconds,mse,"), "{table}");
    assert_eq!(table.lines().count(), 1 + 6 * (9 + 5));
}

/// Two renderers without a scene, one of which is 10 % too bright: by images that are given.
#[cfg(unix)]
#[test]
fn renderers_need_no_scene() {
    use etalon::raster::{Image, Metadata, write};
    use etalon::sampling::stream::{Independent, Stream};
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let image = |seed: u64, spp: u32, scale: f32| {
        let noise = |i: u64| (Independent::new(seed, i, 0).pair(0)[0] as f32 - 0.5) / (spp as f32).sqrt();
        Image::from_fn(12, 8, |x, y| glam::Vec3::splat(scale * (1.0 + noise((12 * y + x) as u64))))
    };
    for spp in [1, 4, 16, 64, 256] {
        for seed in 1..=8 {
            write(
                &path(&format!("good-{spp}-{seed}.pfm")),
                &image(seed + 100 * u64::from(spp), spp, 1.0),
                &Metadata::default(),
            )
            .unwrap();
            write(
                &path(&format!("bsdf-{spp}-{seed}.pfm")),
                &image(seed + 101 * u64::from(spp), spp, 1.1),
                &Metadata::default(),
            )
            .unwrap();
        }
    }
    write(&path("ref.exr"), &image(1, u32::MAX, 1.0), &Metadata::default()).unwrap();
    let renderer = |name: &str| format!("{name}=sh -c \"cp {name}-$0-$1.pfm $2\" {{spp}} {{seed}} {{out}}");
    let (good, bright) = (renderer("good"), renderer("bsdf"));
    let args = [
        "converge",
        "--renderer",
        &good,
        "--reference",
        "ref.exr",
        "--max-spp",
        "256",
        "--replicates",
        "8",
        "--budget",
        "60",
    ];
    let ran = etalon(folder.path(), &[&args[..], &["--junit", "j.xml"]].concat());
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.replace("\n  ", " ").contains("good: no bias found; one of "), "{}", ran.stdout);
    assert!(
        path("out/good-converge.csv").is_file() && !ran.stdout.contains("NaN") && !ran.stdout.contains("inf "),
        "{}",
        ran.stdout
    );
    let ran = etalon(folder.path(), &[&args[..], &["--renderer", &bright, "--markdown", "m.md"]].concat());
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    let markdown = std::fs::read_to_string(path("m.md")).unwrap();
    assert!(markdown.contains("; no bias found; one of "), "{markdown}");
    assert!(
        markdown.starts_with("## etalon converge good-bsdf: rejected\n") && markdown.contains("all channels +10."),
        "{markdown}"
    );
    let pictures = std::fs::read_to_string(path("out/good-bsdf-converge-pictures.svg")).unwrap();
    assert!(pictures.contains("At 256 samples per pixel: image and"), "--max-spp shows images of equal samples");
    // A bias that might have gone unnoticed, and one that was not tested, are no pass
    let small = etalon(folder.path(), &[&args[..], &["--detect", "0.01%", "--junit", "j.xml"]].concat());
    assert_eq!(small.code, 3, "{}{}", small.stdout, small.stderr);
    assert!(small.stdout.contains("good: cannot tell: the smallest bias") && !small.stdout.contains("good: no bias"));
    let junit = || std::fs::read_to_string(path("j.xml")).unwrap();
    assert!(junit().contains("errors=\"1\"") && junit().contains(", not 0.01"), "{}", junit());
    let two = ["converge", "--renderer", &bright, "--reference", "ref.exr", "--max-spp", "256", "--replicates", "2"];
    let ran = etalon(folder.path(), &[&two[..], &["--budget", "60", "--junit", "j.xml"]].concat());
    assert_eq!(ran.code, 3, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.starts_with("bsdf: bias not tested (2 replicates; 3 are needed)\n"), "{}", ran.stdout);
    assert!(
        !ran.stdout.contains("no known bias") && junit().contains("<error message=\"bias not tested ("),
        "{}",
        junit()
    );
    // A renderer that fails is named first, in the table, and once in the report
    let bad = ["--renderer", "bad=sh -c \"exit 9\" {spp} {seed} {out}", "--junit", "j.xml"];
    let ran = etalon(folder.path(), &[&args[..], &bad].concat());
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    assert!(
        ran.stdout.starts_with("failed: bad: it failed (exit code 9") && ran.stdout.contains("(2 of 2"),
        "{}",
        ran.stdout
    );
    assert!(ran.stdout.lines().any(|line| line.starts_with("bad ") && line.ends_with(" failed")), "{}", ran.stdout);
    assert!(junit().contains("tests=\"2\" failures=\"1\"") && junit().contains("name=\"bad\""), "{}", junit());
    let figure = std::fs::read_to_string(path("out/good-bsdf-converge.svg")).unwrap();
    assert!(figure.contains(">bsdf (biased)<") && !figure.contains("BSDF"), "a renderer keeps its name");
    for (args, says) in [
        (&["converge"][..], "required"),
        (&["converge", "--renderer", &good], "--reference: without a scene"),
        (&["converge", "--renderer", &good, "--reference", "mis"], "is no file and no renderer"),
        (&["converge", "--renderer", &good, "--reference", "good"], "no file says how large the images are"),
        (&["converge", "--renderer", &good, "--reference", "ref.exr", "--alpha", "0.5"], "it changes a scene"),
        (&["converge", "cornell-lambert", "--junit", "j.xml"], "--renderer"),
    ] {
        let ran = etalon(folder.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains(says), "{args:?}: {}", ran.stderr);
    }
}

/// Planted faults of renderers: each is found and named, and the others are measured all the same.
#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn faults_of_renderers_are_found_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("etalon");
    let good =
        format!("'{}' render cornell-lambert -s $0 --seed $1 -l 1 -t 1 --quiet -r $2 16 -o $3", program.display());
    let renderer = |name: &str, script: &str| format!("{name}=sh -c \"{script}\" {{spp}} {{seed}} 20 {{out}}");
    let renderers = [
        renderer("sound", &good),
        renderer("small", &good.replace("-r $2 16", "-r 10 8")),
        renderer("crash", "echo no memory left >&2; exit 9"),
        renderer("same", &good.replace("--seed $1", "--seed 5")),
        renderer("hang", "sleep 1000"),
        renderer("later", &format!("test $0 -lt 16 || exit 4; {good}")),
    ];
    let mut args = vec!["converge", "cornell-lambert", "-r", "20", "16", "--strategies", "mis", "-o", "out", "--json"];
    args.extend(["--max-spp", "64", "--replicates", "4", "--budget", "100", "--timeout", "5"]);
    renderers.iter().for_each(|renderer| args.extend(["--renderer", renderer]));
    let ran = etalon(folder.path(), &args);
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let names: Vec<&str> =
        value["curves"].as_array().unwrap().iter().map(|c| c["strategy"].as_str().unwrap()).collect();
    assert_eq!(names, ["mis", "sound"], "{}", ran.stderr);
    let faults = value["faults"].as_array().unwrap();
    for (name, count, says) in [
        ("small", 2, "its image has 10x8 pixels, not 20x16"),
        ("crash", 2, "exit code 9); its standard error ends with \"no memory left\""),
        ("same", 1, "its image is that of seed 1, to the last bit"),
        ("hang", 1, "did not end within 5."),
        ("later", 2, "exit code 4"),
    ] {
        let found: Vec<&str> = faults
            .iter()
            .filter(|fault| fault["strategy"] == name)
            .map(|fault| fault["message"].as_str().unwrap())
            .collect();
        assert!(found.len() == count && found.iter().all(|message| message.contains(says)), "{name}: {found:?}");
        assert!(ran.stderr.contains(&format!("warning: {name}, replicate")), "{}", ran.stderr);
    }
}

/// A renderer that hangs takes a third of the budget, whatever its own limit is.
#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_renderer_that_hangs_leaves_time_for_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut args =
        vec!["converge", "cornell-lambert", "-r", "20", "16", "--strategies", "mis", "--budget", "12", "-o", "out"];
    args.extend(["--json", "--renderer", "hang=sh -c \"sleep 1000\" {spp} {seed} {out}"]);
    let ran = etalon(folder.path(), &args);
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(value["curves"][0]["strategy"], "mis", "{}", ran.stderr);
    assert!(value["faults"][0]["message"].as_str().unwrap().contains("did not end within"), "{}", ran.stderr);
}

/// Images that are 1 % brighter than the reference.
#[test]
fn one_per_cent_of_light_is_bias() {
    use etalon::raster::{Image, Metadata, ReadOptions, read, write};
    let folder = tempfile::tempdir().unwrap();
    let render =
        ["render", "cornell-lambert", "-r", "40", "30", "-s", "1024", "-l", "4", "--seed", "77", "-o", "long.exr"];
    json(folder.path(), &render);
    let long = read(&folder.path().join("long.exr"), ReadOptions::default()).unwrap();
    let verdict = |factor: f32| {
        let scaled: Image = long.map(|pixel| pixel * factor);
        write(&folder.path().join("reference.exr"), &scaled, &Metadata::default()).unwrap();
        let args = ["converge", "cornell-lambert", "-r", "40", "30", "--strategies", "mis", "--max-spp", "64"];
        let more = ["--replicates", "8", "--reference", "reference.exr", "-o", "out"];
        let value = json(folder.path(), &[&args[..], &more].concat());
        (value["curves"][0]["verdict"].as_str().unwrap() == "biased", value["curves"][0]["mean_bias"]["value"].as_f64())
    };
    let (is_biased, mean) = verdict(1.0 / 1.01);
    assert!(is_biased && (mean.unwrap() - 0.01).abs() < 0.002, "{mean:?}");
    let (is_biased, mean) = verdict(1.0);
    assert!(!is_biased && mean.unwrap().abs() < 0.002, "{mean:?}");
}
