//! Parts of a render: their files, `etalon merge`, and what may not be merged.

use crate::program::{etalon, json};
use etalon::Error;
use etalon::math::Rgb;
use etalon::raster::{ExrFile, Image, Metadata, ReadOptions, read};
use etalon::render::film::{Film, Part, PathClasses, Row, merge_files, shard};
use etalon::sampling::stream::{Independent, Stream};
use std::ops::Range;
use std::path::{Path, PathBuf};

const SIZE: (usize, usize) = (19, 34);
const SPP: u32 = 24;

/// Adds sample `s` of a pixel: some light of each path class, now and then something impossible.
fn add(row: &mut Row<'_>, x: usize, s: u32) {
    let pixel = row.y() * SIZE.0 + x;
    let mut paths = [Rgb::ZERO; 8];
    for (class, light) in paths.iter_mut().enumerate() {
        let [u, v] = Independent::new(1, pixel as u64, s).pair(class as u32);
        *light = Rgb::new(u as f32, (10.0 * v - 5.0).exp() as f32, (u * v) as f32);
    }
    let total = if (pixel + s as usize).is_multiple_of(1001) { -Rgb::ONE } else { paths.iter().sum() };
    row.add(x, total, &paths);
}

fn empty(classes: Option<PathClasses>) -> Part {
    let metadata = Metadata::default().with("command", "render x").with("seed", 1).with("seconds", 0.5);
    Part::new(Film::new(SIZE.0, SIZE.1, classes).unwrap(), SPP, "f1", metadata)
}

/// A part with some of the samples.
fn part(samples: Range<u32>) -> Part {
    let mut part = empty(Some(PathClasses::up_to(2)));
    go_on(&mut part, samples, u32::MAX);
    part
}

/// Renders what is missing of `samples`, at most `at_most` of them for each pixel (fewer further down).
fn go_on(part: &mut Part, samples: Range<u32>, at_most: u32) {
    while let Some(task) = part.next(samples.clone()) {
        part.film.accumulate(|row| {
            for x in 0..SIZE.0 {
                let budget = at_most.saturating_sub(row.y() as u32 / 8) as usize;
                task.left(row.samples(x)).take(budget).for_each(|s| add(row, x, s));
            }
        });
        if at_most < u32::MAX {
            return;
        }
    }
}

fn write(folder: &Path, name: &str, part: &Part) -> PathBuf {
    let path = folder.join(name);
    part.write(&path).unwrap();
    path
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn layers(path: &Path) -> Vec<(String, Image)> {
    ExrFile::open(path).unwrap().layers().unwrap()
}

#[test]
fn parts_survive_their_files() {
    let dir = folder();
    for samples in [0..1, 5..17] {
        let part = part(samples);
        let path = write(dir.path(), "a.exr", &part);
        assert!(Part::read(&path).unwrap() == part);
        assert_eq!(read(&path, ReadOptions::default()).unwrap(), part.film.image());
    }
    let mut without = empty(None);
    go_on(&mut without, 3..9, 4);
    assert_eq!((without.ranges().samples(), without.ranges().begun()), (0, Some(3..9)));
    assert!(Part::read(&write(dir.path(), "b.exr", &without)).unwrap() == without);
}

#[test]
fn a_complete_part_keeps_its_sums_if_it_is_to_get_more() {
    let dir = folder();
    let (few, path) = (part(0..SPP), dir.path().join("a.exr"));
    few.save(&path).unwrap();
    let mut more = Part::read(&path).unwrap();
    assert!(more == few && more.is_complete() && more.count() == (SIZE.0 * SIZE.1) as u64 * u64::from(SPP));
    assert!(more.set_spp(SPP - 1).unwrap_err().to_string().contains("0..24 of 24"));
    more.set_spp(SPP + 5).unwrap();
    assert!(!more.is_complete());
    go_on(&mut more, 0..SPP + 5, u32::MAX);
    let mut whole = empty(Some(PathClasses::up_to(2)));
    whole.set_spp(SPP + 5).unwrap();
    go_on(&mut whole, 0..SPP + 5, u32::MAX);
    assert!(more == whole && !whole.ranges().have(&(0..SPP + 6)));
}

#[test]
fn merged_shards_are_the_render_in_one_go() {
    let dir = folder();
    let whole = write(dir.path(), "whole.exr", &part(0..SPP));
    for count in [1, 2, 5, 24] {
        let part = |i| write(dir.path(), &format!("{i}.exr"), &part(shard(i, count, SPP)));
        let mut paths: Vec<PathBuf> = (1..=count).map(part).collect();
        paths.reverse();
        if count == 1 {
            assert!(merge_files(&paths).unwrap_err().to_string().contains("complete"));
            continue;
        }
        let merged = merge_files(&paths).unwrap();
        let merged = write(dir.path(), "merged.exr", &merged);
        assert_eq!(layers(&merged), layers(&whole), "{count} shards");
    }
}

#[test]
fn an_interrupted_part_goes_on_where_it_was() {
    let dir = folder();
    let mut interrupted = part(0..4);
    for at_most in [0, 3, 5] {
        go_on(&mut interrupted, 4..16, at_most);
        interrupted = Part::read(&write(dir.path(), "a.exr", &interrupted)).unwrap();
        assert_eq!(interrupted.ranges().to_string(), "0..4 begun 4..16 of 24");
    }
    // Merged while it is open, then finished.
    let paths = [write(dir.path(), "b.exr", &part(16..20)), write(dir.path(), "a.exr", &interrupted)];
    let mut merged = merge_files(&paths).unwrap();
    assert_eq!(merged.ranges().to_string(), "0..4 16..20 begun 4..16 of 24");
    go_on(&mut merged, 0..SPP, u32::MAX);
    assert!(merged.is_complete() && merged == part(0..SPP));
}

#[test]
fn the_layers_of_a_file_add_up_to_its_picture() {
    let dir = folder();
    let file = ExrFile::open(&write(dir.path(), "a.exr", &part(0..7))).unwrap();
    let layers = file.layers().unwrap();
    let layer = |name: &str| &layers.iter().find(|(known, _)| known == name).unwrap().1;
    let names = file.metadata().get("paths").unwrap();
    assert_eq!(names, "LE LDE LSE LDDE LDSE LSDE LSSE rest");
    let sums = (0..SIZE.0 * SIZE.1).map(|i| {
        let add = |sum: glam::DVec3, name: &str| sum + layer(name).pixels()[i].as_dvec3();
        names.split(' ').fold(glam::DVec3::ZERO, add).as_vec3()
    });
    assert_eq!(layer(""), &Image::from_pixels(SIZE.0, SIZE.1, sums.collect()));
    assert_eq!(layer("error"), &part(0..7).film.standard_error());
    assert_eq!(layers.len(), 10, "the sums are no layers of light");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let dir = folder();
    let at = |name: &str, part: &Part| write(dir.path(), name, part);
    let first = at("first.exr", &part(0..8));
    let interrupted = |samples: Range<u32>| {
        let mut part = empty(Some(PathClasses::up_to(2)));
        go_on(&mut part, samples, 3);
        part
    };
    let other = |change: fn(&mut Part)| {
        let mut part = part(8..16);
        change(&mut part);
        part
    };
    for (a, b, expected) in [
        (part(0..8), part(6..12), "samples 6..8 are also in"),
        (part(0..8), part(0..8), "samples 0..8"),
        (interrupted(0..8), interrupted(8..16), "interrupted in samples 8..16"),
        (part(0..8), other(|p| p.fingerprint = "f2".into()), "fingerprint of scene and settings: f2 here, f1 there"),
        (
            part(0..8),
            other(|p| p.metadata = Metadata::default().with("build", "0.1.0+9")),
            "build: 0.1.0+9 here, unknown there",
        ),
        (part(0..8), other(|p| p.film = Film::new(3, 3, None).unwrap()), "has 0 samples"),
        (part(0..8), Part::new(Film::new(3, 3, None).unwrap(), 16, "f1", Metadata::default()), "3x3 here, 19x34"),
        (part(0..8), Part::new(Film::new(19, 34, None).unwrap(), 24, "f1", Metadata::default()), "path classes: no"),
    ] {
        let error = merge_files(&[at("a.exr", &a), at("b.exr", &b)]).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(expected) && message.contains("b.exr") && error.hint().is_some(), "{message}");
        assert!(message.contains("a.exr") || message.contains("has 0 samples"), "{message}");
    }
    assert!(merge_files(&[first.clone(), first]).unwrap_err().to_string().contains("also in"));
    assert!(matches!(merge_files(&[]), Err(Error::Parameter { .. })));
    etalon::raster::write(&dir.path().join("image.exr"), &Image::new(2, 2), &Metadata::default()).unwrap();
    let error = merge_files(&[dir.path().join("image.exr")]).unwrap_err();
    assert!(error.to_string().contains("no part of a render"), "{error}");
}

#[test]
fn parts_cut_anywhere_are_errors() {
    let dir = folder();
    let path = write(dir.path(), "a.exr", &part(0..3));
    let sound = std::fs::read(&path).unwrap();
    let header = sound.windows(12).position(|w| w == b"droppedFirst").unwrap();
    for i in 0..150 {
        let [u, _] = Independent::new(4, 0, i).pair(0);
        // Half of the cuts in the header, where they are most interesting.
        let place = (u * if i % 2 == 0 { header as f64 } else { sound.len() as f64 }) as usize;
        std::fs::write(&path, &sound[..place]).unwrap();
        assert!(Part::read(&path).is_err(), "cut off at byte {place}");
    }
}

#[test]
fn attributes_that_lie_are_refused() {
    let dir = folder();
    let path = write(dir.path(), "a.exr", &part(0..3));
    let sound = std::fs::read(&path).unwrap();
    for (from, to, expected) in [
        ("0..3 of 24", "0..4 of 24", "has 3 samples"),
        ("0..3 of 24", "0..3 of 02", "\"samples\" makes no sense"),
        ("0..3 of 24", "3..0 of 24", "\"samples\" makes no sense"),
        ("LE LDE LSE", "LE LDE LLE", "\"paths\" makes no sense"),
        ("sums.n", "sums.m", "no channel \"sums.n\""),
        ("squares.G2\0\0", "squares.G2\0\x02", "no channel \"squares.G2\""),
    ] {
        let at = sound.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let mut bytes = sound.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        std::fs::write(&path, bytes).unwrap();
        let error = Part::read(&path).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn the_command_merges_and_says_what_is_missing() {
    let dir = folder();
    let parts: Vec<PathBuf> =
        (1..=4).map(|i| write(dir.path(), &format!("{i}.exr"), &part(shard(i, 4, SPP)))).collect();
    let some = json(dir.path(), &["merge", "4.exr", "1.exr", "2.exr", "-o", "some.exr"]);
    let expected = serde_json::json!({
        "parts": 3, "width": 19, "height": 34, "samples": 18, "of": 24, "complete": false,
        "missing": [{"start": 12, "end": 18}],
        "dropped": some["dropped"], "files": ["some.exr", "some.png"], "replaced": [],
    });
    assert_eq!(some, expected);
    let ran = etalon(dir.path(), &["merge", "4.exr", "2.exr", "-o", "gaps.exr"]);
    assert!(ran.code == 0 && ran.stderr.contains("samples 0..6 12..18 of 24 are missing"), "{}", ran.stderr);

    // What was merged goes on being merged.
    let all = json(dir.path(), &["merge", "some.exr", "3.exr", "-o", "all.exr"]);
    assert_eq!(
        (&all["samples"], &all["complete"], &all["missing"]),
        (&24.into(), &true.into(), &serde_json::json!([]))
    );
    let whole = part(0..SPP);
    let file = ExrFile::open(&dir.path().join("all.exr")).unwrap();
    assert_eq!(file.layers().unwrap(), layers(&write(dir.path(), "whole.exr", &whole)));
    assert_eq!(all["dropped"]["negative"], whole.film.dropped().negative);
    assert_eq!(file.metadata().get("seed"), Some("1"));
    assert!(file.metadata().get("command").unwrap().contains("merge"));
    assert!(parts.iter().all(|p| p.exists()));

    for (args, expected) in [
        (&["merge", "all.exr", "1.exr"][..], "complete"),
        (&["merge", "1.exr", "1.exr"], "1.exr: samples 0..6 are also in 1.exr"),
        (&["merge", "1.exr", "-o", "x.pfm"], "OpenEXR"),
        (&["merge", "gone.exr"], "gone.exr"),
        (&["merge"], "PARTS"),
    ] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains(expected) && ran.stdout.is_empty(), "{args:?}: {}", ran.stderr);
    }
}

/// The job script of the book, run with a stand-in for Slurm's `srun`: as an array, and with one task alone.
#[cfg(unix)]
mod slurm {
    use crate::program::json;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;
    use std::process::Command;

    /// The book's script, for three small shares.
    fn script() -> String {
        let page = include_str!("../../docs/src/cluster.md");
        let script = page.split("```").find(|block| block.contains("#SBATCH")).expect("the page has a job script");
        let script = script.strip_prefix("sh\n").expect("a block of shell commands");
        let changes = [("--array=1-16 ", "--array=1-3 "), ("tasks=16 ", "tasks=3 "), ("-s 16384 ", "-s 6 -r 24 18 ")];
        changes.into_iter().fold(script.to_owned(), |script, (old, new)| {
            assert_eq!(script.matches(old).count(), 1, "{old}: {script}");
            script.replace(old, new)
        })
    }

    /// Runs task `index` of a job in which Slurm counts `count` tasks.
    fn run(folder: &Path, index: u32, count: u32) {
        let program = assert_cmd::cargo::cargo_bin("etalon");
        let path =
            format!("{}:{}:{}", folder.display(), program.parent().unwrap().display(), std::env::var("PATH").unwrap());
        let output = Command::new("sh")
            .arg("job.sh")
            .current_dir(folder)
            .env("PATH", path)
            .env("SLURM_ARRAY_TASK_ID", index.to_string())
            .env("SLURM_ARRAY_TASK_COUNT", count.to_string())
            .env("SLURM_CPUS_PER_TASK", "1")
            .output()
            .unwrap();
        assert!(output.status.success(), "task {index} of {count}: {}", String::from_utf8_lossy(&output.stderr));
    }

    #[test]
    fn a_task_that_is_submitted_alone_completes_the_array() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path();
        std::fs::write(folder.join("job.sh"), script()).unwrap();
        let srun = folder.join("srun");
        std::fs::write(&srun, "#!/bin/sh\n[ \"$1 $2\" = \"-c 1\" ] && shift 2 && exec \"$@\"\n").unwrap();
        std::fs::set_permissions(&srun, std::fs::Permissions::from_mode(0o755)).unwrap();
        let merged = |name: &str| {
            json(folder, &["merge", "parts/1.exr", "parts/2.exr", "parts/3.exr", "-o", name]);
            json(folder, &["compare", "whole.exr", name])["mse"].as_f64().unwrap()
        };
        json(folder, &["render", "cornell-spheres", "-s", "6", "-r", "24", "18", "-o", "whole.exr"]);
        (1..=3).for_each(|index| run(folder, index, 3));
        assert_eq!(merged("array.exr"), 0.0);
        std::fs::remove_file(folder.join("parts/2.exr")).unwrap();
        run(folder, 2, 1);
        assert_eq!(merged("alone.exr"), 0.0);
    }
}
