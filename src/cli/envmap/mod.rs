//! `etalon envmap`: environment maps: their size, range and flux; inversion with uniform and with Gaussian random numbers; a built-in
//! map as a file. The arguments of several subcommands: the map, how it is shown, and the results for several numbers of samples.

mod cut;
mod sample;

use super::console::Console;
use crate::cli::global::{Global, OUTPUT, SAMPLING, Verdict, out, seed, threads};
use crate::cli::map_file::{self, MapOptions};
use crate::cli::style::StyleArgs;
use crate::cli::values::stops;
use clap::{Args, Subcommand};
use etalon_bench::proposal;
use etalon_bench::table::Table;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::envmap::{NamedMap, info};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{self, Metadata, Precision, WriteOptions};
use etalon_figures::figure::Wanted;
use etalon_figures::output;
use etalon_figures::view::map::Look;
use etalon_figures::view::proposal as view;
use etalon_figures::view::text::{p_is, rounded};
use etalon_stats::power::ChiSquare;
use serde::Serialize;
use std::ffi::OsString;

#[derive(Subcommand)]
pub enum Envmap {
    Info(Info),
    Sample(sample::Sample),
    Cut(cut::Cut),
    Proposal(Proposal),
    Make(Make),
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

/// Print a map's size, range, flux and contrast
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap info nave")]
pub struct Info {
    #[command(flatten)]
    map: MapArgs,
}

impl Info {
    pub fn run(&self, console: &Console) -> Result<Verdict> {
        let info = info::Info::of(&self.map.load(console)?.map);
        console.result(&info, || {
            let number = |v: Option<f32>| v.map_or("none".into(), |v| rounded(f64::from(v), 4));
            let rgb = |v: [f64; 3]| v.map(|v| format!("{:<9}", rounded(v, 4))).join(" ");
            let brightest = format!(
                "({}, {}), {:.1}° above the horizon, {:.2} % of the energy within 2°",
                info.peak.0,
                info.peak.1,
                info.peak_elevation_deg,
                100.0 * info.peak_share
            );
            let lines = [
                ("size", format!("{} x {}", info.width, info.height)),
                ("range", format!("{} to {}", number(info.min), number(info.max))),
                ("mean over texels (RGB)", rgb(info.mean_rgb)),
                ("mean over the sphere", rgb(info.solid_angle_mean_rgb)),
                ("flux (radiance x sr)", rgb(info.flux_rgb)),
                ("peak / mean", format!("{:.1}", info.peak_to_mean)),
                ("effective texels", format!("{:.0} of {}", info.effective_texels, info.width * info.height)),
                ("brightest texel", brightest),
                ("from above the horizon", format!("{:.1} % of the energy", 100.0 * info.upper_share)),
                ("non-finite, negative", format!("{} and {} texels", info.nonfinite, info.negative)),
            ];
            Table::of(&lines).words("", |line| line.0).words("", |line| &line.1).text()
        });
        Ok(Verdict::Good)
    }
}

/// Sample rows of a map with uniform and with Gaussian random numbers
///
/// Both go through the inverse of the rows' distribution function, as in the first report.
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap proposal nave -n 100000")]
#[command(next_help_heading = SAMPLING, args = [out(), seed(), threads()])]
pub struct Proposal {
    /// Samples with each kind of random number
    #[arg(short, value_name = "N", default_value_t = 100_000)]
    n: usize,
    #[command(flatten)]
    map: MapArgs,
    #[command(flatten)]
    style: StyleArgs,
}

impl Proposal {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = self.map.load(console)?;
        let bar = console.busy("proposal");
        let Some(result) = proposal::compare(&source.map, self.n, global.seed)? else {
            return Err(Error::parameter("map", format!("{} has light in too few rows for this test", source.name)));
        };
        let (target, style) = (global.target(), self.style.style()?);
        let stem = target.stem(&format!("{}-proposal", self.map.short_name()), "", &output::STUDY)?;
        let (mut wanted, drawing) = (Wanted::of(&style), view::drawing(&result));
        let files = output::write(&stem, &drawing, &wanted.style(&drawing), &output::csv(&result.bins)?)?;
        bar.finish_and_clear();
        console.saved(&result, &target.written(files), || {
            let line = |name: &str, t: &ChiSquare| {
                format!("{name:<24} chi-square {:.1}, {} degrees of freedom, {}\n", t.statistic, t.dof, p_is(t.p))
            };
            line("uniform random numbers:", &result.uniform) + &line("Gaussian random numbers:", &result.gaussian)
        });
        wanted.check()?;
        Ok(Verdict::Good)
    }
}

/// Write a built-in map
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap make nave -o envmaps")]
#[command(next_help_heading = "Map", args = [out()])]
pub struct Make {
    /// nave, sun, constant, onehot or black
    #[arg(help_heading = None::<&str>)]
    name: String,
}

impl Make {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        #[derive(Serialize)]
        struct Output {
            name: &'static str,
            width: usize,
            height: usize,
        }
        let Some(synthetic) = Synthetic::from_name(&self.name) else {
            let known: Vec<_> = Synthetic::ALL.iter().map(|s| format!("{} ({})", s.name(), s.description())).collect();
            return Err(Error::parameter("name", format!("there is no built-in map \"{}\"", self.name))
                .with_hint(format!("built-in maps: {}", known.join("; "))));
        };
        synthetic.request()?;
        let image = synthetic.make();
        interrupt::check()?;
        let target = global.target();
        let format = output::image_format(global.out.as_deref())?.unwrap_or("exr");
        let path = target.file(synthetic.name(), "", format)?;
        let metadata = Metadata::default().with("map", synthetic.name());
        let options = WriteOptions { precision: Precision::Half, ..WriteOptions::default() };
        raster::write_with(&path, &image, &metadata, options)?;
        let written = target.written(vec![path]);
        let output = Output { name: synthetic.name(), width: image.width(), height: image.height() };
        console.saved(&output, &written, String::new);
        Ok(Verdict::Good)
    }
}
