//! `etalon envmap info`: size, range, flux and contrast of a map.

use super::options::MapArgs;
use crate::cli::console::Console;
use crate::cli::global::Verdict;
use clap::Args;
use etalon_core::envmap::info;
use etalon_core::error::Result;
use etalon_figures::view::text::rounded;

/// Print a map's size, range, flux and contrast
#[derive(Args)]
pub struct Info {
    #[command(flatten)]
    map: MapArgs,
}

impl Info {
    pub fn run(&self, console: &Console) -> Result<Verdict> {
        let info = info::Info::of(&self.map.load(console)?.map);
        console.result(&info, || {
            let number = |v: Option<f32>| v.map_or("none".into(), |v| rounded(f64::from(v), 4));
            let rgb = |v: [f64; 3]| v.map(|v| format!("{:<9}", rounded(v, 4))).join(" ").trim_end().to_owned();
            format!(
                "size                      {} x {}\nrange                     {} to {}\nmean over texels (RGB)    {}\n\
                 mean over the sphere      {}\nflux (radiance x sr)      {}\npeak / mean               {:.1}\n\
                 effective texels          {:.0} of {}\nbrightest texel           ({}, {}), {:.1}° above the horizon, \
                 {:.2} % of the energy within 2°\nfrom above the horizon    {:.1} % of the energy\n\
                 non-finite, negative      {} and {} texels\n",
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
