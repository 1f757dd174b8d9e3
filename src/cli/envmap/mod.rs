//! `etalon envmap`: environment maps, one file per subcommand, and the arguments of several of them: the map, how it is shown, and
//! the results for several numbers of samples.

mod cut;
mod info;
mod make;
mod proposal;
mod sample;

use super::console::Console;
use crate::cli::global::{Global, OUTPUT, Verdict};
use crate::cli::map_file::{self, MapOptions};
use crate::cli::values::stops;
use clap::{Args, Subcommand};
use etalon_core::envmap::NamedMap;
use etalon_core::error::{Error, Result};
use etalon_figures::view::map::Look;
use serde::Serialize;
use std::ffi::OsString;

#[derive(Subcommand)]
pub enum Envmap {
    Info(info::Info),
    Sample(sample::Sample),
    Cut(cut::Cut),
    Proposal(proposal::Proposal),
    Make(make::Make),
}

impl Envmap {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        match self {
            Envmap::Info(args) => args.run(console),
            Envmap::Sample(args) => args.run(global, console),
            Envmap::Cut(args) => args.run(global, console),
            Envmap::Proposal(args) => args.run(global, console),
            Envmap::Make(args) => args.run(global, console),
        }
    }
}

/// The map.
#[derive(Args)]
#[command(next_help_heading = "Map")]
pub struct MapArgs {
    /// A file (.exr, .hdr, .pfm) or a built-in map: nave, sun, constant, onehot, black
    #[arg(help_heading = None::<&str>)]
    map: OsString,
    #[command(flatten)]
    options: MapOptions,
}

impl MapArgs {
    pub fn load(&self, console: &Console) -> Result<NamedMap> {
        map_file::load(&self.map, self.options, console)
    }

    pub fn short_name(&self) -> String {
        map_file::short_name(&self.map)
    }
}

/// How a map is shown.
#[derive(Args)]
#[command(next_help_heading = OUTPUT)]
pub struct LookArgs {
    /// Exposure of the drawing in stops [default: chosen from the map]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = stops)]
    exposure: Option<f32>,
    /// Pure power law 1/GAMMA instead of the sRGB curve
    #[arg(long, value_name = "GAMMA", value_parser = gamma)]
    gamma: Option<f32>,
    /// Side of the markers of samples, in texels; less where they are many
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub window: u32,
}

impl LookArgs {
    pub fn look(&self) -> Look {
        Look { exposure: self.exposure, gamma: self.gamma }
    }
}

fn gamma(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|v: &f32| (0.1..=10.0).contains(v)).ok_or("not a number between 0.1 and 10".into())
}

/// The JSON object: a result for each number.
#[derive(Serialize)]
pub struct Outputs<T> {
    pub map: String,
    pub results: Vec<T>,
    pub interrupted: bool,
}

impl<T> Outputs<T> {
    /// Collects `all` results; after an interruption, those that were finished.
    pub fn of(map: &str, all: impl Iterator<Item = Result<T>>) -> Result<Self> {
        let mut outputs = Self { map: map.to_owned(), results: Vec::new(), interrupted: false };
        for result in all {
            match result {
                Err(Error::Interrupted) if !outputs.results.is_empty() => {
                    outputs.interrupted = true;
                    break;
                }
                result => outputs.results.push(result?),
            }
        }
        Ok(outputs)
    }

    pub fn verdict(&self) -> Verdict {
        if self.interrupted { Verdict::Inconclusive } else { Verdict::Good }
    }
}
