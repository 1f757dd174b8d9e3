//! Wrong input: exit code 2, a message that names the culprit, a hint where one helps, and nothing written.

use crate::program::{etalon, json};
use std::path::Path;

/// A folder of things that are not what their names say.
fn prepared() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    for name in ["map.exr", "map.hdr", "map.pfm", "map.png"] {
        json(dir.path(), &["envmap", "make", "onehot", "-o", name]);
        let bytes = std::fs::read(at(name)).unwrap();
        std::fs::write(at(&format!("cut-{name}")), &bytes[..bytes.len() / 2]).unwrap();
        std::fs::write(at(&format!("head-{name}")), &bytes[..12]).unwrap();
    }
    json(dir.path(), &["envmap", "make", "sun", "-o", "large.pfm"]);
    std::fs::write(at("nan.pfm"), b"Pf\n1 1\n-1\n\xff\xff\xff\xff").unwrap();
    std::fs::create_dir(at("folder")).unwrap();
    std::fs::create_dir(at("folder.pbrt")).unwrap();
    for (name, text) in [
        ("empty.exr", ""),
        ("empty.pbrt", ""),
        ("text.exr", "hello, world\n"),
        ("lfs.exr", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2145\nsize 1726329\n"),
        ("page.hdr", "<!DOCTYPE html><title>404</title>"),
        ("huge.pfm", "PF\n60000 4000\n-1\nabc"),
        ("syntax.pbrt", "Camera \"orthographic\"\nWorldBegin\n  Shape \"sphere\" \"float radius\" [1 \"two\"]\n"),
        ("unknown.pbrt", "Camera \"orthographic\"\nWorldBegin\nTeapot \"utah\"\n"),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("no-map.pbrt", "WorldBegin LightSource \"infinite\" \"string mapname\" \"gone.exr\" Shape \"sphere\"\n"),
    ] {
        std::fs::write(at(name), text).unwrap();
    }
    dir
}

fn listing(folder: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    names
}

/// A command line; words that standard error must contain.
type Case = (&'static str, &'static [&'static str]);

/// Runs each case twice, once with --json: refusals go to standard error alone.
fn refused(cases: &[Case]) {
    let dir = prepared();
    let before = listing(dir.path());
    for (line, expected) in cases {
        for flag in [&[][..], &["--json"]] {
            let args: Vec<&str> = line.split_whitespace().chain(flag.iter().copied()).collect();
            let ran = etalon(dir.path(), &args);
            assert_eq!(ran.code, 2, "{line}: {}", ran.stderr);
            assert_eq!(ran.stdout, "", "{line}");
            assert!(ran.stderr.starts_with("error: ") || ran.stderr.starts_with("warning: "), "{line}: {}", ran.stderr);
            for word in *expected {
                assert!(ran.stderr.contains(word), "{line}: no \"{word}\" in\n{}", ran.stderr);
            }
        }
        assert_eq!(listing(dir.path()), before, "{line} left something behind");
    }
}

#[test]
fn numbers_out_of_range() {
    refused(&[
        ("fresnel --eta-i 0", &["--eta-i: 0 ", "hint: "]),
        ("fresnel --eta-t=-1", &["--eta-t: -1 ", "hint: "]),
        ("fresnel --eta-t NaN", &["--eta-t: NaN ", "hint: "]),
        ("fresnel --eta-t inf", &["--eta-t: inf ", "hint: "]),
        ("fresnel --eta-t Au", &["--eta-t", "Au", "--list"]),
        ("fresnel --k -1", &["--k: -1 ", "hint: "]),
        ("fresnel --k NaN", &["--k: NaN ", "hint: "]),
        ("fresnel --points 0", &["--points: 0 ", "hint: "]),
        ("fresnel --points 1", &["--points: 1 ", "hint: "]),
        ("fresnel --points 99999999999", &["--points", "hint: "]),
        ("fresnel --metal Unobtainium", &["--metal", "Unobtainium", "hint: ", "Au"]),
        ("fresnel --metal Au --k 2", &["--metal", "--k"]),
        ("fresnel water unobtainium", &["MEDIUM", "unobtainium", "hint: ", "diamond"]),
        ("fresnel water -0.5", &["MEDIUM: -0.5 ", "hint: "]),
        ("fresnel water NaN", &["MEDIUM: NaN ", "hint: "]),
        ("fresnel water Water", &["MEDIUM", "twice"]),
        ("fresnel gold --metal Au", &["MEDIUM", "twice"]),
        ("fresnel 1.1 1.2 1.3 1.4 1.5 1.6 1.7 1.8", &["MEDIUM: 8 ", "hint: "]),
        ("fresnel water --eta-t 1.5", &["MEDIUM", "--eta-t"]),
        ("fresnel water --show colour", &["--show", "schlick"]),
        ("fresnel --angles Au", &["MEDIUM", "gold", "hint: "]),
        ("fresnel --angles --metal Au", &["--angles", "--metal"]),
        ("fresnel --angles water water", &["MEDIUM", "twice"]),
        ("fresnel --list water", &["--list", "MEDIUM"]),
        ("fresnel --metal Au --model report", &["--model", "hint: "]),
        ("envmap sample onehot -n 0", &["-n: 0 ", "hint: "]),
        ("envmap sample onehot -n 64,,256", &["-n"]),
        ("envmap sample onehot -n 99999999999999", &["-n: 99999999999999", "hint: "]),
        ("envmap sample onehot --window 0", &["--window"]),
        ("envmap sample onehot --gamma 0", &["--gamma"]),
        ("envmap sample onehot --exposure NaN", &["--exposure"]),
        ("envmap sample onehot --model report --sampler cosine", &["--model", "--sampler"]),
        ("envmap cut onehot -n 0", &["-n: 0 ", "hint: "]),
        ("envmap cut onehot -n 2049", &["-n: 2049 ", "hint: "]),
        ("envmap cut onehot --window 0", &["--window"]),
        ("envmap proposal onehot -n 0", &["-n: 0 ", "hint: "]),
        ("envmap proposal onehot -n 99999999999", &["-n: 99999999999 "]),
        ("render cornell-statue-au --mesh flat.obj", &["error: flat.obj: it has no triangle with an area"]),
        ("render sphere-env --envmap black -s 0", &["-s: "]),
        ("render sphere-env --envmap black -l 0", &["-l: "]),
        ("render sphere-env --envmap black -r 0 0", &["-r: ", "0x0", "hint: "]),
        ("render sphere-env --envmap black -r 99999999 99999999", &["-r: ", "hint: "]),
        ("render sphere-env --envmap black -r 18446744073709551615 2", &["-r: ", "hint: "]),
        ("render sphere-env --envmap black -r 64", &["--size"]),
        ("render cornell-lambert --flip", &["--flip", "no map"]),
        ("render cornell-lambert --ldr", &["--ldr", "no map"]),
        ("render cornell-lambert --light-density cosine", &["--light-density", "environment map"]),
        ("render cornell-lambert --normals visible", &["--normals", "no metal"]),
        ("render cornell-lambert --fresnel schlick", &["--fresnel", "no glass"]),
        ("scenes --flip", &["--flip", "no map"]),
        ("scenes --seed 2", &["--seed"]),
        ("envmap info nave --threads 2", &["--threads"]),
        ("validate warp --flip", &["--flip", "no map"]),
        ("render sphere-env --envmap black --threads 0", &["--threads"]),
        ("render sphere-env --envmap black --seed -1", &["-1"]),
        ("render sphere-env --envmap black --sampling luck", &["--sampling", "luck", "hemisphere"]),
        ("render furnace -H --sampling mis", &["-H", "--sampling"]),
        ("render furnace -s 99999999999", &["-s"]),
        ("render furnace -m -1", &["-1"]),
        ("render furnace -s 4294967295 -l 4294967295", &["-s: ", "hint: "]),
        ("render furnace -s 1 -l 4294967295", &["-l: 4294967295 ", "hint: at most 65536"]),
        ("render furnace -m 4294967295", &["-m: 4294967295 ", "hint: at most 65536"]),
        ("render furnace --alpha 10.1", &["--alpha: 10.1 "]),
        ("render furnace --alpha -1", &["--alpha: -1 "]),
        ("render furnace --alpha NaN", &["--alpha: NaN "]),
        ("render cornell-lambert --alpha 0.5", &["--alpha: ", "no metal or glass", "hint: "]),
        ("render furnace --alpha 0.1,0.2,0.3", &["--alpha: 3 widths"]),
        ("render furnace --multiple-scattering --model report", &["--multiple-scattering: ", "single scattering"]),
        ("render cornell-spheres --multiple-scattering", &["--multiple-scattering: ", "no metal"]),
        ("render furnace --paths 7", &["--paths", "7"]),
        ("render furnace --shard 0/2", &["--shard", "0/2"]),
        ("render furnace --shard 3/2", &["--shard", "3/2"]),
        ("render furnace --shard 1", &["--shard", "I/N"]),
        ("render furnace -s 2 --shard 1/3", &["--shard: ", "hint: "]),
        ("render furnace --shard 1/2 -o a.png", &["-o: ", "hint: "]),
        ("render furnace --model exact,report", &["--model: "]),
        ("render furnace --model luck", &["--model", "luck", "lambda-pi"]),
        ("render furnace --model lambda-pi --normals visible", &["--normals: ", "hint: "]),
        ("render furnace --model report --fresnel exact", &["--fresnel: ", "hint: "]),
        ("render furnace --tone film", &["--tone", "film", "srgb"]),
        ("render furnace -f a.exr -o b.exr", &["-f: ", "-o"]),
        ("render furnace -f a.csv", &["-o: ", "csv", "hint: "]),
        ("render furnace -c camera.txt", &["-c: ", "hint: "]),
        ("render furnace --mesh gone.ply", &["gone.ply: "]),
        ("render furnace --envmap sun", &["--envmap: ", "furnace", "hint: "]),
        ("render furnace --resume a.png", &["--resume: ", "a.png", "hint: "]),
        ("render furnace --resume map.exr", &["map.exr: ", "no part of a render", "hint: "]),
    ]);
}

#[test]
fn names_that_are_not_there() {
    refused(&[
        ("envmap info atlantis", &["MAP: ", "atlantis", "hint: ", "nave"]),
        ("envmap info gone.exr", &["gone.exr: "]),
        ("envmap make atlantis", &["NAME: ", "atlantis", "hint: ", "nave"]),
        ("render atlantis", &["SCENE: ", "atlantis", "hint: ", "sphere-env"]),
        ("render gone.pbrt", &["gone.pbrt: "]),
        ("render gone.dae", &["gone.dae: "]),
        ("render gone.dae --envmap sun", &["gone.dae: "]),
        ("render gone.dae --mesh gone.ply", &["--mesh: ", "hint: "]),
        ("render gone.pbrt -c gone.txt", &["-c: ", "hint: "]),
        ("render sphere-env --envmap gone.hdr", &["gone.hdr: "]),
        ("render no-map.pbrt", &["gone.exr", "No such file"]),
        ("reproduce --only fresnel-enter,atlantis -o new", &["--only: ", "atlantis", "hint: ", "sphere-8"]),
        ("compare map.exr gone.exr", &["gone.exr: "]),
        ("atlantis", &["atlantis"]),
    ]);
}

#[test]
fn files_that_are_not_what_they_seem() {
    refused(&[
        ("envmap info folder", &["folder: ", "directory"]),
        ("envmap info empty.exr", &["empty.exr: ", "empty"]),
        ("envmap sample text.exr", &["text.exr: ", "text file", "hint: "]),
        ("envmap cut lfs.exr", &["lfs.exr: ", "Git LFS pointer", "hint: "]),
        ("envmap proposal page.hdr", &["page.hdr: ", "web page", "hint: "]),
        ("envmap info cut-map.exr", &["cut-map.exr: "]),
        ("envmap info cut-map.hdr", &["cut-map.hdr"]),
        ("envmap info cut-map.pfm", &["cut-map.pfm", "hint: "]),
        ("envmap info cut-map.png --ldr", &["cut-map.png"]),
        ("envmap info head-map.exr", &["head-map.exr: "]),
        ("envmap info head-map.hdr", &["head-map.hdr"]),
        ("envmap info head-map.pfm", &["head-map.pfm"]),
        ("envmap info head-map.png --ldr", &["head-map.png"]),
        ("envmap info huge.pfm", &["huge.pfm", "2880000017", "hint: "]),
        ("envmap info map.png", &["map.png: ", "clipped at 1", "hint: ", "--ldr"]),
        ("render sphere-env --envmap map.png", &["map.png: ", "--ldr"]),
        ("render map.exr", &["SCENE: ", "map.exr", "hint: "]),
        ("render folder.pbrt", &["folder.pbrt: "]),
        ("render syntax.pbrt", &["syntax.pbrt:3:"]),
        ("render unknown.pbrt", &["unknown.pbrt:3:1: ", "Teapot"]),
        ("compare map.pfm large.pfm", &["64x32", "1024x512"]),
        ("compare folder map.pfm", &["folder: ", "directory"]),
        ("compare nan.pfm nan.pfm", &["nan.pfm: ", "nothing to compare", "hint: "]),
        // A file stands where a folder should be made.
        ("fresnel -o text.exr/new", &["text.exr"]),
        ("envmap make black -o map.png/new.exr", &["map.png"]),
        ("render sphere-env --envmap black -s 1 -r 4 4 -o map.pfm/new", &["map.pfm"]),
        ("render furnace -s 4000000 --resume map.png/state.exr", &["map.png"]),
        ("render furnace -s 4000000 -o map.png/new.exr", &["map.png"]),
        ("reproduce --only fresnel-enter -o syntax.pbrt", &["syntax.pbrt"]),
    ]);
}

#[test]
fn clipped_pictures_are_read_when_asked_for() {
    let dir = prepared();
    let value = json(dir.path(), &["envmap", "info", "map.png", "--ldr"]);
    assert_eq!((value["width"].as_u64(), value["max"].as_f64()), (Some(64), Some(1.0)));
}

/// A superuser may write everywhere; then there is nothing to see.
#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_to() {
    use std::os::unix::fs::PermissionsExt;
    let dir = prepared();
    let locked = dir.path().join("folder");
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        println!("skipped: this user may write everywhere");
        return;
    }
    for args in [&["fresnel", "-o", "folder"][..], &["envmap", "make", "black", "-o", "folder/new/map.exr"]] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains("folder"), "{args:?}: {}", ran.stderr);
    }
}

/// What a scene names is an input of the render, too: textures, meshes and included files.
#[test]
fn no_output_replaces_what_a_scene_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let image = etalon(folder.path(), &["render", "furnace", "-s", "2", "-r", "4", "4", "-o", "wood.exr"]);
    assert_eq!(image.code, 0, "{}", image.stderr);
    let mesh = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(at("triangle.ply"), mesh).unwrap();
    std::fs::write(at("part.pbrt"), "Shape \"plymesh\" \"string filename\" \"triangle.ply\"\n").unwrap();
    let scene = "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nWorldBegin\n\
                 LightSource \"point\" \"rgb I\" [1 1 1] \"point3 from\" [0 3 -3]\n\
                 Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.png\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n\
                 Include \"part.pbrt\"\n";
    std::fs::write(at("scene.pbrt"), scene).unwrap();
    std::fs::create_dir(at("folder")).unwrap();
    let before: Vec<Vec<u8>> =
        ["wood.png", "triangle.ply", "part.pbrt"].map(|name| std::fs::read(at(name)).unwrap()).into();
    #[cfg(unix)]
    std::os::unix::fs::symlink("wood.png", at("link.png")).unwrap();
    let links: &[&str] = if cfg!(unix) { &["link.exr", "link.png"] } else { &[] };
    for out in ["wood.exr", "wood.png", "folder/../wood.pfm"].iter().chain(links) {
        let ran = etalon(folder.path(), &["render", "scene.pbrt", "-s", "2", "-o", out]);
        assert!(
            ran.code == 2 && ran.stderr.contains("is an input of this command"),
            "{out}: {} {}",
            ran.code,
            ran.stderr
        );
    }
    let args =
        ["converge", "scene.pbrt", "--budget", "20", "--max-spp", "1", "--replicates", "1", "--strategies", "light"];
    let ran = etalon(folder.path(), &[&args[..], &["-o", "wood.svg"]].concat());
    assert!(ran.code == 2 && ran.stderr.contains("is an input of this command"), "{} {}", ran.code, ran.stderr);
    let after: Vec<Vec<u8>> =
        ["wood.png", "triangle.ply", "part.pbrt"].map(|name| std::fs::read(at(name)).unwrap()).into();
    assert!(before == after);
    // A name that no file can have is refused before the work.
    let long = format!("{}.exr", "n".repeat(253));
    let ran = etalon(folder.path(), &["render", "scene.pbrt", "-s", "2", "-o", &long]);
    assert!(
        ran.code == 2 && ran.stderr.contains("too long") && !ran.stdout.contains("samples"),
        "{} {}",
        ran.stdout,
        ran.stderr
    );
}
