//! `etalon envmap cut`: the regions of a median cut and the lights that stand for them.

use super::{LookArgs, MapArgs, Outputs};
use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict, out};
use crate::cli::style::FigureArgs;
use crate::cli::values::choice;
use clap::{ArgAction, Args};
use etalon_bench::median_cut::{self, Centroid, RegionRow};
use etalon_core::envmap::cut::{SideRule, Split};
use etalon_core::envmap::info::Info;
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_figures::output::{self, Written};
use etalon_figures::view::map::Display;
use etalon_figures::view::text::counted;
use serde::Serialize;

/// Divide a map by median cut
#[derive(Args)]
#[command(after_long_help = "Writes MAP-cut-N.{csv,svg,png,pdf} (the map with the regions and their centroids) and \
                        MAP-cut-lights-N.{svg,png,pdf} (the centroids alone, in the colour of their region's flux).\n\n\
                        Example:\n  etalon envmap cut nave -n 2,4,16,64")]
#[command(next_help_heading = "Regions", args = [out()])]
pub struct Cut {
    /// Numbers of regions
    ///
    /// A power of two is reached level by level, every region cut at every level (Debevec 2005); any other number by cutting
    /// the region with the most energy first.
    #[arg(short, value_name = "N,...", value_delimiter = ',', action = ArgAction::Set, default_value = "2,4,16,64")]
    n: Vec<usize>,
    /// Where a region is cut
    #[arg(long, default_value = Split::default().name(), value_parser = choice(Split::ALL.map(|s| (s.name(), s.about(), s))))]
    split: Split,
    /// Put lights at energy centroids, or at the first report's median pixels
    #[arg(long, default_value = "energy",
          value_parser = choice([("energy", "", Centroid::Energy), ("median", "", Centroid::Median)]))]
    centroid: Centroid,
    /// How the sides of a region are measured, of which the cut divides the longer
    ///
    /// In texels, as in the first report, or on the sphere, where texels near the poles are narrow.
    #[arg(long, default_value = "texels",
          value_parser = choice([("texels", "", SideRule::Texels), ("sphere", "", SideRule::Sphere)]))]
    sides: SideRule,
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
    /// Relative error of the regions' total flux.
    flux_error: f64,
    /// Energy of the most energetic region over the mean of all regions.
    imbalance: f64,
    lights: Vec<RegionRow>,
    #[serde(flatten)]
    written: Written,
}

impl Cut {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = self.map.load(console)?;
        let flux = Info::of(&source.map).flux_rgb;
        let cuts = median_cut::cut(&source.map, &self.n, self.split, self.sides, self.centroid)?;
        let display = Display::new(&source.map, self.look.look());
        let (target, style) = (global.target(), self.style.style()?);
        let name = self.map.short_name();
        // Draw the regions over the map, and their lights on black.
        let one = |(&n, rows): (&usize, Vec<RegionRow>)| -> Result<Output> {
            interrupt::check()?;
            let stem = target.stem(&format!("{name}-cut"), &format!("-{n}"), &output::STUDY)?;
            let titled = |what: &str| style.clone().or_title(&format!("{} of {name}", counted(rows.len(), what)));
            let mut files = output::write(&stem, &display.partition(&rows), &titled("region"), &output::csv(&rows)?)?;
            // Half a million regions take seconds to draw.
            interrupt::check()?;
            let lights = target.stem(&format!("{name}-cut"), &format!("-lights-{n}"), &output::DRAWING)?;
            files.extend(display.lights(&rows, self.look.window as usize).write(&lights, &titled("light"))?);
            let (flux_error, imbalance) = (median_cut::flux_error(&rows, flux), median_cut::imbalance(&rows));
            Ok(Output { n, flux_error, imbalance, lights: rows, written: target.written(files) })
        };
        let bar = console.progress(self.n.len() as u64, "cut", "numbers");
        let outputs = self.n.iter().zip(cuts).map(|cut| one(cut).inspect(|_| bar.inc(1)));
        let outputs = Outputs::of(&source.name, outputs)?;
        bar.finish_and_clear();
        console.result(&outputs, || {
            let line = |r: &Output| {
                format!(
                    "{}: flux of all exact to {:.1e}, the largest {:.2} times the mean\n{}",
                    counted(r.n, "region"),
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
