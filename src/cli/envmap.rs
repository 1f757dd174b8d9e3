//! `etalon envmap`: inspecting, sampling, cutting and making environment maps.

use super::console::Console;
use super::map_file::{self, MapOptions};
use super::{Global, Model, Verdict, map_samplers, map_sampling};
use crate::envmap::info::Info;
use crate::envmap::samplers::{ConventionalSampler, MapSampling, SurfaceSampler};
use crate::envmap::synthetic::Synthetic;
use crate::envmap::{EnvMap, cut};
use crate::errata::Conventions;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::output::{self, Written};
use crate::raster::{self, Metadata, Precision, WriteOptions};
use crate::study::map_samples;
use crate::study::{median_cut, proposal};
use crate::view::map::{Display, Look};
use crate::view::proposal as proposal_view;
use clap::{ArgAction, Args, Subcommand, ValueEnum};
use glam::DVec3;
use serde::Serialize;
use std::ffi::OsString;
use std::sync::Arc;

#[derive(Subcommand)]
pub enum Envmap {
    /// Print a map's size, range, flux and contrast
    Info(InfoArgs),
    /// Show importance samples of a map
    Sample(SampleArgs),
    /// Divide a map by median cut
    Cut(CutArgs),
    /// Compare uniform with Gaussian numbers as proposals for inversion
    Proposal(ProposalArgs),
    /// Write a built-in map
    Make(MakeArgs),
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

const MAP_HELP: &str = "A file (.exr, .hdr, .pfm) or a built-in map: nave, sun, constant, onehot, black";

#[derive(Args)]
pub struct InfoArgs {
    #[arg(help = MAP_HELP)]
    map: OsString,
    #[command(flatten)]
    options: MapOptions,
}

impl InfoArgs {
    fn run(&self, console: &Console) -> Result<Verdict> {
        let source = map_file::load(&self.map, self.options, console)?;
        let info = Info::of(&source.map);
        map_file::warn_upside_down(&info, &source.name, console);
        console.result(&info, || {
            let number = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.6e}"));
            let rgb = |v: [f64; 3]| format!("{:.6e} {:.6e} {:.6e}", v[0], v[1], v[2]);
            format!(
                "size                      {} x {}\nrange                     {} to {}\nmean over texels (RGB)    {}\n\
                 mean over the sphere      {}\nflux (radiance x sr)      {}\npeak / mean               {:.1}\n\
                 effective texels          {:.1} of {}\nbrightest texel           ({}, {}), {:.1}° above the horizon, \
                 {:.2} % of the energy within 2°\nfrom above the horizon    {:.1} % of the energy\n\
                 non-finite, negative      {}, {} texels\n",
                info.width,
                info.height,
                number(info.min),
                number(info.max),
                rgb(info.mean_rgb),
                rgb(info.solid_angle_mean_rgb),
                rgb(info.flux_rgb),
                info.peak_to_mean,
                info.effective_texels,
                info.width * info.height,
                info.peak.0,
                info.peak.1,
                info.peak_elevation_deg,
                100.0 * info.peak_share,
                100.0 * info.upper_share,
                info.nonfinite,
                info.negative
            )
        });
        Ok(Verdict::Good)
    }
}

/// How a map is shown.
#[derive(Args)]
struct LookArgs {
    /// Exposure of the picture in stops (default: chosen from the map)
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = finite)]
    exposure: Option<f32>,
    /// Pure power law 1/GAMMA instead of the sRGB curve
    #[arg(long, value_name = "GAMMA", value_parser = gamma)]
    gamma: Option<f32>,
    /// Side of the markers of samples, in texels
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=65536))]
    window: u32,
}

impl LookArgs {
    fn look(&self) -> Look {
        Look { exposure: self.exposure, gamma: self.gamma }
    }
}

fn finite(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|v: &f32| v.is_finite() && v.abs() <= 100.0).ok_or("not a number within ±100".into())
}

fn gamma(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|v: &f32| (0.1..=10.0).contains(v)).ok_or("not a number between 0.1 and 10".into())
}

fn sampler_help() -> String {
    format!("How directions are sampled. {}", map_samplers(|sampling| !sampling.has_fixed_lights()))
}

/// Reads a direction, not necessarily a unit vector.
fn direction(text: &str) -> std::result::Result<DVec3, String> {
    let parts: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let vector = parts.and_then(|parts| Some(DVec3::from_array(parts.try_into().ok()?)));
    vector.and_then(DVec3::try_normalize).ok_or("not a direction X,Y,Z".into())
}

#[derive(Args)]
#[command(after_help = "Writes MAP-samples-N.{csv,svg,png,pdf} (the map with a blue marker at each sample) and \
                        MAP-samples-only-N.{svg,png,pdf} (the samples alone, in their own colours).\n\nExample:\n  \
                        etalon envmap sample grace.exr --flip -n 64,256,1024")]
pub struct SampleArgs {
    #[arg(help = MAP_HELP)]
    map: OsString,
    /// Numbers of samples
    #[arg(short, value_name = "N,...", value_delimiter = ',', action = ArgAction::Set, default_value = "64,256,1024")]
    n: Vec<usize>,
    #[arg(long, value_name = "NAME", help = sampler_help(), default_value = "cdf", value_parser = map_sampling)]
    sampler: MapSampling,
    /// Normal of the surface that is lit, in the map's frame (y up), for samplers that look at it
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = direction, allow_hyphen_values = true)]
    normal: DVec3,
    /// The same as --sampler compensated
    #[arg(long, conflicts_with_all = ["sampler", "model"])]
    compensated: bool,
    /// `report` samples as the first report did: rows weighted by sin(hπ/(H−1)), which loses the pole rows, and texel
    /// corners, an error of half a texel
    #[arg(long, value_enum, default_value_t = Model::Exact, conflicts_with = "sampler")]
    model: Model,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    options: MapOptions,
}

#[derive(Serialize)]
struct SampleOutput {
    n: usize,
    drawn: usize,
    /// Not for densities that miss a part of the light on purpose.
    flux_estimate: Option<f64>,
    #[serde(flatten)]
    written: Written,
}

#[derive(Serialize)]
struct Outputs<T> {
    map: String,
    results: Vec<T>,
    interrupted: bool,
}

impl<T> Outputs<T> {
    /// The results, one after the other: those that were finished if the process is asked to stop.
    fn of(map: &str, all: impl Iterator<Item = Result<T>>) -> Result<Self> {
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

    fn verdict(&self) -> Verdict {
        if self.interrupted { Verdict::Inconclusive } else { Verdict::Good }
    }
}

impl SampleArgs {
    /// The sampler, and whether it finds all of the map's light.
    fn sampler(&self, map: &Arc<EnvMap>) -> Result<(Box<dyn SurfaceSampler>, bool)> {
        if self.model == Model::Report {
            MapSampling::MAP.request(map)?;
            return Ok((Box::new(ConventionalSampler::new(map.clone(), Conventions::FIRST_REPORT)), true));
        }
        let sampling = if self.compensated { MapSampling::COMPENSATED } else { self.sampler };
        let complete = sampling.entry().complete && !sampling.needs_normal();
        Ok((sampling.sampler(map.clone())?, complete))
    }

    fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = map_file::load(&self.map, self.options, console)?;
        map_file::warn_upside_down(&Info::of(&source.map), &source.name, console);
        let display = Display::new(&source.map, self.look.look());
        let target = global.target(&["map", "n"]);
        let name = map_file::short_name(&self.map);
        let (sampler, complete) = self.sampler(&source.map)?;
        let one = |n: usize| -> Result<SampleOutput> {
            interrupt::check()?;
            let samples = map_samples::draw(&source.map, &*sampler, self.normal, n, global.seed)?;
            if samples.rows.is_empty() {
                console.warn(&format!("{}: no texel of this map can be sampled, so there are no samples", source.name));
            }
            let window = self.look.window as usize;
            let stem = target.stem(&format!("{name}-samples"), &format!("-{n}"), &output::STUDY)?;
            let mut files =
                output::write(&stem, &display.samples(&samples.rows, window), &output::table(&samples.rows)?)?;
            let only = target.stem(&format!("{name}-samples"), &format!("-only-{n}"), &output::DRAWING)?;
            files.extend(display.samples_only(&samples.rows, window).write(&only)?);
            let flux_estimate = (complete && !samples.rows.is_empty()).then_some(samples.flux_estimate);
            Ok(SampleOutput { n, drawn: samples.rows.len(), flux_estimate, written: target.written(files) })
        };
        let outputs = Outputs::of(&source.name, self.n.iter().map(|&n| one(n)))?;
        console.result(&outputs, || {
            let line = |r: &SampleOutput| {
                let flux = r.flux_estimate.map_or(String::new(), |f| format!("; flux estimated from them {f:.6}"));
                format!("{} samples{flux}\n{}", r.drawn, r.written.text())
            };
            outputs.results.iter().map(line).collect()
        });
        Ok(outputs.verdict())
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SplitName {
    Energy,
    Variance,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SidesName {
    Texels,
    Sphere,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CentroidName {
    Energy,
    Median,
}

#[derive(Args)]
#[command(after_help = "Writes MAP-cut-N.{csv,svg,png,pdf} (the map with the regions and their centroids) and \
                        MAP-cut-lights-N.{svg,png,pdf} (the centroids alone, in the colour of their region's flux).\n\n\
                        Example:\n  etalon envmap cut nave -n 2,4,16,64")]
pub struct CutArgs {
    #[arg(help = MAP_HELP)]
    map: OsString,
    /// Numbers of regions. A power of two is reached level by level, every region cut at every level (Debevec 2005); any
    /// other number by cutting the region with the most energy first
    #[arg(short, value_name = "N,...", value_delimiter = ',', action = ArgAction::Set, default_value = "2,4,16,64")]
    n: Vec<usize>,
    /// Cut where the energy halves, or where the larger variance of the two halves is smallest
    #[arg(long, value_enum, default_value_t = SplitName::Energy)]
    split: SplitName,
    /// Put a region's light at its energy centroid, or at the first report's median pixel
    #[arg(long, value_enum, default_value_t = CentroidName::Energy)]
    centroid: CentroidName,
    /// How the longer side of a region, which the cut divides, is measured: in texels, as in the first report, or on the
    /// sphere, where texels near the poles are narrow
    #[arg(long, value_enum, default_value_t = SidesName::Texels)]
    sides: SidesName,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    options: MapOptions,
}

#[derive(Serialize)]
struct CutOutput {
    n: usize,
    flux_error: f64,
    imbalance: f64,
    #[serde(flatten)]
    written: Written,
}

impl CutArgs {
    fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = map_file::load(&self.map, self.options, console)?;
        let info = Info::of(&source.map);
        map_file::warn_upside_down(&info, &source.name, console);
        let split = if self.split == SplitName::Energy { cut::Split::Energy } else { cut::Split::Variance };
        let sides = if self.sides == SidesName::Texels { cut::SideRule::Texels } else { cut::SideRule::Sphere };
        let centroid = match self.centroid {
            CentroidName::Energy => median_cut::Centroid::Energy,
            CentroidName::Median => median_cut::Centroid::Median,
        };
        let cuts = median_cut::cut(&source.map, &self.n, split, sides, centroid)?;
        let display = Display::new(&source.map, self.look.look());
        let target = global.target(&["map", "n"]);
        let name = map_file::short_name(&self.map);
        let one = |(&n, rows): (&usize, &Vec<median_cut::RegionRow>)| -> Result<CutOutput> {
            interrupt::check()?;
            let stem = target.stem(&format!("{name}-cut"), &format!("-{n}"), &output::STUDY)?;
            let mut files = output::write(&stem, &display.partition(rows), &output::table(rows)?)?;
            let lights = target.stem(&format!("{name}-cut"), &format!("-lights-{n}"), &output::DRAWING)?;
            files.extend(display.lights(rows, self.look.window as usize).write(&lights)?);
            let (flux_error, imbalance) = (median_cut::flux_error(rows, info.flux_rgb), median_cut::imbalance(rows));
            Ok(CutOutput { n, flux_error, imbalance, written: target.written(files) })
        };
        let outputs = Outputs::of(&source.name, self.n.iter().zip(&cuts).map(one))?;
        console.result(&outputs, || {
            let line = |r: &CutOutput| {
                format!(
                    "{} regions: relative error of the flux {:.1e}, most energetic one {:.3} times the mean\n{}",
                    r.n,
                    r.flux_error,
                    r.imbalance,
                    r.written.text()
                )
            };
            outputs.results.iter().map(line).collect()
        });
        Ok(outputs.verdict())
    }
}

#[derive(Args)]
#[command(after_help = "Example:\n  etalon envmap proposal nave -n 100000")]
pub struct ProposalArgs {
    #[arg(help = MAP_HELP)]
    map: OsString,
    /// Number of samples with each kind of number
    #[arg(short, value_name = "N", default_value_t = 100_000)]
    n: usize,
    #[command(flatten)]
    options: MapOptions,
}

impl ProposalArgs {
    fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        #[derive(Serialize)]
        struct Output {
            #[serde(flatten)]
            result: proposal::Proposal,
            #[serde(flatten)]
            written: Written,
        }
        let source = map_file::load(&self.map, self.options, console)?;
        let Some(result) = proposal::compare(&source.map, self.n, global.seed)? else {
            return Err(Error::parameter("map", format!("{} has light in too few rows for this test", source.name)));
        };
        let target = global.target(&["map"]);
        let stem = target.stem(&format!("{}-proposal", map_file::short_name(&self.map)), "", &output::STUDY)?;
        let files = output::write(&stem, &proposal_view::drawing(&result), &output::table(&result.bins)?)?;
        let output = Output { result, written: target.written(files) };
        console.result(&output, || {
            let line = |name: &str, t: &etalon_stats::chi_square::ChiSquare| {
                format!("{name}: chi-square {:.1} with {} degrees of freedom, p = {:.3e}\n", t.statistic, t.dof, t.p)
            };
            line("uniform numbers ", &output.result.uniform)
                + &line("Gaussian numbers", &output.result.gaussian)
                + &output.written.text()
        });
        Ok(Verdict::Good)
    }
}

#[derive(Args)]
#[command(after_help = "Example:\n  etalon envmap make nave -o envmaps")]
pub struct MakeArgs {
    /// nave, sun, constant, onehot or black
    name: String,
}

impl MakeArgs {
    fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        #[derive(Serialize)]
        struct Output {
            name: &'static str,
            width: usize,
            height: usize,
            #[serde(flatten)]
            written: Written,
        }
        let Some(synthetic) = Synthetic::from_name(&self.name) else {
            let known: Vec<_> = Synthetic::ALL.iter().map(|s| format!("{} ({})", s.name(), s.description())).collect();
            return Err(Error::parameter("name", format!("there is no built-in map \"{}\"", self.name))
                .with_hint(format!("built-in maps: {}", known.join("; "))));
        };
        let image = synthetic.make();
        interrupt::check()?;
        let target = global.target(&["name"]);
        let format = output::image_format(global.out.as_deref())?.unwrap_or("exr");
        let path = output::with_extension(&target.stem(synthetic.name(), "", &[format])?, format);
        let metadata = Metadata::default().with("map", synthetic.name());
        let options = WriteOptions { precision: Precision::Half, ..WriteOptions::default() };
        raster::write_with(&path, &image, &metadata, options)?;
        let written = target.written(vec![path]);
        let output = Output { name: synthetic.name(), width: image.width(), height: image.height(), written };
        console.result(&output, || output.written.text());
        Ok(Verdict::Good)
    }
}
