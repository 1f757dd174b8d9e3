//! A process that gives one reader its inputs, and dies where the reader hangs or takes too much memory.

use super::mutate;
use super::readers::{COMPANIONS, Reader};
use etalon::sampling::stream::{Independent, Stream};
use std::alloc::System;
use std::collections::HashSet;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What an input may allocate at once; inputs have up to 32 KiB.
pub const MEMORY: usize = 256 << 20;
/// How long an input may take, by the clock, of a machine that has other work, too.
const TIME: Duration = Duration::from_secs(10);

#[global_allocator]
static ALLOCATOR: cap::Cap<System> = cap::Cap::new(System, usize::MAX);

/// The input being read.
static NOW: AtomicU64 = AtomicU64::new(0);
/// Where and why something panicked.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// What is known of a run so far: a line in a file, which outlives the process.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// The number of the input being read; after the end the one that would be next.
    pub now: u64,
    /// Inputs that were sound after all.
    pub accepted: u64,
    pub findings: u64,
    pub slowest: u64,
    pub slowest_micros: u64,
    pub peak_bytes: u64,
}

impl Progress {
    const FILE: &str = "progress";

    pub fn read(folder: &Path) -> io::Result<Self> {
        let text = std::fs::read_to_string(folder.join(Self::FILE))?;
        let numbers: Vec<u64> = text.split_ascii_whitespace().map_while(|word| word.parse().ok()).collect();
        let [now, accepted, findings, slowest, slowest_micros, peak_bytes] = numbers[..] else {
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        };
        Ok(Self { now, accepted, findings, slowest, slowest_micros, peak_bytes })
    }

    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let Self { now, accepted, findings, slowest, slowest_micros, peak_bytes } = self;
        let line = format!("{now} {accepted} {findings} {slowest} {slowest_micros} {peak_bytes}");
        std::fs::write(folder.join(Self::FILE), line)
    }
}

/// Inputs of one reader and one seed, by their numbers.
pub struct Inputs<'a> {
    pub reader: &'a Reader,
    pub seed: u64,
    seeds: Vec<Vec<u8>>,
}

impl<'a> Inputs<'a> {
    pub fn new(reader: &'a Reader, seed: u64) -> Self {
        Self { reader, seed, seeds: (reader.seeds)() }
    }

    /// Reads the seeds: behind the first mistake in one, nothing would be reached.
    pub fn check_seeds(&self, folder: &Path) -> io::Result<()> {
        let path = folder.join("seed").with_extension(self.reader.extension);
        self.seeds.iter().enumerate().try_for_each(|(i, seed)| {
            std::fs::write(&path, seed)?;
            let wrong = |e| io::Error::other(format!("seed {i} of {} is not sound: {e}", self.reader.name));
            (self.reader.read)(&path).map_err(wrong)
        })
    }

    pub fn bytes(&self, number: u64) -> Vec<u8> {
        let name = self.reader.name.bytes().fold(0_u32, |hash, byte| hash.wrapping_mul(31) ^ u32::from(byte));
        let mut bytes = mutate::input(&self.seeds, Independent::new(self.seed, number, name));
        (self.reader.seal)(&mut bytes);
        bytes
    }

    /// Keeps an input that was found to be trouble, in the working directory.
    pub fn save(&self, number: u64) -> io::Result<PathBuf> {
        let Reader { name, extension, .. } = self.reader;
        let path = PathBuf::from(format!("fuzz-{name}-{}-{number}.{extension}", self.seed));
        std::fs::write(&path, self.bytes(number)).map(|()| path)
    }
}

/// Puts the files that inputs refer to into a folder.
pub fn companions(folder: &Path) -> io::Result<()> {
    COMPANIONS.iter().try_for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes))
}

/// Reads inputs until number `end` or the time is up, going on from the progress that `folder` holds.
pub fn run(inputs: &Inputs<'_>, folder: &Path, end: u64, time: Duration) -> io::Result<()> {
    let start = Instant::now();
    let mut progress = Progress::read(folder)?;
    std::panic::set_hook(Box::new(|info| {
        *PANIC.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(info.to_string());
    }));
    std::thread::spawn(watch);
    let path = folder.join("input").with_extension(inputs.reader.extension);
    let mut known = HashSet::new();
    let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated() + MEMORY);
    while progress.now < end && start.elapsed() < time {
        std::fs::write(&path, inputs.bytes(progress.now))?;
        progress.write(folder)?;
        NOW.store(progress.now, Ordering::Relaxed);
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (inputs.reader.read)(&path)));
        let micros = begin.elapsed().as_micros() as u64;
        if micros > progress.slowest_micros {
            (progress.slowest, progress.slowest_micros) = (progress.now, micros);
        }
        progress.accepted += u64::from(matches!(outcome, Ok(Ok(()))));
        let panic = PANIC.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
        if let Some(text) = panic {
            progress.findings += 1;
            // One input for each place is enough.
            if known.insert(text.lines().next().unwrap_or_default().to_owned()) {
                let saved = inputs.save(progress.now)?;
                let caught = if outcome.is_ok() { " (and was caught)" } else { "" };
                eprintln!("{}{caught}: {text}", saved.display());
            }
        }
        progress.now += 1;
        progress.peak_bytes = progress.peak_bytes.max(ALLOCATOR.max_allocated() as u64);
    }
    progress.write(folder)
}

/// Ends the process when one input takes too long.
fn watch() {
    let (mut last, mut since) = (u64::MAX, Instant::now());
    loop {
        std::thread::sleep(TIME / 50);
        let now = NOW.load(Ordering::Relaxed);
        if now != last {
            (last, since) = (now, Instant::now());
        } else if since.elapsed() > TIME {
            eprintln!("input {now} takes longer than {} s", TIME.as_secs());
            std::process::abort();
        }
    }
}
