//! Fuzzes the readers: damaged files must give a result or an error, soon, in little memory, and without a panic.
//!
//! ```text
//! cargo run --release --example fuzz -- [READER…] [--inputs N] [--seconds S] [--seed N] [--replay READER:SEED:INPUT]
//! ```
//!
//! Every reader runs in a process of its own, so that what kills it (a hang, too much memory, a deep recursion) is
//! known by its input, too. Inputs that make trouble are left in the working directory as `fuzz-READER-SEED-INPUT.*`.

mod mutate;
mod program;
mod readers;
mod samplers;
mod seeds;
mod worker;

use clap::Parser;
use readers::{READERS, Reader};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};
use worker::{Inputs, Progress};

/// Fuzz the readers
#[derive(Parser)]
struct Args {
    /// Which ones (default: all)
    readers: Vec<String>,
    /// Inputs for each reader
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    inputs: u64,
    /// At most so long for each reader
    #[arg(long, value_name = "S", default_value_t = 1e6)]
    seconds: f64,
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Keep one input as a file and read it
    #[arg(long, value_name = "READER:SEED:INPUT")]
    replay: Option<String>,
    /// Be the process that reads, in this folder
    #[arg(long, hide = true)]
    worker: Option<PathBuf>,
}

/// After so many deaths a reader is given up.
const MOST_DEATHS: u64 = 10;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let args = Args::parse();
    // One thread, so that an input does the same every time: programs are asked in the same order.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    if let Some(input) = &args.replay {
        return replay(input).map(|()| ExitCode::SUCCESS);
    }
    let found: Result<Vec<&Reader>, String> = args.readers.iter().map(|name| by_name(name)).collect();
    let chosen = if args.readers.is_empty() { READERS.iter().collect() } else { found? };
    let time = Duration::try_from_secs_f64(args.seconds)?;
    if let (Some(folder), [reader]) = (&args.worker, &chosen[..]) {
        worker::run(&Inputs::new(reader, args.seed), folder, args.inputs, time)?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut findings = 0;
    println!("reader      inputs    sound  inputs/s  slowest ms  peak MiB  findings");
    for reader in chosen {
        findings += fuzz(reader, &args, time)?;
    }
    Ok(if findings == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn by_name(name: &str) -> Result<&'static Reader, String> {
    let names = || READERS.map(|reader| reader.name).join(", ");
    READERS
        .iter()
        .find(|reader| reader.name == name)
        .ok_or_else(|| format!("no reader {name:?}: there are {}", names()))
}

/// Fuzzes one reader, prints a line about it, and returns the number of findings.
fn fuzz(reader: &Reader, args: &Args, time: Duration) -> Result<u64, Box<dyn Error>> {
    let folder = folder()?;
    let inputs = Inputs::new(reader, args.seed);
    let start = Instant::now();
    Progress::default().write(folder.path())?;
    worker::companions(folder.path())?;
    inputs.check_seeds(folder.path())?;
    let mut deaths = 0;
    let progress = loop {
        let left = time.saturating_sub(start.elapsed());
        let status = Command::new(std::env::current_exe()?)
            .args([reader.name, "--inputs", &args.inputs.to_string(), "--seed", &args.seed.to_string()])
            .args(["--seconds", &left.as_secs_f64().to_string(), "--worker"])
            .arg(folder.path())
            .status()?;
        let mut progress = Progress::read(folder.path())?;
        if status.success() {
            break progress;
        }
        deaths += 1;
        eprintln!("{} kills its reader: {status}", inputs.save(progress.now)?.display());
        progress.now += 1;
        progress.findings += 1;
        progress.write(folder.path())?;
        if deaths == MOST_DEATHS {
            break progress;
        }
    };
    let Progress { now, accepted, findings, slowest, slowest_micros, peak_bytes } = progress;
    println!(
        "{:<9} {now:>8} {accepted:>8} {:>9.0} {:>11.1} {:>9} {findings:>9}   slowest: {}:{}:{slowest}",
        reader.name,
        now as f64 / start.elapsed().as_secs_f64(),
        slowest_micros as f64 * 1e-3,
        peak_bytes >> 20,
        reader.name,
        args.seed,
    );
    Ok(findings)
}

/// Writes an input down and reads it without a net.
fn replay(input: &str) -> Result<(), Box<dyn Error>> {
    let [name, seed, number] = input.split(':').collect::<Vec<_>>()[..] else {
        return Err("--replay takes READER:SEED:INPUT".into());
    };
    let (inputs, number) = (Inputs::new(by_name(name)?, seed.parse()?), number.parse()?);
    println!("{}", inputs.save(number)?.display());
    let folder = folder()?;
    worker::companions(folder.path())?;
    let path = folder.path().join("input").with_extension(inputs.reader.extension);
    std::fs::write(&path, inputs.bytes(number))?;
    let start = Instant::now();
    match (inputs.reader.read)(&path) {
        Ok(()) => println!("sound"),
        Err(error) => println!("{error}"),
    }
    println!("{:.3} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// A folder for inputs, in memory where the system has one.
fn folder() -> std::io::Result<tempfile::TempDir> {
    let memory = Path::new("/dev/shm");
    let builder = || tempfile::Builder::new().prefix("etalon-fuzz-").to_owned();
    if memory.is_dir() { builder().tempdir_in(memory) } else { builder().tempdir() }
}
