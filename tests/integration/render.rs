//! `etalon render`: the same bits in one go, in shards, after an interruption, and on older processors, where an emulator is
//! installed; what its flags change.

use crate::program::{etalon, json};
use etalon::math::Rgb;
use etalon::raster::{ExrFile, Image};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// The layers of an OpenEXR file by their names, as bits.
pub fn layers(path: &Path) -> BTreeMap<String, Vec<[u32; 3]>> {
    let file = ExrFile::open(path).unwrap_or_else(|e| panic!("{e}"));
    let bits = |image: Image| image.pixels().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    file.layers().unwrap().into_iter().map(|(name, image)| (name, bits(image))).collect()
}

/// Renders to `out`; all words of the other arguments are separated by blanks.
fn render(folder: &Path, args: &str, out: &str) -> (Value, BTreeMap<String, Vec<[u32; 3]>>) {
    let words: Vec<&str> = ["render"].into_iter().chain(args.split(' ')).chain(["-o", out]).collect();
    (json(folder, &words), layers(&folder.join(out)))
}

#[test]
fn all_scenes_are_listed_and_rendered_with_or_without_leaving_out() {
    let dir = folder();
    let list = json(dir.path(), &["scenes"]);
    let names: Vec<&str> = list["scenes"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    let registered: Vec<String> = etalon::scene::builtin::scenes().into_iter().map(|scene| scene.name).collect();
    assert_eq!(names, registered);
    assert!(list["scenes"].as_array().unwrap().iter().all(|s| s["description"].as_str().unwrap().len() > 10));
    for scene in names {
        let args = format!("{scene} -r 32 24 -s 2");
        let (lean, a) = render(dir.path(), &args, "lean.exr");
        let (general, b) = render(dir.path(), &format!("{args} --general"), "general.exr");
        assert!(a == b, "{scene}: --general changes the image");
        assert_eq!(lean["scene"], scene);
        let left_out = |value: &Value| value["left_out"].as_array().unwrap().len();
        assert!(left_out(&general) <= left_out(&lean), "{scene}");
    }
}

#[test]
fn shards_are_merged_to_the_same_bits() {
    let dir = folder();
    const ARGS: &str = "cornell-spheres -r 48 36 -s 4 --paths 2 --filter triangle";
    let (_, whole) = render(dir.path(), ARGS, "whole.exr");
    // As separate processes at the same time, like those of a cluster.
    let children = (1..=3).map(|i| {
        let shard = format!("{i}/3");
        let args = ["render"].into_iter().chain(ARGS.split(' ')).chain(["--shard", &shard, "-o", "parts"]);
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("etalon"));
        command.args(args).current_dir(dir.path()).stdout(std::process::Stdio::null()).spawn().unwrap()
    });
    for mut child in children.collect::<Vec<_>>() {
        assert!(child.wait().unwrap().success());
    }
    let parts: Vec<PathBuf> = (1..=3).map(|i| format!("parts/cornell-spheres.shard-{i}-of-3.exr").into()).collect();
    let made = std::fs::read_dir(dir.path().join("parts")).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(made.filter(|name| name != ".etalon").count(), 3, "a shard writes one file");
    let parts: Vec<&str> = parts.iter().map(|p| p.to_str().unwrap()).collect();
    let merge = |parts: &[&str], out: &str| {
        json(dir.path(), &[&["merge"], parts, &["-o", out]].concat());
        layers(&dir.path().join(out))
    };
    assert!(merge(&[parts[2], parts[0], parts[1]], "merged.exr") == whole);

    // A shard that is interrupted or done goes on from its file, and one shard of one can be merged, too.
    let (some, _) = render(dir.path(), &format!("{ARGS} --shard 2/3 --resume {}", parts[1]), "again.exr");
    assert_eq!((&some["samples"], &some["interrupted"]), (&1.into(), &false.into()));
    render(dir.path(), &format!("{ARGS} --shard 1/1"), "all.exr");
    assert!(merge(&["all.exr"], "merged.exr") == whole);
    for (args, message) in [
        (ARGS.replace("-s 4", "-s 8"), "-s: 8"),
        (ARGS.replace("triangle", "triangle:1"), "filter: triangle:2 there, triangle:1 here"),
    ] {
        let words = ["render"].into_iter().chain(args.split(' ')).chain(["--shard", "2/3", "--resume", parts[1]]);
        let other = etalon(dir.path(), &words.collect::<Vec<_>>());
        assert!(other.code == 2 && other.stderr.contains(message), "{}", other.stderr);
    }
    let other = ARGS.replace("triangle", "box");
    render(dir.path(), &format!("{other} --shard 1/3"), "other.exr");
    let ran = etalon(dir.path(), &["merge", "other.exr", parts[1], "-o", "no.exr"]);
    assert!(ran.code == 2 && ran.stderr.contains("fingerprint of scene and settings"), "{}", ran.stderr);
}

#[test]
fn filters_change_the_image_and_are_named_in_it() {
    let dir = folder();
    let of = |filter: &str| render(dir.path(), &format!("furnace -r 16 12 -s 2 {filter}"), "image.exr").1;
    let plain = of("--uniform");
    assert!(plain == of("--uniform --filter box") && plain == of("--uniform --filter box:0.5x0.5"));
    assert!(plain != of("--uniform --filter gaussian"));
    let file = ExrFile::open(&dir.path().join("image.exr")).unwrap();
    assert_eq!(file.metadata().get("filter"), Some("gaussian:1.5,0.5"));
    for bad in ["mitchell", "box:0", "gaussian:1.5,nan", "triangle:1,1"] {
        let ran = etalon(dir.path(), &["render", "furnace", "--filter", bad]);
        assert!(ran.code == 2 && ran.stderr.contains("box, triangle or gaussian"), "{bad}: {}", ran.stderr);
    }
}

/// Interrupts a render of `args` by a signal while it renders: later and later, until it is neither killed nor at its end.
#[cfg(unix)]
fn interrupt(folder: &Path, (name, number): (&str, i32), args: &[&str]) -> crate::program::Ran {
    use std::os::unix::process::ExitStatusExt;
    for delay in [50, 100, 200, 400, 800, 1600] {
        let mut command = crate::program::interruptible();
        let pipe = std::process::Stdio::piped;
        let child = command.args(args).current_dir(folder).stdout(pipe()).stderr(pipe()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(delay));
        let kill = std::process::Command::new("kill").args([name, &child.id().to_string()]).status();
        assert!(kill.is_ok());
        let output = child.wait_with_output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let (stdout, stderr) = (text(output.stdout), text(output.stderr));
        match output.status.code() {
            Some(code) => return crate::program::Ran { code, stdout, stderr },
            None => assert_eq!(output.status.signal(), Some(number), "not killed by the interrupt: {stderr}"),
        }
    }
    panic!("killed before the render began");
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_goes_on_to_the_same_bits() {
    let dir = folder();
    let at = |name: &str| dir.path().join(name);
    const ARGS: &str = "render cornell-spheres -r 48 36 -s 600 -l 1";
    let args = |more: &str| -> Vec<&'static str> { format!("{ARGS} {more}").leak().split(' ').collect() };
    json(dir.path(), &args("-o whole.exr"));

    for (state, more, signal) in
        [("a.exr", "-o a.pfm", ("-INT", 2)), ("state.exr", "-o b.exr --resume state.exr", ("-TERM", 15))]
    {
        let ran = interrupt(dir.path(), signal, &args(&format!("{more} --json")));
        assert_eq!(ran.code, 3, "{}", ran.stderr);
        assert!(ran.stderr.contains(&format!("--resume {state}")), "{}", ran.stderr);
        let value: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(value["interrupted"], true);
        assert!(value["samples"].as_u64() < Some(600));
        let preview = state.replace("state", "b").replace("exr", "png");
        assert_eq!(value["files"], serde_json::json!([state, preview]), "the sums and a preview");

        // Without -s it is the file that says how many samples.
        let again = json(
            dir.path(),
            &format!("render cornell-spheres -r 48 36 -l 1 -o c.exr --resume {state}").split(' ').collect::<Vec<_>>(),
        );
        assert_eq!((&again["samples"], &again["interrupted"]), (&600.into(), &false.into()));
        assert!(layers(&at("c.exr")) == layers(&at("whole.exr")) && layers(&at(state)) == layers(&at("whole.exr")));
    }
}

#[test]
fn a_state_is_kept_written_again_and_given_more_samples() {
    let dir = folder();
    const ARGS: &str = "cornell-lambert -r 24 18";
    let (_, few) = render(dir.path(), &format!("{ARGS} -s 3 --resume state.exr"), "few.exr");
    let again =
        etalon(dir.path(), &["render", "cornell-lambert", "-r", "24", "18", "--resume", "state.exr", "-o", "b.exr"]);
    assert!(again.code == 0 && again.stderr.contains("all samples are there"), "{}", again.stderr);
    assert!(layers(&dir.path().join("b.exr")) == few);
    // The state may be the image itself.
    let (more, raised) = render(dir.path(), &format!("{ARGS} -s 9 --resume state.exr"), "state.exr");
    assert_eq!(more["samples"], 9);
    let (_, nine) = render(dir.path(), &format!("{ARGS} -s 9"), "nine.exr");
    assert!(raised == nine);
    let same = "render cornell-lambert --resume state.exr -r 24 18";
    for (line, expected) in [
        (format!("{same} -s 8"), "-s: 8 samples per pixel are fewer"),
        (format!("{same} -m 2"), "maxDepth: 5 there, 2 here"),
        (format!("{same} --seed 2"), "seed: 1 there, 2 here"),
        (format!("{same} --paths 1"), "path classes: none there, 4 here"),
        (format!("{same} --model lambda-pi"), "model: exact there, lambda-pi here"),
        (same.replace("18", "20"), "pixels: 24x18 there, 24x20 here"),
        (same.replace("lambert", "spheres"), "scene: cornell-lambert there"),
        (same.replace("state", "nine"), "complete"),
    ] {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        assert!(
            ran.code == 2 && ran.stderr.contains(expected) && ran.stderr.contains("hint: "),
            "{line}: {}",
            ran.stderr
        );
    }
}

#[test]
fn the_light_by_path_class_adds_up_and_ends_at_the_depth() {
    let dir = folder();
    for depth in 0..=2 {
        let (value, _) = render(dir.path(), &format!("cornell-spheres -r 48 36 -s 4 -m {depth} --paths 3"), "a.exr");
        let paths = value["paths"].as_array().unwrap();
        let mut shares = 0.0;
        for path in paths {
            let (class, share) = (path["class"].as_str().unwrap(), path["share"].as_f64().unwrap());
            let lit = class != "rest" && class.len() - 2 <= depth;
            // No path by way of both spheres is found with so few samples.
            assert!((share > 0.0) == lit || class == "LSSE", "{class} at depth {depth}: {share}");
            assert!(share == 0.0 || lit, "{class} at depth {depth}: {share}");
            shares += share;
        }
        assert!((shares - 1.0).abs() < 1e-6, "{shares}");

        let file = ExrFile::open(&dir.path().join("a.exr")).unwrap();
        let names: Vec<&str> = file.metadata().get("paths").unwrap().split(' ').collect();
        assert_eq!(names, paths.iter().map(|p| p["class"].as_str().unwrap()).collect::<Vec<_>>());
        let layers: BTreeMap<String, Image> = file.layers().unwrap().into_iter().collect();
        for (i, pixel) in layers[""].pixels().iter().enumerate() {
            let sum = names.iter().fold(glam::DVec3::ZERO, |sum, name| sum + layers[*name].pixels()[i].as_dvec3());
            assert_eq!(sum.as_vec3(), *pixel, "pixel {i}");
        }
        if depth == 0 {
            // The area light in quarters of a pixel, and nothing else.
            let quarters: Vec<Rgb> = (0..=4).map(|n| Rgb::splat(2.5 * n as f32)).collect();
            assert!(layers[""].pixels().iter().all(|p| quarters.contains(p)));
        }
    }
    let (value, _) = render(dir.path(), "cornell-lambert -r 8 6 -s 1", "a.exr");
    assert!(value.get("paths").is_none());
}

#[test]
fn every_model_changes_its_materials() {
    let dir = folder();
    let bytes = |scene: &str, flags: &str| {
        let (_, layers) = render(dir.path(), &format!("{scene} -r 48 36 -s 4{flags}"), "a.exr");
        layers[""].clone()
    };
    for (scene, changing, others) in [
        (
            "cornell-statue-cu",
            &["fresnel-at-normal", "approximate-fresnel", "lambda-pi", "report"][..],
            &["exact", "single-cosine-schlick"][..],
        ),
        ("cornell-spheres", &["single-cosine-schlick", "report"], &["exact", "lambda-pi"]),
    ] {
        let exact = bytes(scene, "");
        for model in changing {
            assert!(bytes(scene, &format!(" --model {model}")) != exact, "{model} changes nothing in {scene}");
        }
        for model in others {
            assert!(bytes(scene, &format!(" --model {model}")) == exact, "{model} changes {scene}");
        }
    }
    let all = " --model fresnel-at-normal,approximate-fresnel,single-cosine-schlick,lambda-pi";
    assert!(bytes("cornell-statue-cu", all) == bytes("cornell-statue-cu", " --model report"));

    let exact = bytes("cornell-statue-cu", "");
    for flags in [" --normals all", " --normals hemisphere", " --alpha 0.5", " --alpha 0"] {
        assert!(bytes("cornell-statue-cu", flags) != exact, "{flags} changes nothing");
    }
    assert!(bytes("cornell-statue-cu", " --normals visible --alpha 0.05") == exact);
    let exact = bytes("cornell-spheres", "");
    assert!(bytes("cornell-spheres", " --fresnel schlick") != exact);
    assert!(bytes("cornell-spheres", " --fresnel exact") == exact);
    assert!(bytes("cornell-spheres", " -H") == bytes("cornell-spheres", " --sampling hemisphere"));
}

#[test]
fn tones_names_and_numbers() {
    let dir = folder();
    let run = |more: &str| {
        let words = format!("render cornell-spheres -r 16 12 {more}");
        json(dir.path(), &words.split(' ').collect::<Vec<_>>())
    };
    let bytes = |name: &str| std::fs::read(dir.path().join(name)).unwrap();
    run("-s 2 -o plain");
    run("-s 2 -o srgb --tone srgb");
    let report = run("-s 2 -f report --tone report");
    assert_eq!(report["files"][0], "report/cornell-spheres.exr");
    let [plain, srgb, report_like] = ["plain", "srgb", "report"].map(|folder| format!("{folder}/cornell-spheres"));
    assert!(bytes(&format!("{plain}.png")) == bytes(&format!("{srgb}.png")));
    assert!(bytes(&format!("{plain}.ppm")) == bytes(&format!("{srgb}.ppm")));
    assert!(bytes(&format!("{report_like}.png")) != bytes(&format!("{srgb}.png")));
    assert!(bytes(&format!("{report_like}.ppm")) != bytes(&format!("{srgb}.ppm")));

    // The error layer, and its mean square.
    let file = ExrFile::open(&dir.path().join(format!("{plain}.exr"))).unwrap();
    let error = &file.layers().unwrap()[1];
    assert_eq!(error.0, "error");
    let square: f64 = error.1.pixels().iter().map(|p| f64::from(p.y).powi(2)).sum::<f64>() / 192.0;
    let [of_pixel, of_mean] =
        ["pixel", "mean"].map(|of| report[format!("standard_error_{of}_rgb")][1].as_f64().unwrap());
    assert!((of_pixel / square.sqrt() - 1.0).abs() < 1e-9 && report["samples_per_second"].as_f64() > Some(0.0));
    assert!((of_mean / (square / 192.0).sqrt() - 1.0).abs() < 1e-9);
    assert!(run("-o one -s 1")["standard_error_mean_rgb"][0].is_null(), "one sample has no error");
    for name in ["command", "seed", "spp", "lightSamples", "maxDepth", "seconds", "sampling", "stream", "model"] {
        assert!(file.metadata().get(name).is_some(), "{name}");
    }
}

#[test]
fn a_mesh_takes_the_place_of_the_statue() {
    let dir = folder();
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    std::fs::write(dir.path().join("mesh.obj"), tetrahedron).unwrap();
    let (_, statue) = render(dir.path(), "cornell-statue-fe -r 32 24 -s 1", "a.exr");
    let (value, mesh) = render(dir.path(), "cornell-statue-fe -r 32 24 -s 1 --mesh mesh.obj", "b.exr");
    assert!(statue[""] != mesh[""]);
    // Whichever way round the corners of its triangles run.
    let inside_out = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(dir.path().join("mesh.obj"), inside_out).unwrap();
    let (other, _) = render(dir.path(), "cornell-statue-fe -r 32 24 -s 1 --mesh mesh.obj", "c.exr");
    for c in 0..3 {
        let [a, b] = [&value, &other].map(|value| value["mean_rgb"][c].as_f64().unwrap());
        assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
    }
}

#[test]
fn conductors_of_pbrt_reflect_on_both_sides() {
    let dir = folder();
    let mean = |indices: &str, roughness: f64| {
        let scene = format!(
            "LookAt 0 0 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 45\nFilm \"rgb\" \"integer xresolution\" 32 \
             \"integer yresolution\" 32\nWorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial \"conductor\" \
             \"float roughness\" {roughness}\nShape \"trianglemesh\" \"integer indices\" [{indices}] \
             \"point3 P\" [-1 -1 0  1 -1 0  1 1 0  -1 1 0]\n"
        );
        std::fs::write(dir.path().join("quad.pbrt"), scene).unwrap();
        let value = json(dir.path(), &["render", "quad.pbrt", "-s", "16"]);
        value["mean_rgb"][0].as_f64().unwrap()
    };
    for roughness in [0.0, 0.1] {
        let [one, other] = ["0 1 2 0 2 3", "0 2 1 0 3 2"].map(|indices| mean(indices, roughness));
        // Copper in front of light of radiance 1.
        assert!(one > 0.9 && (one / other - 1.0).abs() < 1e-3, "{roughness}: {one} {other}");
    }
}

/// A COLLADA scene of a metal quad without lights, as the course has them for its environment maps.
const UNLIT: &str = include_str!("../fuzz/seeds/collada/unlit.dae");

#[test]
fn a_scene_without_lights_warns_and_takes_an_environment_map() {
    let dir = folder();
    std::fs::write(dir.path().join("unlit.dae"), UNLIT).unwrap();
    let args = ["render", "unlit.dae", "-r", "40", "30", "-s", "4"];
    let ran = crate::program::etalon(dir.path(), &args);
    assert!(ran.code == 0 && ran.stderr.contains("unlit.dae: no light source"), "{}", ran.stderr);
    assert_eq!(json(dir.path(), &args)["mean_rgb"][0], 0.0);
    let with_map = [&args[..], &["--envmap", "constant"]].concat();
    let ran = crate::program::etalon(dir.path(), &with_map);
    assert!(ran.code == 0 && !ran.stderr.contains("no light source"), "{}", ran.stderr);
    // Radiance 1 from everywhere, directly and reflected by metal.
    let mean = json(dir.path(), &with_map)["mean_rgb"][0].as_f64().unwrap();
    assert!(mean > 0.7 && mean < 1.0, "{mean}");
}

#[test]
fn a_cropped_view_says_so_and_fit_shows_all_of_it() {
    let dir = folder();
    std::fs::write(dir.path().join("unlit.dae"), UNLIT).unwrap();
    let run = |args: &str| {
        let words: Vec<&str> =
            "render unlit.dae --envmap constant -s 4 --json".split(' ').chain(args.split(' ')).collect();
        let ran = etalon(dir.path(), &words);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let mean = serde_json::from_str::<Value>(&ran.stdout).unwrap()["mean_rgb"][0].as_f64().unwrap();
        (mean, ran.stderr.contains("--fit"))
    };
    let (whole, of_whole) = run("-r 800 600");
    let (cropped, of_cropped) = run("-r 80 60");
    let (fitted, of_fitted) = run("-r 80 60 --fit");
    assert_eq!([of_whole, of_cropped, of_fitted], [false, true, false]);
    // The metal in the middle is darker than the light around it.
    assert!((fitted / whole - 1.0).abs() < 2e-3 && cropped < 0.95 * whole, "{whole} {cropped} {fitted}");
    for wrong in ["sphere-env -r 8 8 --fit", "unlit.dae --fit"] {
        let words: Vec<&str> = ["render"].into_iter().chain(wrong.split(' ')).collect();
        let ran = etalon(dir.path(), &words);
        assert!(
            ran.code == 2 && ran.stderr.contains("--fit: it is for a .dae scene and the size that -r gives"),
            "{}",
            ran.stderr
        );
    }
}

/// A folder of scenes of other programs; `None`, and a word about it, where there is none.
fn scenes() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/scenes");
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: there is no {}", path.display());
    None
}

#[test]
fn collada_scenes_and_camera_settings() {
    let Some(scenes) = scenes() else { return };
    let dir = folder();
    let scene = scenes.join("CBspheres.dae");
    let scene = scene.to_str().unwrap();
    let plain = json(dir.path(), &["render", scene]);
    assert_eq!([&plain["width"], &plain["height"], &plain["spp"], &plain["max_depth"]], [800, 600, 1, 1]);
    assert_eq!(plain["scene"], "CBspheres");

    // The camera that the scene gets for 480x360, as a settings file.
    let settings = "30.6759 23.2491 1.333333 0.001 1000\n0 0.75 4.80234 0 0.75 0\n1.5708 0 4.80234 0.1 100\n\
                    1 0 0 0 1 0 0 0 1\n480 360 875\n4.7 0\n";
    std::fs::write(dir.path().join("camera.txt"), settings).unwrap();
    let own = json(dir.path(), &["render", scene, "-r", "480", "360", "-o", "a"]);
    let given = json(dir.path(), &["render", scene, "-c", "camera.txt", "-o", "b"]);
    assert_eq!([&given["width"], &given["height"]], [480, 360]);
    for c in 0..3 {
        let mean = |value: &Value| value["mean_rgb"][c].as_f64().unwrap();
        assert!((mean(&own) / mean(&given) - 1.0).abs() < 2e-3, "{own} {given}");
        assert!((mean(&own) / mean(&plain) - 1.0).abs() > 0.1, "the size sets the field of view");
    }
}

#[test]
fn the_pbrt_scene_takes_the_size_that_is_asked_for() {
    let Some(scenes) = scenes() else { return };
    let dir = folder();
    let scene = scenes.join("simple_sphere.pbrt");
    let args = ["render", scene.to_str().unwrap(), "--envmap", "sun", "-r", "40", "20", "-s", "2", "--paths", "1"];
    let value = json(dir.path(), &args);
    assert_eq!([&value["width"], &value["height"], &value["spp"]], [40, 20, 2]);
    assert_eq!(value["paths"][1]["class"], "LDE");
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn images_are_the_same_without_wide_vectors() {
    const EMULATOR: &str = "qemu-x86_64";
    if cfg!(not(target_arch = "x86_64")) || Command::new(EMULATOR).arg("--version").output().is_err() {
        return eprintln!("skipped: {EMULATOR} does not run here");
    }
    let program = assert_cmd::cargo::cargo_bin("etalon");
    for line in [
        "cornell-spheres -r 40 30 -s 2",
        "cornell-spheres -r 40 30 -s 2 --sampling mis+lt",
        "cornell-statue-au -r 40 30 -s 2",
        "sphere-env -r 32 32 -s 4",
        "furnace -r 40 10 -s 2 -m 20",
        "brushed-metal -r 30 20 -s 2",
    ] {
        let args: Vec<&str> = ["render"].into_iter().chain(line.split(' ')).chain(["-o", "image.exr"]).collect();
        let native = tempfile::tempdir().unwrap();
        assert_eq!(etalon(native.path(), &args).code, 0, "{line}");
        let native = layers(&native.path().join("image.exr"));
        // The first has SSE4.2 and no AVX; the second AVX2 and FMA and no AVX-512.
        for processor in ["Nehalem", "Haswell"] {
            let folder = tempfile::tempdir().unwrap();
            let mut emulated = Command::new(EMULATOR);
            emulated.args(["-cpu", processor]).arg(&program).args(&args).current_dir(folder.path());
            let ran = emulated.output().unwrap();
            assert!(ran.status.success(), "{line}, {processor}: {}", String::from_utf8_lossy(&ran.stderr));
            assert!(layers(&folder.path().join("image.exr")) == native, "{line}, {processor}: the images differ");
        }
    }
}
