//! What every subcommand takes and returns: the global flags and the verdict.

use super::arguments::Arguments;
use crate::output::Target;
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;

pub const DEFAULT_SEED: u64 = 1;

/// Flags that every subcommand takes.
#[derive(Args)]
pub struct Global {
    /// Print one JSON object on standard output and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Seed of all random numbers
    #[arg(long, global = true, value_name = "N", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Worker threads (default: one per core)
    #[arg(short, long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Upper limit of memory, in bytes or with K, M or G (default: the free memory of the machine)
    #[arg(long, global = true, value_name = "SIZE", value_parser = size)]
    pub memory: Option<u64>,
    /// No progress bars and no warnings
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Where results go: a folder, or a file whose name (with .csv, .png, .exr ...) all of them take [default: out, under
    /// names that contain the options that differ from their defaults]
    #[arg(short, long, global = true, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// All arguments of the run.
    #[arg(skip)]
    pub arguments: Arguments,
}

impl Global {
    /// Where results go. Default names contain the arguments that differ from their defaults, except those (`in_name`, by
    /// their ids) that the name contains already.
    pub fn target(&self, in_name: &[&str]) -> Target {
        self.arguments.target(self.out.as_deref(), in_name)
    }
}

/// Reads a number of bytes, for example `512M`.
fn size(text: &str) -> std::result::Result<u64, String> {
    let shift = match text.chars().last().map(|unit| unit.to_ascii_uppercase()) {
        Some('K') => 10,
        Some('M') => 20,
        Some('G') => 30,
        _ => 0,
    };
    let digits = if shift > 0 { &text[..text.len() - 1] } else { text };
    let bytes = digits.parse::<u64>().ok().and_then(|number| number.checked_mul(1 << shift));
    bytes.ok_or("not a number of bytes such as 512M or 2G".into())
}

/// The result of a command that ran to its end, for the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Exit code 0.
    Good,
    /// A check or a test failed: exit code 1.
    Rejected,
    /// Too few samples, or interrupted: exit code 3.
    Inconclusive,
}

impl Verdict {
    /// The verdict on work whose checks all hold (`good`) or not, or that was interrupted.
    pub fn of(good: bool, interrupted: bool) -> Self {
        match good {
            _ if interrupted => Self::Inconclusive,
            true => Self::Good,
            false => Self::Rejected,
        }
    }
}

impl From<Verdict> for ExitCode {
    fn from(verdict: Verdict) -> Self {
        Self::from(match verdict {
            Verdict::Good => 0,
            Verdict::Rejected => 1,
            Verdict::Inconclusive => 3,
        })
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn sizes_are_bytes_or_have_a_unit() {
        let read = |text| super::size(text).ok();
        assert_eq!(
            [read("77"), read("2K"), read("100M"), read("3g")],
            [Some(77), Some(2048), Some(100 << 20), Some(3 << 30)]
        );
        assert!(["", "M", "-1", "1.5G", "2T", "99999999999G", "é"].into_iter().all(|text| read(text).is_none()));
    }
}
