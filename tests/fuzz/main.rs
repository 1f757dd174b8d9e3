//! Fuzzes the readers: damaged files must give a result or an error, soon, in little memory, and without a panic.
//!
//! `cargo test --test fuzz` damages the seeds at random, for a moment per reader or for as long as
//! `BOLERO_RANDOM_TEST_TIME_MS` says; `cargo bolero test --test fuzz NAME` (nightly Rust) lets libFuzzer choose the damage by the
//! code that it reaches. An input that makes its reader panic stays in `target/tmp/fuzz/NAME/panic.*`; one that ends the
//! process, because its reader hangs, overflows the stack or asks for too much memory, in `input.*` there.

mod damage;
mod readers;

use damage::damaged;
use std::alloc::System;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, Once};
use std::time::{Duration, Instant};

/// What all readers that run at the same time may allocate together; inputs have up to 32 KiB.
const MEMORY: usize = 512 << 20;
/// How long one input may take.
const TIME: Duration = Duration::from_secs(20);
/// How long a reader is fuzzed, if nothing else is asked for.
const BRIEFLY: Duration = Duration::from_millis(500);
/// Most bytes that say how a seed is damaged: some eight changes.
const PROGRAM: usize = 64;

#[global_allocator]
static ALLOCATOR: cap::Cap<System> = cap::Cap::new(System, MEMORY);

/// The inputs being read, and since when.
static RUNNING: LazyLock<Mutex<HashMap<PathBuf, Instant>>> = LazyLock::new(Mutex::default);

/// One reader, the seeds to damage, and the folder of its own in which it reads.
struct Target {
    seeds: Vec<Vec<u8>>,
    input: PathBuf,
    read: fn(&Path) -> etalon::Result<()>,
}

impl Target {
    /// Reads the seeds whole: behind the first mistake in one, nothing would be reached.
    fn new(name: &str, extension: &str, read: fn(&Path) -> etalon::Result<()>) -> Self {
        static WATCH: Once = Once::new();
        WATCH.call_once(|| drop(std::thread::spawn(watch)));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz").join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds");
        // Scenes name other seeds, which therefore lie beside the input.
        for other in ["tga", "ply", "pbrt", "collada", "samples", "grid"] {
            for file in files(&all.join(other)) {
                std::fs::copy(&file, folder.join(file.file_name().unwrap())).unwrap();
            }
        }
        let seeds = files(&all.join(name)).iter().map(|file| std::fs::read(file).unwrap()).collect();
        let target = Self { seeds, input: folder.join("input").with_extension(extension), read };
        for (i, seed) in target.seeds.iter().enumerate() {
            target.read(seed).unwrap_or_else(|e| panic!("seed {i} of {name} is not sound: {e}"));
        }
        target
    }

    fn read(&self, bytes: &[u8]) -> etalon::Result<()> {
        // Some file systems wait for the disk where a file is overwritten, but not where it is new.
        let _ = std::fs::remove_file(&self.input);
        std::fs::write(&self.input, bytes).unwrap();
        let _reading = Reading::new(&self.input);
        (self.read)(&self.input)
    }
}

/// An input while it is read.
struct Reading<'a>(&'a Path);

impl<'a> Reading<'a> {
    fn new(input: &'a Path) -> Self {
        RUNNING.lock().unwrap().insert(input.into(), Instant::now());
        Self(input)
    }
}

impl Drop for Reading<'_> {
    fn drop(&mut self) {
        RUNNING.lock().unwrap().remove(self.0);
        if std::thread::panicking() {
            let _ = std::fs::copy(self.0, self.0.with_file_name("panic").with_extension(self.0.extension().unwrap()));
        }
    }
}

/// The files of a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Ends the process when an input takes too long.
fn watch() {
    loop {
        std::thread::sleep(TIME / 50);
        if let Some((input, _)) = RUNNING.lock().unwrap().iter().find(|(_, since)| since.elapsed() > TIME) {
            eprintln!("{} takes longer than {} s", input.display(), TIME.as_secs());
            std::process::abort();
        }
    }
}

macro_rules! targets {
    ($($name:ident $extension:literal $read:expr;)*) => {$(
        #[test]
        fn $name() {
            let target = Target::new(stringify!($name), $extension, $read);
            let (mut inputs, mut sound) = (0, 0);
            bolero::check!().with_test_time(BRIEFLY).with_max_len(PROGRAM).for_each(|program| {
                // Both are good: an error, and a file that is sound after all.
                sound += u32::from(target.read(&damaged(&target.seeds, program)).is_ok());
                inputs += 1;
            });
            println!("{}: {inputs} inputs, {sound} of them sound", stringify!($name));
        }
    )*};
}

targets! {
    exr "exr" readers::exr;
    hdr "hdr" readers::image;
    pfm "pfm" readers::image;
    pnm "ppm" readers::image;
    png "png" readers::png;
    jpeg "jpg" readers::image;
    tga "tga" readers::image;
    part "exr" readers::part;
    ply "ply" readers::mesh;
    obj "obj" readers::mesh;
    pbrt "pbrt" readers::scene;
    collada "dae" readers::scene;
    settings "txt" readers::settings;
    samples "csv" readers::samples;
    grid "csv" readers::grid;
    protocol "txt" readers::protocol;
}
