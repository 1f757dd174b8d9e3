//! `etalon envmap sample`: importance samples of a map, drawn over it and alone.

use super::{LookArgs, MapArgs, Outputs};
use crate::cli::console::Console;
use crate::cli::global::{Global, SAMPLING, Verdict, out, seed, threads};
use crate::cli::style::FigureArgs;
use crate::cli::values::{map_samplers, map_sampling, model};
use clap::{ArgAction, Args};
use etalon_bench::map_samples::{self, MapSamples, SampleRow};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::samplers::{ErrataSampler, MapSampling, SurfaceSampler};
use etalon_core::errata::Formulas;
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_figures::output::{self, Written};
use etalon_figures::view::map::Display;
use etalon_figures::view::text::{LINE, counted, rounded, wrapped};
use glam::DVec3;
use serde::Serialize;
use std::sync::Arc;

/// Show importance samples of a map
#[derive(Args)]
#[command(after_long_help = "Writes MAP-samples-N.{csv,svg,png,pdf} (the map with a blue marker at each sample) and \
                        MAP-samples-only-N.{svg,png,pdf} (the samples alone, in their own colours).\n\nExample:\n  \
                        etalon envmap sample nave -n 64,256,1024")]
#[command(next_help_heading = SAMPLING, args = [out(), seed(), threads()])]
pub struct Sample {
    /// Numbers of samples
    #[arg(short, value_name = "N,...", value_delimiter = ',', action = ArgAction::Set, default_value = "64,256,1024")]
    n: Vec<usize>,
    /// How directions are sampled
    #[arg(long, value_name = "NAME", long_help = sampler_help(), default_value = "cdf", value_parser = map_sampling)]
    sampler: MapSampling,
    /// Normal of the illuminated surface (y up), for samplers that use it
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = direction, allow_hyphen_values = true)]
    normal: DVec3,
    /// Sample correctly, or as the first report did
    ///
    /// `report`: rows weighted by sin(hπ/(H−1)), which loses the pole rows, and texel corners, an error of half a texel.
    #[arg(long, value_parser = model(), default_value = "exact", conflicts_with = "sampler")]
    model: Formulas,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    map: MapArgs,
    #[command(flatten)]
    style: FigureArgs,
}

#[derive(Serialize)]
struct Output {
    n: usize,
    drawn: usize,
    /// (R + G + B)/3; none for densities that leave out a part of the light.
    flux_estimate: Option<f64>,
    /// Standard error of the estimate; none for one sample, too.
    flux_standard_error: Option<f64>,
    samples: Vec<SampleRow>,
    #[serde(flatten)]
    written: Written,
}

impl Output {
    fn flux(&self) -> String {
        let Some(flux) = self.flux_estimate else { return String::new() };
        let error = match self.flux_standard_error {
            None => "standard error unknown".to_owned(),
            // Radiance is in single precision.
            Some(error) if error < f64::from(f32::EPSILON) * flux => "the same from each of them".to_owned(),
            Some(error) => format!("standard error {}", rounded(error, 2)),
        };
        format!("; flux of (R + G + B)/3 estimated from them {}, {error}", rounded(flux, 4))
    }
}

impl Sample {
    /// The sampler, and whether its density is positive wherever the map has light.
    fn sampler(&self, map: &Arc<EnvMap>) -> Result<(Box<dyn SurfaceSampler>, bool)> {
        if self.model != Formulas::Exact {
            MapSampling::MAP.request(map)?;
            return Ok((Box::new(ErrataSampler::new(map.clone())), true));
        }
        let complete = self.sampler.entry().complete && !self.sampler.needs_normal();
        Ok((self.sampler.sampler(map.clone())?, complete))
    }

    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = self.map.load(console)?;
        let display = Display::new(&source.map, self.look.look());
        let (target, style) = (global.target(), self.style.style()?);
        let name = self.map.short_name();
        let (sampler, complete) = self.sampler(&source.map)?;
        // Sample before drawing, so that the sampler's tables and the pages of figures are not in memory together.
        let sample = |n: usize| {
            interrupt::check()?;
            map_samples::draw(&source.map, &*sampler, self.normal, n, global.seed)
        };
        let sampled: Vec<Result<MapSamples>> = self.n.iter().map(|&n| sample(n)).collect();
        drop(sampler);
        // Draw n directions over the map and on black.
        let one = |n: usize, samples: Result<MapSamples>| -> Result<Output> {
            interrupt::check()?;
            let samples = samples?;
            if samples.rows.is_empty() {
                console.warn(&format!("{}: no texel of this map can be sampled, so there are no samples", source.name));
            }
            let window = self.look.window as usize;
            let stem = target.stem(&format!("{name}-samples"), &format!("-{n}"), &output::STUDY)?;
            let count = counted(samples.rows.len(), "sample");
            let titled = |ending: &str| style.clone().or_title(&format!("{count} of {name}{ending}"));
            let mut files = output::write(
                &stem,
                &display.samples(&samples.rows, window),
                &titled(""),
                &output::csv(&samples.rows)?,
            )?;
            // Many markers take seconds to draw.
            interrupt::check()?;
            let only = target.stem(&format!("{name}-samples"), &format!("-only-{n}"), &output::DRAWING)?;
            files.extend(display.samples_only(&samples.rows, window).write(&only, &titled(", alone"))?);
            let flux_estimate = (complete && !samples.rows.is_empty()).then_some(samples.flux_estimate);
            let flux_standard_error = flux_estimate.and(Some(samples.flux_standard_error)).filter(|e| e.is_finite());
            let (samples, written) = (samples.rows, target.written(files));
            Ok(Output { n, drawn: samples.len(), flux_estimate, flux_standard_error, samples, written })
        };
        let bar = console.progress(self.n.len() as u64, "sample", "numbers");
        let outputs = self.n.iter().zip(sampled).map(|(&n, samples)| one(n, samples).inspect(|_| bar.inc(1)));
        let outputs = Outputs::of(&source.name, outputs)?;
        bar.finish_and_clear();
        console.result(&outputs, || {
            let about = |r: &Output| wrapped(&format!("{}{}", counted(r.drawn, "sample"), r.flux()), "", LINE);
            let line = |r: &Output| about(r) + &r.written.text();
            outputs.results.iter().map(line).collect()
        });
        Ok(outputs.verdict())
    }
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
