//! `etalon envmap info`: size, range, flux and contrast of a map.

use super::MapArgs;
use crate::cli::console::Console;
use crate::cli::global::Verdict;
use clap::Args;
use etalon_bench::table::Table;
use etalon_core::envmap::info;
use etalon_core::error::Result;
use etalon_figures::view::text::rounded;

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
