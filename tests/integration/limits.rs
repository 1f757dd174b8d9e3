//! Limits of memory and of file sizes, and the end by Ctrl-C of every command that may take long.

use crate::program::{Ran, etalon, json};
use etalon::math::Rgb;
use etalon::raster::{Image, Metadata, write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Writes a map with texture and a sun, in the format that the name says.
fn write_map(path: &Path, [width, height]: [usize; 2]) {
    let sun = (width / 3, height / 4);
    let radiance = |x: usize, y: usize| match (x * 7919 + y * 104_729) % 251 {
        _ if (x, y) == sun => Rgb::splat(1e5),
        k => Rgb::new(0.5 + k as f32 / 251.0, 0.5, 0.2 + y as f32 / height as f32),
    };
    write(path, &Image::from_fn(width, height, radiance), &Metadata::default()).unwrap();
}

/// Runs a command and watches the most memory that it held, in bytes.
fn watched(folder: &Path, args: &[&str]) -> (Ran, u64) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("etalon"));
    let command = command.args(args).current_dir(folder).stdin(stdin(folder)).stdout(Stdio::null());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        peak = line.map_or(peak, |kibibytes| kibibytes.parse::<u64>().unwrap() << 10);
        if let Some(status) = child.try_wait().unwrap() {
            let stderr = std::io::read_to_string(child.stderr.take().unwrap()).unwrap();
            let code = status.code().unwrap_or_else(|| panic!("{args:?}: {status}: {stderr}"));
            return (Ran { code, stdout: String::new(), stderr }, peak);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// The most memory that a command held that ends well.
fn peak(folder: &Path, args: &[&str]) -> u64 {
    let (ran, peak) = watched(folder, args);
    assert!(matches!(ran.code, 0 | 3), "{args:?}: {}", ran.stderr);
    peak
}

/// The commands that take a map, and what each is to hold at most for each texel: the map has 12 bytes, tables up to 16.
fn of_map<'a>(map: &'a str, own: &'a str) -> [Vec<&'a str>; 8] {
    [
        vec!["envmap", "info", map],
        vec!["envmap", "sample", map, "-n", "64"],
        vec!["envmap", "sample", map, "-n", "64", "--sampler", "cosine"],
        vec!["envmap", "cut", map, "-n", "16", "--flip"],
        vec!["envmap", "proposal", map, "-n", "1000"],
        vec!["compare", map, map],
        vec!["render", "sphere-env", "--envmap", map, "-s", "1", "-r", "64", "64"],
        vec!["validate", own, "--envmap", map, "--samples", "1000"],
    ]
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn memory_grows_with_the_map_and_no_more() {
    let dir = tempfile::tempdir().unwrap();
    write_map(&dir.path().join("map.hdr"), [4096, 2048]);
    // A quarter of a gibibyte for a quarter of the texels of a large map, and what the program takes by itself.
    let most = (1 << 28) + (36 << 20);
    for args in of_map("map.hdr", "map/map/cdf") {
        let peak = peak(dir.path(), &args);
        assert!(peak < most, "{args:?}: {} MiB", peak >> 20);
    }
}

/// `cargo test --release --test integration limits -- --ignored --nocapture` on an idle machine.
#[cfg(target_os = "linux")]
#[ignore = "takes minutes and a gibibyte"]
#[test]
fn maps_of_8192_x_4096_take_less_than_a_gibibyte_and_a_minute() {
    for format in ["hdr", "exr", "pfm"] {
        let dir = tempfile::tempdir().unwrap();
        let map = format!("map.{format}");
        write_map(&dir.path().join(&map), [8192, 4096]);
        for args in of_map(&map, "map/map") {
            let start = Instant::now();
            let (peak, time) = (peak(dir.path(), &args), start.elapsed());
            println!("{args:?}: {} MiB, {:.1} s", peak >> 20, time.as_secs_f64());
            assert!(peak < 1 << 30 && time < Duration::from_secs(60), "{args:?}: {} MiB, {time:?}", peak >> 20);
        }
    }
}

fn refused(ran: &Ran, says: &str) {
    assert_eq!(ran.code, 2, "{says}: {}{}", ran.stdout, ran.stderr);
    assert!(ran.stderr.contains(says) && ran.stderr.contains("--memory"), "{says}: {}", ran.stderr);
}

#[cfg(target_os = "linux")]
#[test]
fn what_exceeds_the_limit_of_memory_is_refused_with_its_name() {
    let dir = tempfile::tempdir().unwrap();
    write_map(&dir.path().join("map.hdr"), [2048, 1024]);
    let grey = [&b"P5 2000 2000 255\n"[..], &[128; 2000 * 2000]].concat();
    std::fs::write(dir.path().join("grey.pgm"), grey).unwrap();
    for (args, says) in [
        (&["envmap", "info", "map.hdr", "--memory", "30M"][..], "map.hdr, 2048x1024 pixels"),
        (&["envmap", "info", "map.hdr", "--memory", "1K"], "map.hdr, a file"),
        (&["envmap", "info", "nave", "--memory", "16M"], "the map nave"),
        (&["render", "sphere-env", "-s", "1", "--memory", "16M"], "the map nave"),
        (&["compare", "grey.pgm", "grey.pgm", "--memory", "80M"], "grey.pgm, 2000x2000 pixels"),
        (&["envmap", "sample", "map.hdr", "--sampler", "cdf", "--memory", "60M"], "the sampling table of a map"),
        (&["envmap", "cut", "map.hdr", "--split", "variance", "--memory", "80M"], "the summed-area tables of a map"),
        (&["validate", "map/map/cdf", "--envmap", "map.hdr", "--memory", "90M"], "the test map/map/cdf"),
        (&["render", "furnace", "-r", "2000", "2000", "--memory", "200M"], "a film of 2000x2000 pixels"),
        (
            &["render", "furnace", "-r", "1200", "1200", "--sampling", "mis", "--memory", "200M"],
            "the files of a film of 1200x1200 pixels",
        ),
        (
            &["render", "furnace", "-r", "300", "300", "--paths", "6", "--memory", "200M"],
            "a film of 300x300 pixels in ",
        ),
        (&["render", "cornell-statue-au", "--memory", "20M"], "the tree of 7 objects"),
        (&["converge", "cornell-spheres", "-r", "2000", "2000", "--memory", "1G"], "the films of"),
    ] {
        refused(&etalon(dir.path(), args), says);
    }
    assert_eq!(json(dir.path(), &["envmap", "info", "map.hdr", "--memory", "1g"])["width"], 2048);
    assert_eq!(etalon(dir.path(), &["envmap", "info", "map.hdr", "--memory", "1.5"]).code, 2);
}

/// What a command may read from a pipe: the file `piped`, if there is one.
fn stdin(folder: &Path) -> Stdio {
    let Ok(mut file) = std::fs::File::open(folder.join("piped")) else { return Stdio::null() };
    let (reader, mut writer) = std::io::pipe().unwrap();
    // It ends when nobody reads any more.
    std::thread::spawn(move || std::io::copy(&mut file, &mut writer));
    reader.into()
}

const PBRT: &str = "LookAt 0 0 -5 0 0 0 0 1 0\nCamera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 8 \
                    \"integer yresolution\" 8\nWorldBegin\n";

/// Small files of which a reader makes much more than they hold.
#[cfg(target_os = "linux")]
#[test]
fn what_is_read_asks_for_memory_as_it_grows() {
    const LIMIT: u64 = 48 << 20;
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(dir.path().join(name), text).unwrap();
    let pbrt = |name: &str, line: &str, count: usize| write(name, format!("{PBRT}{}", line.repeat(count)));
    pbrt("disks.pbrt", "Shape \"disk\"\n", 20_000);
    pbrt("spheres.pbrt", "Shape \"sphere\"\n", 300_000);
    pbrt("many.pbrt", "LightSource \"point\"\n", 400_000);
    pbrt("lights.pbrt", "LightSource \"point\"\n", 200_000);
    write("numbers.pbrt", format!("{PBRT}Shape \"trianglemesh\" \"point3 P\" [{}]", "0 ".repeat(6_000_000)));
    write("fan.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {}", "1 2 3 ".repeat(300_000)));
    write("nodes.dae", format!("<COLLADA>{}</COLLADA>", "<node><a/></node>\n".repeat(300_000)));
    write("pdf.csv", format!("{}1\n", "1,".repeat(4095)).repeat(1200));
    write("samples.csv", "x,y,z\n0,0,1\n".into());
    write("piped", "0".repeat(100 << 20));
    for (args, says) in [
        (&["render", "disks.pbrt", "-s", "1"][..], "error: disks.pbrt:"),
        (&["render", "spheres.pbrt", "-s", "1"], "error: spheres.pbrt:"),
        (&["render", "many.pbrt", "-s", "1"], "error: many.pbrt:"),
        (&["render", "lights.pbrt", "-s", "1"], "the materials of 0 objects, and 200000 lights"),
        (&["render", "numbers.pbrt", "-s", "1"], "numbers.pbrt:5:"),
        (&["render", "cornell-statue-au", "-s", "1", "--mesh", "fan.obj"], "fan.obj:4:1: this takes"),
        (&["render", "nodes.dae", "-s", "1"], "nodes.dae: this takes"),
        (
            &["validate", "--samples", "samples.csv", "--pdf", "pdf.csv", "--domain", "hemisphere"],
            "pdf.csv, a table of densities",
        ),
        (&["envmap", "info", "/dev/stdin"], "/dev/stdin, a file"),
    ] {
        let args = [args, &["--memory", "48M"]].concat();
        let (ran, peak) = watched(dir.path(), &args);
        refused(&ran, says);
        assert!(peak <= LIMIT + (1 << 20), "{args:?}: {} MiB", peak >> 20);
    }
}

/// Less than a reader needs, in a process that ends at a failed allocation.
#[cfg(target_os = "linux")]
#[test]
fn what_is_read_ends_before_the_process_has_no_addresses_left() {
    let dir = tempfile::tempdir().unwrap();
    let scene = format!("{PBRT}{}", "Shape \"disk\"\n".repeat(40_000));
    std::fs::write(dir.path().join("disks.pbrt"), scene).unwrap();
    let output = Command::new("sh")
        .args(["-c", "ulimit -v 300000; exec \"$0\" render disks.pbrt -s 1 -t 1"])
        .arg(assert_cmd::cargo::cargo_bin("etalon"))
        .current_dir(dir.path())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains("ulimit -v"), "{}: {stderr}", output.status);
}

/// A colour profile of zeros, which takes a thousandth of its size in the file.
#[cfg(target_os = "linux")]
#[test]
fn a_colour_profile_is_not_inflated() {
    use std::io::Write;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("p.png");
    let grey = Image::from_fn(2, 1, |_, _| Rgb::splat(0.5));
    write(&path, &grey, &Metadata::default()).unwrap();
    let png = std::fs::read(&path).unwrap();
    let mut profile = flate2::write::ZlibEncoder::new(b"iCCPp\0\0".to_vec(), flate2::Compression::fast());
    profile.write_all(&vec![0; 100 << 20]).unwrap();
    let chunk = profile.finish().unwrap();
    let mut sum = flate2::Crc::new();
    sum.update(&chunk);
    let (length, sum) = ((chunk.len() as u32 - 4).to_be_bytes(), sum.sum().to_be_bytes());
    let (start, end) = png.split_at(33);
    std::fs::write(&path, [start, &length, &chunk, &sum, end].concat()).unwrap();
    let peak = peak(dir.path(), &["envmap", "info", "p.png", "--ldr", "--memory", "48M"]);
    assert!(peak < 48 << 20, "{} MiB", peak >> 20);
}

#[cfg(unix)]
#[test]
fn a_limit_of_file_sizes_is_an_error_and_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("big.exr"), "old").unwrap();
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 8; exec \"$0\" render furnace -s 1 -r 200 200 -o big.exr"])
        .arg(assert_cmd::cargo::cargo_bin("etalon"))
        .current_dir(dir.path())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("big.exr: File too large"), "{stderr}");
    assert_eq!(std::fs::read(dir.path().join("big.exr")).unwrap(), b"old");
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "a temporary file is left");
}

#[cfg(unix)]
const MOMENT: Duration = Duration::from_millis(500);

/// Starts a command that takes longer than the time limit, and interrupts it after a time.
#[cfg(unix)]
fn interrupted(folder: &Path, args: &[&str], after: Duration) -> Ran {
    use nix::sys::signal::{Signal, kill};

    let mut command = crate::program::interruptible();
    command.args(args).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    std::thread::sleep(after);
    kill(nix::unistd::Pid::from_raw(child.id() as i32), Signal::SIGINT).unwrap();
    let start = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(start.elapsed() < Duration::from_secs(60), "{args:?} took {:?} to end", start.elapsed());
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    let code = output.status.code().unwrap_or_else(|| panic!("{args:?}: {:?}: {stderr}", output.status));
    Ran { code, stdout, stderr }
}

#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn every_long_command_can_be_interrupted() {
    let dir = tempfile::tempdir().unwrap();
    for args in [
        &["validate", "warp", "--samples", "10000000000"][..],
        &["validate", "--planted", "--samples", "10000000000"],
        &["converge", "cornell-spheres", "--budget", "300"],
        &["stability"],
        &["reproduce"],
        &["render", "cornell-spheres", "-s", "1000000"],
        &["envmap", "proposal", "nave", "-n", "268435456"],
        &["envmap", "cut", "nave", "-n", "2,500000"],
    ] {
        let ran = interrupted(dir.path(), &[args, &["--json", "-o", "results"]].concat(), MOMENT);
        assert_eq!(ran.code, 3, "{args:?}: {}{}", ran.stdout, ran.stderr);
        let said = ran.stdout.contains("\"interrupted\":true") || ran.stderr.contains("error: interrupted");
        assert!(said, "{args:?}: {}{}", ran.stdout, ran.stderr);
        let left = std::fs::read_dir(dir.path().join("results")).into_iter().flatten();
        let parts = left.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part"));
        assert_eq!(parts.count(), 0, "{args:?}");
    }
}

/// A program's BSDF, too, keeps its finished checks.
#[cfg(unix)]
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn an_interrupted_test_of_a_bsdf_tells_what_it_has() {
    if !crate::exec::has("python3", &["--version"]) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let diffuse = "
from math import cos, pi, sin, sqrt, tau
def value(wo, wi): return 0.5 / pi if wo[2] > 0 and wi[2] > 0 else 0.0
def pdf(wo, wi): return wi[2] / pi if wo[2] > 0 and wi[2] > 0 else 0.0
def sample(wo, u): return (sqrt(u[0]) * cos(tau * u[1]), sqrt(u[0]) * sin(tau * u[1]), sqrt(1 - u[0]))
";
    std::fs::write(dir.path().join("slow.py"), diffuse).unwrap();
    let args = ["validate", "slow.py", "--samples", "10000000", "--json", "-o", "o"];
    let mut attempts = (1..7).map(|n| interrupted(dir.path(), &args, MOMENT * 2_u32.pow(n)));
    let ran = attempts.find(|ran| !ran.stdout.is_empty()).unwrap();
    assert_eq!(ran.code, 3, "{}{}", ran.stdout, ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(value["interrupted"] == true && value["accepted"].as_u64().unwrap() > 0, "{value}");
}

/// What was not finished is inconclusive, in every format of the result.
#[cfg(unix)]
#[test]
fn an_interrupted_validation_is_never_accepted() {
    let dir = tempfile::tempdir().unwrap();
    let args = ["validate", "warp", "--samples", "17179869184", "--junit", "j.xml", "--json", "-o", "o"];
    // On a busy machine nothing has begun after a moment.
    let mut attempts = (0..6).map(|n| interrupted(dir.path(), &args, MOMENT * 2_u32.pow(n)));
    let ran = attempts.find(|ran| !ran.stdout.is_empty()).unwrap();
    assert_eq!(ran.code, 3, "{}{}", ran.stdout, ran.stderr);
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(value["interrupted"], true);
    let unfinished = value["tests"].as_array().unwrap().iter().filter(|test| test["interrupted"] == true).count();
    assert!(unfinished > 0 && value["inconclusive"].as_u64().unwrap() >= unfinished as u64, "{value}");
    let words = "interrupted before the test was finished";
    let junit = std::fs::read_to_string(dir.path().join("j.xml")).unwrap();
    assert_eq!(junit.matches(&format!("<error message=\"{words}\"")).count(), unfinished, "{junit}");
    let table = std::fs::read_to_string(dir.path().join("o/validation-warp.csv")).unwrap();
    assert_eq!(table.matches(words).count(), unfinished, "{table}");
}
